//! What `raywarp serve` would send of pictures.

use std::time::Instant;

use raywarp_viewer::live::Picture;
use raywarp_viewer::serve::{messages, Coding};
use serde::Serialize;

use super::super::spread::Spread;

/// Times that the picture at rest is encoded.
const REPEATS: usize = 3;

/// Pictures as they would be sent.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Encoded {
    /// Pixels of the last picture that was encoded.
    pub size: [u32; 2],
    /// Of its messages.
    pub bytes: usize,
    /// Of a picture.
    pub ms: Spread,
    /// Their mean.
    pub ms_mean: f64,
}

/// Pictures of a camera that moves, at the best quality that a browser gets.
pub fn moving<'a>(pictures: impl Iterator<Item = &'a Picture>) -> anyhow::Result<Encoded> {
    encoded(pictures, Coding::MOVING)
}

/// A picture at rest, several times.
pub fn still(picture: &Picture) -> anyhow::Result<Encoded> {
    encoded(std::iter::repeat_n(picture, REPEATS), Coding::Lossless)
}

fn encoded<'a>(pictures: impl Iterator<Item = &'a Picture>, coding: Coding) -> anyhow::Result<Encoded> {
    let mut pictures = pictures.peekable();
    if let Some(first) = pictures.peek() {
        // The first time threads wake and memory is new.
        messages(first, coding)?;
    }
    let (mut ms, mut size, mut bytes) = (Vec::new(), [0; 2], 0);
    for picture in pictures {
        let start = Instant::now();
        let sent = messages(picture, coding)?;
        ms.push(start.elapsed().as_secs_f64() * 1e3);
        (size, bytes) = (picture.size, sent.iter().map(|message| message.as_ref().len()).sum());
    }
    let ms_mean = ms.iter().sum::<f64>() / ms.len().max(1) as f64;
    Ok(Encoded { size, bytes, ms: Spread::of(ms), ms_mean })
}
