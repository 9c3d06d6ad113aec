//! Picture files that are there already.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use exr::meta::attribute::AttributeValue;
use exr::prelude::{read, ReadChannels, ReadLayers};

use super::provenance::{EXR_FINGERPRINT, PNG_FINGERPRINT};
use super::{Format, Found};

/// What a picture file is, if there is one and it is whole: every chunk to the last is read, and its checksum where it
/// has one.
///
/// # Errors
/// Where there is a file that cannot be opened.
pub fn probe(path: &Path, format: Format) -> io::Result<Option<Found>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    if !file.metadata()?.is_file() {
        return Ok(None);
    }
    Ok(match format {
        Format::Png => png_found(BufReader::new(file)),
        Format::Exr => exr_found(BufReader::new(file)),
    })
}

fn png_found(file: BufReader<File>) -> Option<Found> {
    let mut reader = png::Decoder::new(file).read_info().ok()?;
    while reader.next_row().ok()?.is_some() {}
    reader.finish().ok()?;
    let info = reader.info();
    let mut texts = info.uncompressed_latin1_text.iter();
    let fingerprint = texts.find(|text| text.keyword == PNG_FINGERPRINT).map(|text| text.text.clone());
    Some(Found { size: [info.width, info.height], fingerprint })
}

fn exr_found(file: BufReader<File>) -> Option<Found> {
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = reader.pedantic().from_buffered(file).ok()?.layer_data;
    let size = [u32::try_from(layer.size.x()).ok()?, u32::try_from(layer.size.y()).ok()?];
    let mut attributes = layer.attributes.other.iter();
    let fingerprint = attributes.find_map(|(name, value)| match value {
        AttributeValue::Text(text) if name == EXR_FINGERPRINT => Some(text.to_string()),
        _ => None,
    });
    Some(Found { size, fingerprint })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{exr, png, Picture, Provenance, Rgb8};

    #[test]
    fn whole_files_have_a_size_and_others_have_none() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        let whole = png::encode(&Rgb8 { width: 3, height: 2, pixels: vec![[1, 2, 3]; 6] }).unwrap();
        let picture = Picture { width: 3, height: 2, whole: [9, 9], pixels: vec![[0.0; 4]; 6], ..Picture::default() };
        let linear = exr::encode(&picture, None, &[]).unwrap();
        assert_eq!(probe(&path, Format::Png).unwrap(), None);
        let found = Some(Found { size: [3, 2], fingerprint: None });
        for (format, bytes) in [(Format::Png, &whole), (Format::Exr, &linear)] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(probe(&path, format).unwrap(), found, "{format}");
            for length in 0..bytes.len() {
                std::fs::write(&path, &bytes[..length]).unwrap();
                assert_eq!(probe(&path, format).unwrap(), None, "{format}, {length} bytes");
            }
        }
        assert_eq!(probe(directory.path(), Format::Png).unwrap(), None);
    }

    #[test]
    fn a_file_says_how_it_was_made() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        let (software, comment) = ("raywarp 1.2.3".to_owned(), "raywarp render größe.obj --samples 4".to_owned());
        let about = Provenance { software, comment, fingerprint: "0123456789abcdef".to_owned() };
        let picture = Picture { width: 1, height: 2, whole: [1, 2], pixels: vec![[0.5; 4]; 2], ..Picture::default() };
        let shown = Rgb8 { width: 1, height: 2, pixels: vec![[7; 3]; 2] };
        let found = Some(Found { size: [1, 2], fingerprint: Some(about.fingerprint.clone()) });
        for (format, bytes) in [
            (Format::Png, png::encode_described(&shown, Some(&about)).unwrap()),
            (Format::Exr, exr::encode_described(&picture, None, &[], Some(&about)).unwrap()),
        ] {
            std::fs::write(&path, &bytes).unwrap();
            assert_eq!(probe(&path, format).unwrap(), found, "{format}");
            let readable = String::from_utf8_lossy(&bytes);
            assert!(readable.contains("raywarp 1.2.3") && readable.contains("--samples 4"), "{format}");
        }
    }

    #[test]
    fn a_png_with_a_wrong_byte_is_damaged() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        let bytes = png::encode(&Rgb8 { width: 9, height: 9, pixels: vec![[9, 8, 7]; 81] }).unwrap();
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x10;
            std::fs::write(&path, damaged).unwrap();
            assert_eq!(probe(&path, Format::Png).unwrap(), None, "byte {place}");
        }
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
