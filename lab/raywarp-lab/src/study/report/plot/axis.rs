//! How values become places along an axis, and where its marks are.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::super::format::tick;

/// Marks on an axis, about.
const MARKS: f64 = 6.0;
/// Decades that a logarithmic axis shows at most: far more than any measurement spans.
const DECADES: f64 = 24.0;

/// Edges that differ by no more than this share of theirs are one.
const ROUNDING: f64 = 1e-9;

/// An axis. Whatever it is made of, its range is finite and not empty.
#[derive(Clone, Debug)]
pub struct Axis {
    scale: Scale,
    marks: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Scale {
    Linear {
        from: f64,
        to: f64,
    },
    /// Powers of ten.
    Log {
        from: f64,
        to: f64,
    },
    /// Edges of columns, each as wide as the other.
    Edges(Vec<f64>),
}

impl Axis {
    /// From zero to the largest of these or a little more.
    pub fn linear(values: impl IntoIterator<Item = f64>) -> Self {
        let most = usable(values).fold(0.0, f64::max);
        let most = if most > 0.0 { most } else { 1.0 };
        let step = round_step(most / MARKS);
        let count = (most / step).ceil().max(1.0);
        Self::with_step(step, count)
    }

    /// From zero to a hundred.
    pub fn percents() -> Self {
        Self::with_step(10.0, 10.0)
    }

    /// A place a pixel, without marks.
    pub fn pixels(count: i32) -> Self {
        Self { scale: Scale::Linear { from: 0.0, to: f64::from(count.max(1)) }, marks: Vec::new() }
    }

    fn with_step(step: f64, count: f64) -> Self {
        let marks = (0..=count as usize).map(|mark| mark as f64 * step).collect();
        Self { scale: Scale::Linear { from: 0.0, to: count * step }, marks }
    }

    /// Logarithmic, over these and a little more at both ends. What is not above zero has no place there.
    pub fn log(values: impl IntoIterator<Item = f64>) -> Self {
        let logs: Vec<f64> = usable(values).filter(|&value| value > 1e-100).map(f64::log10).collect();
        let to = logs.iter().copied().reduce(f64::max).unwrap_or(1.0) + 0.05;
        let from = logs.iter().copied().reduce(f64::min).unwrap_or(0.0) - 0.15;
        let from = from.max(to - DECADES);
        Self { scale: Scale::Log { from, to }, marks: log_marks(from, to) }
    }

    /// Over the columns of a histogram, each as wide as the other in the plot, whatever its width in numbers is.
    pub fn edges(edges: Vec<f64>) -> Self {
        let mut edges: Vec<f64> = usable(edges).collect();
        edges.sort_by(f64::total_cmp);
        // The end of a column and the start of the next may differ by their rounding.
        edges.dedup_by(|next, edge| (*next - *edge).abs() <= ROUNDING * edge.abs().max(next.abs()));
        if edges.len() < 2 {
            edges = vec![0.0, 1.0];
        }
        let marks = edge_marks(&edges);
        Self { scale: Scale::Edges(edges), marks }
    }

    /// Where a value is: 0 at the near end, 1 at the far one. What is beyond an end is at it.
    pub fn place(&self, value: f64) -> f64 {
        let place = match &self.scale {
            Scale::Linear { from, to } => (value - from) / (to - from),
            Scale::Log { from, to } => (value.max(f64::MIN_POSITIVE).log10() - from) / (to - from),
            Scale::Edges(edges) => place_among(edges, value),
        };
        if place.is_nan() {
            0.0
        } else {
            place.clamp(0.0, 1.0)
        }
    }

    /// The value at its near end.
    pub fn near(&self) -> f64 {
        match &self.scale {
            Scale::Linear { from, .. } => *from,
            Scale::Log { from, .. } => 10f64.powf(*from),
            Scale::Edges(edges) => edges.first().copied().unwrap_or(0.0),
        }
    }

    /// The value at its far end.
    pub fn far(&self) -> f64 {
        match &self.scale {
            Scale::Linear { to, .. } => *to,
            Scale::Log { to, .. } => 10f64.powf(*to),
            Scale::Edges(edges) => edges.last().copied().unwrap_or(1.0),
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (near, far): (i32, i32)) -> i32 {
        near + (self.place(*value) * f64::from(far - near)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Lines of a finer mesh are not drawn.
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.marks.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.near()..self.far()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format(value: &f64) -> String {
        tick(*value)
    }
}

/// Numbers that arithmetic on them leaves finite.
fn usable(values: impl IntoIterator<Item = f64>) -> impl Iterator<Item = f64> {
    values.into_iter().filter(|value| value.abs() < 1e100)
}

/// The least of 1, 2 and 5 times a power of ten that is not below this.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|&step| step >= least);
    let step = step.unwrap_or(10.0 * power);
    // Below the least normal number there are no steps.
    if step.is_normal() {
        step
    } else {
        1.0
    }
}

/// Every so many powers of ten; where there are few, what is between as well.
fn log_marks(from: f64, to: f64) -> Vec<f64> {
    let digits: &[f64] = match to - from {
        ..1.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
        1.0..2.5 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let every = ((to - from) / MARKS).ceil().max(1.0);
    let decades = (0..).map(|step| (from / every).floor() * every + f64::from(step) * every);
    let decades = decades.take_while(|&decade| decade <= to);
    let marks = decades.flat_map(|decade| digits.iter().map(move |digit| digit * 10f64.powf(decade)));
    marks.filter(|mark| (from..=to).contains(&mark.log10())).collect()
}

/// Round numbers if the columns are equally wide, else edges.
fn edge_marks(edges: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (edges.first(), edges.last()) else {
        return Vec::new();
    };
    let widths = edges.windows(2).map(|pair| pair[1] - pair[0]);
    let (least, most) = widths.fold((f64::MAX, 0.0), |(least, most): (f64, f64), w| (least.min(w), most.max(w)));
    if most > 1.5 * least {
        let every = (edges.len() as f64 / MARKS).ceil().max(1.0) as usize;
        return edges.iter().copied().step_by(every).collect();
    }
    let step = round_step((last - first) / MARKS);
    let start = (first / step).ceil();
    (0..=MARKS as usize + 1).map(|mark| (start + mark as f64) * step).take_while(|&mark| mark <= last).collect()
}

fn place_among(edges: &[f64], value: f64) -> f64 {
    let columns = edges.len().saturating_sub(1).max(1) as f64;
    let after = edges.partition_point(|&edge| edge <= value);
    match (after.checked_sub(1).and_then(|before| edges.get(before)), edges.get(after)) {
        (None, _) => 0.0,
        (Some(_), None) => 1.0,
        (Some(before), Some(next)) => ((after - 1) as f64 + (value - before) / (next - before)) / columns,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_axis_has_round_marks_from_zero_to_the_largest_value() {
        let axis = Axis::linear([3.0, 23.0]);
        assert_eq!((axis.near(), axis.far()), (0.0, 25.0));
        assert_eq!(axis.marks, [0.0, 5.0, 10.0, 15.0, 20.0, 25.0]);
        assert_eq!([axis.place(0.0), axis.place(12.5), axis.place(99.0)], [0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_logarithmic_axis_holds_its_values_and_marks_powers_of_ten() {
        let axis = Axis::log([0.5, 20_000.0, 0.0, f64::NAN]);
        assert!(axis.near() < 0.5 && axis.far() > 20_000.0);
        assert_eq!(axis.marks.len(), 5, "{:?}", axis.marks);
        assert!(axis.place(0.5) > 0.0 && axis.place(20_000.0) < 1.0);
        assert_eq!(axis.place(0.0), 0.0);
    }

    #[test]
    fn columns_of_a_histogram_are_equally_wide() {
        let axis = Axis::edges(vec![1.0, 10.0, 100.0, 1000.0, 10_000.0]);
        assert_eq!([1.0, 10.0, 55.0, 10_000.0].map(|value| axis.place(value)), [0.0, 0.25, 0.375, 1.0]);
        let rounded = Axis::edges(vec![1.0, 1.3, 1.3 + f64::EPSILON, 1.69]);
        assert!((rounded.place(1.3) - 0.5).abs() < 1e-6);
        assert_eq!(Axis::edges(vec![0.0, 10.0, 20.0]).marks, [0.0, 5.0, 10.0, 15.0, 20.0]);
    }

    #[test]
    fn no_value_makes_an_axis_without_a_range() {
        for values in [vec![], vec![0.0], vec![f64::NAN, f64::INFINITY], vec![5e-324], vec![1e308, -1e308], vec![-3.0]]
        {
            for axis in [Axis::linear(values.clone()), Axis::log(values.clone()), Axis::edges(values.clone())] {
                assert!(axis.near() < axis.far(), "{values:?}: {axis:?}");
                assert!(axis.marks.len() < 40, "{values:?}: {axis:?}");
            }
        }
    }
}
