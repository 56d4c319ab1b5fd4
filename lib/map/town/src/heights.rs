//! How high a road runs: along the ground, smoothed to what its traffic can climb.

use crate::TownError;
use crate::layout::Edge;
use crate::path::Path;
use crate::profile::Profile;
use crate::terrain::Terrain;

/// Distance between the heights that are looked at, metres; long roads take more.
const STATION_M: f64 = 22.0;
/// Most stations of one road.
const MAX_STATIONS: f64 = 400.0;
/// Rounds of smoothing before a road counts as too steep.
const ROUNDS: usize = 4000;
/// Rounds after which the smoothing around a steep place reaches one station further.
const WIDEN_AFTER: usize = 100;

/// A road's height and slope (along s) at one of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EndHeight {
    pub(crate) z_m: f64,
    pub(crate) slope: f64,
    /// Height over the ground that the node wishes for, metres.
    pub(crate) lift_m: f64,
}

/// The elevation of an edge between two ends: the ground's height plus the anchors' lift, even where it is
/// asked to be, with everything smoothed that is steeper than its traffic can climb. Anchors keep their
/// height.
pub(crate) fn elevation(
    edge: &Edge,
    path: &Path,
    terrain: &Terrain,
    [start, end]: [EndHeight; 2],
) -> Result<Profile, TownError> {
    let (length, max_grade) = (path.length_m, edge.shape.max_grade);
    let mut fixed: Vec<(f64, f64)> =
        edge.anchors.iter().map(|a| (path.nearest_s(a.at_m), a.lift_m)).collect();
    fixed.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Anchors beside an end would fight with it.
    fixed.retain(|(s, _)| *s > 5.0 && *s < length - 5.0);
    let mut knots = vec![(0.0, start.lift_m)];
    knots.extend(fixed.iter().copied());
    knots.push((length, end.lift_m));
    let lift = Profile::steps(&knots);

    let mut stations: Vec<(f64, bool)> = Vec::new();
    for pair in knots.windows(2) {
        let (from, to) = (pair[0].0, pair[1].0);
        let step = STATION_M.max(length / MAX_STATIONS);
        let count = ((to - from) / step).floor().max(1.0) as usize;
        stations.extend((0..count).map(|i| (from + (to - from) * i as f64 / count as f64, i == 0)));
    }
    stations.push((length, true));
    let target = |s: f64| {
        let p = path.pose_at(s);
        terrain.bank(p.x_m, p.y_m) + lift.at(s)
    };
    let mut z: Vec<f64> = stations.iter().map(|(s, _)| target(*s)).collect();
    for ends in &edge.even {
        let [a, b] = ends.map(|at| path.nearest_s(at));
        let (from, to) = (a.min(b), a.max(b));
        for ((s, _), z) in stations.iter().zip(&mut z).filter(|((s, _), _)| *s >= from && *s <= to) {
            *z = target(from) + (target(to) - target(from)) * (s - from) / (to - from).max(1.0);
        }
    }
    let last = z.len() - 1;
    (z[0], z[last]) = (start.z_m, end.z_m);
    let mut steepest = f64::INFINITY;
    for round in 0..ROUNDS {
        // What is stuck between heights that need no smoothing themselves takes in more and more of them.
        let reach = 3 + round / WIDEN_AFTER;
        let nodes = with_slopes(&stations, &z, [start.slope, end.slope]);
        let too_steep = |pair: &[[f64; 3]]| {
            let length = pair[1][0] - pair[0][0];
            let piece = [[0.0, pair[0][1], pair[0][2]], [length, pair[1][1], pair[1][2]]];
            Profile::hermite(&piece).steepest(length) > max_grade
        };
        let steep: Vec<bool> = nodes.windows(2).map(too_steep).collect();
        if !steep.contains(&true) {
            return Ok(Profile::hermite(&nodes));
        }
        steepest = Profile::hermite(&nodes).steepest(length);
        let old = z.clone();
        for i in 1..last {
            let near = steep[i.saturating_sub(reach)..(i + reach).min(steep.len())].contains(&true);
            if near && !stations[i].1 {
                let (before, after) = (stations[i].0 - stations[i - 1].0, stations[i + 1].0 - stations[i].0);
                // The chord between the neighbours, wherever the stations lie; beside an end, whose slope is
                // given, a curve that leaves the end in that slope.
                let mut aim = old[i - 1] + before / (before + after) * (old[i + 1] - old[i - 1]);
                if i == 1 && last > 2 {
                    aim = old[0] + before * (start.slope + 2.0 * (old[2] - old[1]) / after) / 3.0;
                } else if i + 1 == last && last > 2 {
                    aim = old[last] - after * (end.slope + 2.0 * (old[i] - old[i - 1]) / before) / 3.0;
                }
                z[i] = 0.3 * old[i] + 0.7 * aim;
            }
        }
    }
    Err(TownError::TooSteep { street: edge.name.clone(), grade: steepest, limit: max_grade })
}

/// The stations with the slopes of a parabola through each and its neighbours.
fn with_slopes(stations: &[(f64, bool)], z: &[f64], ends: [f64; 2]) -> Vec<[f64; 3]> {
    let last = z.len() - 1;
    let chord = |i: usize| (z[i + 1] - z[i]) / (stations[i + 1].0 - stations[i].0);
    (0..=last)
        .map(|i| {
            let slope = if i == 0 {
                ends[0]
            } else if i == last {
                ends[1]
            } else {
                let (before, after) = (stations[i].0 - stations[i - 1].0, stations[i + 1].0 - stations[i].0);
                (chord(i - 1) * after + chord(i) * before) / (before + after)
            };
            [stations[i].0, z[i], slope]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Piece, Pose2};
    use crate::section::{CrossSection, Side};
    use crate::terrain::{Hill, Wave};

    fn straight(length_m: f64) -> Path {
        Path::chain(Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 }, &[Piece::Line(length_m)])
    }

    fn end(z_m: f64) -> EndHeight {
        EndHeight { z_m, slope: 0.0, lift_m: 0.0 }
    }

    fn road(max_grade: f64) -> Edge {
        let shape = CrossSection { max_grade, ..CrossSection::both_ways(Side::town(1, 3.5), 50.0) };
        Edge::new("a", 0, 1, shape)
    }

    #[test]
    fn gentle_ground_is_followed() {
        let terrain = Terrain {
            waves: vec![Wave { amplitude_m: 4.0, period_m: 500.0, heading_rad: 0.0, phase_rad: 0.0 }],
            ..Terrain::flat()
        };
        let heights =
            elevation(&road(0.08), &straight(500.0), &terrain, [end(0.0), end(0.0)]).expect("gentle");
        for i in 2..=18 {
            let s = 25.0 * f64::from(i);
            assert!((heights.at(s) - terrain.bank(s, 0.0)).abs() < 0.15, "{s}");
        }
        assert!(heights.steepest(500.0) <= 0.08);
    }

    #[test]
    fn steep_ground_is_smoothed_and_walls_are_refused() {
        let terrain = Terrain {
            hills: vec![Hill { at_m: [200.0, 0.0], height_m: 30.0, radius_m: 40.0 }],
            ..Terrain::flat()
        };
        let (over, path) = (road(0.06), straight(400.0));
        let heights = elevation(&over, &path, &terrain, [end(0.0), end(0.0)]).expect("smoothed");
        assert!(heights.steepest(400.0) <= 0.06 && heights.at(200.0) > 2.0);
        let refused = elevation(&over, &straight(100.0), &terrain, [end(0.0), end(30.0)]);
        assert!(matches!(refused, Err(TownError::TooSteep { .. })));
        // A tunnel goes straight through.
        let through = road(0.06).evenly([60.0, 0.0], [340.0, 0.0]);
        let heights = elevation(&through, &path, &terrain, [end(0.0), end(0.0)]).expect("even");
        assert!(heights.at(200.0).abs() < 0.5);
    }

    #[test]
    fn anchors_hold_a_deck_up() {
        let deck = road(0.06).lifted([200.0, 0.0], 7.0);
        let heights =
            elevation(&deck, &straight(400.0), &Terrain::flat(), [end(0.0), end(0.0)]).expect("fits");
        assert!((heights.at(200.0) - 7.0).abs() < 1e-9 && heights.steepest(400.0) <= 0.06);
    }
}
