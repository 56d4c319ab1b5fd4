//! How groups keep together: members ahead of the others slow down, and members behind hurry,
//! until they walk abreast again, as far as the way has room for that.

use nalgebra::Vector2;

use crate::walking::walker::Walker;

/// Members farther apart than this have lost one another, metres.
const LOST_M: f64 = 15.0;
/// Share of its speed by which one is faster for each metre that it is behind the others, and bounds of that.
const HURRIES: f64 = 0.25;
const PACES: [f64; 2] = [0.6, 1.3];

/// How fast somebody walks whose others are so far ahead along its way on average, as a share of its speed.
fn pace(behind_m: f64) -> f64 {
    (1.0 + HURRIES * behind_m).clamp(PACES[0], PACES[1])
}

/// Lets all who walk in groups look for their others, before a step.
pub(crate) fn keep_together(walkers: &mut [Walker]) {
    for me in 0..walkers.len() {
        let Some(company) = walkers[me].company() else { continue };
        let own = walkers[me].position();
        let near = |other: &usize| {
            let there = walkers.get(*other)?;
            let away: Vector2<f64> = (there.position() - own).xy();
            let walks = !there.is_struck() && !there.is_asleep() && away.norm() < LOST_M;
            walks.then_some(away)
        };
        let others: Vec<Vector2<f64>> = company.others.iter().filter_map(near).collect();
        let mean = others.iter().sum::<Vector2<f64>>() / others.len().max(1) as f64;
        let (sin, cos) = frames::math::sin_cos(walkers[me].yaw_rad());
        let pace = if others.is_empty() { 1.0 } else { pace(mean.x * cos + mean.y * sin) };
        let first = company.first;
        let follows = first != me && near(&first).is_some();
        let joins = follows && walkers[me].may_join(&walkers[first]);
        let trip = joins.then(|| walkers[first].trip()).flatten();
        walkers[me].keep_up(pace, follows, trip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_behind_hurries() {
        assert_eq!([pace(0.0), pace(1.0), pace(-1.0), pace(9.0), pace(-9.0)], [1.0, 1.25, 0.75, 1.3, 0.6]);
    }
}
