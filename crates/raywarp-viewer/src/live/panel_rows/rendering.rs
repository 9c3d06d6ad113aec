//! The options of the picture.

use std::str::FromStr;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::image::ToneMap;
use raywarp::render::MAX_DEPTH;

use super::{checked, is_meant, row, Effect};
use crate::live::look::{Look, View, FRAME_RATES, MAX_EXPOSURE, MAX_LEVEL, MAX_SAMPLES};
use crate::live::{Control, Row, Section, Value};

const SECTION: &str = "rendering";

pub(super) fn section(looks: [&Look; 2], tree: &[Build; 2]) -> Section {
    Section { id: SECTION.to_owned(), title: "Rendering".to_owned(), rows: rows(looks, tree) }
}

fn rows(looks: [&Look; 2], tree: &[Build; 2]) -> Vec<Row> {
    let both = |value: fn(&Look) -> Value| looks.map(value);
    // A file may ask for more than people usually do.
    let stops = looks.iter().map(|look| look.development.exposure.abs()).fold(MAX_EXPOSURE, f32::max);
    let named = |value: fn(&Build) -> String| [Value::Text(value(&tree[0])), Value::Text(value(&tree[1]))];
    let number = |min: f32, max: f32, step: f32| Control::Number { min, max, step };
    vec![
        row("look.view", "View", both(|look| text(look.view)), choice(View::ALL)),
        row("look.boxes", "Boxes to level", both(|look| level(look.boxes)), number(-1.0, MAX_LEVEL as f32, 1.0)),
        row("look.exposure", "Exposure, stops", both(|look| Value::Number(look.development.exposure)), {
            number(-stops, stops, 0.1)
        }),
        row("look.tone_map", "Tone map", both(|look| text(look.development.tone_map)), choice(ToneMap::ALL)),
        row("look.max_depth", "Bounces", both(|look| Value::Number(look.max_depth as f32)), {
            number(0.0, MAX_DEPTH as f32, 1.0)
        }),
        row("look.shadows", "Shadows", both(|look| Value::Flag(look.shadows)), Control::Flag),
        row("look.spp", "Samples a pixel", both(|look| Value::Number(look.spp as f32)), {
            number(1.0, MAX_SAMPLES as f32, 1.0)
        }),
        row("look.reference", "Full quality", both(|look| Value::Flag(look.reference)), Control::Flag),
        row("look.frame_rate", "Frames a second", both(|look| Value::Number(look.frame_rate)), {
            number(FRAME_RATES[0], FRAME_RATES[1], 1.0)
        }),
        row("look.statistics", "Statistics", both(|look| Value::Flag(look.statistics)), Control::Flag),
        row("tree.kind", "Structure", named(|tree| tree.kind.to_string()), choice(AccelKind::ALL)),
        row("tree.quality", "Quality of the tree", named(|tree| tree.quality.to_string()), choice(Quality::ALL)),
    ]
}

pub(super) fn set(look: &mut Look, usual: &Look, tree: &[Build; 2], id: &str, value: &Value) -> Result<Effect, String> {
    checked(&rows([look, usual], tree), id, value)?;
    apply(look, tree, id, value).ok_or_else(|| format!("'{id}' cannot take this value"))
}

pub(super) fn reset(look: &mut Look, usual: &Look, tree: &[Build; 2], id: &str) -> Vec<Effect> {
    let mut effects = Vec::new();
    let defaults = rows([usual, usual], &[tree[1], tree[1]]);
    let mut wanted = tree[0];
    for (row, usual) in rows([look, usual], tree).iter().zip(&defaults) {
        if !row.changed || !is_meant(id, SECTION, &row.id) {
            continue;
        }
        match apply(look, &[wanted, tree[1]], &row.id, &usual.value) {
            // The kind and the quality are one wish.
            Some(Effect::Build(build)) => wanted = build,
            effect => effects.extend(effect),
        }
    }
    effects.extend((wanted != tree[0]).then_some(Effect::Build(wanted)));
    effects
}

/// Of a value that its row takes.
fn apply(look: &mut Look, tree: &[Build; 2], id: &str, value: &Value) -> Option<Effect> {
    let effect = match (id, value) {
        ("look.view", Value::Text(name)) => (look.view = name.parse().ok()?, Effect::Picture).1,
        ("look.boxes", Value::Number(x)) => (look.boxes = (*x >= 0.0).then(|| x.round() as u32), Effect::Develop).1,
        ("look.exposure", Value::Number(x)) => (look.development.exposure = *x, Effect::Develop).1,
        ("look.tone_map", Value::Text(name)) => (look.development.tone_map = name.parse().ok()?, Effect::Develop).1,
        ("look.max_depth", Value::Number(x)) => (look.max_depth = x.round() as u32, Effect::Picture).1,
        ("look.shadows", Value::Flag(on)) => (look.shadows = *on, Effect::Picture).1,
        ("look.spp", Value::Number(x)) => (look.spp = x.round() as u32, Effect::Picture).1,
        ("look.reference", Value::Flag(on)) => (look.reference = *on, Effect::Overlay).1,
        ("look.frame_rate", Value::Number(x)) => (look.frame_rate = *x, Effect::Overlay).1,
        ("look.statistics", Value::Flag(on)) => (look.statistics = *on, Effect::Overlay).1,
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
