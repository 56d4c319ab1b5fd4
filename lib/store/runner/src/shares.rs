//! Shares of a plan's scenes that take about as long as one another: what each of many tasks makes.

use std::collections::BTreeMap;

use crate::options::Shard;

/// The scenes of a share, ascending, out of the work of all (seconds of one core).
///
/// The longest scene goes to the share with the least work so far (of equals the first), then the next
/// longest: so no share has more than a third above the best cut. All that it depends on is the plan: every
/// stage cuts it alike, and a task that is tried again has the same scenes.
#[must_use]
pub fn scenes_of(work_s: &BTreeMap<u32, f64>, shard: Shard) -> Vec<u32> {
    let mut longest: Vec<(u32, f64)> = work_s.iter().map(|(scene, work_s)| (*scene, *work_s)).collect();
    longest.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut shares = vec![(0.0, Vec::new()); shard.count as usize];
    for (scene, work_s) in longest {
        // There is one: a share of none is no `Shard`.
        let least = shares.iter_mut().reduce(|least, share| if share.0 < least.0 { share } else { least });
        if let Some((sum_s, scenes)) = least {
            *sum_s += work_s;
            scenes.push(scene);
        }
    }
    let mut scenes = std::mem::take(&mut shares[shard.index as usize].1);
    scenes.sort_unstable();
    scenes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(work_s: &[f64], count: u32) -> Vec<Vec<u32>> {
        let work_s: BTreeMap<u32, f64> = (0..).zip(work_s.iter().copied()).collect();
        (0..count).map(|index| scenes_of(&work_s, Shard { index, count })).collect()
    }

    #[test]
    fn every_scene_is_in_one_share() {
        let work_s: Vec<f64> = (0..50_u32).map(|scene| f64::from(scene * 37 % 11)).collect();
        for count in [1, 2, 7, 49, 60] {
            let mut scenes = all(&work_s, count).concat();
            scenes.sort_unstable();
            assert_eq!(scenes, (0..50).collect::<Vec<u32>>(), "{count} shares");
        }
    }

    #[test]
    fn long_scenes_are_spread_and_equal_ones_dealt() {
        assert_eq!(all(&[9.0, 1.0, 1.0, 8.0, 1.0, 1.0], 2), [vec![0, 2, 5], vec![1, 3, 4]]);
        assert_eq!(all(&[3.0; 7], 3), [vec![0, 3, 6], vec![1, 4], vec![2, 5]]);
        assert_eq!(all(&[2.0], 3), [vec![0], vec![], vec![]]);
    }

    #[test]
    fn no_share_is_far_above_the_mean() {
        let work_s: Vec<f64> = (0..200_u32).map(|scene| 60.0 + f64::from(scene * 7919 % 240)).collect();
        let sums = all(&work_s, 16)
            .into_iter()
            .map(|scenes| scenes.into_iter().map(|scene| work_s[scene as usize]).sum::<f64>());
        let (mean_s, most_s) = (work_s.iter().sum::<f64>() / 16.0, sums.fold(0.0, f64::max));
        assert!(most_s < 1.05 * mean_s, "{most_s} beside {mean_s}");
    }
}
