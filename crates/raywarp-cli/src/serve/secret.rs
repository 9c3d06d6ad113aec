//! Where the secret of a server comes from: never from the command line, which every user of a machine can read.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use raywarp_viewer::serve::Token;

use crate::failure::{fail, Context, Result};
use crate::messages;
use crate::options::ServeOptions;

/// The environment's word for it.
const VARIABLE: &str = "RAYWARP_TOKEN";
/// Most bytes that are read of a file: more than the longest token has.
const MOST: u64 = 1024;

/// The secret that is asked for: of the file, of the environment, or a random one.
pub fn token(options: &ServeOptions) -> Result<Option<Token>> {
    if let Some(path) = &options.token_file {
        return from_file(path).map(Some);
    }
    if let Some(text) = std::env::var_os(VARIABLE) {
        let text = text.into_string().ok().with_context(|| format!("{VARIABLE} is not UTF-8"))?;
        return Ok(Some(Token::chosen(&text).with_context(|| format!("cannot take the token of {VARIABLE}"))?));
    }
    Ok(if options.token { Some(Token::random()?) } else { None })
}

/// A file of one line. A pipe will do.
fn from_file(path: &Path) -> Result<Token> {
    let name = path.display();
    let reason = || format!("cannot read the token of {name}");
    let file = File::open(path).with_context(reason)?;
    if is_open_to_others(&file) {
        messages::line(&format!("warning: {name} can be read by other users: chmod 600 {name}"));
    }
    let mut text = String::new();
    file.take(MOST + 1).read_to_string(&mut text).with_context(reason)?;
    if text.len() as u64 > MOST {
        fail!("{name} has more than {MOST} bytes; expected one line, the token");
    }
    let line = text.strip_suffix('\n').map_or(text.as_str(), |line| line.strip_suffix('\r').unwrap_or(line));
    Token::chosen(line).with_context(|| format!("cannot take the token of {name}"))
}

#[cfg(unix)]
fn is_open_to_others(file: &File) -> bool {
    use std::os::unix::fs::PermissionsExt;
    file.metadata().is_ok_and(|data| data.is_file() && data.permissions().mode() & 0o077 != 0)
}

#[cfg(not(unix))]
fn is_open_to_others(_: &File) -> bool {
    false
}

/// What to say instead of the parser's words, which would repeat the secret.
pub fn advise(error: &clap::Error) -> Option<&'static str> {
    let of_token = |value: &ContextValue| matches!(value, ContextValue::String(name) if name.starts_with("--token"));
    let is_value = error.kind() == ErrorKind::TooManyValues && error.get(ContextKind::InvalidArg).is_some_and(of_token);
    is_value.then_some(
        "--token takes no value, as every user of the machine can read the command line: put the secret in a file and \
         give its name with --token-file, or in the environment as RAYWARP_TOKEN; --token alone makes one at random",
    )
}
