//! Any bytes as an STL file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_files(&[("fuzz.stl", bytes)]));
