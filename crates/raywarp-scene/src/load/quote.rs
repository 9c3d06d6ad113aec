//! Text from files in messages: printable and short, whatever it was.

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
    // Only what would garble a terminal is escaped: an apostrophe or a backslash is part of a name.
    let shown: String = shown.map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect();
    format!("{dots}{shown}")
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
    fn names_keep_their_end() {
        assert_eq!(file_name("a\u{7}b.png"), "a\u{fffd}b.png");
        let long = file_name(&format!("{}.png", "d/".repeat(500)));
        assert!(long.starts_with("...") && long.ends_with("d/.png") && long.len() == 163, "{long}");
    }
}
