//! What the lanes of a warp do, followed step by step on the host.
//!
//! The model: 32 lanes run in step and meet again where their loops end. A step visits one node or tests one triangle of
//! each lane that takes part, and costs the same whatever it is. Caches, memory and scheduling are not in it.

use std::mem::MaybeUninit;

use rayon::prelude::*;
use raywarp_core::traversal::binary::Storage;
use raywarp_core::traversal::bvh2::MAX_DEPTH;
use raywarp_core::traversal::query::{AnyHit, ClosestHit, Query};
use raywarp_core::traversal::{self, Counter, NullStatistics};
use raywarp_lab_core::sharing::search::Search;

use raywarp::accel::bvh2::Bvh2;
use raywarp::Ray;

/// Lanes of a warp.
pub const WARP: usize = 32;

/// The order in which the threads of a warp take steps (Aila and Laine 2009).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopForm {
    /// A node or a triangle, and again.
    IfIf,
    /// Nodes until there is a leaf, then its triangles.
    WhileWhile,
    /// A lane with a leaf goes on to nodes while others have none.
    Speculative,
    /// Each step is what more of the lanes want.
    Postponed,
}

impl LoopForm {
    /// Every form.
    pub const ALL: [Self; 4] = [Self::IfIf, Self::WhileWhile, Self::Speculative, Self::Postponed];

    /// As the literature calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::IfIf => "if-if",
            Self::WhileWhile => "while-while",
            Self::Speculative => "speculative",
            Self::Postponed => "postponed",
        }
    }
}

/// Lane-steps, by what the lane does. All but `steps` add up to [`WARP`] times `steps`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneSteps {
    /// Steps of warps.
    pub steps: u64,
    /// It visits a node or tests a triangle.
    pub useful: u64,
    /// It has triangles to test, and others visit nodes.
    pub boxes: u64,
    /// It has nodes to visit, and others test triangles.
    pub leaves: u64,
    /// It has no ray left.
    pub finished: u64,
    /// It has no ray where others have one: see [`frame`].
    pub shading: u64,
}

impl LaneSteps {
    /// Both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            useful: self.useful + other.useful,
            boxes: self.boxes + other.boxes,
            leaves: self.leaves + other.leaves,
            finished: self.finished + other.finished,
            shading: self.shading + other.shading,
        }
    }

    /// Useful over all lane-steps: the SIMD efficiency; 1 where there are none.
    pub fn efficiency(&self) -> f64 {
        if self.steps == 0 {
            1.0
        } else {
            self.useful as f64 / (self.steps * WARP as u64) as f64
        }
    }
}

/// Follows a batch, 32 rays in a row a warp: every n-th warp, with the smallest n that leaves at most `most` warps.
pub fn batch(tree: &Bvh2, rays: &[Ray], any_hit: bool, form: LoopForm, most: usize) -> LaneSteps {
    let warps: Vec<&[Ray]> = rays.chunks(WARP).collect();
    let step = warps.len().div_ceil(most.max(1)).max(1);
    let view = tree.view();
    // SAFETY: used within this call, while the tree is borrowed.
    let view = unsafe { view.get() };
    let follow = |rays: &&[Ray]| match any_hit {
        true => Warp::<AnyHit>::follow(&view, rays, form),
        false => Warp::<ClosestHit>::follow(&view, rays, form),
    };
    warps.par_iter().step_by(step).map(follow).reduce(LaneSteps::default, LaneSteps::plus)
}

/// Searches that run in step.
struct Warp<'a, Q: Query> {
    lanes: Vec<Search<'a, Q>>,
    sum: LaneSteps,
}

impl<'a, Q: Query> Warp<'a, Q> {
    fn follow(tree: &traversal::Bvh2, rays: &[Ray], form: LoopForm) -> LaneSteps {
        let mut rooms: Vec<Storage> = vec![[const { MaybeUninit::uninit() }; MAX_DEPTH + 1]; rays.len()];
        let begin = |(storage, ray)| {
            let mut search = Search::idle(tree, storage);
            search.begin(ray);
            search
        };
        let lanes = rooms.iter_mut().zip(rays).map(begin).collect();
        let mut warp = Warp::<Q> { lanes, sum: LaneSteps::default() };
        while !warp.lanes.iter().all(Search::is_over) {
            match form {
                LoopForm::IfIf => warp.if_if(),
                LoopForm::WhileWhile => warp.while_while(),
                LoopForm::Speculative => warp.speculative(),
                LoopForm::Postponed => warp.postponed(),
            }
        }
        warp.sum
    }

    /// One step of those lanes that `take` it; the others wait, for nodes or for triangles.
    fn step(&mut self, nodes: bool, take: impl Fn(&Search<'a, Q>) -> bool) -> bool {
        let mut sum = LaneSteps { steps: 1, finished: (WARP - self.lanes.len()) as u64, ..LaneSteps::default() };
        for lane in &mut self.lanes {
            if lane.is_over() {
                sum.finished += 1;
            } else if !take(lane) {
                *(if nodes { &mut sum.boxes } else { &mut sum.leaves }) += 1;
            } else {
                sum.useful += 1;
                match nodes {
                    true => lane.visit(&mut NullStatistics),
                    false => lane.test_one(&mut NullStatistics),
                }
            }
        }
        if sum.useful > 0 {
            self.sum = self.sum.plus(sum);
        }
        sum.useful > 0
    }

    fn hold(&mut self) {
        self.lanes.iter_mut().filter(|lane| lane.is_at_leaf() && !lane.holds_leaf()).for_each(Search::hold);
    }

    fn test_held(&mut self) {
        while self.step(false, Search::holds_leaf) {}
    }

    fn if_if(&mut self) {
        self.step(true, |lane| lane.is_at_node() && !lane.holds_leaf());
        self.hold();
        self.step(false, Search::holds_leaf);
    }

    fn while_while(&mut self) {
        while self.step(true, Search::is_at_node) {}
        self.hold();
        self.test_held();
    }

    fn speculative(&mut self) {
        while self.lanes.iter().any(Search::is_at_node) {
            let visiting: Vec<bool> = self.lanes.iter().map(Search::is_at_node).collect();
            self.step(true, Search::is_at_node);
            self.hold_where(&visiting);
            if self.lanes.iter().zip(visiting).all(|(lane, visited)| !visited || lane.holds_leaf()) {
                break;
            }
        }
        self.test_held();
        self.hold();
        self.test_held();
    }

    fn hold_where(&mut self, chosen: &[bool]) {
        let lanes = self.lanes.iter_mut().zip(chosen).filter(|(_, &chosen)| chosen).map(|(lane, _)| lane);
        lanes.filter(|lane| lane.is_at_leaf() && !lane.holds_leaf()).for_each(Search::hold);
    }

    fn postponed(&mut self) {
        self.hold();
        let count = |has: fn(&Search<'a, Q>) -> bool| self.lanes.iter().filter(|lane| has(lane)).count();
        if count(Search::is_at_node) >= count(Search::holds_leaf) {
            self.step(true, Search::is_at_node);
        } else {
            self.test_held();
        }
    }
}

/// What a pixel's thread did: its rays, in the order in which it traced them.
#[derive(Clone, Debug, Default)]
pub struct Log {
    rays: Vec<(Rank, Runs)>,
    /// Of the next ray.
    rank: Rank,
}

/// When a ray's turn is: which of the camera's, mirrored and refracted rays it belongs to, 0 for that ray itself or one more
/// than the light that it goes to, and how many of the same came before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    branch: u32,
    light: u32,
    again: u32,
}

/// A ray as numbers of nodes and of triangles, in turn: some nodes, then a leaf.
type Runs = Vec<[u64; 2]>;

impl Counter for Log {
    fn branch(&mut self) {
        self.rank = Rank { branch: self.rank.branch + 1, ..Rank::default() };
    }

    fn light(&mut self, light: u32) {
        self.rank = Rank { light: light + 1, again: 0, ..self.rank };
    }

    fn ray(&mut self) {
        self.rays.push((self.rank, Vec::new()));
        self.rank.again += 1;
    }

    fn node(&mut self) {
        let Some((_, runs)) = self.rays.last_mut() else { return };
        match runs.last_mut() {
            Some([nodes, 0]) => *nodes += 1,
            _ => runs.push([1, 0]),
        }
    }

    fn leaf(&mut self) {
        let Some((_, runs)) = self.rays.last_mut() else { return };
        if !matches!(runs.last(), Some([_, 0])) {
            runs.push([0, 0]);
        }
    }

    fn triangle(&mut self) {
        if let Some([_, triangles]) = self.rays.last_mut().and_then(|(_, runs)| runs.last_mut()) {
            *triangles += 1;
        }
    }
}

/// Follows a warp of pixels through all of their rays, with the loop that renders: while-while. The n-th camera, mirrored or
/// refracted rays of all lanes run in step, and so do the rays from there to the same light. A lane that has no such ray
/// counts as `shading`; one that has no later ray either, as `finished`.
pub fn frame(pixels: &[Log]) -> LaneSteps {
    let mut ranks: Vec<Rank> = pixels.iter().flat_map(|log| log.rays.iter().map(|(rank, _)| *rank)).collect();
    ranks.sort_unstable();
    ranks.dedup();
    let mut sum = LaneSteps::default();
    for rank in ranks {
        let ray = |log: &Log| log.rays.iter().find(|(other, _)| *other == rank).map(|(_, runs)| runs.clone());
        let runs: Vec<Option<Runs>> = pixels.iter().map(ray).collect();
        let finished = |log: &Log| log.rays.last().is_none_or(|(last, _)| *last < rank);
        let absent: Vec<bool> = pixels.iter().map(finished).collect();
        sum = sum.plus(in_step(&runs, &absent));
    }
    sum
}

/// One ray of each lane that has one; `absent` lanes have none left at all.
fn in_step(lanes: &[Option<Runs>], absent: &[bool]) -> LaneSteps {
    let mut sum = LaneSteps::default();
    let most = lanes.iter().flatten().map(Vec::len).max().unwrap_or(0);
    for run in 0..most {
        for kind in [0, 1] {
            let own = |lane: &Option<Runs>| lane.as_ref().and_then(|runs| runs.get(run)).map_or(0, |run| run[kind]);
            let steps = lanes.iter().map(own).max().unwrap_or(0);
            sum.steps += steps;
            sum.finished += steps * (WARP - lanes.len().min(WARP)) as u64;
            for (lane, &absent) in lanes.iter().zip(absent) {
                let useful = own(lane);
                sum.useful += useful;
                let idle = steps - useful;
                // After its last triangle, or its last node where no triangle follows, a ray is done.
                let done =
                    |runs: &Runs| run + 1 > runs.len() || (run + 1 == runs.len() && (kind == 1 || runs[run][1] == 0));
                match lane {
                    None if absent => sum.finished += idle,
                    None => sum.shading += idle,
                    Some(runs) if done(runs) => sum.finished += idle,
                    Some(_) if kind == 0 => sum.boxes += idle,
                    Some(_) => sum.leaves += idle,
                }
            }
        }
    }
    sum
}
