use std::fs;
use std::path::PathBuf;

use raywarp_core::math::vec3;
use raywarp_core::traversal::bvh2::{Child, Node};
use tempfile::TempDir;
use xxhash_rust::xxh3::xxh3_64;

use super::*;
use crate::accel::bvh2::Bvh2;
use crate::accel::bvh2_build::{build_ordered, recipe};
use crate::accel::Quality;

fn triangles(count: u32) -> Vec<Triangle> {
    let triangle = |i: u32| {
        let (a, b) = ((i as f32 * 0.618).fract() * 10.0, (i as f32 * 0.414).fract() * 10.0);
        let length = [10.0, 0.1][(i % 10).min(1) as usize];
        Triangle::new(vec3(a, b, 0.0), vec3(a + length, b + length, length), vec3(a, b + 0.1, 0.1), i, 0)
    };
    (0..count).map(triangle).collect()
}

const HIGH: Build = Build { kind: AccelKind::Bvh2, quality: Quality::High, cached: true };

const KEY: u128 = 7;

/// A cache with one tree, and the tree's file.
struct CachedTree {
    cache: Cache,
    triangles: Vec<Triangle>,
    tree: Bvh2,
    order: Vec<u32>,
    path: PathBuf,
    _directory: TempDir,
}

fn keep() -> CachedTree {
    let directory = tempfile::tempdir().unwrap();
    let cache = Cache::at(directory.path());
    let triangles = triangles(400);
    let (tree, order) = build_ordered(&triangles, recipe(Quality::High).unwrap()).unwrap();
    cache.write(KEY, &tree.nodes, &order).unwrap();
    let path = fs::read_dir(directory.path()).unwrap().next().unwrap().unwrap().path();
    CachedTree { cache, triangles, tree, order, path, _directory: directory }
}

impl CachedTree {
    fn read(&self) -> Option<Bvh2> {
        self.cache.read(KEY, &self.triangles).unwrap()
    }

    fn is_as_built(&self) -> bool {
        self.read().is_some_and(|tree| tree.nodes == self.tree.nodes && tree.triangles == self.tree.triangles)
    }

    /// Something else, with the right checksum.
    fn forge(&self, change: impl FnOnce(&mut Vec<Node>, &mut Vec<u32>)) {
        let (mut nodes, mut order) = (self.tree.nodes.clone(), self.order.clone());
        change(&mut nodes, &mut order);
        self.cache.write(KEY, &nodes, &order).unwrap();
    }
}

#[test]
fn what_was_kept_is_found() {
    let kept = keep();
    assert!(kept.tree.stats().duplicates > 0);
    assert!(kept.is_as_built());
}

#[test]
fn a_file_cut_short_anywhere_is_ignored() {
    let kept = keep();
    let file = fs::OpenOptions::new().write(true).open(&kept.path).unwrap();
    for len in (0..file.metadata().unwrap().len()).rev() {
        file.set_len(len).unwrap();
        assert!(kept.read().is_none(), "{len}");
    }
}

#[test]
fn a_longer_file_is_ignored() {
    let kept = keep();
    let mut bytes = fs::read(&kept.path).unwrap();
    bytes.push(0);
    fs::write(&kept.path, bytes).unwrap();
    assert!(kept.read().is_none());
}

#[test]
fn a_flipped_bit_anywhere_is_noticed() {
    let kept = keep();
    let bytes = fs::read(&kept.path).unwrap();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        fs::write(&kept.path, damaged).unwrap();
        assert!(kept.read().is_none(), "{at}");
    }
    fs::write(&kept.path, bytes).unwrap();
    assert!(kept.is_as_built());
}

#[test]
fn another_version_is_ignored() {
    let kept = keep();
    let mut bytes = fs::read(&kept.path).unwrap();
    bytes[8] += 1;
    bytes[40..48].fill(0);
    let sum = xxh3_64(&bytes);
    bytes[40..48].copy_from_slice(&sum.to_le_bytes());
    fs::write(&kept.path, bytes).unwrap();
    assert!(kept.read().is_none());
}

/// The checksum is no secret: links and boxes are proved all the same.
#[test]
fn a_forged_tree_is_refused() {
    let kept = keep();
    kept.forge(|_, _| ());
    assert!(kept.is_as_built());
    let refused = |change: fn(&mut Vec<Node>, &mut Vec<u32>)| {
        kept.forge(change);
        kept.read().is_none()
    };
    assert!(refused(|nodes, _| nodes[1].children[0] = Child::node(0)));
    assert!(refused(|nodes, _| nodes[1].children[0] = Child::node(u32::MAX >> 4)));
    assert!(refused(|nodes, _| nodes[1].children[0] = Child::leaf(u32::MAX >> 4, 15)));
    assert!(refused(|nodes, _| nodes[0].low[0].x += 1.0));
    assert!(refused(|nodes, _| nodes.truncate(3)));
    assert!(refused(|nodes, _| nodes.clear()));
    assert!(refused(|_, order| order[5] = u32::MAX));
    assert!(refused(|_, order| order[5] = order[6]));
    assert!(refused(|_, order| order.clear()));
}

#[test]
fn keys_tell_everything_apart() {
    let list = triangles(20_000);
    let key = file::key(HIGH, &list);
    assert_eq!(key, file::key(HIGH, &list.clone()));
    assert_ne!(key, file::key(Build { quality: Quality::Fast, ..HIGH }, &list));
    assert_ne!(key, file::key(HIGH, &list[1..]));
    for index in [0, 8191, 8192, 19_999] {
        let mut other = list.clone();
        other[index].flags = 1;
        assert_ne!(key, file::key(HIGH, &other), "{index}");
    }
}

#[test]
fn the_second_build_is_found() {
    let directory = tempfile::tempdir().unwrap();
    let cache = Cache::at(directory.path().join("new").join("deep"));
    for quality in Quality::ALL {
        let what = Build { kind: AccelKind::Bvh2, quality, cached: true };
        let first = build_cached(what, triangles(5000), Some(&cache)).unwrap();
        let second = build_cached(what, triangles(5000), Some(&cache)).unwrap();
        // Fast trees are there sooner than a file.
        assert!(!first.found && second.found == (quality != Quality::Fast));
        assert!(first.warning.is_none() && second.warning.is_none());
        let (Accel::Bvh2(first), Accel::Bvh2(second)) = (first.accel, second.accel) else { panic!("another kind") };
        assert!(first.nodes == second.nodes && first.triangles == second.triangles);
    }
    // A damaged file is written anew.
    let path = fs::read_dir(cache.directory()).unwrap().next().unwrap().unwrap().path();
    fs::write(&path, b"nonsense").unwrap();
    let found = Quality::ALL
        .map(|quality| build_cached(Build { quality, ..HIGH }, triangles(5000), Some(&cache)).unwrap().found);
    assert_eq!(found.iter().filter(|&&found| found).count(), 1);
    assert!(fs::metadata(&path).unwrap().len() > 1000);
}

#[test]
fn what_is_not_worth_a_file_has_none() {
    let directory = tempfile::tempdir().unwrap();
    let cache = Cache::at(directory.path());
    for (what, count) in [(HIGH, 100), (AccelKind::Kd.into(), 5000), (AccelKind::Brute.into(), 5000), (HIGH, 0)] {
        assert!(!build_cached(what, triangles(count), Some(&cache)).unwrap().found);
    }
    assert!(!build_cached(HIGH, triangles(5000), None).unwrap().found);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// No directory can be made where a file is, nor a file read where a directory is.
#[test]
fn an_unusable_place_is_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("file");
    fs::write(&file, b"").unwrap();
    let cached = build_cached(HIGH, triangles(5000), Some(&Cache::at(file.join("below")))).unwrap();
    assert!(matches!(cached.warning, Some(CacheError::Read { .. } | CacheError::Write { .. })), "{cached:?}");
    assert_eq!(cached.accel.validate(), Ok(()));

    let cache = Cache::at(directory.path());
    fs::create_dir(directory.path().join(format!("{:032x}.tree", file::key(HIGH, &triangles(5000))))).unwrap();
    let cached = build_cached(HIGH, triangles(5000), Some(&cache)).unwrap();
    assert!(!cached.found && cached.warning.is_some());
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
}

#[test]
fn many_may_write_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let cache = Cache::at(directory.path());
    std::thread::scope(|scope| {
        for i in 0..8 {
            let cache = &cache;
            scope.spawn(move || {
                for _ in 0..4 {
                    let what = Build { quality: [Quality::Medium, Quality::High][i % 2], ..HIGH };
                    let cached = build_cached(what, triangles(5000), Some(cache)).unwrap();
                    assert!(cached.warning.is_none(), "{:?}", cached.warning);
                }
            });
        }
    });
    let names = fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert!(build_cached(Build { quality: Quality::Medium, ..HIGH }, triangles(5000), Some(&cache)).unwrap().found);
}

#[test]
fn the_longest_unused_go_first() {
    let kept = keep();
    let size = fs::metadata(&kept.path).unwrap().len();
    let other = kept.cache.directory().join("notes.txt");
    fs::write(&other, vec![0; 4 * size as usize]).unwrap();
    let cache = kept.cache.clone().with_limit(3 * size);
    let age = |key: u128, seconds: u64| {
        let path = cache.directory().join(format!("{key:032x}.tree"));
        let time = std::time::SystemTime::now() - std::time::Duration::from_secs(seconds);
        fs::OpenOptions::new().append(true).open(path).unwrap().set_modified(time).unwrap();
    };
    for key in [1, 2] {
        cache.write(key, &kept.tree.nodes, &kept.order).unwrap();
        age(key, 100 * key as u64);
    }
    age(KEY, 1000);
    // The oldest but for this.
    assert!(kept.is_as_built());
    cache.write(3, &kept.tree.nodes, &kept.order).unwrap();
    let there = |key| cache.read(key, &kept.triangles).unwrap().is_some();
    assert_eq!([KEY, 1, 2, 3].map(there), [true, true, false, true]);
    assert!(other.exists());
    // Larger than all the room.
    cache.clone().with_limit(size - 1).write(4, &kept.tree.nodes, &kept.order).unwrap();
    assert!(!there(4) && there(3));
}
