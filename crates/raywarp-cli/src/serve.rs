//! `raywarp serve`, and `raywarp view` where there is no window.

mod secret;

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use raywarp::device::Device;
use raywarp::scene::load::{load, EXTENSIONS};
use raywarp::scene::{LoadError, LoadOptions};
use raywarp_viewer::live::{LiveScene, Source};
use raywarp_viewer::serve::{self, Addresses, Server, Stopper};

use crate::browser;
use crate::failure::{Context, Result};
use crate::interrupt::{self, INTERRUPTED};
use crate::messages;
use crate::options::{LiveOptions, ServeOptions, ViewOptions};
use crate::render::limit_threads;

pub use secret::advise;

/// Longest time from an interrupt to the end, whatever the device is at.
const PARTING: Duration = Duration::from_millis(150);

/// Shows a scene to browsers until it is interrupted.
pub fn run(options: &ServeOptions) -> Result<()> {
    // The port comes first: that it is taken should not be told after minutes of reading a scene.
    let server = Server::bind(settings(options)?)?;
    check_scene(options)?;
    let source = Source { path: options.scene.clone(), strict: options.strict, watch: options.watch };
    show(server, source, &options.live, |_| ())
}

/// Shows a scene to the browser of this machine, at a port that is free, until it is interrupted.
pub fn view(options: &ViewOptions) -> Result<()> {
    let server = Server::bind(serve::ServeOptions { port: 0, ..serve::ServeOptions::default() })?;
    let source = options.source();
    source.path.as_deref().map_or(Ok(()), is_missing)?;
    show(server, source, &options.live, |server| browser::open(&server.addresses().here))
}

fn show(server: Server, source: Source, live: &LiveOptions, told: impl FnOnce(&Server)) -> Result<()> {
    limit_threads(live.machine.threads)?;
    let options = live.live_scene()?;
    let device = Device::open(live.machine.device)?;
    messages::fallback(&device);
    end_on_interrupt(server.stopper());
    announce(&server, source.path.as_deref())?;
    told(&server);
    server.run(|| LiveScene::open(source, device, options))?;
    std::process::exit(INTERRUPTED)
}

fn settings(options: &ServeOptions) -> Result<serve::ServeOptions> {
    let (host, port, viewers) = (options.host.clone(), options.port, options.viewers as usize);
    Ok(serve::ServeOptions { host, port, token: secret::token(options)?, viewers, ..serve::ServeOptions::default() })
}

/// Fails for a scene that is certainly not coming: nobody is to open an address that ends a moment later.
fn check_scene(options: &ServeOptions) -> Result<()> {
    let Some(path) = &options.scene else { return Ok(()) };
    let checked = is_missing(path);
    if options.token && path.extension().is_none() {
        return checked.context("--token takes no value: the secret is made at random, or comes from --token-file");
    }
    Ok(checked?)
}

fn is_missing(path: &Path) -> Result<(), LoadError> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let known = extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()));
    if known && path.is_file() && File::open(path).is_ok() {
        return Ok(());
    }
    load(path, &LoadOptions::default()).map(drop)
}

/// A launch on the device can take longer than anybody waits for the prompt.
fn end_on_interrupt(stopper: Stopper) {
    interrupt::once(move || {
        stopper.stop();
        std::thread::sleep(PARTING);
        std::process::exit(INTERRUPTED);
    });
}

/// The address is the result: it goes to standard output, alone.
fn announce(server: &Server, scene: Option<&Path>) -> Result<()> {
    let scene = scene.map_or("the built-in scene".to_owned(), |path| path.display().to_string());
    messages::line(&format!("{scene} until Ctrl-C, in a browser at"));
    let Addresses { here, through_ssh } = server.addresses();
    messages::out(format!("{here}\n").as_bytes())?;
    let command = server.ssh_line();
    messages::line(&format!("through ssh: on the machine of the browser run\n{command}\nand open {through_ssh} there"));
    server.tell_addresses(|Addresses { here, through_ssh }| {
        messages::line(&format!("that address was used; for another browser: {here}\nthrough ssh: {through_ssh}"));
    });
    Ok(())
}
