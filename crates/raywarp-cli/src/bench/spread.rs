//! Repeated measurements in three numbers.

use serde::Serialize;

/// Over the repeats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Of an even number of repeats, the mean of the middle two.
    pub median: f64,
    pub least: f64,
    pub most: f64,
}

impl Spread {
    /// Of at least one number; of none, zeros.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |index: usize| values.get(index).copied().unwrap_or(0.0);
        let (half, last) = (values.len() / 2, values.len().saturating_sub(1));
        Self { median: 0.5 * (at(half) + at(last.saturating_sub(half))), least: at(0), most: at(last) }
    }

    /// Each number through a function that falls as they rise, such as a rate of times.
    pub fn falling(self, function: impl Fn(f64) -> f64) -> Self {
        Self { median: function(self.median), least: function(self.most), most: function(self.least) }
    }
}

/// The least number that at least this share of them does not exceed; of none, 0.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_one_or_between_the_middle_two() {
        let spread = |values: &[f64]| Spread::of(values.to_vec());
        assert_eq!(spread(&[3.0, 1.0, 2.0]), Spread { median: 2.0, least: 1.0, most: 3.0 });
        assert_eq!(spread(&[4.0, 1.0, 2.0, 9.0]), Spread { median: 3.0, least: 1.0, most: 9.0 });
        assert_eq!(spread(&[]).median, 0.0);
    }

    #[test]
    fn a_quantile_is_one_of_the_numbers() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!([0.0, 0.5, 0.95, 1.0].map(|share| quantile(&values, share)), [1.0, 50.0, 95.0, 100.0]);
        assert_eq!((quantile(&[7.0], 0.95), quantile(&[], 0.95)), (7.0, 0.0));
    }

    #[test]
    fn the_shortest_time_is_the_highest_rate() {
        let rates = Spread::of(vec![1.0, 2.0, 4.0]).falling(|seconds| 8.0 / seconds);
        assert_eq!(rates, Spread { median: 4.0, least: 2.0, most: 8.0 });
    }
}
