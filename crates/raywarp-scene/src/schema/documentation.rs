//! The rows of parameters in `docs/scene-file.md`.

use super::{Parameter, Usual, Value};

/// The row of a parameter in a table of the documentation: key, value, meaning, default.
pub fn row<T>(parameter: &Parameter<T>) -> String {
    let Parameter { name, kind, meaning, .. } = parameter;
    let also = parameter.alias.map(|alias| format!("; `{alias}` is read as well")).unwrap_or_default();
    format!("| `{name}` | {kind} | {}{also} | {} |", uncapitalized(meaning), default(parameter))
}

fn default<T>(parameter: &Parameter<T>) -> String {
    match parameter.default {
        Usual::Words(words) => words.to_owned(),
        Usual::Value(value) => match value() {
            Value::Flag(on) => format!("`{on}`"),
            Value::Size([width, height]) => format!("`[{width}, {height}]`"),
            Value::Triple([x, y, z]) if x == y && y == z => x.to_string(),
            Value::Triple([x, y, z]) => format!("`[{x}, {y}, {z}]`"),
            Value::Word(word) => format!("`\"{word}\"`"),
            value => value.to_string(),
        },
    }
}

/// As within a sentence: a single capital as in "PNG" or "EV" stays.
fn uncapitalized(sentence: &str) -> String {
    let mut letters = sentence.chars();
    match letters.next() {
        Some(first) => first.to_lowercase().chain(letters).collect(),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::schema::Described;
    use crate::{Light, Material, RenderDefaults};

    /// A section of the document with the rows of all parameters of a `T`: in place of those that are there, the first
    /// ones after the head of the table, each of the others after the one before it.
    fn rewritten<T: Described>(section: &str) -> String {
        let mut lines: Vec<String> = section.lines().map(str::to_owned).collect();
        let mut at = lines.iter().position(|line| line.starts_with("|---")).expect("a table");
        for parameter in T::parameters() {
            let key = format!("| `{}` |", parameter.name);
            match lines.iter().position(|line| line.starts_with(&key)) {
                Some(row) => at = row,
                None => {
                    at += 1;
                    lines.insert(at, String::new());
                }
            }
            lines[at] = row(parameter);
        }
        lines.join("\n") + "\n"
    }

    fn rewrite<T: Described>(text: &str, heading: &str) -> String {
        let start = text.find(heading).expect(heading);
        let end = text[start + 3..].find("\n## ").map_or(text.len(), |end| start + 3 + end + 1);
        format!("{}{}{}", &text[..start], rewritten::<T>(&text[start..end]), &text[end..])
    }

    /// `RAYWARP_BLESS=1` writes the tables anew.
    #[test]
    fn the_documentation_says_what_the_schema_says() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scene-file.md");
        let text = std::fs::read_to_string(&path).unwrap();
        let text_anew = rewrite::<RenderDefaults>(&text, "## `[render]`");
        let text_anew = rewrite::<Material>(&text_anew, "## `[[materials]]`");
        let text_anew = rewrite::<Light>(&text_anew, "## `[[lights]]`");
        if std::env::var_os("RAYWARP_BLESS").is_some_and(|value| value == "1") {
            std::fs::write(&path, text_anew).unwrap();
        } else {
            assert_eq!(text, text_anew, "RAYWARP_BLESS=1 writes the tables of docs/scene-file.md anew");
        }
    }
}
