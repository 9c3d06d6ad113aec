//! What is wrong with a scene file, and where.

use std::path::Path;

use super::words;
use crate::load::{LoadError, Place};

/// Where to look everything up.
const DOCUMENTATION: &str = "docs/scene-file.md describes every key.";

/// Something wrong at a place of the text.
#[derive(Debug)]
pub struct Complaint {
    /// Offset in bytes.
    pub at: usize,
    /// What is there.
    pub read: String,
    /// What should be there.
    pub expected: String,
    /// What to do.
    pub help: String,
}

impl Complaint {
    /// Without advice.
    pub fn new(at: usize, read: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { at, read: short(read.into()), expected: short(expected.into()), help: DOCUMENTATION.to_owned() }
    }

    /// A name that means nothing, with the nearest that does.
    pub fn unknown(at: usize, what: &str, name: &str, known: &[&str]) -> Self {
        let expected = match known {
            [] => format!("the name of a {what} of this file, and it has none"),
            _ => format!("one of {}", known.join(", ")),
        };
        let mut complaint = Self::new(at, format!("there is no {what} '{name}'"), expected);
        complaint.suggest(name, known);
        complaint
    }

    /// What the parser says, with the nearest key for an unknown one.
    pub fn from_parser(error: &toml::de::Error) -> Self {
        let message = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
        let (read, expected) = words::plain(&message);
        let mut complaint = Self::new(error.span().map_or(0, |span| span.start), read, expected);
        // An unknown key or word, and all that are known.
        let mut quoted = message.split('`').skip(1).step_by(2);
        if let (Some(name), true) = (quoted.next(), message.starts_with("unknown ")) {
            let known: Vec<_> = quoted.collect();
            complaint.suggest(name, &known);
        }
        complaint
    }

    fn suggest(&mut self, name: &str, known: &[&str]) {
        if let Some(nearest) = nearest(name, known) {
            self.help = format!("Did you mean '{}'? {DOCUMENTATION}", short(nearest.to_owned()));
        }
    }

    /// The error for a file with this text.
    pub fn into_error(self, path: &Path, text: &str) -> LoadError {
        LoadError::Syntax {
            path: path.to_owned(),
            place: place(text, self.at),
            read: self.read,
            expected: self.expected,
            help: self.help,
        }
    }
}

/// The line and column of an offset.
pub fn place(text: &str, at: usize) -> Place {
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    Place::Line(line, column)
}

/// Longest quote of a file, in characters.
const LONGEST: usize = 400;

/// A phrase on one line and of bounded length, whatever the file says.
fn short(phrase: String) -> String {
    let mut characters = phrase.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c });
    let shown: String = characters.by_ref().take(LONGEST).collect();
    if characters.next().is_some() {
        shown + "..."
    } else {
        shown
    }
}

/// The known word that a wrong one was probably meant to be.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let close = (name.chars().count() / 3).max(2);
    let distances = known.iter().map(|word| (edit_distance(name, word), *word));
    distances.filter(|(distance, _)| *distance <= close).min_by_key(|(distance, _)| *distance).map(|(_, word)| word)
}

/// Levenshtein's distance of two words; of long ones only that they are far apart.
fn edit_distance(a: &str, b: &str) -> usize {
    const LONGEST: usize = 64;
    if a.len() > LONGEST || b.len() > LONGEST {
        return usize::MAX;
    }
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, a) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a != *b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_suggested_unless_none_is_near() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(nearest("tranlate", &["rotate", "translate"]), Some("translate"));
        assert_eq!(nearest("xyzzy", &["rotate", "translate"]), None);
    }
}
