//! Polygons into triangles: a fan where that is right, clipped ears where it is not.

/// Cuts polygons, with a limit on the time that all of them together may take.
pub(crate) struct Triangulator {
    /// Steps, such as the test of a corner against an ear, that may still be made.
    budget: u64,
    /// Polygons that were not cut to the end for want of budget.
    pub unfinished: usize,
    triangles: Vec<[u32; 3]>,
    flat: Vec<[f64; 2]>,
    ring: Vec<u32>,
    reflex: Vec<u32>,
}

/// Steps a byte of the file. Ears cost the square of a polygon's corners: this is enough for any polygon of a thousand
/// corners, and files of large ones still end.
const STEPS_A_BYTE: u64 = 100;

impl Triangulator {
    /// For a file of so many bytes.
    pub fn new(file_bytes: usize) -> Self {
        Self {
            budget: (file_bytes as u64).saturating_mul(STEPS_A_BYTE),
            unfinished: 0,
            triangles: Vec::new(),
            flat: Vec::new(),
            ring: Vec::new(),
            reflex: Vec::new(),
        }
    }

    /// Triangles over the corners of a polygon, in its winding: two fewer than it has corners that differ from the one
    /// before, even if it is degenerate, crosses itself or is not finite.
    pub fn cut(&mut self, polygon: &[[f32; 3]]) -> &[[u32; 3]] {
        self.triangles.clear();
        self.ring.clear();
        self.ring.extend((0..polygon.len()).filter(|&at| polygon[at] != before(polygon, at)).map(|at| at as u32));
        match area_vector(polygon) {
            Some(area) if !fan_fits(polygon, &self.ring, area) => {
                self.flatten(polygon, area);
                self.clip_ears();
            }
            _ => self.fan(),
        }
        &self.triangles
    }

    /// What is left of the ring, around its first corner.
    fn fan(&mut self) {
        let Some((&hub, rim)) = self.ring.split_first() else { return };
        self.triangles.extend(rim.windows(2).map(|pair| [hub, pair[0], pair[1]]));
    }

    /// A triangle of the latest polygon.
    pub fn triangle(&self, index: usize) -> [u32; 3] {
        self.triangles[index]
    }

    /// Drops the coordinate along which the polygon is largest, so that it winds counter-clockwise.
    fn flatten(&mut self, polygon: &[[f32; 3]], area: [f64; 3]) {
        let axis = (0..3).max_by(|&i, &j| area[i].abs().total_cmp(&area[j].abs())).unwrap_or(2);
        let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
        if area[axis] < 0.0 {
            std::mem::swap(&mut u, &mut v);
        }
        self.flat.clear();
        self.flat.extend(polygon.iter().map(|p| [f64::from(p[u]), f64::from(p[v])]));
    }

    /// Meisters 1975. Where no ear is left, a corner without an area is cut, which changes nothing; without such, as in
    /// polygons that cross themselves, the next one is. Where the budget ends, what is left is cut as a fan.
    fn clip_ears(&mut self) {
        self.reflex.clear();
        for at in 0..self.ring.len() {
            if self.bulges_in(at) {
                self.reflex.push(self.ring[at]);
            }
        }
        let (mut at, mut passed_over) = (0, 0);
        while self.ring.len() > 3 && self.budget > 0 {
            at %= self.ring.len();
            if passed_over == self.ring.len() {
                at = self.flat_corner().unwrap_or(at);
                self.clip(at);
                passed_over = 0;
            } else if self.is_ear(at) {
                self.clip(at);
                passed_over = 0;
            } else {
                passed_over += 1;
            }
            at += 1;
        }
        self.unfinished += usize::from(self.ring.len() > 3);
        self.fan();
    }

    fn clip(&mut self, at: usize) {
        self.triangles.push(self.ear(at));
        let corner = self.ring.remove(at);
        self.reflex.retain(|&reflex| reflex != corner);
        let count = self.ring.len();
        for neighbour in [(at + count - 1) % count, at % count] {
            self.update_reflex(neighbour);
        }
        // Both lists are gone through once.
        self.spend(1 + (count + self.reflex.len()) / 16);
    }

    fn update_reflex(&mut self, at: usize) {
        let corner = self.ring[at];
        let listed = self.reflex.iter().position(|&reflex| reflex == corner);
        match (listed, self.bulges_in(at)) {
            (Some(index), false) => {
                self.reflex.swap_remove(index);
            }
            (None, true) => self.reflex.push(corner),
            _ => {}
        }
    }

    fn flat_corner(&mut self) -> Option<usize> {
        self.spend(self.ring.len());
        (0..self.ring.len()).find(|&at| turn(self.points(self.ear(at))) == 0.0)
    }

    fn spend(&mut self, tests: usize) {
        self.budget = self.budget.saturating_sub(tests as u64);
    }

    /// The corner and its neighbours on the ring.
    fn ear(&self, at: usize) -> [u32; 3] {
        let count = self.ring.len();
        [self.ring[(at + count - 1) % count], self.ring[at], self.ring[(at + 1) % count]]
    }

    fn points(&self, triangle: [u32; 3]) -> [[f64; 2]; 3] {
        triangle.map(|corner| self.flat[corner as usize])
    }

    /// Only such a corner can lie in an ear.
    fn bulges_in(&self, at: usize) -> bool {
        turn(self.points(self.ear(at))) <= 0.0
    }

    fn is_ear(&mut self, at: usize) -> bool {
        let ear = self.ear(at);
        let [a, b, c] = self.points(ear);
        self.spend(1);
        if turn([a, b, c]) <= 0.0 {
            return false;
        }
        self.spend(self.reflex.len());
        !self.reflex.iter().map(|&corner| self.flat[corner as usize]).any(|p| {
            // A corner may be repeated: where a slit leads to a hole, the same point is on the ring twice.
            p != a && p != b && p != c && [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|side| turn(side) >= 0.0)
        })
    }
}

/// Twice the area of the polygon along each axis (Newell). `None` where it has none or is not finite.
fn area_vector(polygon: &[[f32; 3]]) -> Option<[f64; 3]> {
    let mut area = [0.0; 3];
    for pair in polygon[1..].windows(2) {
        let part = cross(polygon[0], pair[0], pair[1]);
        area = [area[0] + part[0], area[1] + part[1], area[2] + part[2]];
    }
    let square = dot(area, area);
    (square.is_finite() && square > 0.0).then_some(area)
}

/// The corner before another, all the way round.
fn before(polygon: &[[f32; 3]], at: usize) -> [f32; 3] {
    polygon[at.checked_sub(1).unwrap_or(polygon.len() - 1)]
}

/// Whether all triangles of the fan around the first corner of a ring wind as the polygon does.
fn fan_fits(polygon: &[[f32; 3]], ring: &[u32], area: [f64; 3]) -> bool {
    let corner = |at: u32| polygon[at as usize];
    let Some((&hub, rim)) = ring.split_first() else { return true };
    rim.len() == 2 || rim.windows(2).all(|pair| dot(cross(corner(hub), corner(pair[0]), corner(pair[1])), area) > 0.0)
}

fn cross(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> [f64; 3] {
    let [a, b, c] = [a, b, c].map(|p| p.map(f64::from));
    let (d, e) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    [d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Twice the signed area: positive for a left turn.
fn turn([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(polygon: &[[f32; 3]]) -> Vec<[u32; 3]> {
        Triangulator::new(1 << 20).cut(polygon).to_vec()
    }

    fn flat(points: &[[f32; 2]]) -> Vec<[f32; 3]> {
        points.iter().map(|p| [p[0], p[1], 0.0]).collect()
    }

    /// Twice the areas of the triangles: all positive and of the right sum means that they tile the polygon.
    fn areas(polygon: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
        triangles
            .iter()
            .map(|t| cross(polygon[t[0] as usize], polygon[t[1] as usize], polygon[t[2] as usize])[2])
            .collect()
    }

    #[test]
    fn convex_polygons_are_fans() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cut(&square[..3]), [[0, 1, 2]]);
    }

    #[test]
    fn a_concave_quad_is_cut_at_its_notch() {
        let dart = flat(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]);
        for start in 0..4 {
            let mut turned = dart.clone();
            turned.rotate_left(start);
            let areas = areas(&turned, &cut(&turned));
            assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
        }
    }

    #[test]
    fn a_point_in_the_middle_of_an_edge_makes_no_flat_triangle() {
        let polygon = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert!(areas(&polygon, &cut(&polygon)).iter().all(|&area| area > 0.0));
    }

    #[test]
    fn corners_that_repeat_go_first() {
        let dart = flat(&[[0.5, 1.0], [0.0, 0.0], [0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.0, 2.0]]);
        for start in 0..6 {
            let mut turned = dart.clone();
            turned.rotate_left(start);
            let areas = areas(&turned, &cut(&turned));
            assert!(areas.len() == 2 && areas.iter().all(|&area| area > 0.0), "{areas:?}");
        }
        assert_eq!(cut(&flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [0.0, 0.0]])), [[1, 2, 4]]);
    }

    /// A star-shaped polygon around the origin, its corners on a grid so fine that their middles are floats too.
    fn star(radii: &[f32]) -> Vec<[f32; 2]> {
        let corner = |(at, radius): (usize, &f32)| {
            let (sin, cos) = (std::f64::consts::TAU * at as f64 / radii.len() as f64).sin_cos();
            [cos, sin].map(|x| ((f64::from(*radius) * x * 4096.0).round() / 4096.0) as f32)
        };
        radii.iter().enumerate().map(corner).collect()
    }

    /// By the edges that a line to the right crosses.
    fn is_inside(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
        let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let crossed =
            edges.filter(|(a, b)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
        crossed.count() % 2 == 1
    }

    #[test]
    fn what_cannot_be_cut_well_is_cut_all_the_same() {
        let star: Vec<_> = (0..5).map(|i| (i as f32 * 2.0 * std::f32::consts::TAU / 5.0).sin_cos()).collect();
        let star = flat(&star.iter().map(|p| [p.0, p.1]).collect::<Vec<_>>());
        assert_eq!(cut(&star).len(), 3);
        assert_eq!(cut(&[[1.0; 3]; 6]).len(), 0);
        assert_eq!(cut(&[[f32::NAN; 3]; 6]).len(), 4);
        assert_eq!(cut(&flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])).len(), 2);
    }

    #[test]
    fn the_budget_ends() {
        let saw = |i: usize| [i as f32, if i.is_multiple_of(2) { 1.0 } else { 0.0 }];
        let comb: Vec<_> = (0..2000).map(saw).chain([[2000.0, 9.0], [0.0, 9.0]]).collect();
        let mut triangulator = Triangulator::new(1000);
        assert_eq!(triangulator.cut(&flat(&comb)).len(), 2000);
        assert_eq!(triangulator.unfinished, 1);
        let areas = areas(&flat(&comb), &cut(&flat(&comb)));
        assert!(areas.iter().all(|&area| area > 0.0));
    }

    proptest! {
        /// A star-shaped polygon around the origin, in any plane, seen from either side.
        #[test]
        fn simple_polygons_are_tiled(radii in prop::collection::vec(0.1_f32..1.0, 3..40), axis in 0_usize..3) {
            let count = radii.len();
            let corner = |(i, r): (usize, &f32)| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                [(f64::from(*r) * cos) as f32, (f64::from(*r) * sin) as f32]
            };
            let polygon = flat(&radii.iter().enumerate().map(corner).collect::<Vec<_>>());
            let mut turned = polygon.clone();
            turned.iter_mut().for_each(|p| p.rotate_right(axis));
            let triangles = cut(&turned);
            let areas = areas(&polygon, &triangles);
            let whole = area_vector(&polygon).unwrap()[2];
            prop_assert_eq!(triangles.len(), count - 2);
            prop_assert!(areas.iter().all(|&area| area >= 0.0), "{:?}", areas);
            prop_assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-6);
        }

        #[test]
        fn any_corners_at_all_are_cut(points in prop::collection::vec(prop::array::uniform3(any::<f32>()), 3..30)) {
            prop_assert_eq!(cut(&points).len(), points.len() - 2);
        }

        /// Corners that repeat and corners on edges change nothing: every point is covered once inside and never outside.
        #[test]
        fn odd_corners_do_not_change_a_polygon(
            radii in prop::collection::vec(0.1_f32..1.0, 3..20),
            odd in prop::collection::vec((any::<prop::sample::Index>(), prop::bool::ANY), 1..8),
            start in any::<prop::sample::Index>(),
            seen in prop::collection::vec((-1.0_f64..1.0, -1.0_f64..1.0), 40),
        ) {
            let mut points = star(&radii);
            for (at, repeat) in odd {
                let at = at.index(points.len());
                let (a, b) = (points[at], points[(at + 1) % points.len()]);
                // The middle of an edge of multiples of 1/4096 is exact.
                points.insert(at + 1, if repeat { a } else { [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0] });
            }
            let turn_by = start.index(points.len());
            points.rotate_left(turn_by);
            let polygon = flat(&points);
            let triangles = cut(&polygon);
            let areas = areas(&polygon, &triangles);
            let whole = area_vector(&polygon).map_or(0.0, |area| area[2]);
            prop_assert!((areas.iter().map(|area| area.abs()).sum::<f64>() - whole).abs() < 1e-9, "{:?}", areas);
            for (x, y) in seen {
                let corners = |t: &[u32; 3]| t.map(|corner| points[corner as usize].map(f64::from)).to_vec();
                let covered = triangles.iter().filter(|t| is_inside(&corners(t), [x, y])).count();
                let wide: Vec<_> = points.iter().map(|p| p.map(f64::from)).collect();
                prop_assert_eq!(covered, usize::from(is_inside(&wide, [x, y])));
            }
        }
    }
}
