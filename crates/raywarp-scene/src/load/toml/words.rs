//! The parser's words for people: what a file says, not what a program calls it.

/// What was read and what was expected, of a message of the parser.
pub fn plain(message: &str) -> (String, String) {
    let (read, expected) = message.split_once(", expected ").unwrap_or((message, "a scene file in TOML"));
    let is_table = is_of_type(read, "map");
    (read_phrase(read), expected_phrase(expected, is_table))
}

/// Kinds of things, as the parser and as people call them. What follows is quoted.
const KINDS: [(&str, &str); 6] = [
    ("integer ", "the whole number "),
    ("floating point ", "the number "),
    ("string ", "the text "),
    ("boolean ", ""),
    ("map", "a table"),
    ("sequence", "an array"),
];

fn is_of_type(read: &str, kind: &str) -> bool {
    read.strip_prefix("invalid type: ").is_some_and(|rest| rest == kind)
}

fn read_phrase(read: &str) -> String {
    if let Some(thing) = read.strip_prefix("invalid type: ").or_else(|| read.strip_prefix("invalid value: ")) {
        return thing_phrase(thing);
    }
    if let Some(length) = read.strip_prefix("invalid length ") {
        return format!("an array of {length}");
    }
    if let Some(key) = read.strip_prefix("missing field ") {
        return format!("the key {} is missing", quoted(key));
    }
    let words = [("unknown field ", "the unknown key "), ("unknown variant ", "the unknown word ")];
    let mut words = words.into_iter().chain([("duplicate field ", "a second key ")]);
    let named = words.find_map(|(from, to)| Some(format!("{to}{}", quoted(read.strip_prefix(from)?))));
    named.unwrap_or_else(|| quoted(read))
}

fn thing_phrase(thing: &str) -> String {
    let known = KINDS.into_iter().find_map(|(from, to)| Some((to, thing.strip_prefix(from)?)));
    match known {
        // Numbers and words of the language speak for themselves; texts have their quotes.
        Some((to, value)) => format!("{to}{}", value.trim_matches('`')),
        None => quoted(thing),
    }
}

fn expected_phrase(expected: &str, for_a_table: bool) -> String {
    let array = "an array";
    match expected {
        "a sequence" if for_a_table => {
            "an array: entries of one begin with two brackets, as [[meshes]] does".to_owned()
        }
        "a sequence" => array.to_owned(),
        "a map" => "a table".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" | "string or table" => "a text in quotes".to_owned(),
        "i64" | "u64" | "i32" | "u32" | "usize" => "a whole number".to_owned(),
        "f64" | "f32" => "a number".to_owned(),
        _ if expected.starts_with("struct ") => "a table".to_owned(),
        _ if expected.starts_with("enum ") => "a word in quotes".to_owned(),
        _ => match expected.strip_prefix("an array of length ") {
            Some(length) => format!("{array} of {length}"),
            None => quoted(expected),
        },
    }
}

/// With one kind of quotes.
fn quoted(phrase: &str) -> String {
    phrase.replace('`', "'")
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn the_language_of_the_program_does_not_show() {
        for (message, read, expected) in [
            ("invalid type: integer `3`, expected a string", "the whole number 3", "a text in quotes"),
            ("invalid type: string \"3\", expected i64", "the text \"3\"", "a whole number"),
            ("invalid type: boolean `true`, expected struct Mesh", "true", "a table"),
            ("invalid value: floating point `NaN`, expected a colour", "the number NaN", "a colour"),
            ("invalid length 2, expected an array of length 3", "an array of 2", "an array of 3"),
            ("missing field `eye`", "the key 'eye' is missing", "a scene file in TOML"),
            ("unknown field `a`, expected `b` or `c`", "the unknown key 'a'", "'b' or 'c'"),
            ("unknown variant `a`, expected one of `b`, `c`", "the unknown word 'a'", "one of 'b', 'c'"),
            ("invalid type: sequence, expected a boolean", "an array", "true or false"),
        ] {
            assert_eq!(plain(message), (read.to_owned(), expected.to_owned()), "{message}");
        }
        let (read, expected) = plain("invalid type: map, expected a sequence");
        assert!(read == "a table" && expected.contains("[[meshes]]"), "{read}; {expected}");
    }
}
