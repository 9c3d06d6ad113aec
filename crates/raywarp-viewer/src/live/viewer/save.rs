//! The scene as it is shown, as a scene file.

use raywarp::render::RenderOptions;
use raywarp::scene::{Camera, RenderDefaults};

use crate::live::export::{Content, EditedScene, Export, Ticket};
use crate::live::live_scene::Ready;
use crate::live::view_settings::ViewSettings;
use crate::live::LiveScene;

/// A file to be kept in the folder that the program was started in, from where it names the original: edits, options, and
/// the camera first of all.
pub fn scene_file(
    live_scene: &LiveScene,
    ready: &Ready,
    view_settings: &ViewSettings,
    camera: Camera,
    size: [u32; 2],
    ticket: Ticket,
) -> Export {
    let path = live_scene.source().path.clone();
    let mut now = ready.edits.scene().clone();
    if now.cameras.first() != Some(&camera) {
        now.cameras.insert(0, camera);
    }
    let ([wanted, _], natural) = (live_scene.builds(), ready.natural);
    // What `raywarp render` would do without being told.
    let plain = RenderOptions::from(&ready.read.render);
    let chosen = RenderDefaults {
        size: (size != plain.size).then_some(size),
        spp: view_settings.render.spp.filter(|&spp| spp != plain.spp),
        accel: (wanted.kind != natural.kind).then_some(wanted.kind),
        tree: (wanted.quality != natural.quality).then_some(wanted.quality),
        ..view_settings.overrides(&ViewSettings::of(&ready.read.render))
    };
    now.render = chosen.or(&now.render);
    let name = name(path.as_ref().and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy().into_owned()));
    let scene = EditedScene { path, files: ready.files.clone(), read: ready.read.clone(), now };
    Export { name, media_type: "application/toml", content: Content::Scene(Box::new(scene)), ticket }
}

/// After the original, but never its own.
fn name(stem: Option<String>) -> String {
    let stem = stem.unwrap_or_else(|| "raywarp".to_owned());
    format!("{stem}-edited.toml")
}
