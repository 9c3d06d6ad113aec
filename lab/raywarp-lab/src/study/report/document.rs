//! The report before it is a page: headings, sentences, tables and figures in order.
//!
//! All texts are plain. Whoever renders them escapes what its notation gives a meaning.

use raywarp_cli::columns::{Column, Table};

/// A whole report.
#[derive(Debug)]
pub struct Document {
    /// Of the page.
    pub title: String,
    /// From top to bottom.
    pub blocks: Vec<Block>,
}

/// A part of it.
#[derive(Debug)]
pub enum Block {
    /// A section; with a name that is unique in the document, for links.
    Section { name: String, text: String },
    /// A part of a section.
    Heading(String),
    /// Sentences.
    Paragraph(String),
    /// A sentence each.
    List(Vec<String>),
    /// What was typed.
    Code(String),
    /// With what it shows.
    Table { caption: String, table: Table },
    /// A picture.
    Figure(Figure),
}

/// A picture with what it shows.
#[derive(Debug)]
pub struct Figure {
    /// Of its file: unique in the document, lower-case letters, digits and hyphens, with extension.
    pub file: String,
    /// Below it.
    pub caption: String,
    /// What the file holds.
    pub picture: Picture,
}

/// What a figure shows.
#[derive(Debug)]
pub enum Picture {
    /// Drawn, as XML text.
    Svg(String),
    /// Measured, as an encoded PNG.
    Png(Vec<u8>),
}

impl Picture {
    /// As a file holds it.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Svg(text) => text.as_bytes(),
            Self::Png(bytes) => bytes,
        }
    }
}

impl Document {
    /// Nothing but a title.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), blocks: Vec::new() }
    }

    /// Begins a section.
    pub fn section(&mut self, name: &str, text: &str) {
        self.blocks.push(Block::Section { name: name.to_owned(), text: text.to_owned() });
    }

    /// Begins a part of a section.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Heading(text.into()));
    }

    /// Says something.
    pub fn say(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Says several things, if there are any.
    pub fn list(&mut self, sentences: Vec<String>) {
        if !sentences.is_empty() {
            self.blocks.push(Block::List(sentences));
        }
    }

    /// Shows what was typed.
    pub fn code(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Code(text.into()));
    }

    /// A table with a row for each of `rows`, if there are any.
    pub fn table<R>(&mut self, caption: impl Into<String>, columns: &[Column<R>], rows: &[R]) {
        if !rows.is_empty() {
            self.blocks.push(Block::Table { caption: caption.into(), table: Table::of(columns, rows) });
        }
    }

    /// A figure; its file is named after the words.
    pub fn figure(&mut self, words: &[&str], picture: Picture, caption: impl Into<String>) {
        let extension = match picture {
            Picture::Svg(_) => "svg",
            Picture::Png(_) => "png",
        };
        let file = self.unused(&file_name(words), extension);
        self.blocks.push(Block::Figure(Figure { file, caption: caption.into(), picture }));
    }

    /// Every figure.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.blocks.iter().filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
    }

    /// The name, with a number where another figure has it.
    fn unused(&self, name: &str, extension: &str) -> String {
        let taken = |file: &String| self.figures().any(|figure| figure.file == *file);
        let numbered = (2..).map(|number| format!("{name}-{number}.{extension}"));
        let mut names = std::iter::once(format!("{name}.{extension}")).chain(numbered);
        names.find(|file| !taken(file)).unwrap_or_default()
    }
}

/// Letters of a word in the name of a file at most.
const WORD: usize = 40;

/// Words as every file system and every link takes them.
fn file_name(words: &[&str]) -> String {
    let letters = |word: &&str| {
        let lower = word.to_lowercase();
        let parts = lower.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
        let joined = parts.collect::<Vec<_>>().join("-");
        joined.chars().take(WORD).collect::<String>()
    };
    let words: Vec<String> = words.iter().map(letters).filter(|word| !word.is_empty()).collect();
    words.join("-")
}

/// A text in one line, without what no page may hold: control characters, and those that are no characters in XML.
pub fn clean(text: &str) -> String {
    let forbidden = |letter: char| letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|letter| if forbidden(letter) { ' ' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_plain_and_unique() {
        let mut document = Document::new("a");
        for scene in ["../Crown (a).obj", "crown a obj", "<script>&", "鳥"] {
            document.figure(&["load", scene], Picture::Svg(String::new()), "");
        }
        let files: Vec<&str> = document.figures().map(|figure| figure.file.as_str()).collect();
        assert_eq!(files, ["load-crown-a-obj.svg", "load-crown-a-obj-2.svg", "load-script.svg", "load.svg"]);
    }

    #[test]
    fn empty_tables_are_left_out() {
        let mut document = Document::new("a");
        document.table::<u32>("nothing", &[], &[]);
        document.list(Vec::new());
        assert!(document.blocks.is_empty());
    }
}
