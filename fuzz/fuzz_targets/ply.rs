//! Any bytes as a PLY file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_files(&[("fuzz.ply", bytes)]));
