//! Tables that say of each column what its head is and what is in it.

/// A column of a table: its head, where its text stands, and what is in it.
pub struct Column<'a, R> {
    head: Head,
    cell: Box<dyn Fn(&R) -> String + 'a>,
}

/// The head of a column.
#[derive(Clone, Debug)]
pub struct Head {
    /// Its text.
    pub text: String,
    /// Whether its cells stand at the right, as numbers do.
    pub right: bool,
}

/// A column of words.
pub fn left<'a, R>(head: impl Into<String>, cell: impl Fn(&R) -> String + 'a) -> Column<'a, R> {
    Column { head: Head { text: head.into(), right: false }, cell: Box::new(cell) }
}

/// A column of numbers.
pub fn right<'a, R>(head: impl Into<String>, cell: impl Fn(&R) -> String + 'a) -> Column<'a, R> {
    Column { head: Head { text: head.into(), right: true }, cell: Box::new(cell) }
}

/// A table that is filled.
#[derive(Clone, Debug)]
pub struct Table {
    /// As many as each row has cells.
    pub heads: Vec<Head>,
    /// Without the heads.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A row for each of `rows`.
    pub fn of<R>(columns: &[Column<R>], rows: &[R]) -> Self {
        let cells = |row| columns.iter().map(|column| (column.cell)(row)).collect();
        let heads = columns.iter().map(|column| column.head.clone()).collect();
        Self { heads, rows: rows.iter().map(cells).collect() }
    }

    /// As Markdown, an empty line before it. Each cell goes through `escape`.
    pub fn markdown(&self, escape: impl Fn(&str) -> String) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let head = line(self.heads.iter().map(|head| escape(&head.text)).collect());
        let rule = line(self.heads.iter().map(|head| if head.right { "---:" } else { "---" }.to_owned()).collect());
        let body = self.rows.iter().map(|row| line(row.iter().map(|cell| escape(cell)).collect()));
        format!("\n{head}{rule}{}", body.collect::<String>())
    }
}
