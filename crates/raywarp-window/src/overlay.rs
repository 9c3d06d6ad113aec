//! Lines of text over the picture, the scale of a debug view, and the help.

use egui::{vec2, Align2, Area, Color32, Context, Frame, Id, Order, Rect, RichText, Ui, Vec2};

use crate::interface::Content;
use raywarp_viewer::live::{Legend, Notice, Status, HELP};

const MARGIN: f32 = 8.0;
const ERROR: Color32 = Color32::from_rgb(255, 140, 120);
/// Height of letters, in points.
const TEXT: f32 = 12.5;
const HELP_NAME: &str = "help";
/// From one line to the next, in heights of letters.
const LINE: f32 = 1.35;
/// Width of a key and what it does in letters of that height, in points.
const HELP_COLUMN: f32 = 560.0;
const BAR: Vec2 = vec2(240.0, 12.0);

/// Lines for the upper left corner.
pub fn lines(status: &Status) -> Vec<String> {
    let mut speed = vec![format!("{:.1} ms", status.frame_ms)];
    // At rest a picture is refined in steps, and their number a second is nothing to people.
    let moves = status.samples <= 1 && status.frame_ms > 0.0;
    speed.extend(moves.then(|| format!("{:.0} FPS", 1e3 / status.frame_ms)));
    speed.extend((status.kernel_ms > 0.0).then(|| format!("kernels {:.1} ms", status.kernel_ms)));
    speed.extend(status.mrays_per_s.map(|rays| format!("{rays:.0} Mrays/s")));

    let mut quality = vec![format!("{}/{} samples", status.samples, status.spp), by(status.size)];
    quality.extend((status.traced != status.size).then(|| format!("traced {}", by(status.traced))));
    quality.extend(status.reference.then(|| "reference".to_owned()));
    quality.extend(status.settled.then(|| "done".to_owned()));

    let mut scene = vec![format!("{} triangles", status.triangles)];
    scene.extend((!status.accel.is_empty()).then(|| status.accel.clone()));
    scene.extend((status.view != "picture").then(|| format!("showing {}", status.view)));
    vec![speed.join("  "), quality.join("  "), scene.join("  "), status.device.clone()]
}

fn by([width, height]: [u32; 2]) -> String {
    format!("{width}x{height}")
}

/// Lays out all of it.
pub fn show(context: &Context, content: &Content) {
    let (status, free) = (content.status, context.available_rect());
    if status.statistics || !status.pick.is_empty() {
        corner(context, "status", free, Align2::LEFT_TOP, |ui| {
            content.lines.iter().filter(|_| status.statistics).for_each(|line| mono(ui, line));
            pick(ui, &status.pick);
        });
    }
    if let Some(legend) = &status.legend {
        corner(context, "legend", free, Align2::LEFT_BOTTOM, |ui| show_legend(ui, legend));
    }
    let notices: Vec<_> = content.notice.into_iter().chain(&status.notice).collect();
    let busy = status.busy.as_ref().filter(|_| !content.empty);
    if busy.is_some() || !notices.is_empty() {
        corner(context, "notices", free, Align2::CENTER_BOTTOM, |ui| {
            busy.into_iter().for_each(|busy| mono(ui, &format!("{busy} ...")));
            notices.into_iter().for_each(|notice| show_notice(ui, notice));
        });
    }
    if let (true, Some(busy)) = (content.empty, &status.busy) {
        corner(context, "empty", free, Align2::CENTER_CENTER, |ui| mono(ui, &format!("{busy} ...")));
    }
    if status.help {
        let window = context.screen_rect();
        corner(context, HELP_NAME, window, Align2::CENTER_CENTER, |ui| help(ui, window.size()));
    }
}

/// A dark box at a side of a part of the window. The pointer goes through it.
fn corner(context: &Context, name: &str, within: Rect, align: Align2, add: impl FnOnce(&mut Ui)) {
    let away = -align.to_sign() * MARGIN;
    // The help covers other text; the rest should hide as little as it can.
    let (shade, order) = if name == HELP_NAME { (235, Order::Foreground) } else { (175, Order::Middle) };
    let area = Area::new(Id::new(name)).order(order).interactable(false);
    area.anchor(align, away).constrain_to(within).show(context, |ui| {
        let frame = Frame::new().fill(Color32::from_black_alpha(shade)).corner_radius(4.0).inner_margin(6.0);
        frame.show(ui, |ui| {
            ui.set_max_width((within.width() - 4.0 * MARGIN).max(100.0));
            ui.style_mut().visuals.override_text_color = Some(Color32::from_gray(235));
            ui.spacing_mut().item_spacing.y = 2.0;
            add(ui);
        });
    });
}

fn mono(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).monospace());
}

fn show_notice(ui: &mut Ui, notice: &Notice) {
    let text = RichText::new(&notice.text);
    ui.label(if notice.error { text.color(ERROR) } else { text });
}

fn pick(ui: &mut Ui, lines: &[(String, String)]) {
    if lines.is_empty() {
        return;
    }
    ui.add_space(6.0);
    table(ui, "pick", TEXT, lines.iter().map(|(what, value)| (what.as_str(), value.as_str())));
}

type Group = (&'static str, &'static [(&'static str, &'static str)]);

/// All keys, in as many columns and as large as the window allows.
fn help(ui: &mut Ui, window: Vec2) {
    let larger = |a: &Fitted, b: &Fitted| a.0.total_cmp(&b.0);
    let Some((size, columns)) = (1..=4).map(|count| fitted(in_columns(HELP, count), window)).max_by(larger) else {
        return;
    };
    ui.horizontal_top(|ui| {
        for groups in columns {
            ui.vertical(|ui| {
                for (title, keys) in groups {
                    ui.label(RichText::new(*title).strong().size(size));
                    table(ui, title, size, keys.iter().copied());
                }
            });
            ui.add_space(12.0);
        }
    });
}

type Fitted = (f32, Vec<&'static [Group]>);

/// Columns and the height of letters with which they fit into a window.
fn fitted(columns: Vec<&'static [Group]>, window: Vec2) -> Fitted {
    let rows = columns.iter().map(|groups| rows(groups)).max().unwrap_or(1);
    let by_height = ((window.y - 60.0) / rows as f32 - 2.0) / LINE;
    let by_width = TEXT * window.x / (columns.len() as f32 * HELP_COLUMN);
    (by_height.min(by_width).clamp(6.0, TEXT), columns)
}

/// Lines that groups take: a title each, and a line a key.
fn rows(groups: &[Group]) -> usize {
    groups.iter().map(|(_, keys)| 1 + keys.len()).sum()
}

/// Groups in their order, in at most so many columns of about the same height.
fn in_columns(groups: &[Group], columns: usize) -> Vec<&[Group]> {
    let height = rows(groups).div_ceil(columns.max(1));
    let (mut rest, mut filled) = (groups, Vec::new());
    while !rest.is_empty() {
        // The last column takes what is left.
        let last = filled.len() + 1 >= columns;
        let full = (1..=rest.len()).find(|&count| !last && rows(&rest[..count]) >= height);
        let count = full.unwrap_or(rest.len());
        let (column, left) = rest.split_at(count);
        filled.push(column);
        rest = left;
    }
    filled
}

fn table<'a>(ui: &mut Ui, name: &str, size: f32, rows: impl Iterator<Item = (&'a str, &'a str)>) {
    egui::Grid::new(name).spacing(vec2(12.0, 2.0)).min_row_height(0.0).show(ui, |ui| {
        for (left, right) in rows {
            ui.label(RichText::new(left).monospace().size(size).color(Color32::from_rgb(170, 200, 255)));
            ui.label(RichText::new(right).size(size));
            ui.end_row();
        }
    });
}

fn show_legend(ui: &mut Ui, legend: &Legend) {
    ui.label(&legend.title);
    if legend.colors.is_empty() {
        return;
    }
    let (bar, _) = ui.allocate_exact_size(BAR, egui::Sense::hover());
    let width = bar.width() / legend.colors.len() as f32;
    for (i, &[r, g, b]) in legend.colors.iter().enumerate() {
        let left = bar.min + vec2(i as f32 * width, 0.0);
        let part = Rect::from_min_size(left, vec2(width, bar.height()));
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    ui.horizontal(|ui| {
        ui.set_width(BAR.x);
        ui.label(&legend.low);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| ui.label(&legend.high));
    });
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn columns_hold_all_groups_in_their_order(heights in prop::collection::vec(0usize..9, 0..12), columns in 0usize..5) {
            const KEYS: [(&str, &str); 9] = [("", ""); 9];
            const ALL: &[(&str, &str)] = &KEYS;
            let groups: Vec<Group> = heights.iter().map(|&height| ("", &ALL[..height])).collect();
            let filled = in_columns(&groups, columns);
            prop_assert!(filled.len() <= columns.max(1));
            prop_assert_eq!(filled.concat(), groups);
        }
    }
}
