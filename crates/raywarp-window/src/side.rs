//! The side panel, laid out from the core's data.

use egui::{
    collapsing_header::CollapsingState, Align, ComboBox, Context, DragValue, Id, Layout, Rect, ScrollArea, SidePanel,
    Slider, SliderClamping, TopBottomPanel, Ui,
};

use raywarp_viewer::live::{Control, Event, Panel, Row, Section, Value};

const WIDTH: f32 = 320.0;
/// A window is narrow below this width, in points.
const NARROW: f32 = 600.0;
/// Most of the window that the panel takes.
const SHARE: f32 = 0.45;
/// Share of the width that labels take.
const LABELS: f32 = 0.36;
const UNDO: &str = "⟲";

/// Lays out the panel beside the picture, adds what people do to `events`, and returns the place it takes: at the right, and
/// in a narrow window below, its sections folded.
pub fn show(context: &Context, panel: &Panel, events: &mut Vec<Event>) -> Rect {
    let window = context.screen_rect();
    let folded = window.width() < NARROW;
    let lay_out = |ui: &mut Ui| sections(ui, panel, folded, events);
    let shown = if folded {
        let below = TopBottomPanel::bottom("panel below").resizable(true);
        below.default_height(window.height() * SHARE).max_height(window.height() * SHARE).show(context, lay_out)
    } else {
        let side = SidePanel::right("panel").default_width(WIDTH).width_range(WIDTH * 0.7..=window.width() * SHARE);
        side.show(context, lay_out)
    };
    shown.response.rect
}

fn sections(ui: &mut Ui, panel: &Panel, folded: bool, events: &mut Vec<Event>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for section in &panel.sections {
            show_section(ui, section, folded, events);
        }
        let changed = panel.sections.iter().flat_map(|section| &section.rows).any(|row| row.changed);
        if ui.add_enabled(changed, egui::Button::new("Reset everything")).clicked() {
            events.push(Event::Reset { id: String::new() });
        }
    });
}

fn show_section(ui: &mut Ui, section: &Section, folded: bool, events: &mut Vec<Event>) {
    let id = Id::new(("section", &section.id, folded));
    let header = CollapsingState::load_with_default_open(ui.ctx(), id, !folded).show_header(ui, |ui| {
        ui.strong(&section.title);
        if section.rows.iter().any(|row| row.changed) {
            undo(ui, &section.id, "back to the defaults of this section", events);
        }
    });
    header.body_unindented(|ui| section.rows.iter().for_each(|row| show_row(ui, row, events)));
    ui.separator();
}

fn show_row(ui: &mut Ui, row: &Row, events: &mut Vec<Event>) {
    ui.push_id(&row.id, |ui| {
        ui.horizontal(|ui| {
            if row.control == Control::Action {
                if ui.button(&row.label).clicked() {
                    set(row, Value::Flag(true), events);
                }
                return;
            }
            let size = egui::vec2(ui.available_width() * LABELS, ui.spacing().interact_size.y);
            ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_width(size.x);
                ui.add(egui::Label::new(&row.label).truncate()).on_hover_text(&row.label);
            });
            let value = control(ui, row);
            if let Some(value) = value {
                set(row, value, events);
            }
            if row.changed {
                undo(ui, &row.id, "back to the default", events);
            }
        });
    });
}

fn set(row: &Row, value: Value, events: &mut Vec<Event>) {
    events.push(Event::Set { id: row.id.clone(), value });
}

fn undo(ui: &mut Ui, id: &str, hint: &str, events: &mut Vec<Event>) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if ui.small_button(UNDO).on_hover_text(hint).clicked() {
            events.push(Event::Reset { id: id.to_owned() });
        }
    });
}

/// The widget for a row; what it was changed to, if it was.
fn control(ui: &mut Ui, row: &Row) -> Option<Value> {
    match (&row.control, &row.value) {
        (Control::Flag, &Value::Flag(mut on)) => ui.checkbox(&mut on, "").changed().then_some(Value::Flag(on)),
        (&Control::Number { min, max, step }, &Value::Number(value)) => number(ui, value, [min, max], step),
        (Control::Choice { options }, Value::Text(chosen)) => choice(ui, options, chosen),
        (&Control::Color { max }, &Value::Triple(color)) => self::color(ui, color, max),
        (&Control::Vector { step }, &Value::Triple(vector)) => self::vector(ui, vector, step),
        (_, value) => {
            ui.add(egui::Label::new(words(value)).wrap());
            None
        }
    }
}

fn words(value: &Value) -> String {
    match value {
        Value::Flag(on) => if *on { "on" } else { "off" }.to_owned(),
        Value::Number(number) => number.to_string(),
        Value::Triple([x, y, z]) => format!("{x} {y} {z}"),
        Value::Text(text) => text.clone(),
    }
}

fn number(ui: &mut Ui, mut value: f32, [min, max]: [f32; 2], step: f32) -> Option<Value> {
    let response = if min < max && min.is_finite() && max.is_finite() {
        // Numbers that span orders of magnitude are set by their order.
        let logarithmic = step <= 0.0 && min > 0.0 && max / min > 1000.0;
        ui.spacing_mut().slider_width = (ui.available_width() - 100.0).clamp(40.0, 400.0);
        let slider = Slider::new(&mut value, min..=max).logarithmic(logarithmic).clamping(SliderClamping::Edits);
        let slider = if step >= 1.0 { slider.fixed_decimals(0) } else { slider };
        ui.add(if step > 0.0 { slider.step_by(f64::from(step)) } else { slider })
    } else {
        ui.add(DragValue::new(&mut value).speed(if step > 0.0 { step } else { 0.01 }))
    };
    response.changed().then_some(Value::Number(rounded(value, step)))
}

/// To whole steps from zero: egui counts them from the smallest value, with its rounding.
fn rounded(value: f32, step: f32) -> f32 {
    if step > 0.0 {
        (f64::from(value / step).round() * f64::from(step)) as f32
    } else {
        value
    }
}

fn choice(ui: &mut Ui, options: &[String], chosen: &String) -> Option<Value> {
    let mut now = chosen;
    let width = (ui.available_width() - 36.0).max(60.0);
    ComboBox::from_id_salt("choice").selected_text(chosen).width(width).truncate().show_ui(ui, |ui| {
        for option in options {
            ui.selectable_value(&mut now, option, option);
        }
    });
    (now != chosen).then(|| Value::Text(now.clone()))
}

/// A colour of at most 1 a channel, and beyond it what that is multiplied with.
fn color(ui: &mut Ui, color: [f32; 3], max: f32) -> Option<Value> {
    let mut strength = color.into_iter().fold(1.0f32, f32::max);
    let mut shown = color.map(|channel| channel / strength);
    let picked = ui.color_edit_button_rgb(&mut shown).changed();
    let scaled = max > 1.0 && {
        let speed = 0.01 * strength;
        let drag = DragValue::new(&mut strength).speed(speed).range(1.0..=max).prefix("× ");
        ui.add(drag).changed()
    };
    (picked || scaled).then(|| Value::Triple(shown.map(|channel| (channel * strength).min(max))))
}

fn vector(ui: &mut Ui, mut vector: [f32; 3], step: f32) -> Option<Value> {
    ui.spacing_mut().interact_size.x = 20.0;
    ui.spacing_mut().item_spacing.x = 3.0;
    let speed = if step > 0.0 { step } else { 0.01 };
    let changes = vector.each_mut().map(|x| ui.add(DragValue::new(x).speed(speed).max_decimals(3)).changed());
    changes.contains(&true).then_some(Value::Triple(vector))
}
