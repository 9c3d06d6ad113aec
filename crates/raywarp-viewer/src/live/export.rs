//! Files that people ask for, from what they see to bytes.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};

use raywarp::image::{png, Rgb8};
use raywarp::scene::save::{self, Original};
use raywarp::scene::Scene;

use super::Picture;
use crate::ViewerError;

/// A file that is asked for and not made yet. It holds what it is made of, so any thread can make it while the viewer
/// goes on; the viewer gives no other one while this or a clone of its [`Ticket`] lives.
#[derive(Clone, Debug)]
pub struct Export {
    /// Suggested name, without folders.
    pub name: String,
    /// For the browser: "image/png", "application/toml".
    pub media_type: &'static str,
    pub(super) content: Content,
    pub(super) ticket: Ticket,
}

/// While it or a clone of it lives, its file is on its way.
#[derive(Clone, Debug)]
pub struct Ticket {
    _held: Arc<()>,
}

impl Ticket {
    /// One, and what tells whether it lives.
    pub(super) fn new() -> (Self, Weak<()>) {
        let held = Arc::new(());
        let watched = Arc::downgrade(&held);
        (Self { _held: held }, watched)
    }
}

/// What a file is made of.
#[derive(Clone, Debug)]
pub(super) enum Content {
    Picture(Arc<Picture>),
    Scene(Box<EditedScene>),
}

/// A scene as it was read and as it is now, both without geometry.
#[derive(Clone, Debug)]
pub(super) struct EditedScene {
    /// The original; none for the built-in scene.
    pub path: Option<PathBuf>,
    /// All files of the original.
    pub files: Vec<PathBuf>,
    pub read: Scene,
    pub now: Scene,
}

impl Export {
    /// Makes the content. It takes as long as it takes to compress a picture.
    ///
    /// # Errors
    /// [`ViewerError`] where the picture cannot be encoded, or a scene file cannot say what was changed.
    pub fn make(&self) -> Result<Vec<u8>, ViewerError> {
        match &self.content {
            Content::Picture(picture) => picture_file(picture),
            Content::Scene(scene) => scene.to_toml(Path::new(&self.name)),
        }
    }

    /// To be held until the file is where it belongs.
    pub fn ticket(&self) -> Ticket {
        self.ticket.clone()
    }
}

fn picture_file(picture: &Picture) -> Result<Vec<u8>, ViewerError> {
    let pixels = picture.rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
    let [width, height] = picture.size;
    Ok(png::encode(&Rgb8 { width, height, pixels })?)
}

impl EditedScene {
    fn to_toml(&self, target: &Path) -> Result<Vec<u8>, ViewerError> {
        let original = match &self.path {
            Some(path) => Original::File { path, files: &self.files },
            None => Original::BuiltIn,
        };
        Ok(save::to_toml(&original, &self.read, &self.now, target)?.into_bytes())
    }
}
