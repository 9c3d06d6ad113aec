//! Other ray tracers, each in a Python of its own that does as it is told: see `peers.py`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use raywarp::device::Device;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{json, Value};

use super::exchange::read_distances;
use super::spread::Spread;

use crate::failure::{ensure, fail, Context, Result};

/// What the Python runs.
const SCRIPT: &str = include_str!("peers.py");

/// A ray tracer that runs, until this is dropped.
pub struct Peer {
    /// What it is.
    pub about: About,
    /// Its ways with the scene.
    pub variants: Vec<Variant>,
    child: Child,
    orders: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
}

/// What a peer says of itself.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct About {
    /// For people.
    pub name: String,
    /// The package and its version.
    pub version: String,
    /// What it runs on.
    pub device: String,
}

/// A way of a peer to build its tree and to ask it.
#[derive(Clone, Debug, Deserialize)]
pub struct Variant {
    /// For people.
    pub name: String,
    /// Of its tree.
    pub build_seconds: f64,
    /// Of each repeat with the rays at hand.
    #[serde(skip)]
    pub seconds: Vec<f64>,
}

/// A path as JSON holds it.
fn text(path: &Path) -> Result<&str> {
    path.to_str().with_context(|| format!("the folder for temporary files, {}, is not UTF-8 text", path.display()))
}

impl Peer {
    /// Starts the peer of a name on the device's machine. `folder` holds the script while it runs.
    ///
    /// # Errors
    /// Why it does not run.
    pub fn start(python: &Path, folder: &Path, name: &str, device: &Device) -> Result<Self> {
        let script = folder.join("peers.py");
        std::fs::write(&script, SCRIPT).with_context(|| format!("cannot write {}", script.display()))?;
        let device = device.cuda_index().map_or("cpu".to_owned(), |index| format!("cuda:{index}"));
        let mut command = Command::new(python);
        command.arg(&script).args([name, &device]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().with_context(|| format!("cannot run {}", python.display()))?;
        let orders = child.stdin.take();
        let replies = BufReader::new(child.stdout.take().context("it has no output")?);
        let about = About { name: name.to_owned(), version: String::new(), device };
        let mut peer = Self { about, variants: Vec::new(), child, orders, replies };
        peer.about = peer.reply()?;
        Ok(peer)
    }

    /// Has it read the scene in a folder and build its trees.
    pub fn scene(&mut self, folder: &Path) -> Result<()> {
        #[derive(Deserialize)]
        struct Reply {
            variants: Vec<Variant>,
        }
        self.variants = self.ask::<Reply>(json!({"do": "scene", "folder": text(folder)?}))?.variants;
        Ok(())
    }

    /// Has it read the rays in a folder.
    pub fn rays(&mut self, folder: &Path, any_hit: bool) -> Result<()> {
        self.variants.iter_mut().for_each(|variant| variant.seconds.clear());
        self.ask::<Value>(json!({"do": "rays", "folder": text(folder)?, "any_hit": any_hit})).map(drop)
    }

    /// Times every variant, and keeps the seconds.
    pub fn time(&mut self, warmup: u32, repeats: u32) -> Result<()> {
        #[derive(Deserialize)]
        struct Reply {
            seconds: Vec<f64>,
        }
        for index in 0..self.variants.len() {
            let order = json!({"do": "time", "variant": index, "warmup": warmup, "repeats": repeats});
            let reply: Reply = self.ask(order)?;
            self.variants[index].seconds.extend(reply.seconds);
        }
        Ok(())
    }

    /// Index of the variant with the shortest median.
    pub fn fastest(&self) -> Option<usize> {
        let median = |index: &usize| Spread::of(self.variants[*index].seconds.clone()).median;
        (0..self.variants.len()).min_by(|a, b| median(a).total_cmp(&median(b)))
    }

    /// Distance of each ray's hit, infinite for a miss; 0 for a hit where any would do.
    pub fn answers(&mut self, variant: usize, folder: &Path) -> Result<Vec<f32>> {
        let file = folder.join("answers");
        self.ask::<Value>(json!({"do": "answers", "variant": variant, "file": text(&file)?}))?;
        read_distances(&file).with_context(|| format!("cannot read {}", file.display()))
    }

    fn ask<T: DeserializeOwned>(&mut self, order: Value) -> Result<T> {
        let orders = self.orders.as_mut().context("it has ended")?;
        writeln!(orders, "{order}").and_then(|()| orders.flush()).context("it does not listen")?;
        self.reply()
    }

    fn reply<T: DeserializeOwned>(&mut self) -> Result<T> {
        let mut line = String::new();
        self.replies.read_line(&mut line).context("it does not answer")?;
        ensure!(!line.is_empty(), "it ended before it answered");
        let reply: Value = serde_json::from_str(&line).context("its answer is no JSON")?;
        if let Some(reason) = ["missing", "failed"].iter().find_map(|key| reply.get(key)?.as_str()) {
            fail!("{reason}");
        }
        serde_json::from_value(reply).context("its answer is not what was asked for")
    }
}

impl Drop for Peer {
    /// It ends when its input does.
    fn drop(&mut self) {
        self.orders = None;
        let _ = self.child.wait();
    }
}
