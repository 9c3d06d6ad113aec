//! Any bytes as a picture: the contents pick the decoder, and the name where they do not.
#![no_main]

const OBJ: &[u8] = b"mtllib fuzz.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
const MTL: &[u8] = b"newmtl a\nmap_Kd a.tga\nmap_d a.tga\nbump a.tga\n";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    raywarp_fuzz::load_files(&[("fuzz.obj", OBJ), ("fuzz.mtl", MTL), ("a.tga", bytes)]);
});
