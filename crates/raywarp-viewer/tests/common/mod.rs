//! A server in this process, and a client that speaks its protocol.
#![allow(dead_code, missing_docs)]

use std::net::{SocketAddr, TcpStream};
use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use raywarp::device::{Device, DeviceChoice};
use raywarp_viewer::live::{LiveScene, LiveSceneOptions, Source};
use raywarp_viewer::serve::{Patience, ServeError, ServeOptions, Server, Stopper, PROTOCOL};
use serde_json::{json, Value};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::Request;
use tungstenite::{Error, Message, WebSocket};

/// A red triangle before a green background.
const SCENE: &str = r#"
version = 1
background = [0.1, 0.5, 0.2]

[[materials]]
name = "red"
diffuse = [0.8, 0.1, 0.1]

[[meshes]]
vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
faces = [[0, 1, 2]]
material = "red"

[[lights]]
kind = "directional"
direction = [0, -0.3, -1]

[[cameras]]
name = "near"
eye = [0, 0, 4]
target = [0, 0, 0]
"#;

pub const SIZE: [u32; 2] = [200, 150];

/// As long as any wait may take on a busy machine.
pub const LONG: Duration = Duration::from_secs(60);

/// A server with a scene of its own.
pub struct House {
    pub at: SocketAddr,
    /// What a browser would open.
    pub url: String,
    stopper: Stopper,
    server: Option<JoinHandle<Result<(), ServeError>>>,
    _directory: tempfile::TempDir,
}

impl House {
    pub fn new(options: ServeOptions) -> Self {
        Self::with_scene(options, SCENE)
    }

    pub fn with_scene(options: ServeOptions, scene: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let server = Server::bind(ServeOptions { port: 0, ..options }).unwrap();
        let (at, stopper, url) = (server.address(), server.stopper(), server.addresses().here);
        let server = std::thread::spawn(move || server.run(|| live_scene(path)));
        Self { at, url, stopper, server: Some(server), _directory: directory }
    }

    pub fn open() -> Self {
        Self::new(ServeOptions::default())
    }

    pub fn stop(&self) {
        self.stopper.stop();
    }

    /// How it ended.
    pub fn join(mut self) -> Result<(), ServeError> {
        self.server.take().unwrap().join().unwrap()
    }

    pub fn request(&self) -> Request<()> {
        format!("ws://{}/live", self.at).into_client_request().unwrap()
    }

    /// A connection that has not said hello.
    pub fn connect(&self) -> Client {
        self.connect_by(self.request()).unwrap()
    }

    pub fn connect_by(&self, request: Request<()>) -> Result<Client, Box<Error>> {
        Self::connect_through(self.at, request)
    }

    /// A connection by way of another address.
    pub fn connect_through(at: SocketAddr, request: Request<()>) -> Result<Client, Box<Error>> {
        let stream = TcpStream::connect(at).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let mut handshake = tungstenite::client::client(request, stream);
        loop {
            match handshake {
                Ok((socket, _)) => return Ok(Client { socket, status: Value::Null }),
                Err(tungstenite::HandshakeError::Interrupted(more)) => handshake = more.handshake(),
                Err(tungstenite::HandshakeError::Failure(error)) => return Err(Box::new(error)),
            }
        }
    }

    /// A connection that has been greeted.
    pub fn enter(&self) -> Client {
        let mut client = self.connect();
        client.send(&hello(""));
        assert_eq!(client.text("hello")["protocol"], PROTOCOL);
        client
    }
}

impl Drop for House {
    fn drop(&mut self) {
        self.stopper.stop();
        if let Some(server) = self.server.take() {
            let _ = server.join();
        }
    }
}

/// The scene of a file, on the CPU.
pub fn live_scene(path: PathBuf) -> LiveScene {
    let device = Device::open(DeviceChoice::Cpu).unwrap();
    LiveScene::open(Source { path: Some(path), ..Source::default() }, device, LiveSceneOptions::default())
}

pub fn own_stage(directory: &tempfile::TempDir) -> LiveScene {
    let path = directory.path().join("scene.toml");
    std::fs::write(&path, SCENE).unwrap();
    live_scene(path)
}

/// For waits that a test can sit out.
pub fn impatient() -> Patience {
    let tenths = |n: u64| Duration::from_millis(100 * n);
    Patience { head: tenths(10), request: tenths(10), hello: tenths(5), silence: tenths(30) }
}

pub fn hello(token: &str) -> Value {
    json!({"type": "hello", "protocol": PROTOCOL, "token": token, "width": SIZE[0], "height": SIZE[1]})
}

pub fn event(event: Value) -> Value {
    json!({"type": "event", "event": event})
}

/// Moves the camera, so that a picture follows.
pub fn wheel() -> Value {
    event(json!({"kind": "wheel", "notches": 0.25}))
}

pub struct Client {
    pub socket: WebSocket<TcpStream>,
    /// The last one that was told.
    pub status: Value,
}

/// What comes from the server.
#[derive(Debug)]
pub enum News {
    Text(Value),
    Stripe(Stripe),
    File(Vec<u8>),
    Closed(u16, String),
}

#[derive(Clone, Debug)]
pub struct Stripe {
    pub lossless: bool,
    pub settled: bool,
    pub index: u16,
    pub count: u16,
    pub size: [u32; 2],
    pub row: u16,
    pub rows: u16,
    pub frame: u32,
    pub mark: u32,
    pub content: Vec<u8>,
}

/// A whole picture.
pub struct Shown {
    pub first: Stripe,
    pub rgba: Vec<u8>,
    pub bytes: usize,
}

impl Client {
    pub fn send(&mut self, message: &Value) {
        self.write(Message::text(message.to_string()));
    }

    pub fn write(&mut self, message: Message) {
        self.socket.send(message).unwrap();
    }

    pub fn ack(&mut self, frame: u32) {
        self.send(&json!({"type": "ack", "frame": frame}));
    }

    /// The next message; none if none comes within the time.
    pub fn next(&mut self, limit: Duration) -> Option<News> {
        let start = Instant::now();
        while start.elapsed() < limit {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let message: Value = serde_json::from_str(&text).unwrap();
                    if message["type"] == "status" {
                        self.status = message.clone();
                    }
                    return Some(News::Text(message));
                }
                Ok(Message::Binary(bytes)) if bytes[0] == 3 => return Some(News::File(bytes[1..].to_vec())),
                Ok(Message::Binary(bytes)) => return Some(News::Stripe(stripe(&bytes))),
                Ok(Message::Close(frame)) => {
                    let (code, reason) = frame.map_or((0, String::new()), |f| (f.code.into(), f.reason.to_string()));
                    let _ = self.socket.flush();
                    return Some(News::Closed(code, reason));
                }
                Ok(_) => {}
                Err(Error::Io(error)) if is_timeout(&error) => {}
                Err(error) => return Some(News::Closed(0, error.to_string())),
            }
        }
        None
    }

    /// The next message of a type; others are passed over.
    #[track_caller]
    pub fn text(&mut self, kind: &str) -> Value {
        let start = Instant::now();
        while start.elapsed() < LONG {
            match self.next(LONG) {
                Some(News::Text(message)) if message["type"] == kind => return message,
                Some(News::Closed(code, reason)) => panic!("closed with {code} before '{kind}': {reason}"),
                _ => {}
            }
        }
        panic!("no '{kind}' came");
    }

    /// How the connection is closed.
    #[track_caller]
    pub fn closed(&mut self) -> (u16, String) {
        let start = Instant::now();
        while start.elapsed() < LONG {
            if let Some(News::Closed(code, reason)) = self.next(LONG) {
                return (code, reason);
            }
        }
        panic!("it stays open");
    }

    /// The next picture, whole. Not acknowledged.
    #[track_caller]
    pub fn picture(&mut self) -> Shown {
        self.picture_within(LONG).expect("no picture came")
    }

    pub fn picture_within(&mut self, limit: Duration) -> Option<Shown> {
        let start = Instant::now();
        let (mut stripes, mut bytes): (Vec<Stripe>, usize) = (Vec::new(), 0);
        while start.elapsed() < limit {
            match self.next(limit.saturating_sub(start.elapsed())) {
                Some(News::Stripe(stripe)) => {
                    if stripes.first().is_some_and(|first| first.frame != stripe.frame) {
                        stripes.clear();
                        bytes = 0;
                    }
                    assert_eq!(stripe.index as usize, stripes.len());
                    bytes += stripe.content.len() + 24;
                    if stripe.lossless {
                        self.send(&json!({"type": "received", "frame": stripe.frame, "bytes": bytes}));
                    }
                    stripes.push(stripe);
                    if stripes.len() == stripes[0].count as usize {
                        return Some(joined(&stripes, bytes));
                    }
                }
                Some(News::Closed(code, reason)) => panic!("closed with {code}: {reason}"),
                _ => {}
            }
        }
        None
    }
}

fn is_timeout(error: &std::io::Error) -> bool {
    matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)
}

fn stripe(bytes: &[u8]) -> Stripe {
    let short = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    Stripe {
        lossless: bytes[0] == 2,
        settled: bytes[1] & 1 == 1,
        index: short(2),
        count: short(4),
        size: [short(6).into(), short(8).into()],
        row: short(10),
        rows: short(12),
        frame: long(16),
        mark: long(20),
        content: bytes[24..].to_vec(),
    }
}

fn joined(stripes: &[Stripe], bytes: usize) -> Shown {
    let mut rgba = Vec::new();
    let [width, height] = stripes[0].size;
    for stripe in stripes {
        let image = image::load_from_memory(&stripe.content).unwrap().to_rgba8();
        assert_eq!((image.width(), image.height()), (width, stripe.rows.into()));
        assert_eq!(rgba.len(), 4 * width as usize * stripe.row as usize);
        rgba.extend(image.into_raw());
    }
    assert_eq!(rgba.len(), 4 * (width * height) as usize);
    Shown { first: stripes[0].clone(), rgba, bytes }
}
