//! The tests of the server from outside, as one program; a file here is a module:
//! `cargo test -p raywarp-viewer --test sessions serve_crowd::`. Apart from the viewer's, which would keep all cores busy: some of
//! these are about time.

mod common;
mod serve;
mod serve_crowd;
mod serve_link;
