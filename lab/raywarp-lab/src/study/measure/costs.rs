//! Tests a ray, exactly counted: on the CPU, where they are the same.

use raywarp_lab::structures::StructureKind;

use super::scene::Stage;
use super::structures::Entrant;
use crate::study::findings::{Bin, Distribution, TestCost};
use raywarp_cli::bench::quantile;

/// Columns of a histogram.
const COLUMNS: usize = 40;

/// What rays cost in each structure. Where two cost the same, or nearly, one is left out.
pub fn tests(stage: &Stage, entrants: &[Entrant]) -> Vec<TestCost> {
    stage.say("counting tests");
    let told = |entrant: &&Entrant| {
        !matches!(
            entrant.build.kind,
            StructureKind::Staged
                | StructureKind::Bvh2c
                | StructureKind::BVH
                | StructureKind::Bvh8
                | StructureKind::Bvh8w
        )
    };
    let mut rows = Vec::new();
    for entrant in entrants.iter().filter(told) {
        for workload in stage.workloads.iter().filter(|workload| !workload.rays.is_empty()) {
            let most = match entrant.build.kind {
                StructureKind::BRUTE => (400_000_000 / stage.triangles.len()).min(stage.setting.counted / 100).max(1),
                _ => stage.setting.counted,
            };
            let each = entrant.tree.tests(&workload.rays, workload.kind.any_hit(), most);
            let triangles = Distribution::of(each.iter().map(|tests| f64::from(tests.triangles)).collect());
            let stats = entrant.tree.stats();
            rows.push(TestCost {
                structure: entrant.name.to_owned(),
                rays: workload.kind.to_string(),
                counted: each.len(),
                nodes: Distribution::of(each.iter().map(|tests| f64::from(tests.nodes)).collect()),
                share_of_references: triangles.mean / stats.references.max(1) as f64,
                share_of_triangles: triangles.mean / stage.triangles.len() as f64,
                triangles,
            });
        }
    }
    rows
}

impl Distribution {
    /// Of numbers; of none, zeros.
    pub fn of(values: Vec<f64>) -> Self {
        let most = values.iter().copied().fold(0.0, f64::max);
        let p95 = quantile(&values, 0.95);
        Self {
            mean: values.iter().sum::<f64>() / values.len().max(1) as f64,
            median: quantile(&values, 0.5),
            p95,
            most,
            histogram: histogram(&values, most, 2.0 * p95),
        }
    }
}

/// Columns of the same width, whole numbers wide, from 0 to about `usual`, the last one to beyond the most: a few values far
/// out would leave the rest in one column.
fn histogram(values: &[f64], most: f64, usual: f64) -> Vec<Bin> {
    let width = ((most.min(usual) + 1.0) / COLUMNS as f64).ceil().max(1.0);
    let columns = ((most / width) as usize + 1).min(COLUMNS + 1);
    let mut counts = vec![0usize; columns];
    for value in values {
        let column = ((value / width) as usize).min(columns - 1);
        counts[column] += 1;
    }
    let bin = |(column, count): (usize, &usize)| Bin {
        from: column as f64 * width,
        to: if column + 1 < columns {
            (column + 1) as f64 * width
        } else {
            (most + 1.0).max((column + 1) as f64 * width)
        },
        share: *count as f64 / values.len().max(1) as f64,
    };
    if values.is_empty() {
        return Vec::new();
    }
    counts.iter().enumerate().map(bin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_holds_everything_once() {
        let distribution = Distribution::of((0..=100).map(f64::from).collect());
        assert_eq!((distribution.mean, distribution.median, distribution.most), (50.0, 50.0, 100.0));
        let bins = &distribution.histogram;
        assert!((bins.iter().map(|bin| bin.share).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(bins.windows(2).all(|pair| pair[0].to == pair[1].from));
        assert_eq!((bins[0].from, bins[0].to), (0.0, 3.0));
        assert!((bins[0].share - 3.0 / 101.0).abs() < 1e-12);
        assert!(bins.last().unwrap().to > 100.0);
        let mut values = vec![1.0; 99];
        values.push(1e6);
        let bins = Distribution::of(values).histogram;
        assert!(bins.len() > 2 && bins[1].share == 0.99 && bins.last().unwrap().to > 1e6, "one far out");
        assert_eq!(Distribution::of(vec![0.0; 5]).histogram.len(), 1);
        assert!(Distribution::of(Vec::new()).histogram.is_empty());
    }
}
