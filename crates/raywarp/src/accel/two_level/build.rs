//! From meshes and placements to the trees.

use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::traversal::bvh2::Child;
use raywarp_core::traversal::two_level::Instance;
use raywarp_core::triangle::{flags, Triangle};

use super::bake::bake;
use super::join::{cover, Arrays};
use super::place::Inverse;
use super::{upper, InstancedStats, Placement, TwoLevel};
use crate::accel::bounds::Bounds;
use crate::accel::bvh2::Bvh2;
use crate::accel::{drop_degenerate, Accel, AccelKind, Build, BuildError, Dropped, Quality};

/// A mesh of so few triangles takes less memory in each place than an instance of it would.
const SMALL: usize = 4;

/// Every flag of a triangle.
const ALL_FLAGS: u32 = flags::CUTOUT | flags::TRANSPARENT;

/// Builds the trees. Triangles are named from 0 in each mesh (see [`Triangle::primitive`]).
///
/// A placement is baked, its triangles brought to world space for good, where that costs nothing (a mesh that is placed
/// once, or of four triangles at most) and where it must be: a transform that is flat, or that single precision cannot
/// undo. Placements of a mesh that has no triangle to hit are left out.
///
/// # Errors
/// A placement of a mesh that is not there, or more triangles or instances than links can tell apart.
pub fn build(meshes: Vec<Vec<Triangle>>, placements: &[Placement], quality: Quality) -> Result<TwoLevel, BuildError> {
    Plan::new(meshes, placements.to_vec())?.build(quality)
}

/// What is built, and what becomes of each placement: a function of what is placed, and of nothing else.
pub struct Plan {
    meshes: Vec<Mesh>,
    placements: Vec<Placement>,
    fates: Vec<Fate>,
    start: Instant,
}

impl Plan {
    /// Of meshes and where they are placed.
    ///
    /// # Errors
    /// A placement of a mesh that is not there.
    pub fn new(meshes: Vec<Vec<Triangle>>, placements: Vec<Placement>) -> Result<Self, BuildError> {
        let start = Instant::now();
        check(&meshes, &placements)?;
        let meshes: Vec<Mesh> = meshes.into_par_iter().map(Mesh::new).collect();
        let fates = decide(&meshes, &placements);
        Ok(Self { meshes, placements, fates, start })
    }

    /// Whether a placement is an instance of a mesh that stays in a space of its own, and not baked.
    pub fn is_shared(&self, placement: usize) -> bool {
        self.fates[placement] == Fate::Shared
    }

    /// How many there are.
    pub(crate) fn placements(&self) -> usize {
        self.placements.len()
    }

    /// Builds the trees.
    ///
    /// # Errors
    /// More triangles or instances than links can tell apart.
    pub fn build(self, quality: Quality) -> Result<TwoLevel, BuildError> {
        let Self { meshes, placements, fates, start } = self;
        grow(meshes, &placements, &fates, quality, start)
    }
}

fn grow(
    mut meshes: Vec<Mesh>,
    placements: &[Placement],
    fates: &[Fate],
    quality: Quality,
    start: Instant,
) -> Result<TwoLevel, BuildError> {
    let (baked, baked_dropped) = bake_all(&meshes, placements, fates);
    let mut stats = count(&meshes, placements, fates, baked_dropped);

    // Each tree with the boxes that instances turn; the baked one's is the first.
    let mut trees: Vec<Bvh2> = if baked.is_empty() { Vec::new() } else { vec![tree(baked, quality)?] };
    let (first, shared) = (trees.len(), number(fates, placements, meshes.len()));
    let ordered: Vec<Vec<Triangle>> = shared.iter().map(|&mesh| std::mem::take(&mut meshes[mesh].triangles)).collect();
    trees.extend(ordered.into_par_iter().map(|mesh| tree(mesh, quality)).collect::<Result<Vec<_>, _>>()?);
    let covers: Vec<Vec<Bounds>> = trees.par_iter().map(|tree| cover(&tree.nodes, Child::node(0))).collect();

    let mut placed = Placed::default();
    if first == 1 {
        placed.add_baked(&covers[0]);
    }
    let mut part_of = vec![0; meshes.len()];
    shared.iter().zip(first..).for_each(|(&mesh, part)| part_of[mesh] = part);
    for (placement, fate) in placements.iter().zip(fates) {
        let inverse = (*fate == Fate::Shared).then(|| Inverse::of(&placement.transform)).flatten();
        if let Some(inverse) = inverse {
            let part = part_of[placement.mesh];
            placed.add(placement, &inverse, part, &covers[part]);
        }
    }
    BuildError::check_index("instances", placed.instances.len())?;

    let (nodes, upper_depth) = upper::build(&placed.boxes);
    if trees.is_empty() {
        // What a ray of NaN may follow.
        trees.push(tree(Vec::new(), quality)?);
        placed.add_nothing();
    }
    let mut arrays = Arrays::new(nodes);
    arrays.add_all(trees)?;
    for (instance, &part) in placed.instances.iter_mut().zip(&placed.parts) {
        instance.root = arrays.root(part);
    }
    stats.instances = placed.boxes.len();
    stats.upper_depth = upper_depth;
    Ok(arrays.finish(placed.instances, placed.slack, stats, start))
}

/// What is known of a mesh before it has a tree.
struct Mesh {
    /// Those that can be hit.
    triangles: Vec<Triangle>,
    dropped: Dropped,
    bounds: Bounds,
}

impl Mesh {
    fn new(triangles: Vec<Triangle>) -> Self {
        let (triangles, dropped) = drop_degenerate(triangles);
        let bounds = triangles.iter().fold(Bounds::EMPTY, |all, triangle| all.join(&Bounds::of(triangle)));
        Self { triangles, dropped, bounds }
    }
}

/// What becomes of a placement.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    LeftOut,
    Baked,
    Shared,
}

fn check(meshes: &[Vec<Triangle>], placements: &[Placement]) -> Result<(), BuildError> {
    match placements.iter().position(|placement| placement.mesh >= meshes.len()) {
        Some(placement) => {
            Err(BuildError::NoSuchMesh { placement, mesh: placements[placement].mesh, count: meshes.len() })
        }
        None => Ok(()),
    }
}

fn decide(meshes: &[Mesh], placements: &[Placement]) -> Vec<Fate> {
    let decide = |placement: &Placement| {
        let mesh = &meshes[placement.mesh];
        match mesh.triangles.len() {
            0 => Fate::LeftOut,
            1..=SMALL => Fate::Baked,
            _ => Inverse::of(&placement.transform)
                .filter(|inverse| inverse.world_bounds(&[mesh.bounds]).is_some())
                .map_or(Fate::Baked, |_| Fate::Shared),
        }
    };
    let mut fates: Vec<Fate> = placements.par_iter().map(decide).collect();
    let mut uses = vec![0; meshes.len()];
    for (fate, placement) in fates.iter().zip(placements) {
        uses[placement.mesh] += (*fate == Fate::Shared) as usize;
    }
    for (fate, placement) in fates.iter_mut().zip(placements) {
        if *fate == Fate::Shared && uses[placement.mesh] == 1 {
            *fate = Fate::Baked;
        }
    }
    fates
}

/// The meshes that are shared, in the order in which they are placed first.
fn number(fates: &[Fate], placements: &[Placement], meshes: usize) -> Vec<usize> {
    let mut seen = vec![false; meshes];
    let shared = fates.iter().zip(placements).filter(|(&fate, _)| fate == Fate::Shared);
    shared.map(|(_, placement)| placement.mesh).filter(|&mesh| !std::mem::replace(&mut seen[mesh], true)).collect()
}

fn bake_all(meshes: &[Mesh], placements: &[Placement], fates: &[Fate]) -> (Vec<Triangle>, Dropped) {
    let baked = placements.iter().zip(fates).filter(|(_, &fate)| fate == Fate::Baked);
    drop_degenerate(baked.flat_map(|(placement, _)| bake(&meshes[placement.mesh].triangles, placement)).collect())
}

/// Of the world: each mesh as often as it is placed.
fn count(meshes: &[Mesh], placements: &[Placement], fates: &[Fate], mut dropped: Dropped) -> InstancedStats {
    let baked = fates.iter().filter(|&&fate| fate == Fate::Baked).count();
    let lost = (dropped.not_finite + dropped.without_area) as u64;
    let mut seen = 0;
    for placement in placements {
        let mesh = &meshes[placement.mesh];
        seen += mesh.triangles.len() as u64;
        dropped.not_finite += mesh.dropped.not_finite;
        dropped.without_area += mesh.dropped.without_area;
    }
    InstancedStats { baked, seen: seen - lost, dropped, ..InstancedStats::default() }
}

fn tree(triangles: Vec<Triangle>, quality: Quality) -> Result<Bvh2, BuildError> {
    match Accel::build(Build { kind: AccelKind::Bvh2, quality, cached: false }, triangles)? {
        Accel::Bvh2(tree) => Ok(tree),
        _ => unreachable!("a hierarchy was asked for"),
    }
}

/// Instances under construction.
#[derive(Default)]
struct Placed {
    instances: Vec<Instance>,
    /// Which tree each is of; its root is not known yet.
    parts: Vec<usize>,
    boxes: Vec<Bounds>,
    slack: f32,
}

impl Placed {
    fn add(&mut self, placement: &Placement, inverse: &Inverse, part: usize, cover: &[Bounds]) {
        self.instances.push(Instance {
            rows: inverse.rows,
            index: placement.instance,
            keep: if placement.flags.is_some() { 0 } else { ALL_FLAGS },
            flags: placement.flags.unwrap_or(0) & ALL_FLAGS,
            ..Instance::IDENTITY
        });
        self.parts.push(part);
        // Finite, as the box of the whole mesh is.
        self.boxes.push(inverse.world_bounds(cover).unwrap_or(Bounds::ALL));
        self.slack = self.slack.max(inverse.slack());
    }

    /// Its rays are those of the world, so its box is that of the tree.
    fn add_baked(&mut self, cover: &[Bounds]) {
        self.boxes.push(cover.iter().fold(Bounds::EMPTY, |all, part| all.join(part)));
        self.add_nothing();
    }

    fn add_nothing(&mut self) {
        self.instances.push(Instance::IDENTITY);
        self.parts.push(0);
    }
}
