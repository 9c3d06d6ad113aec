//! The report as one page that needs nothing else: styles, plots and pictures are within it.

use std::fmt::Write;

use base64::engine::general_purpose::STANDARD;
use base64::Engine;

use super::document::{clean, Block, Document, Figure, Picture};
use raywarp_cli::columns::{Head, Table};

const STYLE: &str = include_str!("page.css");

/// The page, which is well-formed as XML too.
pub fn page(document: &Document) -> String {
    let title = escape(&document.title);
    let body: String = document.blocks.iter().map(block).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n{}{body}\
         </main>\n</body>\n</html>\n",
        contents(document)
    )
}

/// Links to the sections.
fn contents(document: &Document) -> String {
    let links = document.blocks.iter().filter_map(|block| match block {
        Block::Section { name, text } => Some(format!("<a href=\"#{}\">{}</a>\n", escape(name), escape(text))),
        _ => None,
    });
    format!("<nav>\n{}</nav>\n", links.collect::<String>())
}

fn block(block: &Block) -> String {
    match block {
        Block::Section { name, text } => format!("<h2 id=\"{}\">{}</h2>\n", escape(name), escape(text)),
        Block::Heading(text) => format!("<h3>{}</h3>\n", escape(text)),
        Block::Paragraph(text) => format!("<p>{}</p>\n", escape(text)),
        Block::Code(text) => format!("<pre><code>{}</code></pre>\n", escape(text)),
        Block::List(sentences) => {
            let items = sentences.iter().map(|sentence| format!("<li>{}</li>\n", escape(sentence)));
            format!("<ul>\n{}</ul>\n", items.collect::<String>())
        }
        Block::Table { caption, table } => table_of(caption, table),
        Block::Figure(figure) => figure_of(figure),
    }
}

fn table_of(caption: &str, table: &Table) -> String {
    let row = |tag: &str, cells: Vec<(&Head, &str)>| {
        let mut text = String::from("<tr>");
        for (head, cell) in cells {
            let class = if head.right { " class=\"number\"" } else { "" };
            // Writing to a string cannot fail.
            let _ = write!(text, "<{tag}{class}>{}</{tag}>", escape(cell));
        }
        text + "</tr>\n"
    };
    let head = row("th", table.heads.iter().map(|head| (head, head.text.as_str())).collect());
    let body =
        table.rows.iter().map(|cells| row("td", table.heads.iter().zip(cells.iter().map(String::as_str)).collect()));
    format!(
        "<div class=\"table\" tabindex=\"0\">\n<table>\n<caption>{}</caption>\n<thead>\n{head}</thead>\n<tbody>\n{}</tbody>\n\
         </table>\n</div>\n",
        escape(caption),
        body.collect::<String>()
    )
}

fn figure_of(figure: &Figure) -> String {
    let caption = escape(&figure.caption);
    let class = match figure.picture {
        Picture::Svg(_) => "plot",
        Picture::Png(_) => "map",
    };
    let picture = match &figure.picture {
        // Within a page the name space is known, and no address has to be there.
        Picture::Svg(text) => text.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", " role=\"img\"", 1),
        Picture::Png(bytes) => {
            format!("<img alt=\"{caption}\" src=\"data:image/png;base64,{}\" />", STANDARD.encode(bytes))
        }
    };
    format!("<figure class=\"{class}\">\n<div class=\"card\">\n{picture}\n</div>\n<figcaption>{caption}</figcaption>\n</figure>\n")
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in clean(text).chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(letter),
        }
    }
    escaped
}
