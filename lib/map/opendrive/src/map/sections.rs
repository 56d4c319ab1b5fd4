//! Lane sections that the file leaves implicit: one-sided ones get their other side, and roads that go on
//! through a virtual junction get a section boundary where others join.

use std::collections::BTreeMap;

use crate::model::{Lane, LaneSection, Network, Road, RoadLink};

/// Places nearer to a section's boundary than this are at it, metres.
const AT_BOUNDARY_M: f64 = 1e-3;

/// Makes implicit lane sections explicit. Nearly all networks stay as they are.
pub(super) fn settle(network: &mut Network) {
    for road in &mut network.roads {
        if road.sections.iter().any(|s| s.single_side) {
            fill_single_sides(road);
        }
    }
    let mut cuts: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for main in network.junctions.iter().filter_map(|j| j.main_road.as_ref()) {
        cuts.entry(&main.road).or_default().extend([main.s_start, main.s_end]);
    }
    for link in network.roads.iter().flat_map(|r| [&r.predecessor, &r.successor]).flatten() {
        if let RoadLink::Along { id, s, .. } = link {
            cuts.entry(id).or_default().push(*s);
        }
    }
    // The first road with an id is the one that is meant.
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    for (i, road) in network.roads.iter().enumerate() {
        index.entry(&road.id).or_insert(i);
    }
    let cuts: Vec<(usize, Vec<f64>)> =
        cuts.into_iter().filter_map(|(id, places)| Some((*index.get(id)?, places))).collect();
    for (road, mut places) in cuts {
        places.sort_by(f64::total_cmp);
        for s in places {
            split(&mut network.roads[road], s);
        }
    }
}

/// The section that begins at a place of a road, and the one that ends there.
pub(super) fn sections_at(road: &Road, s: f64) -> [Option<usize>; 2] {
    let next = road.sections.partition_point(|section| section.s < s - AT_BOUNDARY_M);
    let begins = road.sections.get(next).filter(|section| section.s <= s + AT_BOUNDARY_M).map(|_| next);
    let ends = match begins {
        Some(next) => next.checked_sub(1),
        None if s >= road.length_m - AT_BOUNDARY_M => next.checked_sub(1),
        None => None,
    };
    [begins, ends]
}

/// Gives each one-sided section the lanes of the other side, which go on from the section before.
fn fill_single_sides(road: &mut Road) {
    for i in 1..road.sections.len() {
        let (before, rest) = road.sections.split_at_mut(i);
        let (Some(before), Some(section)) = (before.last_mut(), rest.first_mut()) else { continue };
        let by = section.s - before.s;
        if !section.single_side || by < 0.0 {
            continue;
        }
        if section.left.is_empty() {
            section.left = cut_lanes(&mut before.left, by);
        } else if section.right.is_empty() {
            section.right = cut_lanes(&mut before.right, by);
        }
    }
}

/// Cuts the section that a place lies in.
fn split(road: &mut Road, s: f64) {
    let after = road.sections.partition_point(|section| section.s <= s);
    let Some(index) = after.checked_sub(1) else { return };
    let end = road.sections.get(after).map_or(road.length_m, |next| next.s);
    let by = s - road.sections[index].s;
    if by < AT_BOUNDARY_M || end - s < AT_BOUNDARY_M || road.sections.len() >= usize::from(u16::MAX) {
        return;
    }
    let old = &mut road.sections[index];
    let section = LaneSection {
        s,
        single_side: old.single_side,
        left: cut_lanes(&mut old.left, by),
        centre: cut_lane(&mut old.centre, by),
        right: cut_lanes(&mut old.right, by),
    };
    road.sections.insert(after, section);
}

/// The parts of lanes that lie more than `by` metres after their section's start, as lanes of a section that
/// begins there; the lanes keep the parts before, and lead to them.
fn cut_lanes(lanes: &mut [Lane], by: f64) -> Vec<Lane> {
    lanes.iter_mut().map(|lane| cut_lane(lane, by)).collect()
}

fn cut_lane(lane: &mut Lane, by: f64) -> Lane {
    Lane {
        predecessors: vec![lane.id],
        successors: std::mem::replace(&mut lane.successors, vec![lane.id]),
        widths: cut(&mut lane.widths, by, |r| &mut r.s),
        borders: cut(&mut lane.borders, by, |r| &mut r.s),
        marks: cut(&mut lane.marks, by, |r| &mut r.s_offset),
        speeds: cut(&mut lane.speeds, by, |r| &mut r.s_offset),
        heights: cut(&mut lane.heights, by, |r| &mut r.s_offset),
        materials: cut(&mut lane.materials, by, |r| &mut r.s_offset),
        accesses: cut(&mut lane.accesses, by, |r| &mut r.s_offset),
        rules: cut(&mut lane.rules, by, |r| &mut r.s_offset),
        kept: lane.kept.clone(),
        ..*lane
    }
}

/// Cuts a list of records in two at an offset: the later part begins with those that still hold there, and
/// counts its offsets from there (those of its first records may be negative).
fn cut<T: Clone>(records: &mut Vec<T>, by: f64, s_of: fn(&mut T) -> &mut f64) -> Vec<T> {
    let offsets: Vec<f64> = records.iter_mut().map(|r| *s_of(r)).collect();
    let after = offsets.partition_point(|s| *s <= by);
    let holding = after.checked_sub(1).map_or(0, |last| offsets.partition_point(|s| *s < offsets[last]));
    let mut rest = records[holding..].to_vec();
    rest.iter_mut().for_each(|r| *s_of(r) -= by);
    // A first record that begins late also holds before it.
    records.truncate(after.max(1));
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Cubic, LaneAccess};

    #[test]
    fn records_are_cut_where_they_hold() {
        let at = |s: f64| Cubic { s, a: s, ..Cubic::default() };
        let mut records = vec![at(0.0), at(5.0), at(10.0)];
        let rest = cut(&mut records, 7.0, |r| &mut r.s);
        assert_eq!(records, [at(0.0), at(5.0)]);
        let starts: Vec<(f64, f64)> = rest.iter().map(|r| (r.s, r.a)).collect();
        assert_eq!(starts, [(-2.0, 5.0), (3.0, 10.0)]);
        // Records of one offset hold together.
        let access = |s_offset| LaneAccess { s_offset, ..LaneAccess::default() };
        let mut records = vec![access(0.0), access(1.0), access(1.0), access(9.0)];
        assert_eq!(cut(&mut records, 4.0, |r| &mut r.s_offset).len(), 3);
        assert_eq!(records.len(), 3);
        let mut late = vec![at(8.0)];
        assert_eq!(cut(&mut late, 4.0, |r| &mut r.s), [Cubic { s: 4.0, ..at(8.0) }]);
        assert_eq!(late, [at(8.0)]);
    }
}
