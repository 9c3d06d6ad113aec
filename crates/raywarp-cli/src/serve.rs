//! `raywarp serve`, and `raywarp view` where there is no window.

use std::path::Path;

use raywarp::backend::Device;
use raywarp_viewer::live::{Source, Stage};
use raywarp_viewer::serve::{self, Server, Token};

use crate::browser;
use crate::interrupt::{self, INTERRUPTED};
use crate::options::{LiveOptions, ServeOptions, ViewOptions};
use crate::render::limit_threads;
use crate::say;

/// Shows a scene to browsers until it is interrupted.
pub fn run(options: &ServeOptions) -> anyhow::Result<()> {
    // The port comes first: that it is taken should not be told after minutes of reading a scene.
    let server = Server::bind(settings(options)?)?;
    let source = Source { path: options.scene.clone(), strict: options.strict, watch: options.watch };
    show(server, source, &options.live, |_| ())
}

/// Shows a scene to the browser of this machine, at a port that is free, until it is interrupted.
pub fn view(options: &ViewOptions) -> anyhow::Result<()> {
    let server = Server::bind(serve::ServeOptions { port: 0, ..serve::ServeOptions::default() })?;
    show(server, options.source(), &options.live, |server| browser::open(&server.url()))
}

fn show(server: Server, source: Source, live: &LiveOptions, told: impl FnOnce(&Server)) -> anyhow::Result<()> {
    limit_threads(live.machine.threads)?;
    let device = Device::open(live.machine.device)?;
    say::fallback(&device);
    announce(&server, source.path.as_deref())?;
    told(&server);

    let stopper = server.stopper();
    interrupt::once(move || stopper.stop());
    server.run(|| Stage::open(source, device, live.stage()))?;
    std::process::exit(INTERRUPTED)
}

fn settings(options: &ServeOptions) -> anyhow::Result<serve::ServeOptions> {
    let token = match options.token.as_deref() {
        Some("") => Some(Token::random()?),
        Some(text) => Some(Token::chosen(text)?),
        None => None,
    };
    let (host, port, viewers) = (options.host.clone(), options.port, options.viewers as usize);
    Ok(serve::ServeOptions { host, port, token, viewers, ..serve::ServeOptions::default() })
}

/// The address is the result: it goes to standard output, alone.
fn announce(server: &Server, scene: Option<&Path>) -> anyhow::Result<()> {
    let scene = scene.map_or("the built-in scene".to_owned(), |path| path.display().to_string());
    say::line(&format!("{scene} until Ctrl-C, in a browser at"));
    say::out(format!("{}\n", server.url()).as_bytes())?;
    let (command, there) = (server.ssh_line(), server.url_through_ssh());
    say::line(&format!("through ssh: on the machine of the browser run\n{command}\nand open {there} there"));
    Ok(())
}
