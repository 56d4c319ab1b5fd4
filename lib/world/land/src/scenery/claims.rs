//! Which of several candidates for one place is kept.
//!
//! All candidates of a kind are looked at at once. Each has a rank of its own, drawn from what it is; it
//! stands if no candidate of a higher rank is in its way, whether that one stands or not. So whether
//! something stands depends on what is beside it and no farther, and no order of making things matters.

use std::collections::BTreeMap;

use frames::OrientedRect;
use random::Stream;

use crate::scenery::land::{Land, cells};

/// What decides between candidates: a drawn number; then, where two are equal, whose and which it is.
pub(crate) type Rank = (u32, u64, u64);

/// The rank of the `slot`-th candidate of some entity.
pub(crate) fn rank(seed: u64, topic: &str, entity: u64, slot: u64) -> Rank {
    (Stream::new(seed, slot, topic, entity).next_u32(), entity, slot)
}

/// Something that would stand somewhere.
#[derive(Debug)]
pub(crate) struct Candidate<T> {
    /// The ground that it takes.
    pub(crate) takes: OrientedRect,
    /// The ground that nobody else may take.
    pub(crate) needs: OrientedRect,
    pub(crate) rank: Rank,
    /// What it is.
    pub(crate) what: T,
}

/// Those candidates that stand, in their order. `land` has their ground taken from then on.
pub(crate) fn settle<T>(candidates: Vec<Candidate<T>>, land: &mut Land<'_>) -> Vec<Candidate<T>> {
    let mut takers: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
    for (i, candidate) in candidates.iter().enumerate() {
        for cell in cells(&candidate.takes) {
            takers.entry(cell).or_default().push(i);
        }
    }
    let mut stands = vec![true; candidates.len()];
    for (i, one) in candidates.iter().enumerate() {
        for j in cells(&one.needs).filter_map(|cell| takers.get(&cell)).flatten().copied() {
            let other = &candidates[j];
            if i != j && one.needs.meets(&other.takes) {
                stands[if one.rank < other.rank { i } else { j }] = false;
            }
        }
    }
    let kept: Vec<Candidate<T>> =
        candidates.into_iter().zip(stands).filter_map(|(c, stands)| stands.then_some(c)).collect();
    kept.iter().for_each(|candidate| land.take(candidate.takes));
    kept
}

#[cfg(test)]
mod tests {
    use crate::surfaces::{Atlas, Region};

    use super::*;

    #[test]
    fn the_highest_of_neighbours_stands_and_not_the_next_best() {
        let map = testkit::straight(100.0);
        let atlas = Atlas::new(&map);
        let ground = atlas.ground(&Region { min: [0.0, 0.0], max: [64.0, 64.0] });
        let mut land = Land::new(&ground.levels, false);
        // Squares of 2 m on a line. 3 beats 2 and 2 beats 1; 5 needs more room than it takes.
        let row: [(f64, u32, f64); 6] =
            [(0.0, 1, 1.0), (1.5, 2, 1.0), (3.0, 3, 1.0), (20.0, 5, 2.0), (22.5, 4, 1.0), (60.0, 0, 1.0)];
        let candidates = row.map(|(x, rank, needs)| Candidate {
            takes: OrientedRect::square([x, 30.0], 1.0),
            needs: OrientedRect::square([x, 30.0], needs),
            rank: (rank, 0, 0),
            what: rank,
        });
        let kept = settle(candidates.into(), &mut land);
        assert_eq!(kept.iter().map(|c| c.what).collect::<Vec<_>>(), [3, 5, 0]);
        let free = |x: f64| land.unused(&OrientedRect::square([x, 30.0], 0.1));
        assert_eq!([0.0, 3.0, 20.0, 21.5, 60.0].map(free), [true, false, false, true, false]);
    }
}
