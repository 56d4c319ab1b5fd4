//! Shares of a plan's scenes that take about as long as one another: what each of many tasks makes.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};

use crate::options::Shard;

/// The scenes of a share, ascending, out of the work of all (seconds of one core).
///
/// The longest scene goes to the share with the least work so far (of equals the first), then the next
/// longest: so no share has more than a third above the best cut. All that it depends on is the plan: every
/// stage cuts it alike, and a task that is tried again has the same scenes.
#[must_use]
pub fn scenes_of(work_s: &BTreeMap<u32, f64>, shard: Shard) -> Vec<u32> {
    let mut scenes = Vec::new();
    deal(work_s, shard.count, |share, scene| {
        if share.index == shard.index {
            scenes.push(scene);
        }
    });
    scenes.sort_unstable();
    scenes
}

/// The work of the largest of so many shares, in seconds of one core. More shares never make it larger.
#[must_use]
pub fn largest_of(work_s: &BTreeMap<u32, f64>, count: u32) -> f64 {
    let mut largest: f64 = 0.0;
    deal(work_s, count, |share, _| largest = largest.max(share.sum_s));
    largest
}

/// Deals all scenes to shares, and tells of each the share that got it, with its work so far.
fn deal(work_s: &BTreeMap<u32, f64>, count: u32, mut got: impl FnMut(Share, u32)) {
    let mut longest: Vec<(u32, f64)> = work_s.iter().map(|(scene, work_s)| (*scene, *work_s)).collect();
    longest.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut shares: BinaryHeap<Reverse<Share>> =
        (0..count).map(|index| Reverse(Share { sum_s: 0.0, index })).collect();
    for (scene, work_s) in longest {
        // There is one: a share of none is no `Shard`.
        if let Some(mut least) = shares.peek_mut() {
            least.0.sum_s += work_s;
            got(least.0, scene);
        }
    }
}

/// A share, ordered by its work so far and its number.
#[derive(Clone, Copy, Debug)]
struct Share {
    sum_s: f64,
    index: u32,
}

impl Ord for Share {
    fn cmp(&self, other: &Self) -> Ordering {
        self.sum_s.total_cmp(&other.sum_s).then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Share {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Share {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Share {}

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
    #[test]
    fn the_largest_share_shrinks_with_their_number() {
        let work_s: BTreeMap<u32, f64> =
            (0..90_u32).map(|scene| (scene, f64::from(scene * 37 % 23))).collect();
        let largest: Vec<f64> = (1..=95).map(|count| largest_of(&work_s, count)).collect();
        assert!(largest.is_sorted_by(|fewer, more| fewer >= more), "{largest:?}");
        for (count, largest_s) in (1_u32..).zip(&largest) {
            let sum =
                |index| scenes_of(&work_s, Shard { index, count }).iter().map(|s| work_s[s]).sum::<f64>();
            assert_eq!((0..count).map(sum).fold(0.0, f64::max), *largest_s, "{count} shares");
        }
        assert_eq!(largest.last(), Some(&22.0));
    }
}
