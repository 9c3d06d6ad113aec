//! Names of frames: `frame-####.png`, `frame-{frame:04}.png`.

use std::path::{Path, PathBuf};

use raywarp::write;

use crate::failure::{ensure, fail, Result};

/// A file name with places for the number of the frame.
#[derive(Debug)]
pub struct Template {
    pieces: Vec<Piece>,
}

#[derive(Debug, PartialEq)]
enum Piece {
    Text(String),
    /// The number, with zeros before it up to so many digits.
    Number(usize),
}

/// Most digits that a number is filled up to.
const MOST_DIGITS: usize = 20;

impl Template {
    /// The last row of `#` in a file name is the number, with as many digits; so is `{frame}` or `{frame:04}` anywhere
    /// in a path, and then `#` means itself. `-`, standard output, takes frame after frame.
    ///
    /// # Errors
    /// Where there is no place for the number, or one that is not understood.
    pub fn new(path: &Path) -> Result<Self> {
        let Some(text) = path.to_str() else {
            fail!("cannot number {}: its name is not UTF-8 text", path.display());
        };
        let pieces = match text.contains("{frame") {
            true => braces(text)?,
            false => hashes(text),
        };
        ensure!(
            write::is_dash(path) || pieces.iter().any(|piece| matches!(piece, Piece::Number(_))),
            "every frame needs a file of its own, and {text} is one: put #### or {{frame}} into the name, as in {}",
            numbered(path).display()
        );
        Ok(Self { pieces })
    }

    /// The file of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        let piece = |piece: &Piece| match piece {
            Piece::Text(text) => text.clone(),
            Piece::Number(digits) => format!("{frame:0digits$}"),
        };
        self.pieces.iter().map(piece).collect::<String>().into()
    }
}

/// A name with a place for a number before its extension.
fn numbered(path: &Path) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push("-####");
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

fn hashes(text: &str) -> Vec<Piece> {
    let name = text.rfind(['/', std::path::MAIN_SEPARATOR]).map_or(0, |separator| separator + 1);
    let Some(last) = text[name..].rfind('#').map(|last| name + last) else { return vec![Piece::Text(text.to_owned())] };
    let before = text[name..=last].trim_end_matches('#').len() + name;
    let after = text[last + 1..].to_owned();
    vec![Piece::Text(text[..before].to_owned()), Piece::Number(last + 1 - before), Piece::Text(after)]
}

fn braces(text: &str) -> Result<Vec<Piece>> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("{frame") {
        let parts = after.split_once('}').and_then(|(form, after)| Some((digits(form)?, after)));
        let Some((digits, after)) = parts else {
            fail!("'{{frame{after}' in {text} is not understood: give {{frame}}, or {{frame:04}} for four digits");
        };
        pieces.extend([Piece::Text(before.to_owned()), Piece::Number(digits)]);
        rest = after;
    }
    pieces.push(Piece::Text(rest.to_owned()));
    Ok(pieces)
}

/// Least digits, of nothing or `:04`.
fn digits(form: &str) -> Option<usize> {
    match form.strip_prefix(":0") {
        Some(digits) => digits.parse().ok().filter(|&digits| digits <= MOST_DIGITS),
        None => form.is_empty().then_some(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(template: &str, frame: u32) -> String {
        Template::new(Path::new(template)).unwrap().path(frame).display().to_string()
    }

    #[test]
    fn numbers_stand_where_the_name_says() {
        for (template, frame, expected) in [
            ("a-####.png", 7, "a-0007.png"),
            ("a-#.png", 12, "a-12.png"),
            ("####", 12345, "12345"),
            ("#1/#-##.exr", 3, "#1/#-03.exr"),
            ("é#é##é.png", 3, "é#é03é.png"),
            ("{frame}.png", 7, "7.png"),
            ("{frame:04}/a#-{frame:02}.png", 7, "0007/a#-07.png"),
            ("-", 7, "-"),
        ] {
            assert_eq!(name(template, frame), expected, "{template}");
        }
    }

    #[test]
    fn names_without_a_place_and_odd_places_are_refused() {
        for (template, sentence) in [
            ("a.png", "as in a-####.png"),
            ("##/a.png", "as in ##/a-####.png"),
            ("", "put ####"),
            ("{frame:4}.png", "'{frame:4}.png'"),
            ("{frame:0x}", "is not understood"),
            ("{frame:099}", "is not understood"),
            ("{frames}", "is not understood"),
            ("a{frame", "is not understood"),
        ] {
            let error = Template::new(Path::new(template)).unwrap_err().to_string();
            assert!(error.contains(sentence), "{template}: {error}");
        }
    }

    #[test]
    fn every_frame_has_another_name() {
        for template in ["a##.png", "{frame}-{frame:03}.png"] {
            let names: std::collections::HashSet<String> = (0..2000).map(|frame| name(template, frame)).collect();
            assert_eq!(names.len(), 2000, "{template}");
        }
    }
}
