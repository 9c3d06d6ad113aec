//! The options of the picture.

use std::str::FromStr;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::scene::settings::{Part, Setting, SETTINGS};

use super::{checked, is_meant, row, Effect};
use crate::live::parameter_control::{control, shown, taken};
use crate::live::view_settings::{View, ViewSettings, FRAME_RATES, MAX_LEVEL};
use crate::live::{Control, Row, Section, Value};

const SECTION: &str = "rendering";

pub(super) fn section(looks: [&ViewSettings; 2], tree: &[Build; 2]) -> Section {
    Section { id: SECTION.to_owned(), title: "Rendering".to_owned(), rows: rows(looks, tree) }
}

fn rows(looks: [&ViewSettings; 2], tree: &[Build; 2]) -> Vec<Row> {
    let both = |value: fn(&ViewSettings) -> Value| looks.map(value);
    let named = |value: fn(&Build) -> String| [Value::Text(value(&tree[0])), Value::Text(value(&tree[1]))];
    let number = |min: f32, max: f32, step: f32| Control::Number { min, max, step };
    let mut rows = vec![
        row("look.view", "View", both(|settings| text(settings.view)), choice(View::ALL)),
        row("look.boxes", "Boxes to level", both(|settings| level(settings.boxes)), {
            number(-1.0, MAX_LEVEL as f32, 1.0)
        }),
    ];
    rows.extend(SETTINGS.iter().filter_map(|setting| setting_row(setting, looks)));
    rows.extend([
        row("look.reference", "Full quality", both(|settings| Value::Flag(settings.reference)), Control::Flag),
        row("look.frame_rate", "Frames a second", both(|settings| Value::Number(settings.frame_rate)), {
            number(FRAME_RATES[0], FRAME_RATES[1], 1.0)
        }),
        row("look.statistics", "Statistics", both(|settings| Value::Flag(settings.statistics)), Control::Flag),
        row("tree.kind", "Structure", named(|tree| tree.kind.to_string()), choice(AccelKind::ALL)),
        row("tree.quality", "Quality of the tree", named(|tree| tree.quality.to_string()), choice(Quality::ALL)),
    ]);
    rows
}

/// An option of the schema, as "look.NAME"; nothing for those that are not on the panel.
fn setting_row(setting: &Setting, looks: [&ViewSettings; 2]) -> Option<Row> {
    let parameter = &setting.parameter;
    let panel = parameter.panel.as_ref()?;
    let [now, usual] = looks.map(|settings| parameter.get(&settings.render).map(shown));
    let values = [now?, usual?];
    let control = control(parameter, panel, &values.each_ref());
    Some(row(&format!("look.{}", parameter.name), panel.label, values, control))
}

pub(super) fn set(
    view_settings: &mut ViewSettings,
    usual: &ViewSettings,
    tree: &[Build; 2],
    id: &str,
    value: &Value,
) -> Result<Effect, String> {
    checked(&rows([view_settings, usual], tree), id, value)?;
    apply(view_settings, tree, id, value).ok_or_else(|| format!("'{id}' cannot take this value"))
}

pub(super) fn reset(
    view_settings: &mut ViewSettings,
    usual: &ViewSettings,
    tree: &[Build; 2],
    id: &str,
) -> Vec<Effect> {
    let mut effects = Vec::new();
    let defaults = rows([usual, usual], &[tree[1], tree[1]]);
    let mut wanted = tree[0];
    for (row, usual) in rows([view_settings, usual], tree).iter().zip(&defaults) {
        if !row.changed || !is_meant(id, SECTION, &row.id) {
            continue;
        }
        match apply(view_settings, &[wanted, tree[1]], &row.id, &usual.value) {
            // The kind and the quality are one wish.
            Some(Effect::Build(build)) => wanted = build,
            effect => effects.extend(effect),
        }
    }
    effects.extend((wanted != tree[0]).then_some(Effect::Build(wanted)));
    effects
}

/// Of a value that its row takes.
fn apply(view_settings: &mut ViewSettings, tree: &[Build; 2], id: &str, value: &Value) -> Option<Effect> {
    let setting = |name: &str| SETTINGS.iter().find(|setting| setting.parameter.name == name);
    if let Some(setting) = id.strip_prefix("look.").and_then(setting) {
        setting.parameter.set(&mut view_settings.render, taken(setting.parameter.kind, value)?);
        return Some(if setting.part == Part::Display { Effect::ToneMapFilm } else { Effect::Picture });
    }
    let effect = match (id, value) {
        ("look.view", Value::Text(name)) => (view_settings.view = name.parse().ok()?, Effect::Picture).1,
        ("look.boxes", Value::Number(x)) => {
            (view_settings.boxes = (*x >= 0.0).then(|| x.round() as u32), Effect::ToneMapFilm).1
        }
        ("look.reference", Value::Flag(on)) => (view_settings.reference = *on, Effect::Overlay).1,
        ("look.frame_rate", Value::Number(x)) => (view_settings.frame_rate = *x, Effect::Overlay).1,
        ("look.statistics", Value::Flag(on)) => (view_settings.statistics = *on, Effect::Overlay).1,
        ("tree.kind", Value::Text(name)) => Effect::Build(Build { kind: AccelKind::from_str(name).ok()?, ..tree[0] }),
        ("tree.quality", Value::Text(name)) => Effect::Build(Build { quality: name.parse().ok()?, ..tree[0] }),
        _ => return None,
    };
    Some(effect)
}

fn text(name: impl ToString) -> Value {
    Value::Text(name.to_string())
}

/// -1 for none.
fn level(boxes: Option<u32>) -> Value {
    Value::Number(boxes.map_or(-1.0, |level| level as f32))
}

fn choice<T: ToString, const N: usize>(all: [T; N]) -> Control {
    Control::Choice { options: all.iter().map(T::to_string).collect() }
}
