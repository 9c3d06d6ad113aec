//! Picture files that are there already.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::Format;

/// What every PNG begins with, up to its width.
const PNG_HEAD: [u8; 16] = *b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
/// What every PNG ends with.
const PNG_END: [u8; 12] = *b"\0\0\0\0IEND\xaeB`\x82";

/// Width and height of a picture file, if there is one and it is whole: a PNG up to its end, an EXR as far as its head
/// tells.
///
/// # Errors
/// Where there is a file that cannot be read.
pub fn probe(path: &Path, format: Format) -> io::Result<Option<[u32; 2]>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    if !file.metadata()?.is_file() {
        return Ok(None);
    }
    let size = match format {
        Format::Png => png_size(file),
        Format::Exr => return Ok(exr_size(file)),
    };
    match size {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        size => size,
    }
}

fn png_size(mut file: File) -> io::Result<Option<[u32; 2]>> {
    let (mut head, mut size, mut end) = ([0; 16], [[0; 4]; 2], [0; 12]);
    file.read_exact(&mut head)?;
    file.read_exact(size.as_flattened_mut())?;
    file.seek(SeekFrom::End(-(PNG_END.len() as i64)))?;
    file.read_exact(&mut end)?;
    Ok((head == PNG_HEAD && end == PNG_END).then_some(size.map(u32::from_be_bytes)))
}

fn exr_size(file: File) -> Option<[u32; 2]> {
    let head = exr::meta::MetaData::read_from_buffered(BufReader::new(file), false).ok()?;
    let size = head.headers.first()?.layer_size;
    Some([u32::try_from(size.x()).ok()?, u32::try_from(size.y()).ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{exr, png, Picture, Rgb8};

    #[test]
    fn whole_files_have_a_size_and_others_have_none() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        let whole = png::encode(&Rgb8 { width: 3, height: 2, pixels: vec![[1, 2, 3]; 6] }).unwrap();
        let picture = Picture { width: 3, height: 2, whole: [9, 9], pixels: vec![[0.0; 4]; 6], ..Picture::default() };
        let linear = exr::encode(&picture, None, &[]).unwrap();
        assert_eq!(probe(&path, Format::Png).unwrap(), None);
        for (format, bytes, cuts) in [(Format::Png, &whole, whole.len()), (Format::Exr, &linear, 100)] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(probe(&path, format).unwrap(), Some([3, 2]), "{format}");
            for length in 0..cuts {
                std::fs::write(&path, &bytes[..length]).unwrap();
                assert_eq!(probe(&path, format).unwrap(), None, "{format}, {length} bytes");
            }
        }
        assert_eq!(probe(directory.path(), Format::Png).unwrap(), None);
    }

    #[test]
    fn a_png_is_read_as_it_was_written() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        let picture = Rgb8 { width: 2, height: 2, pixels: vec![[1, 2, 3], [0; 3], [255; 3], [9, 8, 7]] };
        std::fs::write(&path, png::encode(&picture).unwrap()).unwrap();
        assert_eq!(png::read(&path).unwrap(), picture);
        std::fs::write(&path, b"no picture").unwrap();
        assert!(png::read(&path).unwrap_err().to_string().contains("a.png"));
    }
}
