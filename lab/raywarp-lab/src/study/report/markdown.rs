//! The report as Markdown, whose plots are files beside it.

use super::document::{clean, Block, Document};

/// The text. Figures are in `plots`, a folder beside it.
pub fn text(document: &Document, plots: &str) -> String {
    let body: String = document.blocks.iter().map(|one| block(one, plots)).collect();
    format!("# {}\n{body}", escape(&document.title))
}

fn block(block: &Block, plots: &str) -> String {
    match block {
        Block::Section { text, .. } => format!("\n## {}\n", escape(text)),
        Block::Heading(text) => format!("\n### {}\n", escape(text)),
        Block::Paragraph(text) => format!("\n{}\n", escape(text)),
        Block::Code(text) => format!("\n    {}\n", clean(text)),
        Block::List(sentences) => {
            let items = sentences.iter().map(|sentence| format!("- {}\n", escape(sentence)));
            format!("\n{}", items.collect::<String>())
        }
        Block::Table { caption, table } => format!("{}\n{}\n", table.markdown(escape), escape(caption)),
        Block::Figure(figure) => {
            let caption = escape(&figure.caption);
            format!("\n![{caption}]({plots}/{})\n\n{caption}\n", figure.file)
        }
    }
}

/// A text in one line in which no letter has a meaning.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let text = clean(text);
    for (index, letter) in text.char_indices() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' => escaped.extend(['\\', letter]),
            // At the start of a line these begin a list.
            '-' | '+' if index == 0 && text.len() > 1 => escaped.extend(['\\', letter]),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_have_no_meaning() {
        assert_eq!(escape("a|b\n<i> *x* [y](z) C:\\d"), "a\\|b &lt;i&gt; \\*x\\* \\[y\\](z) C:\\\\d");
        assert_eq!([escape("-"), escape("- a"), escape("k-d tree")], ["-", "\\- a", "k-d tree"]);
    }
}
