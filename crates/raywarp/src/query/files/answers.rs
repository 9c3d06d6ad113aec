//! Answers on their way to a file: collected piece by piece, written at once.

use std::fmt::Write as _;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use bytemuck::cast_slice;
use tempfile::SpooledTempFile;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::npy::Head;
use super::{Format, Mode};
use crate::query::{AllHits, Hits};

/// Bytes of an array that are kept in memory; a longer one waits in a file without a name.
const IN_MEMORY: usize = 1 << 26;

/// Byte order of this machine, as NumPy writes it.
const ORDER: &str = if cfg!(target_endian = "big") { ">" } else { "<" };

/// The answers to some rays.
#[derive(Clone, Copy, Debug)]
pub enum Answers<'a> {
    /// To [`Mode::Closest`].
    Closest(&'a Hits),
    /// To [`Mode::Any`].
    Any(&'a [bool]),
    /// To [`Mode::Count`].
    Count(&'a [u32]),
    /// To [`Mode::All`].
    All(&'a AllHits),
}

impl Answers<'_> {
    /// Rays that are answered, and the hits that they have, where that is known.
    fn counts(&self) -> [u64; 2] {
        match self {
            Self::Closest(hits) => {
                [hits.len() as u64, hits.primitive.iter().filter(|&&p| p != crate::MISS).count() as u64]
            }
            Self::Any(blocked) => [blocked.len() as u64, blocked.iter().filter(|&&blocked| blocked).count() as u64],
            Self::Count(counts) => [counts.len() as u64, counts.iter().map(|&count| u64::from(count)).sum()],
            Self::All(all) => [all.offsets.len() as u64 - 1, all.hits.len() as u64],
        }
    }
}

/// Collects the answers of a batch, in whatever pieces, and writes them to a file.
///
/// The arrays are `t` (float32), `primitive` and `geometry` (uint32) and `uv` (float32, two a hit) for
/// [`Mode::Closest`], `occluded` (bool) for [`Mode::Any`], `count` (uint32) for [`Mode::Count`], and for [`Mode::All`]
/// `offsets` (uint64) and the arrays of hits, where ray `i` has the items from `offsets[i]` to `offsets[i + 1]`.
pub struct AnswerWriter {
    format: Format,
    columns: Vec<Column>,
    rays: u64,
    hits: u64,
}

/// An array that grows, or all text.
struct Column {
    name: &'static str,
    /// Its type without the byte order.
    item: &'static str,
    axes: Axes,
    data: SpooledTempFile,
}

/// The shape of an array.
#[derive(Clone, Copy)]
enum Axes {
    /// That of the batch.
    Batch,
    /// That of the batch, and two.
    PairOfBatch,
    /// One more than there are rays.
    Offsets,
    /// That of all hits.
    Hits,
    /// That of all hits, and two.
    PairOfHits,
}

impl AnswerWriter {
    /// For the answers to a question in a format. What does not fit in memory waits in `directory`, in files without a
    /// name.
    ///
    /// None where the format has no room for them: a `.npy` file holds one array.
    pub fn new(mode: Mode, format: Format, directory: &Path) -> Option<Self> {
        use Axes::{Batch, Hits, Offsets, PairOfBatch, PairOfHits};
        let hits =
            |each, pair| [("t", "f4", each), ("primitive", "u4", each), ("geometry", "u4", each), ("uv", "f4", pair)];
        let columns: Vec<_> = match (format, mode) {
            (Format::Csv, _) => vec![(head(mode), "", Batch)],
            (Format::Npy, Mode::Closest | Mode::All) => return None,
            (_, Mode::Closest) => hits(Batch, PairOfBatch).into(),
            (_, Mode::Any) => vec![("occluded", "b1", Batch)],
            (_, Mode::Count) => vec![("count", "u4", Batch)],
            (_, Mode::All) => [("offsets", "u8", Offsets)].into_iter().chain(hits(Hits, PairOfHits)).collect(),
        };
        let data = || SpooledTempFile::new_in(IN_MEMORY, directory);
        let columns = columns.into_iter().map(|(name, item, axes)| Column { name, item, axes, data: data() }).collect();
        Some(Self { format, columns, rays: 0, hits: 0 })
    }

    /// Rays answered.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// Hits of all rays; for [`Mode::Closest`] and [`Mode::Any`] rays with a hit.
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Adds the answers to the next rays.
    ///
    /// # Errors
    /// They are too many for memory, and the directory has no room; or they are not to the question that is asked.
    pub fn add(&mut self, answers: Answers) -> io::Result<()> {
        let [rays, hits] = answers.counts();
        if rays == 0 {
            return Ok(());
        }
        match self.format {
            Format::Csv => self.add_text(answers)?,
            Format::Npz | Format::Npy => self.add_arrays(answers)?,
        }
        (self.rays, self.hits) = (self.rays + rays, self.hits + hits);
        Ok(())
    }

    fn add_arrays(&mut self, answers: Answers) -> io::Result<()> {
        match answers {
            Answers::Closest(hits) => self.put(&arrays(hits)),
            Answers::Any(blocked) => self.put(&[cast_slice(blocked)]),
            Answers::Count(counts) => self.put(&[cast_slice(counts)]),
            Answers::All(all) => {
                // The first offset of a piece is the last one of the piece before.
                let skipped = usize::from(self.rays > 0);
                let offsets: Vec<u64> = all.offsets[skipped..].iter().map(|offset| self.hits + offset).collect();
                let [t, primitive, geometry, uv] = arrays(&all.hits);
                self.put(&[cast_slice(&offsets), t, primitive, geometry, uv])
            }
        }
    }

    fn put(&mut self, arrays: &[&[u8]]) -> io::Result<()> {
        if arrays.len() != self.columns.len() {
            return Err(io::Error::other("answers to another question than was asked"));
        }
        self.columns.iter_mut().zip(arrays).try_for_each(|(column, array)| column.data.write_all(array))
    }

    fn add_text(&mut self, answers: Answers) -> io::Result<()> {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = match answers {
            Answers::Closest(hits) => (0..hits.len()).try_for_each(|i| line(&mut text, hits, i)),
            Answers::Any(blocked) => blocked.iter().try_for_each(|&b| writeln!(text, "{}", u8::from(b))),
            Answers::Count(counts) => counts.iter().try_for_each(|count| writeln!(text, "{count}")),
            Answers::All(all) => all.offsets.windows(2).zip(self.rays..).try_for_each(|(ends, ray)| {
                (ends[0] as usize..ends[1] as usize).try_for_each(|i| {
                    write!(text, "{ray},")?;
                    line(&mut text, &all.hits, i)
                })
            }),
        };
        self.put(&[text.as_bytes()])
    }

    /// About the bytes that the file will have.
    ///
    /// # Errors
    /// The system fails.
    pub fn bytes(&mut self) -> io::Result<u64> {
        const HEADS: u64 = 512;
        self.columns.iter_mut().try_fold(0, |sum, column| Ok(sum + HEADS + column.data.seek(SeekFrom::End(0))?))
    }

    /// Writes the file. The arrays of a batch get its `shape`, if that has as many rays as were answered, or else one
    /// axis.
    ///
    /// # Errors
    /// The system fails.
    pub fn write(mut self, shape: Option<&[u64]>, output: &mut (impl Write + Seek)) -> io::Result<()> {
        let rays = |shape: &[u64]| shape.iter().try_fold(1u64, |rays, &axis| rays.checked_mul(axis));
        let shape = shape.filter(|shape| rays(shape) == Some(self.rays));
        let shape = shape.map_or_else(|| vec![self.rays], <[u64]>::to_vec);
        self.finish_offsets()?;
        let Self { format, mut columns, rays, hits } = self;
        for column in &mut columns {
            column.data.rewind()?;
        }
        let heads: Vec<_> = columns.iter().map(|column| column.head(&shape, rays, hits)).collect();
        match (format, &mut columns[..]) {
            (Format::Csv, [text]) => {
                writeln!(output, "{}", text.name)?;
                copy(&mut text.data, output)
            }
            (Format::Npy, [column]) => {
                output.write_all(&heads[0])?;
                copy(&mut column.data, output)
            }
            (_, columns) => archive(columns, &heads, output),
        }
    }

    /// A batch without rays has an offset all the same.
    fn finish_offsets(&mut self) -> io::Result<()> {
        match self.columns.first_mut() {
            Some(column) if matches!(column.axes, Axes::Offsets) && self.rays == 0 => {
                column.data.rewind()?;
                column.data.write_all(&[0; 8])
            }
            _ => Ok(()),
        }
    }
}

impl Column {
    /// The head of its file.
    fn head(&self, shape: &[u64], rays: u64, hits: u64) -> Vec<u8> {
        let order = if self.item == "b1" { "|" } else { ORDER };
        let shape = match self.axes {
            Axes::Batch => shape.to_vec(),
            Axes::PairOfBatch => [shape, &[2]].concat(),
            Axes::Offsets => vec![rays + 1],
            Axes::Hits => vec![hits],
            Axes::PairOfHits => vec![hits, 2],
        };
        Head::write(&format!("{order}{}", self.item), &shape)
    }
}

fn arrays(hits: &Hits) -> [&[u8]; 4] {
    [cast_slice(&hits.t), cast_slice(&hits.primitive), cast_slice(&hits.geometry), cast_slice(&hits.uv)]
}

/// The first line of text.
fn head(mode: Mode) -> &'static str {
    match mode {
        Mode::Closest => "t,primitive,geometry,u,v",
        Mode::Any => "occluded",
        Mode::Count => "count",
        Mode::All => "ray,t,primitive,geometry,u,v",
    }
}

fn line(text: &mut String, hits: &Hits, i: usize) -> std::fmt::Result {
    let [u, v] = hits.uv[i];
    // The shortest digits that lead back, with an exponent where they would be many.
    writeln!(text, "{:?},{},{},{u:?},{v:?}", hits.t[i], hits.primitive[i], hits.geometry[i])
}

/// An archive as `numpy.savez` writes it.
fn archive(columns: &mut [Column], heads: &[Vec<u8>], output: &mut (impl Write + Seek)) -> io::Result<()> {
    let mut archive = ZipWriter::new(output);
    for (column, head) in columns.iter_mut().zip(heads) {
        let len = head.len() as u64 + column.data.seek(SeekFrom::End(0))?;
        column.data.rewind()?;
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        archive.start_file(format!("{}.npy", column.name), options.large_file(len > u64::from(u32::MAX)))?;
        archive.write_all(head)?;
        copy(&mut column.data, &mut archive)?;
    }
    archive.finish()?;
    Ok(())
}

fn copy(data: &mut SpooledTempFile, output: &mut impl Write) -> io::Result<()> {
    let mut piece = vec![0; 1 << 20];
    loop {
        match data.read(&mut piece)? {
            0 => return output.flush(),
            len => output.write_all(&piece[..len])?,
        }
    }
}
