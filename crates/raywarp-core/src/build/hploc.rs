//! Merges sorted triangles into a binary tree: hierarchical parallel locally-ordered clustering (Benthin and others 2024).
//!
//! The ranges are those of a linear hierarchy over the codes, climbed from the triangles up as Apetrei (2014) does it: of the
//! two threads that come to the gap between two ranges the second goes on with both. Where a range has more than 16
//! triangles, the warp merges its clusters until so many are left, which wait in a list for the range above.
//!
//! Who comes second depends on the time, but not what is done then: it is a function of the two ranges. A node has the number
//! of the cluster that it takes in on the right, which is that cluster's for good, so numbers need no counter.

use super::bounds::Bounds;
use super::cluster::{nth_bit, Cluster, Clusters};
use super::node::{Below, Link, Node};
use super::survey::Findings;
use crate::arch::{self, in_each_lane, lanes_where, Lanes, Shuffle, LANES, WARP};
use crate::kernels::Thread;
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// Clusters that a range keeps for the one above it.
const KEPT: u32 = LANES / 2;

/// All threads of a warp, a bit each.
const ALL: u32 = u32::MAX >> (32 - WARP);

/// Builds the tree, one thread a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Hploc {
    /// As given.
    pub triangles: View<Triangle>,
    /// One.
    pub findings: View<Findings>,
    /// Codes in ascending order, and which triangle each is of.
    pub sorted: View<[u32; 2]>,
    /// Of each gap between two triangles the other end of the range that came there first, plus one; zeros before.
    pub ends: ViewMut<u32>,
    /// The clusters of a range, from its first place on.
    pub lists: ViewMut<u32>,
    /// By number, written.
    pub nodes: ViewMut<Node>,
}

/// Triangles `first` to `last` of the sorted order, of which those up to `middle` are one part.
#[derive(Clone, Copy)]
struct Range {
    first: u32,
    middle: u32,
    last: u32,
    /// Whether these are all.
    whole: bool,
}

impl Range {
    #[inline(always)]
    fn is_small(&self) -> bool {
        self.last - self.first < KEPT && !self.whole
    }

    /// Whether one of the parts has a list of clusters.
    #[inline(always)]
    fn has_list(&self) -> bool {
        self.middle - self.first >= KEPT || self.last - self.middle > KEPT
    }
}

impl Hploc {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let count = self.findings.item(0).hittable(self.triangles.len());
        let mut range = Range { first: thread.x, middle: thread.x, last: thread.x, whole: false };
        if count == 1 && thread.x == 0 {
            self.only_one();
        }
        let mut climbs = thread.x < count && count > 1;
        loop {
            if climbs {
                climbs = self.climb(&mut range, count);
            }
            let mut open = vote(climbs && !range.is_small());
            while open != 0 {
                self.reduce(&of_lane(&range, open.trailing_zeros()));
                open &= open - 1;
            }
            climbs &= !range.whole;
            if vote(climbs) == 0 {
                return;
            }
        }
    }

    /// Joins a range with its neighbour, if that came to the gap between them before.
    #[inline(always)]
    fn climb(&self, range: &mut Range, count: u32) -> bool {
        let (first, last) = (range.first, range.last);
        let is_left = first == 0 || (last + 1 < count && self.distance(last) < self.distance(first - 1));
        let (gap, end) = if is_left { (last, first) } else { (first - 1, last) };
        // SAFETY: nothing else touches the ends of gaps.
        let other = unsafe { arch::exchange(self.ends.shared(gap), end + 1) };
        if other == 0 {
            return false;
        }
        let (first, last) = if is_left { (first, other - 1) } else { (other - 1, last) };
        *range = Range { first, middle: gap, last, whole: last - first + 1 == count };
        true
    }

    /// How far the triangles on both sides of a gap are apart on the curve. Equal codes are told apart by their places. Of
    /// the gaps at both ends of a range one is always farther.
    #[inline(always)]
    fn distance(&self, gap: u32) -> u64 {
        let (a, b) = (self.sorted.at(gap)[0], self.sorted.at(gap + 1)[0]);
        ((a ^ b) as u64) << 32 | (gap ^ (gap + 1)) as u64
    }

    /// Merges the clusters of a range until few are left, or one of all. All threads of the warp are here.
    #[inline(always)]
    fn reduce(&self, range: &Range) {
        if range.has_list() {
            self.meet();
        }
        let mut clusters = self.of_both_parts(range);
        let left = if range.whole { 1 } else { KEPT };
        while clusters.count > left {
            let is_root = range.whole && clusters.count == 2;
            clusters = clusters.round(|a, b| self.merge(a, b, is_root));
            // Another thread may write to a node in the next round.
            // SAFETY: all threads of the warp are here.
            unsafe { arch::syncwarp(ALL) };
        }
        if !range.whole {
            self.keep(range, &clusters);
        }
        self.meet();
    }

    /// Between what was written before threads met at a gap and what is read after.
    #[inline(always)]
    fn meet(&self) {
        arch::fence();
        // SAFETY: all threads of the warp are here.
        unsafe { arch::syncwarp(ALL) };
    }

    #[inline(always)]
    fn of_both_parts(&self, range: &Range) -> Clusters {
        let links = Lanes::<u32>::each(|lane| {
            if lane < KEPT {
                self.listed(range.first, range.middle, lane)
            } else {
                self.listed(range.middle + 1, range.last, lane - KEPT)
            }
        });
        let there = lanes_where(|lane| links.of(lane) != Link::NONE.bits());
        let count = there.count_ones();
        let links = Lanes::<u32>::each(|lane| links.from(nth_bit(there, lane)));
        let cluster = |lane| {
            if lane < count {
                self.cluster(Link::of_bits(links.of(lane)))
            } else {
                Cluster::default()
            }
        };
        Clusters { lanes: Lanes::each(cluster), count }
    }

    /// The cluster at a place of a part's list. A small part has none: its clusters are its triangles.
    #[inline(always)]
    fn listed(&self, first: u32, last: u32, place: u32) -> u32 {
        if last - first >= KEPT {
            // SAFETY: written before this part came to its gap, and for good.
            return unsafe { arch::load_word_coherent(self.lists.shared(first + place)) };
        }
        if first + place <= last {
            Link::leaf(first + place).bits()
        } else {
            Link::NONE.bits()
        }
    }

    #[inline(always)]
    fn cluster(&self, link: Link) -> Cluster {
        if link.is_leaf() {
            return self.triangle(link.index());
        }
        // SAFETY: written before its range came to its gap; only what is above it changes, by the thread that reads it here.
        let node = unsafe { arch::load_coherent(self.nodes.shared(link.index())) };
        Cluster { bounds: node.bounds(), below: node.below(), link, leader: node.leader }
    }

    #[inline(always)]
    fn triangle(&self, place: u32) -> Cluster {
        let bounds = Bounds::of(&self.triangles.load(self.sorted.at(place)[1]));
        let below = Below::triangle(bounds.half_area());
        Cluster { bounds, below, link: Link::leaf(place), leader: place }
    }

    /// Makes a node of two clusters.
    #[inline(always)]
    fn merge(&self, left: &Cluster, right: &Cluster, is_root: bool) -> Cluster {
        let bounds = left.bounds.join(&right.bounds);
        let below = Below::join(bounds.half_area(), &left.below, &right.below);
        let number = if is_root { 0 } else { right.leader };
        let larger_first = right.bounds.half_area() > left.bounds.half_area();
        let children = if larger_first { [right.link, left.link] } else { [left.link, right.link] };
        let merged = Cluster { bounds, below, link: Link::node(number), leader: left.leader };
        // SAFETY: no other node has this number.
        unsafe { self.nodes.set(number, node(&merged, children)) };
        if is_root {
            // The root's own number stays free.
            // SAFETY: as above.
            unsafe { self.nodes.set(right.leader, Node::default()) };
        }
        self.set_parent(left.link, number);
        self.set_parent(right.link, number);
        merged
    }

    #[inline(always)]
    fn set_parent(&self, child: Link, parent: u32) {
        if !child.is_leaf() {
            // SAFETY: a node is merged once, and nothing else writes to it then.
            unsafe { (&raw mut (*self.nodes.shared(child.index())).parent).write(parent) };
        }
    }

    #[inline(always)]
    fn keep(&self, range: &Range, clusters: &Clusters) {
        in_each_lane(|lane| {
            if lane < KEPT {
                let link = if lane < clusters.count { clusters.lanes.of(lane).link } else { Link::NONE };
                // SAFETY: of this range alone, until another one takes it over.
                unsafe { self.lists.set(range.first + lane, link.bits()) };
            }
        });
    }

    /// A root that is a leaf.
    #[inline(always)]
    fn only_one(&self) {
        let one = self.triangle(0);
        // SAFETY: no other thread writes anything then.
        unsafe { self.nodes.set(0, node(&one, [one.link; 2])) };
    }
}

#[inline(always)]
fn node(cluster: &Cluster, children: [Link; 2]) -> Node {
    let (Bounds { low, high }, Below { cost, sah, count, nodes, shape }) = (cluster.bounds, cluster.below);
    Node { low, cost, high, sah, children, count, nodes, shape, leader: cluster.leader, parent: 0, unused: 0 }
}

/// Which threads of the warp say yes, a bit each. All of them are here.
#[inline(always)]
fn vote(value: bool) -> u32 {
    // SAFETY: no thread leaves the loop before all of its warp do.
    unsafe { arch::ballot(ALL, value) }
}

/// The range of a thread of the warp. All of them are here.
#[inline(always)]
fn of_lane(range: &Range, lane: u32) -> Range {
    let (first, middle, last) = (range.first.of_lane(lane), range.middle.of_lane(lane), range.last.of_lane(lane));
    Range { first, middle, last, whole: (range.whole as u32).of_lane(lane) != 0 }
}
