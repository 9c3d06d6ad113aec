//! Text from files in messages: printable and short, whatever it was.

use std::borrow::Cow;

/// Longest quote, in characters; enough to find a place by.
const LONGEST_QUOTE: usize = 40;
/// Longest file name: its end tells more than its beginning.
const LONGEST_NAME: usize = 160;

/// A piece of a file in quotes, escaped and cut to 40 characters.
pub fn quote(bytes: &[u8]) -> String {
    // A character has at most four bytes: no more than these can be shown.
    let head = &bytes[..bytes.len().min(4 * LONGEST_QUOTE + 4)];
    let text = String::from_utf8_lossy(head);
    let mut characters = text.chars();
    let shown: String = characters.by_ref().take(LONGEST_QUOTE).flat_map(char::escape_debug).collect();
    let dots = if characters.next().is_some() || head.len() < bytes.len() { "..." } else { "" };
    format!("'{shown}{dots}'")
}

/// A file name that a file gave, escaped and cut at its beginning.
pub fn file_name(name: &str) -> String {
    let count = name.chars().count();
    let dots = if count > LONGEST_NAME { "..." } else { "" };
    let shown = name.chars().skip(count.saturating_sub(LONGEST_NAME));
    // An apostrophe or a backslash is part of a name.
    format!("{dots}{}", printable(&shown.collect::<String>()))
}

/// A text without what would garble a terminal or turn the text around: in place of each control character, line end and
/// mark of direction stands U+FFFD.
pub fn printable(text: &str) -> Cow<'_, str> {
    match text.contains(garbles) {
        true => Cow::Owned(text.replace(garbles, "\u{fffd}")),
        false => Cow::Borrowed(text),
    }
}

/// Whether a terminal would obey a character instead of showing it, or show what follows in another order.
pub fn garbles(c: char) -> bool {
    let is_line_end = matches!(c, '\u{2028}' | '\u{2029}');
    let is_direction =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || is_line_end || is_direction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"f 1 2"), "'f 1 2'");
        assert_eq!(quote(b"\x00\xff\n"), "'\\0\u{fffd}\\n'");
        assert_eq!(quote(&[b'x'; 1_000_000]), format!("'{}...'", "x".repeat(40)));
        assert_eq!(quote(&[0xff; 1000]).chars().count(), 45);
        assert_eq!(quote("ü".repeat(40).as_bytes()), format!("'{}'", "ü".repeat(40)));
    }

    #[test]
    fn what_garbles_is_replaced() {
        assert_eq!(printable("\u{1b}[31mred\u{9b}0m\ta\u{202e}b"), "\u{fffd}[31mred\u{fffd}0m\u{fffd}a\u{fffd}b");
        assert!(matches!(printable("Stra\u{df}e 'a\\b'"), Cow::Borrowed(_)));
    }

    #[test]
    fn names_keep_their_end() {
        assert_eq!(file_name("a\u{7}b.png"), "a\u{fffd}b.png");
        let long = file_name(&format!("{}.png", "d/".repeat(500)));
        assert!(long.starts_with("...") && long.ends_with("d/.png") && long.len() == 163, "{long}");
    }
}
