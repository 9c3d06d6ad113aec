//! Names of entry points, put together while the program is compiled.

/// Most letters of a name.
const MOST: usize = 48;

/// A name of up to 48 letters; a longer one does not compile.
pub struct Name {
    letters: [u8; MOST],
    len: usize,
}

impl Name {
    /// Of its parts.
    pub const fn of(parts: [&str; 3]) -> Self {
        let (mut letters, mut len, mut part) = ([0; MOST], 0, 0);
        while part < parts.len() {
            let (from, mut index) = (parts[part].as_bytes(), 0);
            while index < from.len() {
                letters[len] = from[index];
                len += 1;
                index += 1;
            }
            part += 1;
        }
        Self { letters, len }
    }

    /// As text.
    pub const fn text(&'static self) -> &'static str {
        match core::str::from_utf8(self.letters.split_at(self.len).0) {
            Ok(text) => text,
            Err(_) => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Name;

    #[test]
    fn parts_follow_each_other() {
        const NAME: &str = const { &Name::of(["whitted_", "bvh2", "_counted"]) }.text();
        assert_eq!(NAME, "whitted_bvh2_counted");
        const SHORT: &str = const { &Name::of(["all_", "kd", ""]) }.text();
        assert_eq!(SHORT, "all_kd");
    }
}
