//! What `raywarp serve` would send of pictures.

use std::time::Instant;

use raywarp_viewer::live::Picture;
use raywarp_viewer::serve::{messages, Coding};
use serde::Serialize;

use super::super::spread::Spread;

use crate::failure::Result;

/// Times that the picture at rest is encoded.
const REPEATS: usize = 3;

/// Pictures as they would be sent.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Encoded {
    /// Pictures that were encoded.
    pub pictures: usize,
    /// Of a picture's messages, mean.
    pub bytes: f64,
    /// Of a picture.
    pub ms: Spread,
    /// Their mean.
    pub ms_mean: f64,
}

/// Pictures of a camera that moves, at the best quality that a browser gets.
pub fn moving<'a>(pictures: impl Iterator<Item = &'a Picture>) -> Result<Encoded> {
    encoded(pictures, Coding::MOVING)
}

/// A picture at rest, several times.
pub fn still(picture: &Picture) -> Result<Encoded> {
    encoded(std::iter::repeat_n(picture, REPEATS), Coding::Lossless)
}

fn encoded<'a>(pictures: impl Iterator<Item = &'a Picture>, coding: Coding) -> Result<Encoded> {
    let mut pictures = pictures.peekable();
    if let Some(first) = pictures.peek() {
        // The first time threads wake and memory is new.
        messages(first, coding)?;
    }
    let (mut ms, mut bytes) = (Vec::new(), 0);
    for picture in pictures {
        let start = Instant::now();
        let sent = messages(picture, coding)?;
        ms.push(start.elapsed().as_secs_f64() * 1e3);
        bytes += sent.iter().map(|message| message.as_ref().len()).sum::<usize>();
    }
    let count = ms.len().max(1) as f64;
    let ms_mean = ms.iter().sum::<f64>() / count;
    Ok(Encoded { pictures: ms.len(), bytes: bytes as f64 / count, ms: Spread::of(ms), ms_mean })
}
