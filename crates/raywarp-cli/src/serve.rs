//! `raywarp serve`.

use raywarp::backend::Device;
use raywarp_viewer::live::{Source, Stage};
use raywarp_viewer::serve::{self, Server, Token};

use crate::interrupt::{self, INTERRUPTED};
use crate::options::ServeOptions;
use crate::render::limit_threads;
use crate::say;

/// Shows a scene to browsers until it is interrupted.
pub fn run(options: &ServeOptions) -> anyhow::Result<()> {
    // The port comes first: that it is taken should not be told after minutes of reading a scene.
    let server = Server::bind(settings(options)?)?;
    let machine = &options.live.machine;
    limit_threads(machine.threads)?;
    let device = Device::open(machine.device)?;
    say::fallback(&device);
    announce(&server, options)?;

    let stopper = server.stopper();
    interrupt::once(move || stopper.stop());
    let source = Source { path: options.scene.clone(), strict: options.strict, watch: options.watch };
    server.run(|| Stage::open(source, device, options.live.stage()))?;
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
fn announce(server: &Server, options: &ServeOptions) -> anyhow::Result<()> {
    let scene = options.scene.as_ref().map_or("the built-in scene".to_owned(), |path| path.display().to_string());
    say::line(&format!("{scene} until Ctrl-C, in a browser at"));
    say::out(format!("{}\n", server.url()).as_bytes())?;
    let (command, there) = (server.ssh_line(), server.url_through_ssh());
    say::line(&format!("through ssh: on the machine of the browser run\n{command}\nand open {there} there"));
    Ok(())
}
