//! Lines of text over the picture, the scale of a debug view, and the help.

use egui::{vec2, Align2, Area, Color32, Context, Frame, Id, Order, RichText, Ui, Vec2};

use super::interface::Content;
use crate::live::{Legend, Notice, Status, HELP};

const MARGIN: f32 = 8.0;
const ERROR: Color32 = Color32::from_rgb(255, 140, 120);
const BAR: Vec2 = vec2(240.0, 12.0);

/// Lines for the upper left corner.
pub fn lines(status: &Status) -> Vec<String> {
    let mut speed = vec![format!("{:.1} ms", status.frame_ms)];
    speed.extend((status.frame_ms > 0.0).then(|| format!("{:.0} FPS", 1e3 / status.frame_ms)));
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
    let status = content.status;
    corner(context, "status", Align2::LEFT_TOP, |ui| {
        content.lines.iter().for_each(|line| mono(ui, line));
        pick(ui, &status.pick);
    });
    if let Some(legend) = &status.legend {
        corner(context, "legend", Align2::LEFT_BOTTOM, |ui| show_legend(ui, legend));
    }
    let notices: Vec<_> = content.notice.into_iter().chain(&status.notice).collect();
    let busy = status.busy.as_ref().filter(|_| !content.empty);
    if busy.is_some() || !notices.is_empty() {
        corner(context, "notices", Align2::CENTER_BOTTOM, |ui| {
            busy.into_iter().for_each(|busy| mono(ui, &format!("{busy} ...")));
            notices.into_iter().for_each(|notice| show_notice(ui, notice));
        });
    }
    if let (true, Some(busy)) = (content.empty, &status.busy) {
        corner(context, "empty", Align2::CENTER_CENTER, |ui| mono(ui, &format!("{busy} ...")));
    }
    if status.help {
        corner(context, "help", Align2::CENTER_CENTER, help);
    }
}

/// A dark box at a side of what the panel leaves of the window. The pointer goes through it.
fn corner(context: &Context, name: &str, align: Align2, add: impl FnOnce(&mut Ui)) {
    let away = -align.to_sign() * MARGIN;
    let area = Area::new(Id::new(name)).order(Order::Middle).interactable(false);
    area.anchor(align, away).constrain_to(context.available_rect()).show(context, |ui| {
        let frame = Frame::new().fill(Color32::from_black_alpha(170)).corner_radius(4.0).inner_margin(6.0);
        frame.show(ui, |ui| {
            ui.set_max_width((context.available_rect().width() - 4.0 * MARGIN).max(100.0));
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
    ui.separator();
    table(ui, "pick", lines.iter().map(|(what, value)| (what.as_str(), value.as_str())));
}

fn help(ui: &mut Ui) {
    // Two columns of groups: one would be higher than a small window.
    let half = HELP.len().div_ceil(2);
    ui.horizontal_top(|ui| {
        for groups in HELP.chunks(half.max(1)) {
            ui.vertical(|ui| {
                for (title, keys) in groups {
                    ui.label(RichText::new(*title).strong());
                    table(ui, title, keys.iter().copied());
                    ui.add_space(6.0);
                }
            });
            ui.add_space(12.0);
        }
    });
}

fn table<'a>(ui: &mut Ui, name: &str, rows: impl Iterator<Item = (&'a str, &'a str)>) {
    egui::Grid::new(name).spacing(vec2(12.0, 2.0)).show(ui, |ui| {
        for (left, right) in rows {
            ui.label(RichText::new(left).monospace().color(Color32::from_rgb(170, 200, 255)));
            ui.label(right);
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
        let part = egui::Rect::from_min_size(left, vec2(width, bar.height()));
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    ui.horizontal(|ui| {
        ui.set_width(BAR.x);
        ui.label(&legend.low);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| ui.label(&legend.high));
    });
}
