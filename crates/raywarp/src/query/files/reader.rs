//! Rays from a file or a pipe, piece by piece.

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use super::csv::{self, Lines};
use super::error::{At, Trouble};
use super::fortran::Fortran;
use super::npy::{Head, MAGIC};
use super::RayFileError;
use crate::scene::load::quote::quote;
use crate::write::is_dash;
use crate::Ray;

/// Rays in a file: `.npy`, or else CSV.
///
/// A `.npy` file has a last axis of 6 (origin, direction; from 0 to infinity) or of 8 (origin, t_min, direction, t_max);
/// any axes before it are the shape of the batch. Items are float32 or float64, which is rounded to float32, of either
/// byte order. CSV has as many columns. `docs/query.md` in the repository tells of both.
pub struct RayReader {
    name: String,
    source: Source,
}

enum Source {
    Npy(Items),
    Csv(Lines<Box<dyn BufRead + Send>>),
}

impl RayReader {
    /// Opens a file; `-` is standard input. Its contents say which kind it is.
    ///
    /// # Errors
    /// It cannot be read, or its head is not that of an array of rays.
    pub fn open(path: &Path) -> Result<Self, RayFileError> {
        if is_dash(path) {
            return Self::new("standard input", Box::new(BufReader::new(io::stdin())), None);
        }
        let name = path.display().to_string();
        let failed = |source| RayFileError::Io { name: name.clone(), source };
        let file = File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        let bytes = metadata.is_file().then_some(metadata.len());
        Self::new(&name, Box::new(BufReader::with_capacity(1 << 20, file)), bytes)
    }

    /// Reads from `input`, which errors call `name`; `bytes` is its length, where that is known.
    ///
    /// # Errors
    /// As for [`open`](Self::open).
    pub fn new(name: &str, mut input: Box<dyn BufRead + Send>, bytes: Option<u64>) -> Result<Self, RayFileError> {
        let source = Source::new(name, &mut input, bytes).map_err(|trouble| trouble.in_file(name))?;
        let source = source.unwrap_or_else(|| Source::Csv(Lines::new(input)));
        Ok(Self { name: name.to_owned(), source })
    }

    /// Axes of the batch, where the file says them before its rays: all but the last of a `.npy` file.
    pub fn shape(&self) -> Option<&[u64]> {
        match &self.source {
            Source::Npy(items) => Some(&items.shape),
            Source::Csv(_) => None,
        }
    }

    /// Rays in the file, where it says so.
    pub fn rays(&self) -> Option<u64> {
        match &self.source {
            Source::Npy(items) => Some(items.rays),
            Source::Csv(_) => None,
        }
    }

    /// Whether numbers are rounded from float64.
    pub fn is_rounded(&self) -> bool {
        matches!(&self.source, Source::Npy(items) if items.kind.bytes == 8)
    }

    /// Replaces `rays` by the next ones, at most `most`; by none at the end.
    ///
    /// # Errors
    /// The file ends too early, or is not what it should be there.
    pub fn read(&mut self, most: usize, rays: &mut Vec<Ray>) -> Result<(), RayFileError> {
        rays.clear();
        let read = match &mut self.source {
            Source::Npy(items) => items.read(most, rays),
            Source::Csv(lines) => lines.read(most, rays),
        };
        read.map_err(|trouble| trouble.in_file(&self.name))
    }
}

impl Source {
    /// An array; nothing for what must be text, of which nothing is read.
    fn new(name: &str, input: &mut Box<dyn BufRead + Send>, bytes: Option<u64>) -> Result<Option<Self>, Trouble> {
        let start = input.fill_buf()?;
        let is_npy = start.starts_with(&MAGIC[..1]) || name.to_ascii_lowercase().ends_with(".npy");
        if start.starts_with(b"PK\x03\x04") {
            return Err(Trouble::flaw(At::Byte(0), "an archive; expected a single array, as numpy.save writes it"));
        }
        if !is_npy {
            return Ok(None);
        }
        let head = Head::read(input)?;
        // The input goes into the array: text has its own.
        let input = std::mem::replace(input, Box::new(io::empty()));
        Items::new(head, input, bytes).map(|items| Some(Self::Npy(items)))
    }
}

/// The rays of a `.npy` file.
struct Items {
    input: Box<dyn BufRead + Send>,
    kind: Kind,
    /// Numbers of a ray.
    columns: usize,
    shape: Vec<u64>,
    /// The array, where it is in that order.
    fortran: Option<Fortran>,
    rays: u64,
    /// Rays read.
    done: u64,
    /// Bytes before the first ray.
    start: u64,
    raw: Vec<u8>,
}

/// How a number is stored.
#[derive(Clone, Copy)]
struct Kind {
    bytes: usize,
    big_endian: bool,
}

/// Rays whose bytes are held at once.
const PIECE: usize = 1 << 15;

impl Items {
    fn new(head: Head, input: Box<dyn BufRead + Send>, bytes: Option<u64>) -> Result<Self, Trouble> {
        let flaw = |what: String| Trouble::flaw(At::Byte(0), what);
        let kind = Kind::of(&head.descr).ok_or_else(|| {
            flaw(format!(
                "items of type {}; expected float32 or float64, so save rays.astype(numpy.float32)",
                quote(head.descr.as_bytes())
            ))
        })?;
        let Some((&columns @ (6 | 8), shape)) = head.shape.split_last() else {
            return Err(flaw(format!(
                "an array of shape {}; expected a last axis of 6 (origin, direction) or 8 (origin, t_min, direction, t_max)",
                tuple(&head.shape)
            )));
        };
        let rays = shape.iter().try_fold(1u64, |product, &axis| product.checked_mul(axis));
        let data = rays.and_then(|rays| rays.checked_mul(columns * kind.bytes as u64));
        let (Some(rays), Some(data)) = (rays, data) else {
            return Err(flaw(format!("an array of shape {}, more than 2^64 bytes", tuple(&head.shape))));
        };
        let is_short = bytes.is_some_and(|bytes| bytes.saturating_sub(head.len) < data);
        if let (true, Some(bytes)) = (is_short, bytes) {
            let what = format!(
                "the file ends here, and rays of shape {} take {data} bytes from byte {} on; it may not be complete",
                tuple(&head.shape),
                head.len
            );
            return Err(Trouble::flaw(At::Byte(bytes), what));
        }
        let fortran = head.fortran_order.then(|| Fortran::new(shape, kind.bytes));
        let (columns, shape) = (columns as usize, shape.to_vec());
        Ok(Self { input, kind, columns, shape, fortran, rays, done: 0, start: head.len, raw: Vec::new() })
    }

    fn read(&mut self, most: usize, rays: &mut Vec<Ray>) -> Result<(), Trouble> {
        let end = usize::try_from(self.rays - self.done).unwrap_or(usize::MAX).min(most) + rays.len();
        while rays.len() < end {
            let piece = (end - rays.len()).min(PIECE);
            self.fill(piece)?;
            let ray = |raw: &[u8]| self.kind.ray(raw, self.columns);
            rays.extend(self.raw.chunks_exact(self.columns * self.kind.bytes).map(ray));
            self.done += piece as u64;
        }
        Ok(())
    }

    /// Reads the bytes of so many rays.
    fn fill(&mut self, rays: usize) -> Result<(), Trouble> {
        if let Some(array) = &mut self.fortran {
            // `new` has seen that this is no more than 2^64.
            array.load(&mut self.input, self.start, self.rays * (self.columns * self.kind.bytes) as u64)?;
            self.raw.clear();
            (0..rays).for_each(|_| array.next(self.columns, &mut self.raw));
            return Ok(());
        }
        self.raw.resize(rays * self.columns * self.kind.bytes, 0);
        self.input.read_exact(&mut self.raw).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => {
                let at = self.start + self.done * (self.columns * self.kind.bytes) as u64;
                let what = format!("the data end within {rays} rays from here, after {} of {}", self.done, self.rays);
                Trouble::flaw(At::Byte(at), what)
            }
            _ => error.into(),
        })
    }
}

impl Kind {
    fn of(descr: &str) -> Option<Self> {
        let (order, item) = descr.split_at_checked(1)?;
        let big_endian = match order {
            "<" => false,
            ">" => true,
            "=" | "|" => cfg!(target_endian = "big"),
            _ => return None,
        };
        match item {
            "f4" => Some(Self { bytes: 4, big_endian }),
            "f8" => Some(Self { bytes: 8, big_endian }),
            _ => None,
        }
    }

    fn ray(self, raw: &[u8], columns: usize) -> Ray {
        let mut numbers = [0.0; 8];
        for (number, bytes) in numbers.iter_mut().zip(raw.chunks_exact(self.bytes)) {
            *number = self.number(bytes);
        }
        csv::ray(&numbers[..columns])
    }

    fn number(self, bytes: &[u8]) -> f32 {
        match (bytes, self.big_endian) {
            (&[a, b, c, d], false) => f32::from_le_bytes([a, b, c, d]),
            (&[a, b, c, d], true) => f32::from_be_bytes([a, b, c, d]),
            (&[a, b, c, d, e, f, g, h], false) => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
            (&[a, b, c, d, e, f, g, h], true) => f64::from_be_bytes([a, b, c, d, e, f, g, h]) as f32,
            _ => f32::NAN,
        }
    }
}

/// A shape as NumPy writes it, cut where it is long.
fn tuple(shape: &[u64]) -> String {
    const SHOWN: usize = 8;
    let axes: Vec<_> = shape.iter().take(SHOWN).map(u64::to_string).collect();
    match shape.len() {
        1 => format!("({},)", axes[0]),
        len if len > SHOWN => format!("({}, ...)", axes.join(", ")),
        _ => format!("({})", axes.join(", ")),
    }
}
