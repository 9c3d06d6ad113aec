//! The options of the picture.

use std::str::FromStr;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::image::ToneMap;
use raywarp::render::MAX_DEPTH;

use super::{checked, is_meant, row, Effect};
use crate::live::view_settings::{View, ViewSettings, FRAME_RATES, MAX_EXPOSURE, MAX_LEVEL, MAX_SAMPLES};
use crate::live::{Control, Row, Section, Value};

const SECTION: &str = "rendering";

pub(super) fn section(looks: [&ViewSettings; 2], tree: &[Build; 2]) -> Section {
    Section { id: SECTION.to_owned(), title: "Rendering".to_owned(), rows: rows(looks, tree) }
}

fn rows(looks: [&ViewSettings; 2], tree: &[Build; 2]) -> Vec<Row> {
    let both = |value: fn(&ViewSettings) -> Value| looks.map(value);
    // A file may ask for more than people usually do.
    let stops = looks.iter().map(|view_settings| view_settings.development.exposure.abs()).fold(MAX_EXPOSURE, f32::max);
    let named = |value: fn(&Build) -> String| [Value::Text(value(&tree[0])), Value::Text(value(&tree[1]))];
    let number = |min: f32, max: f32, step: f32| Control::Number { min, max, step };
    vec![
        row("look.view", "View", both(|view_settings| text(view_settings.view)), choice(View::ALL)),
        row(
            "look.boxes",
            "Boxes to level",
            both(|view_settings| level(view_settings.boxes)),
            number(-1.0, MAX_LEVEL as f32, 1.0),
        ),
        row(
            "look.exposure",
            "Exposure, stops",
            both(|view_settings| Value::Number(view_settings.development.exposure)),
            number(-stops, stops, 0.1),
        ),
        row(
            "look.tone_map",
            "Tone map",
            both(|view_settings| text(view_settings.development.tone_map)),
            choice(ToneMap::ALL),
        ),
        row("look.max_depth", "Bounces", both(|view_settings| Value::Number(view_settings.max_depth as f32)), {
            number(0.0, MAX_DEPTH as f32, 1.0)
        }),
        row("look.shadows", "Shadows", both(|view_settings| Value::Flag(view_settings.shadows)), Control::Flag),
        row("look.spp", "Samples a pixel", both(|view_settings| Value::Number(view_settings.spp as f32)), {
            number(1.0, MAX_SAMPLES as f32, 1.0)
        }),
        row(
            "look.reference",
            "Full quality",
            both(|view_settings| Value::Flag(view_settings.reference)),
            Control::Flag,
        ),
        row("look.frame_rate", "Frames a second", both(|view_settings| Value::Number(view_settings.frame_rate)), {
            number(FRAME_RATES[0], FRAME_RATES[1], 1.0)
        }),
        row(
            "look.statistics",
            "Statistics",
            both(|view_settings| Value::Flag(view_settings.statistics)),
            Control::Flag,
        ),
        row("tree.kind", "Structure", named(|tree| tree.kind.to_string()), choice(AccelKind::ALL)),
        row("tree.quality", "Quality of the tree", named(|tree| tree.quality.to_string()), choice(Quality::ALL)),
    ]
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
    let effect = match (id, value) {
        ("look.view", Value::Text(name)) => (view_settings.view = name.parse().ok()?, Effect::Picture).1,
        ("look.boxes", Value::Number(x)) => {
            (view_settings.boxes = (*x >= 0.0).then(|| x.round() as u32), Effect::ToneMapFilm).1
        }
        ("look.exposure", Value::Number(x)) => (view_settings.development.exposure = *x, Effect::ToneMapFilm).1,
        ("look.tone_map", Value::Text(name)) => {
            (view_settings.development.tone_map = name.parse().ok()?, Effect::ToneMapFilm).1
        }
        ("look.max_depth", Value::Number(x)) => (view_settings.max_depth = x.round() as u32, Effect::Picture).1,
        ("look.shadows", Value::Flag(on)) => (view_settings.shadows = *on, Effect::Picture).1,
        ("look.spp", Value::Number(x)) => (view_settings.spp = x.round() as u32, Effect::Picture).1,
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
