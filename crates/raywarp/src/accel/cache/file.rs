//! The format: a header of 48 bytes, the nodes, the order of the triangles. All numbers are little-endian.

use std::fs::File;
use std::io::{self, Read};
use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::math::vec3;
use raywarp_core::traversal::bvh2::{Child, Node, MAX_INDEX};
use raywarp_core::triangle::Triangle;
use xxhash_rust::xxh3::{xxh3_128, xxh3_64};

use crate::accel::bvh2::Bvh2;
use crate::accel::Build;

/// Of the format and of the builders: to be raised when either changes.
const VERSION: u32 = 3;

const MAGIC: [u8; 8] = *b"raywarpT";

const HEADER: usize = 48;

/// Bytes of a node: six coordinates a child, and two links.
const NODE: usize = 56;

/// Triangles that are hashed together.
const CHUNK: usize = 8192;

/// What a tree is told by: everything that it depends on.
pub(super) fn key(what: Build, triangles: &[Triangle]) -> u128 {
    let chunks: Vec<u128> = triangles.par_chunks(CHUNK).map(|chunk| xxh3_128(&bytes_of(chunk))).collect();
    let mut all = Vec::with_capacity(16 * chunks.len() + 64);
    all.extend(VERSION.to_le_bytes());
    all.extend((triangles.len() as u64).to_le_bytes());
    all.extend([what.kind.name(), " ", what.quality.name()].concat().bytes());
    all.extend(chunks.iter().flat_map(|hash| hash.to_le_bytes()));
    xxh3_128(&all)
}

fn bytes_of(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(48 * triangles.len());
    for t in triangles {
        let corners = [t.v0, t.v1, t.v2].into_iter().flat_map(|v| v.to_array()).map(f32::to_bits);
        for word in corners.chain([t.primitive, t.flags, t.instance]) {
            bytes.extend(word.to_le_bytes());
        }
    }
    bytes
}

/// The bytes of a file.
pub(super) fn encode(key: u128, nodes: &[Node], order: &[u32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + NODE * nodes.len() + 4 * order.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((nodes.len() as u32).to_le_bytes());
    bytes.extend((order.len() as u32).to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend(key.to_le_bytes());
    bytes.extend([0; 8]);
    for node in nodes {
        let corners = [node.low[0], node.low[1], node.high[0], node.high[1]];
        let corners = corners.into_iter().flat_map(|v| v.to_array()).map(f32::to_bits);
        let links = node.children.map(|child| child.index() | child.count() << 28);
        for word in corners.chain(links) {
            bytes.extend(word.to_le_bytes());
        }
    }
    for index in order {
        bytes.extend(index.to_le_bytes());
    }
    let sum = xxh3_64(&bytes);
    bytes[HEADER - 8..HEADER].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// The tree in a file; nothing where anything in it is not as it was written, or not of these triangles.
///
/// # Errors
/// What the system says when the file is there and cannot be read.
pub(super) fn decode(mut file: File, key: u128, triangles: &[Triangle]) -> io::Result<Option<Bvh2>> {
    let start = Instant::now();
    let size = file.metadata()?.len();
    let mut bytes = vec![0; HEADER];
    if size < HEADER as u64 {
        return Ok(None);
    }
    file.read_exact(&mut bytes)?;
    let Some(counts) = counts(&bytes, key, size) else { return Ok(None) };
    // Neither more nor less than the header says, though the file may have changed since.
    bytes.reserve(size as usize - HEADER);
    file.take(size - HEADER as u64).read_to_end(&mut bytes)?;
    if bytes.len() as u64 != size || !sum_is_right(&mut bytes) {
        return Ok(None);
    }
    Ok(tree(&bytes[HEADER..], counts, triangles)
        .map(|tree| Bvh2 { build_seconds: start.elapsed().as_secs_f64(), ..tree }))
}

/// Nodes and references, if they make a file of `size`.
fn counts(header: &[u8], key: u128, size: u64) -> Option<[usize; 2]> {
    let word = |at: usize| Some(u32::from_le_bytes(header.get(at..at + 4)?.try_into().ok()?));
    let [nodes, references] = [word(12)?, word(16)?];
    let expected = HEADER as u64 + NODE as u64 * u64::from(nodes) + 4 * u64::from(references);
    let fits = header.starts_with(&MAGIC)
        && word(8)? == VERSION
        && header.get(24..40)? == key.to_le_bytes()
        && nodes <= MAX_INDEX
        && references <= MAX_INDEX
        && size == expected;
    fits.then_some([nodes as usize, references as usize])
}

/// Of everything, with zeroes in the place of the sum.
fn sum_is_right(bytes: &mut [u8]) -> bool {
    let mut said = [0; 8];
    said.copy_from_slice(&bytes[HEADER - 8..HEADER]);
    bytes[HEADER - 8..HEADER].fill(0);
    xxh3_64(bytes) == u64::from_le_bytes(said)
}

fn tree(body: &[u8], [nodes, references]: [usize; 2], triangles: &[Triangle]) -> Option<Bvh2> {
    let (nodes, order) = body.split_at_checked(NODE * nodes)?;
    let nodes = nodes.par_chunks_exact(NODE).map(node).collect();
    let order: Vec<u32> = order.par_chunks_exact(4).map(|bytes| word(bytes, 0)).collect();
    if order.len() != references || !holds_all(&order, triangles.len()) {
        return None;
    }
    let runs = order.par_iter().filter_map(|&index| triangles.get(index as usize).copied()).collect();
    Bvh2::from_parts(nodes, runs).ok()
}

/// Whether these are indices of `count` triangles, each of them at least once.
fn holds_all(order: &[u32], count: usize) -> bool {
    let mut held = vec![false; count];
    let in_range = order.iter().all(|&index| held.get_mut(index as usize).map(|held| *held = true).is_some());
    in_range && held.into_iter().all(|held| held)
}

fn word(bytes: &[u8], index: usize) -> u32 {
    bytes.get(4 * index..4 * index + 4).and_then(|four| four.try_into().ok()).map_or(0, u32::from_le_bytes)
}

fn node(bytes: &[u8]) -> Node {
    let corner = |i: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| f32::from_bits(word(bytes, 3 * i + k)));
        vec3(x, y, z)
    };
    let link = |i: usize| match word(bytes, 12 + i) {
        link if link >> 28 == 0 => Child::node(link),
        link => Child::leaf(link & MAX_INDEX, link >> 28),
    };
    Node { low: [corner(0), corner(1)], high: [corner(2), corner(3)], children: [link(0), link(1)], unused: [0; 2] }
}
