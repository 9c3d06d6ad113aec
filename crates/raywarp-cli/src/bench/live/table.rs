//! Measurements of the viewer as people read them: Markdown.

use super::super::table::{number, table};
use super::rows::{Live, Part, Row};
use crate::columns::{left, right, Column};
use crate::messages;

impl Live {
    /// Frames, where their time goes, and notes.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{}; one sample a pixel, {} bounces, {} shadows; {} s a row; median (least to most)\n'full' is every picture at \
             full size, 'held' aims at {} a second\n",
            self.machine.sentence(),
            self.max_depth,
            if self.shadows { "with" } else { "without" },
            self.seconds,
            self.aim
        );
        text += &table(&frames(), &self.rows);
        text += &format!(
            "\nTime of a picture on its way to a browser, one thing after the other, mean; JPEG of quality {}\n",
            self.jpeg_quality
        );
        text += &table(&parts(), &self.rows);
        if !self.notes.is_empty() {
            text += "\n";
        }
        self.notes.iter().for_each(|note| text += &format!("- {note}\n"));
        text
    }
}

/// Which row it is.
fn names() -> Vec<Column<'static, Row>> {
    vec![
        left("scene", |row: &Row| row.scene.clone()),
        right("triangles", |row: &Row| row.triangles.to_string()),
        left("tree", |row: &Row| format!("{}, {}", row.layout, row.tree)),
        left("size", |row: &Row| format!("{}x{}", row.size[0], row.size[1])),
        left("case", |row: &Row| row.case.to_string()),
    ]
}

fn frames() -> Vec<Column<'static, Row>> {
    let mut columns = names();
    columns.extend([
        right("frames/s", |row: &Row| number(row.frames_per_s)),
        right("frame, ms", |row: &Row| {
            format!("{} ({} to {})", number(row.ms.median), number(row.ms.least), number(row.ms.most))
        }),
        right("95 % within", |row: &Row| number(row.ms_95)),
        right("late", |row: &Row| percent(row.late)),
        right("pixels traced", |row: &Row| percent(row.traced)),
        right("least", |row: &Row| percent(row.traced_least)),
    ]);
    columns
}

fn parts() -> Vec<Column<'static, Row>> {
    let mut columns = names();
    columns.extend([
        right("trace", |row: &Row| part(row.parts.trace)),
        right("tone-map and fetch", |row: &Row| part(row.parts.fetch)),
        right("other", |row: &Row| part(row.parts.other)),
        right("JPEG", |row: &Row| part(row.parts.encode)),
        right("bytes", |row: &Row| messages::bytes(row.jpeg.bytes as u64)),
        right("PNG at rest", |row: &Row| {
            format!("{} ms, {}", number(row.png.ms.median), messages::bytes(row.png.bytes as u64))
        }),
    ]);
    columns
}

fn part(part: Part) -> String {
    format!("{} ms, {}", number(part.ms), percent(part.share))
}

/// Small shares with a digit more.
fn percent(share: f64) -> String {
    let digits = usize::from(share < 0.0995);
    format!("{:.digits$} %", 100.0 * share)
}
