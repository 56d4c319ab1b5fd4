//! Groups: two or three people who walk together.
//!
//! The first of a group goes where it likes; the others take over its route and their place beside it.

use random::Stream;

/// A group of two is as much more likely than one of three.
const TWO_OF_THREE: f64 = 2.0 / 3.0;
/// Mean size of a group.
const MEAN_SIZE: f64 = 2.0 * TWO_OF_THREE + 3.0 * (1.0 - TWO_OF_THREE);
/// Where across the way each likes to walk, in its direction: -1 is the right edge.
const ABREAST: [&[f64]; 2] = [&[-0.85, 0.15], &[-1.0, 0.0, 1.0]];
/// The group that a walker belongs to.
#[derive(Clone, Debug, Default)]
pub(crate) struct WalkingGroup {
    /// Index of the first of the group.
    pub(crate) first: usize,
    /// The others, without oneself.
    pub(crate) others: Vec<usize>,
}

/// The sizes of the groups that walkers set out in, one after another, so that this share of all walks with
/// others; 1 is somebody who walks alone.
pub(crate) fn draw_sizes(count: usize, share: f64, stream: &dyn Fn(u64) -> Stream) -> Vec<usize> {
    // Of g groups a walker alone: q m / (q m + 1 - q) walk with others.
    let begins = share / (MEAN_SIZE - share * (MEAN_SIZE - 1.0));
    let mut sizes = Vec::new();
    let mut placed = 0;
    while placed < count {
        let mut draw = stream(placed as u64);
        let size = match (draw.chance(begins), draw.chance(TWO_OF_THREE)) {
            (false, _) => 1,
            (true, true) => 2,
            (true, false) => 3,
        };
        sizes.push(size.min(count - placed));
        placed += size;
    }
    sizes
}

/// Where across the way one of a group likes to walk.
pub(crate) fn abreast(size: usize, rank: usize) -> Option<f64> {
    ABREAST.get(size.checked_sub(2)?)?.get(rank).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wished_share_walks_in_groups() {
        for (share, seed) in [(0.0, 1), (0.3, 2), (0.7, 3), (1.0, 4)] {
            let count = 30_000;
            let sizes = draw_sizes(count, share, &|i| Stream::new(seed, 0, "test/group", i));
            assert_eq!(sizes.iter().sum::<usize>(), count);
            let together: usize = sizes.iter().filter(|s| **s > 1).sum();
            // Four standard deviations, and groups of three count thrice.
            let found = together as f64 / count as f64;
            assert!((found - share).abs() < 0.02, "{found} instead of {share}");
            let twos = sizes.iter().filter(|s| **s == 2).count() as f64;
            let threes = sizes.iter().filter(|s| **s == 3).count() as f64;
            assert!(share == 0.0 || (twos / threes - 2.0).abs() < 0.15, "{twos} {threes}");
        }
    }
}
