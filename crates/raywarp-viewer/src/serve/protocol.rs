//! What goes over the WebSocket at `/live`. This version is 1.
//!
//! # From the client: JSON text, an object each with a `type`
//!
//! | type | fields | |
//! | --- | --- | --- |
//! | `hello` | `protocol`, `token`, `ticket`, `width`, `height` | first, and once; one of `token` and `ticket` where one is needed; size of the picture in pixels |
//! | `event` | `event` | an [`Event`], such as `{"kind": "wheel", "notches": 1}` |
//! | `mark` | `mark` | a number that the first picture made after all input so far is to carry |
//! | `ack` | `frame` | this picture is shown, and so are or never will be those before it |
//! | `received` | `frame`, `bytes` | so many bytes of a lossless picture are there, heads included; after each of its stripes |
//! | `visible` | `visible` | whether anybody can see the pictures; none are made while nobody can |
//!
//! A message has at most 64 KiB. What cannot be read ends the connection.
//!
//! # From the server: JSON text in the same form
//!
//! | type | fields | |
//! | --- | --- | --- |
//! | `hello` | `protocol`, `version`, `name`, `help`, `token` | answers the client's; the help is a list of groups, each a title and a list of keys and what they do; the token comes once, for a ticket, and the ticket is used up |
//! | `status` | `status`, `link` | a [`Status`], and how pictures are sent: `quality`, `scale`, `lag_ms`, `ping_ms`, `viewers` |
//! | `panel` | `panel` | a [`Panel`], whenever it has changed |
//! | `copy` | `text` | to be put on the clipboard |
//! | `file` | `name`, `media_type`, `bytes` | the next binary message of kind 3 is a file to keep |
//! | `end` | `text`, `error` | why the connection is about to be closed |
//!
//! and binary messages. The first byte is the kind: 1 a stripe of a picture in JPEG, 2 one in PNG, 3 a file, whose
//! content follows at once. The head of a stripe has 24 bytes, numbers in little-endian order:
//!
//! | byte | | |
//! | --- | --- | --- |
//! | 0 | u8 | kind |
//! | 1 | u8 | bit 0: nothing more is coming until something happens |
//! | 2 | u16 | index of the stripe, from the top |
//! | 4 | u16 | stripes of the picture |
//! | 6, 8 | u16 | width and height of the picture, which may be smaller than what was asked for |
//! | 10, 12 | u16 | first row and height of the stripe |
//! | 14 | u16 | 0 |
//! | 16 | u32 | number of the picture, growing |
//! | 20 | u32 | latest mark that it includes, 0 at first |
//!
//! The stripes of a picture come in order and whole, but for a lossless one (PNG): the server may break that off for a
//! newer picture. At most two pictures are under way: the third is not made before the first is acknowledged. A ping of
//! WebSocket follows each that is not lossless: its pong tells what the link took, as clients answer it before they decode.
//!
//! Connections are closed with a code and a sentence: 1001 the server was stopped, 1009 a message was too long, 1011
//! the scene or the device failed, 4000 a message could not be read, 4001 the token is wrong, 4002 all places are
//! taken, 4003 another version of the protocol, 4004 nothing was heard from the client.

use serde::{Deserialize, Serialize};

use crate::live::{Event, Panel, Status, HELP};

/// Of the protocol. Clients of another are told to load the page again.
pub const VERSION: u32 = 1;
/// Longest message of a client, in bytes.
pub const MAX_MESSAGE: usize = 64 << 10;
/// Longest side of a picture, and most pixels: 4K.
pub const MAX_SIDE: u32 = 4096;
pub const MAX_PIXELS: u64 = 4096 * 2160;

/// Codes with which connections are closed.
pub mod close {
    pub const AWAY: u16 = 1001;
    pub const TOO_LONG: u16 = 1009;
    pub const FAILED: u16 = 1011;
    pub const UNREADABLE: u16 = 4000;
    pub const TOKEN: u16 = 4001;
    pub const FULL: u16 = 4002;
    pub const VERSION: u16 = 4003;
    pub const SILENT: u16 = 4004;
}

/// Messages of clients.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum FromClient {
    Hello {
        protocol: u32,
        #[serde(default)]
        token: String,
        #[serde(default)]
        ticket: String,
        width: u32,
        height: u32,
    },
    Event {
        event: Event,
    },
    Mark {
        mark: u32,
    },
    Ack {
        frame: u32,
    },
    Received {
        frame: u32,
        bytes: u64,
    },
    Visible {
        visible: bool,
    },
}

/// Messages of the server.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum FromServer<'a> {
    Hello {
        protocol: u32,
        version: &'a str,
        name: &'a str,
        help: &'a [(&'a str, &'a [(&'a str, &'a str)])],
        #[serde(skip_serializing_if = "Option::is_none")]
        token: Option<&'a str>,
    },
    Status {
        status: &'a Status,
        link: Link,
    },
    Panel {
        panel: &'a Panel,
    },
    Copy {
        text: &'a str,
    },
    File {
        name: &'a str,
        media_type: &'a str,
        bytes: usize,
    },
    End {
        text: &'a str,
        error: bool,
    },
}

/// How pictures are sent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Link {
    /// Of JPEG.
    pub quality: u8,
    /// Share of each side that is asked for while the camera moves.
    pub scale: f32,
    /// From the first byte of a picture to its acknowledgement.
    pub lag_ms: f64,
    /// Of an empty message, in whole milliseconds.
    pub ping_ms: f64,
    /// Clients there are.
    pub viewers: usize,
}

impl<'a> FromServer<'a> {
    /// The greeting, with the token for one who came with a ticket.
    pub fn hello(token: Option<&'a str>) -> Self {
        Self::Hello { protocol: VERSION, version: env!("CARGO_PKG_VERSION"), name: "raywarp", help: HELP, token }
    }

    /// As it is sent.
    pub fn text(&self) -> String {
        // Strings, numbers and lists always have a form in JSON.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// The head of a stripe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripeHead {
    pub kind: Kind,
    pub settled: bool,
    pub index: u16,
    pub count: u16,
    pub size: [u16; 2],
    pub row: u16,
    pub rows: u16,
    pub frame: u32,
    pub mark: u32,
}

/// What a binary message holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    Jpeg = 1,
    Png = 2,
    File = 3,
}

impl StripeHead {
    pub const BYTES: usize = 24;

    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        (bytes[0], bytes[1]) = (self.kind as u8, u8::from(self.settled));
        let short = [self.index, self.count, self.size[0], self.size[1], self.row, self.rows, 0];
        for (place, value) in bytes[2..16].chunks_exact_mut(2).zip(short) {
            place.copy_from_slice(&value.to_le_bytes());
        }
        bytes[16..20].copy_from_slice(&self.frame.to_le_bytes());
        bytes[20..24].copy_from_slice(&self.mark.to_le_bytes());
        bytes
    }
}

/// A size that can be rendered and sent, as near as can be to the one that is asked for.
pub fn size_within_limits([width, height]: [u32; 2]) -> [u32; 2] {
    let [width, height] = [width.clamp(1, MAX_SIDE), height.clamp(1, MAX_SIDE)];
    let pixels = u64::from(width) * u64::from(height);
    if pixels <= MAX_PIXELS {
        return [width, height];
    }
    scaled([width, height], (MAX_PIXELS as f64 / pixels as f64).sqrt() as f32)
}

/// A size with each side scaled, at least 1.
pub fn scaled(size: [u32; 2], scale: f32) -> [u32; 2] {
    size.map(|side| ((side as f32 * scale) as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_speaks_this_version() {
        assert!(include_str!("page/link.js").contains(&format!("const PROTOCOL = {VERSION};")));
    }

    #[test]
    fn messages_have_their_form() {
        let read = |text: &str| serde_json::from_str::<FromClient>(text);
        let event = r#"{"type": "event", "event": {"kind": "wheel", "notches": 1.5}}"#;
        assert_eq!(read(event).unwrap(), FromClient::Event { event: Event::Wheel { notches: 1.5 } });
        assert!(read(r#"{"type": "hello", "protocol": 1, "width": 3, "height": 4}"#).is_ok());
        for text in ["", "{}", "[]", "7", r#"{"type": "ack"}"#, r#"{"type": "ack", "frame": -1}"#, r#"{"type": "x"}"#] {
            assert!(read(text).is_err(), "{text}");
        }
        let hello: serde_json::Value = serde_json::from_str(&FromServer::hello(None).text()).unwrap();
        assert_eq!((&hello["type"], &hello["protocol"]), (&"hello".into(), &VERSION.into()));
        assert!(hello["help"][0][1][0][1].is_string() && hello.get("token").is_none(), "{hello}");
    }

    #[test]
    fn heads_are_laid_out_as_documented() {
        let head = StripeHead {
            kind: Kind::Png,
            settled: true,
            index: 0x102,
            count: 0x304,
            size: [0x506, 0x708],
            row: 0x90a,
            rows: 0xb0c,
            frame: 0x0d0e_0f10,
            mark: 0x1112_1314,
        };
        let expected = [2, 1, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 0, 0, 16, 15, 14, 13, 20, 19, 18, 17];
        assert_eq!(head.to_bytes(), expected);
    }

    #[test]
    fn sizes_are_kept_within_limits() {
        assert_eq!(size_within_limits([0, u32::MAX]), [1, MAX_SIDE]);
        assert_eq!(size_within_limits([1920, 1080]), [1920, 1080]);
        for asked in [[u32::MAX; 2], [4096, 4096], [4096, 2161], [5120, 2880]] {
            let [width, height] = size_within_limits(asked);
            assert!(
                u64::from(width) * u64::from(height) <= MAX_PIXELS && width * height > 8_000_000,
                "{width}x{height}"
            );
        }
        assert_eq!(scaled([1, 1000], 0.5), [1, 500]);
    }
}
