//! Statements that are passed over: counted by their keyword, or all together where they have none.

use super::Statement;

/// Keywords that are counted apart; a file of nothing but keywords must not become a message for each.
const MAX_KINDS: usize = 20;

/// How often each keyword was passed over, in the order of their first lines.
#[derive(Default)]
pub(crate) struct SkippedStatements<'a> {
    pub kinds: Vec<Kind<'a>>,
    /// Statements of further keywords.
    pub more: usize,
}

/// One keyword.
pub(crate) struct Kind<'a> {
    pub keyword: &'a [u8],
    /// Where it stands first.
    pub line: usize,
    pub count: usize,
}

impl<'a> SkippedStatements<'a> {
    pub fn count(&mut self, statement: &Statement<'a>) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.keyword == statement.keyword) {
            kind.count += 1;
        } else if self.kinds.len() < MAX_KINDS {
            self.kinds.push(Kind { keyword: statement.keyword, line: statement.line, count: 1 });
        } else {
            self.more += 1;
        }
    }
}

/// Lines of some kind that are passed over: how many, and the first.
#[derive(Default)]
pub(crate) struct Strays {
    pub count: usize,
    /// Where the first stands.
    pub line: usize,
    /// What it says, in quotes.
    first: String,
}

impl Strays {
    pub fn count(&mut self, statement: &Statement) {
        if self.count == 0 {
            (self.line, self.first) = (statement.line, statement.quoted());
        }
        self.count += 1;
    }

    /// `1 line IS`, or `3 lines ARE, the first 'x'`; nothing where there is none.
    pub fn message(&self, is: &str, are: &str) -> Option<String> {
        match self.count {
            0 => None,
            1 => Some(format!("1 line {is}: {}", self.first)),
            count => Some(format!("{count} lines {are}; the first is {}", self.first)),
        }
    }
}

/// What may be a statement of a dialect. Anything else is a line of another program, or of a file of another kind.
pub(crate) fn is_keyword(keyword: &[u8]) -> bool {
    keyword.first().is_some_and(u8::is_ascii_alphabetic)
        && keyword.iter().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(byte))
}
