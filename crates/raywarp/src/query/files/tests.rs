//! Files of rays, good and bad, and what is written of answers.

use std::io::{BufReader, Cursor};

use proptest::prelude::*;

use super::npy::Head;
use super::*;
use crate::query::{AllHits, Hits};
use crate::{Ray, Vec3, MISS};

/// Reads all rays in pieces of three.
fn read(name: &str, bytes: &[u8]) -> Result<Vec<Ray>, String> {
    let len = Some(bytes.len() as u64);
    read_pipe(name, bytes, len)
}

fn read_pipe(name: &str, bytes: &[u8], len: Option<u64>) -> Result<Vec<Ray>, String> {
    // A small buffer, so that pieces of a file end anywhere.
    let input = BufReader::with_capacity(16, Cursor::new(bytes.to_vec()));
    let mut reader = RayReader::new(name, Box::new(input), len).map_err(|error| error.to_string())?;
    let (mut all, mut some) = (Vec::new(), Vec::new());
    loop {
        reader.read(3, &mut some).map_err(|error| error.to_string())?;
        assert!(some.len() <= 3);
        if some.is_empty() {
            return Ok(all);
        }
        all.append(&mut some);
    }
}

/// A `.npy` file of float32.
fn npy(shape: &[u64], numbers: &[f32]) -> Vec<u8> {
    let mut file = Head::write("<f4", shape);
    file.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    file
}

/// The ray of this number, with the ends given or from 0 to infinity.
fn ray(i: usize, ends: Option<[f32; 2]>) -> Ray {
    let n = 6.0 * i as f32;
    let ray = Ray::new(Vec3::new(n, n + 1.0, n + 2.0), Vec3::new(n + 3.0, n + 4.0, n + 5.0));
    ends.map_or(ray, |[t_min, t_max]| Ray { t_min, t_max, ..ray })
}

fn numbers(rays: usize) -> Vec<f32> {
    (0..6 * rays).map(|i| i as f32).collect()
}

#[test]
fn arrays_of_every_shape_are_read() {
    let ten: Vec<_> = (0..10).map(|i| ray(i, None)).collect();
    for shape in [&[10u64, 6] as &[u64], &[2, 5, 6], &[1, 10, 1, 6]] {
        assert_eq!(read("a.npy", &npy(shape, &numbers(10))), Ok(ten.clone()));
    }
    assert_eq!(read("a.npy", &npy(&[6], &numbers(1))), Ok(vec![ray(0, None)]));
    for shape in [&[0u64, 6] as &[u64], &[0, 8], &[5, 0, 6]] {
        assert_eq!(read("a.npy", &npy(shape, &[])), Ok(vec![]));
    }
    let limited = [0.0, 1.0, 2.0, -1.0, 3.0, 4.0, 5.0, f32::INFINITY];
    assert_eq!(read("a.npy", &npy(&[1, 8], &limited)), Ok(vec![ray(0, Some([-1.0, f32::INFINITY]))]));
    // What follows the array, another one perhaps, is not read.
    let twice = [npy(&[10, 6], &numbers(10)), npy(&[1, 6], &[f32::NAN; 6])].concat();
    assert_eq!(read("standard input", &twice), Ok(ten));
}

#[test]
fn every_kind_of_float_is_read() {
    let values = numbers(2);
    let rays = vec![ray(0, None), ray(1, None)];
    let file = |descr: &str, bytes: Vec<u8>| [Head::write(descr, &[2, 6]), bytes].concat();
    for (descr, bytes, rounded) in [
        ("<f4", values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>(), false),
        (">f4", values.iter().flat_map(|x| x.to_be_bytes()).collect(), false),
        ("<f8", values.iter().flat_map(|x| f64::from(*x).to_le_bytes()).collect(), true),
        (">f8", values.iter().flat_map(|x| f64::from(*x).to_be_bytes()).collect(), true),
    ] {
        let file = file(descr, bytes);
        assert_eq!(read("a.npy", &file).as_ref(), Ok(&rays), "{descr}");
        let reader = RayReader::new("a", Box::new(Cursor::new(file)), None).unwrap();
        assert_eq!((reader.is_rounded(), reader.rays(), reader.shape()), (rounded, Some(2), Some(&[2u64] as &[u64])));
    }
}

/// An array of these axes in Fortran order, of the numbers that `npy` has in C order.
fn fortran(shape: &[u64], numbers: &[f32]) -> Vec<u8> {
    let head = String::from_utf8(Head::write("<f4", shape)[10..].to_vec()).unwrap().replace("False", "True ");
    let mut bytes = [&Head::write("<f4", shape)[..10], head.as_bytes()].concat();
    for place in 0..numbers.len() as u64 {
        // The first axis runs fastest here, and the last one in `numbers`.
        let (mut rest, mut index) = (place, Vec::new());
        for axis in shape {
            index.push(rest % axis);
            rest /= axis;
        }
        let at = index.iter().zip(shape).fold(0, |at, (i, axis)| at * axis + i);
        bytes.extend(numbers[at as usize].to_le_bytes());
    }
    bytes
}

#[test]
fn either_order_of_an_array_gives_the_same_rays() {
    for shape in [&[6u64] as &[u64], &[10, 6], &[1, 6], &[2, 5, 6], &[5, 1, 2, 6], &[5, 2, 6]] {
        let values = numbers(shape[..shape.len() - 1].iter().product::<u64>() as usize);
        let c = read("a.npy", &npy(shape, &values));
        assert!(c.is_ok());
        assert_eq!(read("a.npy", &fortran(shape, &values)), c, "{shape:?}");
    }
    assert_eq!(read("a.npy", &fortran(&[0, 6], &[])), Ok(vec![]));
    let said = read_pipe("standard input", &fortran(&[10, 6], &numbers(10))[..300], None).unwrap_err();
    assert_eq!(said, "standard input: byte 300: the data end here, 172 bytes of 240");
    // It is still so when it is asked again.
    let input = Cursor::new(fortran(&[10, 6], &numbers(10))[..300].to_vec());
    let mut reader = RayReader::new("a", Box::new(input), None).unwrap();
    let [first, second] = [0; 2].map(|_| reader.read(3, &mut Vec::new()).unwrap_err().to_string());
    assert_eq!(first, second);
}

#[test]
fn arrays_that_are_no_rays_are_refused_with_the_reason() {
    let whole = npy(&[10, 6], &numbers(10));
    for (bytes, sentence) in [
        (npy(&[4, 3], &[0.0; 12]), "an array of shape (4, 3); expected a last axis of 6"),
        (npy(&[7], &[0.0; 7]), "an array of shape (7,); expected"),
        (npy(&[], &[0.0]), "an array of shape (); expected"),
        (npy(&[1; 30], &[0.0]), "an array of shape (1, 1, 1, 1, 1, 1, 1, 1, ...); expected"),
        (npy(&[1 << 63, 6], &[]), "more than 2^64 bytes"),
        (npy(&[1 << 40, 1 << 40, 6], &[]), "more than 2^64 bytes"),
        (npy(&[1 << 40, 6], &numbers(1)), "take 26388279066624 bytes from byte 128 on"),
        (Head::write("<i8", &[1, 6]), "items of type '<i8'; expected float32 or float64"),
        (Head::write("<f2", &[1, 6]), "items of type '<f2'"),
        (Head::write("", &[1, 6]), "items of type ''"),
        (whole[..whole.len() - 1].to_vec(), "byte 367: the file ends here, and rays of shape (10, 6) take 240 bytes"),
        (b"PK\x03\x04".to_vec(), "an archive; expected a single array"),
        (b"".to_vec(), "the file ends"),
        (b"0,0,0,1,1,1\n".to_vec(), "is not how a .npy file begins"),
    ] {
        let said = read("a.npy", &bytes).unwrap_err();
        assert!(said.starts_with("a.npy: byte ") && said.contains(sentence), "{said}");
    }
    // Nobody knows beforehand how long a pipe is.
    let said = read_pipe("standard input", &whole[..300], None).unwrap_err();
    assert_eq!(said, "standard input: byte 272: the data end within 3 rays from here, after 6 of 10");
}

#[test]
fn text_is_read_with_and_without_a_head() {
    let rays = vec![ray(0, None), ray(1, None)];
    for text in [
        "0,1,2,3,4,5\n6,7,8,9,10,11\n",
        "ox,oy,oz,dx,dy,dz\r\n0,1,2,3,4,5\r\n6,7,8,9,10,11",
        "# made by hand\n\n  0, 1 ,2,3,4,5 \n\n#\n6,7,8,9,1e1,1.1E+1\n",
        "\u{feff}0;1;2;3;4;5\n6;7;8;9;10;11\n",
        "0.0e+00 1 2 3 4 5\n 6  7\t8 9 10 11\n",
    ] {
        assert_eq!(read("a.csv", text.as_bytes()).as_ref(), Ok(&rays), "{text:?}");
    }
    let limited = read("a.csv", b"0,1,2,-inf,3,4,5,inf\n").unwrap();
    assert_eq!(limited, [ray(0, Some([f32::NEG_INFINITY, f32::INFINITY]))]);
    assert!(read("a.csv", b"nan,1,2,3,4,5\n").unwrap()[0].origin.x.is_nan());
    assert_eq!(read("a.csv", b""), Ok(vec![]));
    assert_eq!(read("a.csv", b"x,y,z,dx,dy,dz\n"), Ok(vec![]));
}

#[test]
fn bad_text_is_refused_with_its_place() {
    let long = [b"0," as &[u8], &vec![b'1'; 100_000]].concat();
    for (text, sentence) in [
        (b"0,1,2,3,4,5\n0,1,2,3,4\n" as &[u8], "a.csv: line 2: 5 numbers; expected 6, as in the lines before"),
        (b"0,1,2\n", "a.csv: line 1: 3 numbers; expected 6 (origin, direction) or 8"),
        (b"0,1,2,3,4,5,6,7,8,9\n", "a.csv: line 1: 10 numbers; expected 6"),
        (b"0,1,2,3,4,5\n\n0,1,2,x,4,5\n", "a.csv: line 3, column 4: 'x' is no number"),
        (b"0,1,2,3,4,\n", "a.csv: line 1, column 6: '' is no number"),
        (b"a,b\nc,d\n", "a.csv: line 2, column 1: 'c' is no number"),
        (b"\0\xff\xfe", "a.csv: line 1"),
        (&long, "a.csv: line 1: more than 65536 bytes in a line"),
    ] {
        match read("a.csv", text) {
            Err(said) => assert!(said.contains(sentence), "{said}"),
            // Noise on a single line is a head without rays.
            Ok(rays) => assert!(rays.is_empty() && text[0] == 0),
        }
    }
}

fn hits() -> Hits {
    Hits {
        t: vec![1.5, f32::INFINITY, 1e-20, 3.0],
        primitive: vec![7, MISS, 8, 9],
        geometry: vec![1, MISS, 0, 2],
        uv: vec![[0.25, 0.5], [0.0, 0.0], [0.1, 0.2], [1.0, 0.0]],
    }
}

fn written(mode: Mode, format: Format, shape: &[u64], answers: &[Answers]) -> Vec<u8> {
    let mut writer = AnswerWriter::new(mode, format, &std::env::temp_dir()).unwrap();
    answers.iter().try_for_each(|answers| writer.add(*answers)).unwrap();
    let mut output = Cursor::new(Vec::new());
    let estimate = writer.bytes().unwrap();
    writer.write(Some(shape), &mut output).unwrap();
    let bytes = output.into_inner();
    assert!(bytes.len() as u64 <= estimate + 1024, "{} and {estimate}", bytes.len());
    bytes
}

/// Heads and data of the arrays in an archive.
fn arrays(bytes: Vec<u8>) -> Vec<(String, String, Vec<u64>, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let read = |i| {
        let mut file = archive.by_index(i).unwrap();
        let Ok(head) = Head::read(&mut file) else { panic!("{} has a head", file.name()) };
        let mut data = Vec::new();
        std::io::Read::read_to_end(&mut file, &mut data).unwrap();
        (file.name().to_owned(), head.descr, head.shape, data)
    };
    (0..count).map(read).collect()
}

#[test]
fn an_archive_has_the_shape_of_the_batch() {
    let hits = hits();
    let bytes = written(Mode::Closest, Format::Npz, &[2, 4], &[Answers::Closest(&hits), Answers::Closest(&hits)]);
    let arrays = arrays(bytes);
    let names: Vec<_> = arrays.iter().map(|(name, descr, ..)| format!("{name} {descr}")).collect();
    assert_eq!(names, ["t.npy <f4", "primitive.npy <u4", "geometry.npy <u4", "uv.npy <f4"]);
    assert_eq!(
        arrays.iter().map(|array| array.2.as_slice()).collect::<Vec<_>>(),
        [&[2u64, 4] as &[u64], &[2, 4], &[2, 4], &[2, 4, 2]]
    );
    assert_eq!(arrays[0].3[16..], arrays[0].3[..16]);
    assert_eq!(arrays[1].3[4..8], [0xff; 4]);
    assert_eq!(arrays[3].3.len(), 64);
}

#[test]
fn offsets_go_on_from_piece_to_piece() {
    let piece = AllHits { offsets: vec![0, 1, 1, 4], hits: hits() };
    let bytes = written(Mode::All, Format::Npz, &[6], &[Answers::All(&piece), Answers::All(&piece)]);
    let arrays = arrays(bytes);
    let offsets: Vec<_> = arrays[0].3.chunks(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap())).collect();
    assert_eq!(offsets, [0, 1, 1, 4, 5, 5, 8]);
    assert_eq!((&arrays[0].2, &arrays[4].2), (&vec![7], &vec![8, 2]));
    let nothing = self::arrays(written(Mode::All, Format::Npz, &[0], &[Answers::All(&AllHits::default())]));
    assert_eq!((&nothing[0].2, &nothing[0].3, &nothing[1].2), (&vec![1], &vec![0; 8], &vec![0]));
}

#[test]
fn single_arrays_are_files_too() {
    let bytes = written(Mode::Any, Format::Npy, &[3, 1], &[Answers::Any(&[true, false, true])]);
    let mut input = &bytes[..];
    let Ok(head) = Head::read(&mut input) else { panic!("there is a head") };
    assert_eq!((head.descr.as_str(), head.shape, input), ("|b1", vec![3, 1], &[1u8, 0, 1] as &[u8]));
    for mode in [Mode::Closest, Mode::All] {
        assert!(AnswerWriter::new(mode, Format::Npy, &std::env::temp_dir()).is_none());
    }
}

#[test]
fn text_has_a_line_a_ray_or_a_hit() {
    let text = |mode, answers: &[Answers]| String::from_utf8(written(mode, Format::Csv, &[], answers)).unwrap();
    assert_eq!(
        text(Mode::Closest, &[Answers::Closest(&hits())]),
        "t,primitive,geometry,u,v\n1.5,7,1,0.25,0.5\ninf,4294967295,4294967295,0.0,0.0\n1e-20,8,0,0.1,0.2\n3.0,9,2,1.0,0.0\n"
    );
    assert_eq!(text(Mode::Any, &[Answers::Any(&[true]), Answers::Any(&[false])]), "occluded\n1\n0\n");
    assert_eq!(text(Mode::Count, &[Answers::Count(&[3, 0])]), "count\n3\n0\n");
    let one = AllHits {
        offsets: vec![0, 0, 1],
        hits: Hits { t: vec![2.0], primitive: vec![1], geometry: vec![0], uv: vec![[0.5, 0.25]] },
    };
    assert_eq!(
        text(Mode::All, &[Answers::All(&one), Answers::All(&one)]),
        "ray,t,primitive,geometry,u,v\n1,2.0,1,0,0.5,0.25\n3,2.0,1,0,0.5,0.25\n"
    );
}

#[test]
fn answers_to_another_question_are_refused() {
    let mut writer = AnswerWriter::new(Mode::Closest, Format::Npz, &std::env::temp_dir()).unwrap();
    assert!(writer.add(Answers::Count(&[1])).is_err());
}

proptest! {
    /// Whatever happens to a file, there are no more rays than it has room for, and an error is a sentence.
    #[test]
    fn damaged_files_are_rays_or_an_error(
        which in 0..3,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut file = match which {
            0 => npy(&[10, 6], &numbers(10)),
            1 => npy(&[3, 8], &numbers(4)),
            _ => b"ox,oy,oz,dx,dy,dz\n0,1,2,3,4,5\n# six\n6;7;8;9;1e1;nan\n".to_vec(),
        };
        for (place, byte) in damage {
            let at = place.index(file.len());
            file[at] = byte;
        }
        file.truncate(cut.index(2 * file.len()).max(1));
        for (name, len) in [("a.npy", Some(file.len() as u64)), ("a.csv", None)] {
            match read_pipe(name, &file, len) {
                Ok(rays) => prop_assert!(rays.len() <= file.len() / 11),
                Err(said) => prop_assert!(said.starts_with(name) && said.len() < 400, "{said}"),
            }
        }
    }
}
