//! Any bytes as a scene file, beside a mesh that it may name.
#![no_main]

const MESH: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_files(&[("fuzz.toml", bytes), ("m.obj", MESH)]));
