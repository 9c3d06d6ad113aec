//! Any bytes as a file of rays: an array or text, by its beginning, and as an array whatever its beginning.
#![no_main]

use std::io::Cursor;

use raywarp::query::files::RayReader;

/// Reads to the end in pieces. As many rays come as the file says, and none from nothing.
fn read(name: &str, bytes: &[u8], len: Option<u64>) {
    let input = Box::new(Cursor::new(bytes.to_vec()));
    let reader = RayReader::new(name, input, len).map_err(|error| assert!(error.to_string().len() < 2000));
    let Ok(mut reader) = reader else { return };
    let (mut rays, mut count) = (Vec::new(), 0u64);
    loop {
        match reader.read(1000, &mut rays) {
            Err(error) => return assert!(error.to_string().len() < 2000),
            Ok(()) if rays.is_empty() => break,
            Ok(()) => count += rays.len() as u64,
        }
        assert!(count <= bytes.len() as u64, "{count} rays in {} bytes", bytes.len());
    }
    assert!(reader.rays().is_none_or(|rays| rays == count));
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    read("fuzz", bytes, None);
    read("fuzz.npy", bytes, Some(bytes.len() as u64));
});
