//! Any bytes as the meshopt stream of a glTF view, the first four of them its count, stride, mode and filter.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywarp_fuzz::load_meshopt(bytes));
