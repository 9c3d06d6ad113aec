//! The scene as it is shown, as a scene file.

use std::path::PathBuf;

use raywarp::render::RenderOptions;
use raywarp::scene::save::{self, Original, SaveError};
use raywarp::scene::{Camera, RenderDefaults};

use crate::live::look::Look;
use crate::live::stage::Ready;
use crate::live::{Outcome, Stage};

/// A file to be kept in the folder that the program was started in, from where it names the original: edits, options, and
/// the camera first of all.
pub fn scene_file(
    stage: &Stage,
    ready: &Ready,
    look: &Look,
    camera: Camera,
    size: [u32; 2],
) -> Result<Outcome, SaveError> {
    let path = stage.source().path.as_deref();
    let original = match path {
        Some(path) => Original::File { path, files: &ready.files },
        None => Original::BuiltIn,
    };
    let mut now = ready.edits.scene().clone();
    if now.cameras.first() != Some(&camera) {
        now.cameras.insert(0, camera);
    }
    let ([wanted, _], natural) = (stage.builds(), ready.natural);
    // What `raywarp render` would do without being told.
    let plain = RenderOptions::from(&ready.read.render);
    let chosen = RenderDefaults {
        size: (size != plain.size).then_some(size),
        spp: (look.spp != plain.spp).then_some(look.spp),
        accel: (wanted.kind != natural.kind).then_some(wanted.kind),
        tree: (wanted.quality != natural.quality).then_some(wanted.quality),
        ..look.wishes(&Look::of(&ready.read.render))
    };
    now.render = chosen.or(&now.render);
    let name = name(path.and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy().into_owned()));
    let text = save::to_toml(&original, &ready.read, &now, &PathBuf::from(&name))?;
    Ok(Outcome::File { name, content: text.into_bytes(), media_type: "application/toml" })
}

/// After the original, but never its own.
fn name(stem: Option<String>) -> String {
    let stem = stem.unwrap_or_else(|| "raywarp".to_owned());
    format!("{stem}-edited.toml")
}
