//! Alias tables made from weights (Vose 1991), in double precision and in a fixed order: the same on every machine.

use raywarp_core::sampling::AliasEntry;

/// The table by which items are chosen in proportion to their weights, which are finite and not negative; evenly where all are
/// 0. `density` is the probability.
pub fn table(weights: &[f64]) -> Vec<AliasEntry> {
    let sum: f64 = weights.iter().sum();
    let count = weights.len() as f64;
    let probability = |weight: f64| if sum > 0.0 { weight / sum } else { 1.0 / count };
    let entry = |&weight: &f64| AliasEntry { share: 1.0, alias: 0, density: probability(weight) as f32 };
    let mut entries: Vec<AliasEntry> = weights.iter().map(entry).collect();
    // How full each column is.
    let mut filled: Vec<f64> = weights.iter().map(|&weight| probability(weight) * count).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..weights.len()).partition(|&item| filled[item] < 1.0);
    while let (Some(&above), Some(below)) = (large.last(), small.pop()) {
        entries[below] = AliasEntry { share: filled[below] as f32, alias: above as u32, ..entries[below] };
        filled[above] -= 1.0 - filled[below];
        if filled[above] < 1.0 {
            large.pop();
            small.push(above);
        }
    }
    // Rounding alone leaves columns that are not quite full; an item without weight must not be chosen even so.
    let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    for item in small {
        if weights[item] == 0.0 && sum > 0.0 {
            entries[item] = AliasEntry { share: 0.0, alias: heaviest.unwrap_or(item) as u32, ..entries[item] };
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Probability with which a table chooses each item.
    fn chosen(entries: &[AliasEntry]) -> Vec<f64> {
        let mut chosen = vec![0.0; entries.len()];
        for (item, entry) in entries.iter().enumerate() {
            chosen[item] += f64::from(entry.share) / entries.len() as f64;
            chosen[entry.alias as usize] += (1.0 - f64::from(entry.share)) / entries.len() as f64;
        }
        chosen
    }

    #[test]
    fn items_are_chosen_in_proportion_to_their_weights() {
        let many: Vec<f64> = (0..1000).map(|i| f64::from(i * i % 97)).collect();
        for weights in [vec![1.0], vec![1.0, 3.0], vec![0.0, 0.0, 5.0, 1e-9], vec![1e30, 1.0, 1e30], many] {
            let (entries, sum) = (table(&weights), weights.iter().sum::<f64>());
            for (item, chosen) in chosen(&entries).into_iter().enumerate() {
                let wanted = weights[item] / sum;
                assert!((chosen - wanted).abs() < 1e-6, "{item}: {chosen} {wanted}");
                assert!((f64::from(entries[item].density) - wanted).abs() < 1e-6);
                assert!(wanted > 0.0 || chosen == 0.0, "{item}");
            }
        }
    }

    #[test]
    fn without_any_weight_all_are_alike() {
        assert!(chosen(&table(&[0.0; 4])).iter().all(|&chosen| chosen == 0.25));
        assert!(table(&[]).is_empty());
    }
}
