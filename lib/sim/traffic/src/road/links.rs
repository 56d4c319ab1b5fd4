//! Which way leads to which, so that a vehicle that follows them never jumps.
//!
//! Files link lanes whose ends lie apart (a lane that ends beside the one it is said to go on as, for one).
//! There the way before is bent to meet the way after, as drivers do who change lanes.

use std::collections::BTreeMap;

use nalgebra::Point3;
use opendrive::{LaneId, Map};

use crate::road::centreline::Centreline;

/// Ends nearer than this make one line, metres.
const JOINT_M: f64 = 0.1;
/// A way is bent over this many metres for each metre that its end is moved: 2 s at 50 km/h for a lane's
/// width.
const BEND_M_PER_M: f64 = 8.0;
/// Where there are fewer metres of way than this for each metre, nobody can drive the bend.
const LEAST_BEND_M_PER_M: f64 = 2.5;
/// Most lanes without extent in a row that a link leads over.
const MAX_EMPTY: u8 = 3;

/// For each way the ways that it leads on to, in the order of the map's links; a link to a lane without
/// extent leads on to the lanes behind it.
pub(crate) fn links(map: &Map, ways: &[Centreline], index: &BTreeMap<LaneId, usize>) -> Vec<Vec<usize>> {
    let onward = |way: &Centreline| {
        let mut next = Vec::new();
        let mut open: Vec<(LaneId, u8)> = map.successors(way.lane).iter().rev().map(|l| (*l, 0)).collect();
        while let Some((id, depth)) = open.pop() {
            match index.get(&id) {
                Some(&j) if !next.contains(&j) => next.push(j),
                None if depth < MAX_EMPTY => {
                    open.extend(map.successors(id).iter().rev().map(|l| (*l, depth + 1)));
                }
                _ => {}
            }
        }
        next
    };
    ways.iter().map(onward).collect()
}

/// Bends ways whose ends lie apart from where they lead on. Of branches that begin apart from one another
/// those at the nearest beginning are kept; a way too short to be bent loses its links.
pub(crate) fn join_ends(ways: &mut [Centreline], next: &mut [Vec<usize>]) {
    for (i, onward) in next.iter_mut().enumerate() {
        let end = ways[i].end();
        let apart = |ways: &[Centreline], j: usize, from: Point3<f64>| (ways[j].start() - from).norm();
        let nearest =
            onward.iter().copied().min_by(|&a, &b| apart(ways, a, end).total_cmp(&apart(ways, b, end)));
        let Some(start) = nearest.map(|j| ways[j].start()) else { continue };
        onward.retain(|&j| apart(ways, j, start) <= JOINT_M);
        if onward.iter().all(|&j| apart(ways, j, end) <= JOINT_M) {
            continue;
        }
        let off_m = (start - end).norm();
        let span_m = (BEND_M_PER_M * off_m).min(ways[i].length_m);
        if span_m < LEAST_BEND_M_PER_M * off_m {
            onward.clear();
        } else {
            ways[i].bend_end(start, span_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ways of a map and their links, before and after joining.
    fn joined(map: &Map) -> (Vec<Centreline>, Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let drivable = map.lanes().iter().filter(|l| l.lane_type.is_drivable());
        let mut ways: Vec<Centreline> = drivable.filter_map(|l| Centreline::new(map, l)).collect();
        let index = ways.iter().enumerate().map(|(i, w)| (w.lane, i)).collect();
        let before = links(map, &ways, &index);
        let mut after = before.clone();
        join_ends(&mut ways, &mut after);
        (ways, before, after)
    }

    #[test]
    fn nobody_jumps_on_any_map() {
        let town = town::generate(&town::named("convoy/demo").expect("our town")).expect("a town");
        let read = |path: std::path::PathBuf| {
            let bytes = std::fs::read(&path).expect("a readable file");
            (path.display().to_string(), Map::new(opendrive::read_bytes(&bytes).expect("a readable map")))
        };
        let carla = |path: &std::path::PathBuf| path.parent().is_some_and(|folder| folder.ends_with("carla"));
        let mut maps: Vec<(String, Map)> = testkit::map_files().into_iter().filter(carla).map(read).collect();
        maps.push(("convoy/demo".into(), Map::new(town)));
        for (name, map) in &maps {
            let (ways, before, after) = joined(map);
            assert_eq!(before, after, "{name}: a link is lost");
            for (i, way) in ways.iter().enumerate() {
                for &j in &after[i] {
                    let jump = (ways[j].place(0.0).point - way.place(way.length_m).point).norm();
                    assert!(jump <= 0.1, "{name}: {:?} to {:?}: {jump} m", way.lane, ways[j].lane);
                }
                let steps = (way.length_m / 0.5).ceil() as usize;
                let at = |k: usize| way.place(way.length_m * k as f64 / steps as f64).point;
                for k in 0..steps {
                    let jump = (at(k + 1) - at(k)).norm() - way.length_m / steps as f64;
                    assert!(jump <= 0.1, "{name}: {:?} after {k} steps: {jump} m", way.lane);
                }
            }
        }
    }
}
