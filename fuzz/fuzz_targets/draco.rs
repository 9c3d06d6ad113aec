//! Any bytes as the Draco stream of a glTF primitive.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_draco(bytes));
