//! `raywarp serve` as a process.

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

use super::Place;

/// The program with its port open. It ends when this is dropped.
pub struct Server {
    child: Child,
    pub url: String,
    place: Place,
}

impl Server {
    /// At a port, with options.
    pub fn at(place: Place, port: &str, arguments: &[&str]) -> Self {
        let words = [&["serve", "--port", port], arguments].concat();
        let mut child = place.command(&words).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut url = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
        assert!(url.starts_with("http://127.0.0.1:"), "{url}");
        Self { child, url: url.trim().to_owned(), place }
    }

    pub fn port(&self) -> String {
        self.url.split([':', '/']).nth(4).unwrap().to_owned()
    }

    /// Ends it as a power cut would.
    pub fn kill(mut self) -> Place {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        std::mem::replace(&mut self.place, Place::new())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
