//! Any bytes as a glTF file: the contents tell GLB from JSON.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_files(&[("fuzz.glb", bytes)]));
