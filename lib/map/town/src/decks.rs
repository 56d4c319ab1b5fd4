//! Roads that leave the ground: bridges, tunnels, and the clearance where one runs over another.

use std::collections::{BTreeMap, BTreeSet};

use opendrive::{Bridge, Cubic, Network, Road, RoadLink, Tunnel, TunnelType};

use crate::TownError;
use crate::ids::Ids;
use crate::path::Path;
use crate::profile::Profile;
use crate::terrain::Terrain;

/// Least height between two roads over one another, metres.
pub(crate) const CLEARANCE_M: f64 = 5.0;
/// Distance between the places that are looked at, metres.
const STEP_M: f64 = 4.0;
/// A road this far over the ground is a bridge, which reaches to where it is nearer than the second figure,
/// metres.
const BRIDGE_M: [f64; 2] = [3.0, 1.0];
/// A road this far under the ground is a tunnel, which reaches to where it is nearer than the second figure,
/// metres.
const TUNNEL_M: [f64; 2] = [7.5, 6.0];
/// Bridges and tunnels this near to one another are one, metres.
const JOIN_M: f64 = 12.0;
/// A deck reaches this far beyond the road under it, metres.
const ABUTMENT_M: f64 = 2.0;
/// Cells in which roads are sought that might cross, metres.
const CELL_M: f64 = 40.0;

/// A road with what is asked about it.
struct Line {
    points: Vec<[f64; 4]>,
    /// From the reference line to the farther edge, metres.
    reach_m: f64,
}

/// Writes bridges and tunnels.
///
/// # Errors
/// [`TownError::Clearance`] where two roads cross that neither meet nor clear one another.
pub(crate) fn decks(ids: &mut Ids, network: &mut Network, terrain: &Terrain) -> Result<(), TownError> {
    let lines: Vec<Line> = network.roads.iter().map(line).collect();
    let mut bridges: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut tunnels: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut underpasses: Vec<Vec<[f64; 2]>> = lines.iter().map(|_| Vec::new()).collect();
    for line in &lines {
        let over = |p: &[f64; 4]| p[3] - terrain.ground(p[1], p[2]);
        bridges.push(stretches(&line.points, over, BRIDGE_M));
        tunnels.push(stretches(&line.points, |p| -over(p), TUNNEL_M));
    }
    for ((i, sa), (j, sb), sine) in crossings(&lines) {
        if meet(&network.roads[i], &network.roads[j]) {
            continue;
        }
        let z = |road: usize, s: f64| Profile::of(&network.roads[road].elevation).at(s);
        let gap_m = z(i, sa) - z(j, sb);
        let ((upper, su), (lower, sl)) = if gap_m > 0.0 { ((i, sa), (j, sb)) } else { ((j, sb), (i, sa)) };
        if gap_m.abs() < CLEARANCE_M {
            return Err(TownError::Clearance {
                over: network.roads[upper].name.clone(),
                under: network.roads[lower].name.clone(),
                gap_m: gap_m.abs(),
            });
        }
        let half = |of: usize, more: f64| lines[of].reach_m / sine.max(0.3) + more;
        bridges[upper].push([su - half(lower, ABUTMENT_M), su + half(lower, ABUTMENT_M)]);
        let path = Path::of(&network.roads[lower]).pose_at(sl);
        if terrain.bank(path.x_m, path.y_m) - z(lower, sl) > 0.5 * CLEARANCE_M {
            underpasses[lower].push([sl - half(upper, 0.0), sl + half(upper, 0.0)]);
        }
    }
    for (i, road) in network.roads.iter_mut().enumerate() {
        let length = road.length_m;
        for [s, end] in joined(&bridges[i], length) {
            let (id, name) = (ids.next(), format!("{} bridge", road.name).trim().to_owned());
            let kind = "concrete".into();
            road.bridges.push(Bridge { id, name, kind, s, length_m: end - s, ..Bridge::default() });
        }
        let tubes = joined(&tunnels[i], length);
        // What a tunnel holds already needs no underpass.
        let apart = |u: &[f64; 2]| tubes.iter().all(|t| u[1] < t[0] || u[0] > t[1]);
        let short: Vec<[f64; 2]> = underpasses[i].iter().filter(|u| apart(u)).copied().collect();
        let kinds = [(TunnelType::Standard, tubes), (TunnelType::Underpass, joined(&short, length))];
        for (kind, [s, end]) in kinds.into_iter().flat_map(|(k, list)| list.into_iter().map(move |x| (k, x)))
        {
            let under = kind == TunnelType::Underpass;
            road.tunnels.push(Tunnel {
                id: ids.next(),
                name: format!("{} {}", road.name, kind.xml()).trim().to_owned(),
                kind,
                s,
                length_m: end - s,
                lighting: Some(if under { 0.3 } else { 0.8 }),
                daylight: Some(if under { 0.6 } else { 0.0 }),
                ..Tunnel::default()
            });
        }
    }
    Ok(())
}

/// Points `[s, x, y, z]` of a road.
fn line(road: &Road) -> Line {
    let (path, heights) = (Path::of(road), Profile::of(&road.elevation));
    let count = (road.length_m / STEP_M).ceil().max(1.0) as usize;
    let at = |i: usize| {
        let s = road.length_m * i as f64 / count as f64;
        let p = path.pose_at(s);
        [s, p.x_m, p.y_m, heights.at(s)]
    };
    Line { points: (0..=count).map(at).collect(), reach_m: reach_m(road) }
}

/// From a road's reference line to its farther edge, metres, by the widths at the beginning and end of each
/// section.
pub(crate) fn reach_m(road: &Road) -> f64 {
    let mut most = 0.0f64;
    for (i, section) in road.sections.iter().enumerate() {
        let length = road.sections.get(i + 1).map_or(road.length_m, |n| n.s) - section.s;
        let width = |widths: &[Cubic], s: f64| Profile::of(widths).at(s);
        for lanes in [&section.left, &section.right] {
            for s in [0.0, 0.5 * length, length] {
                most = most.max(lanes.iter().map(|l| width(&l.widths, s)).sum());
            }
        }
    }
    let shift = road.lane_offset.iter().map(|c| c.a.abs()).fold(0.0, f64::max);
    most + shift
}

/// Where a height exceeds the first limit, reaching to where it falls below the second.
fn stretches(points: &[[f64; 4]], height: impl Fn(&[f64; 4]) -> f64, [high, low]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    let mut open: Option<(f64, bool)> = None;
    for p in points {
        let h = height(p);
        open = match open {
            None if h > low => Some((p[0], h > high)),
            Some((from, tall)) if h > low => Some((from, tall || h > high)),
            Some((from, true)) => {
                found.push([from, p[0]]);
                None
            }
            _ => None,
        };
    }
    if let (Some((from, true)), Some(last)) = (open, points.last()) {
        found.push([from, last[0]]);
    }
    found
}

/// The stretches in order, clipped to the road, with near ones joined.
fn joined(stretches: &[[f64; 2]], length_m: f64) -> Vec<[f64; 2]> {
    let mut stretches = stretches.to_vec();
    stretches.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    for [from, to] in stretches {
        let (from, to) = (from.max(0.0), to.min(length_m));
        match out.last_mut() {
            Some(last) if from - last[1] < JOIN_M => last[1] = last[1].max(to),
            _ if to > from => out.push([from, to]),
            _ => {}
        }
    }
    out
}

/// Whether two roads touch, or belong to one junction.
fn meet(a: &Road, b: &Road) -> bool {
    let junctions = |road: &Road| -> Vec<String> {
        let links = [&road.predecessor, &road.successor].into_iter().flatten();
        let linked = links.filter_map(|l| match l {
            RoadLink::Junction { id } => Some(id.clone()),
            RoadLink::Road { .. } | RoadLink::Along { .. } => None,
        });
        linked.chain(road.junction.clone()).collect()
    };
    let linked = |a: &Road, b: &Road| {
        [&a.predecessor, &a.successor]
            .into_iter()
            .flatten()
            .any(|l| matches!(l, RoadLink::Road { id, .. } if *id == b.id))
    };
    let of_b = junctions(b);
    // Two streets may meet at one junction and cross elsewhere; parts of the junction itself do not count.
    let shared = junctions(a).into_iter().any(|j| of_b.contains(&j));
    linked(a, b) || linked(b, a) || (shared && (a.junction.is_some() || b.junction.is_some()))
}

/// Road and s on two roads, and the sine of the angle between them.
type Crossing = ((usize, f64), (usize, f64), f64);

/// Where reference lines of different roads cross in plan.
fn crossings(lines: &[Line]) -> Vec<Crossing> {
    let mut cells: BTreeMap<(i64, i64), Vec<(usize, usize)>> = BTreeMap::new();
    let cell = |v: f64| (v / CELL_M).floor() as i64;
    for (i, line) in lines.iter().enumerate() {
        for (k, pair) in line.points.windows(2).enumerate() {
            let keys: BTreeSet<(i64, i64)> = pair.iter().map(|p| (cell(p[1]), cell(p[2]))).collect();
            for key in keys {
                cells.entry(key).or_default().push((i, k));
            }
        }
    }
    let mut seen: BTreeSet<(usize, usize, usize, usize)> = BTreeSet::new();
    let mut found = Vec::new();
    for members in cells.values() {
        for (n, (i, k)) in members.iter().enumerate() {
            for (j, l) in &members[n + 1..] {
                if i == j || !seen.insert((*i, *k, *j, *l)) {
                    continue;
                }
                let (a, b) = (&lines[*i].points[*k..*k + 2], &lines[*j].points[*l..*l + 2]);
                if let Some((u, v, sine)) = cross(a, b) {
                    let s = |p: &[[f64; 4]], u: f64| p[0][0] + u * (p[1][0] - p[0][0]);
                    found.push(((*i, s(a, u)), (*j, s(b, v)), sine));
                }
            }
        }
    }
    found
}

/// Where two segments cross, as shares of each, and the sine of their angle.
fn cross(a: &[[f64; 4]], b: &[[f64; 4]]) -> Option<(f64, f64, f64)> {
    let d = [a[1][1] - a[0][1], a[1][2] - a[0][2]];
    let e = [b[1][1] - b[0][1], b[1][2] - b[0][2]];
    let w = [b[0][1] - a[0][1], b[0][2] - a[0][2]];
    let area = d[0] * e[1] - d[1] * e[0];
    let size = ((d[0] * d[0] + d[1] * d[1]) * (e[0] * e[0] + e[1] * e[1])).sqrt();
    if area.abs() < 1e-9 * size {
        return None;
    }
    let (u, v) = ((w[0] * e[1] - w[1] * e[0]) / area, (w[0] * d[1] - w[1] * d[0]) / area);
    // Half open, so that a crossing at a common point of two segments counts once.
    let inside = |x: f64| (0.0..1.0).contains(&x);
    (inside(u) && inside(v)).then_some((u, v, area.abs() / size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_reach_to_the_lower_limit() {
        let points: Vec<[f64; 4]> = (0..=20).map(|i| [f64::from(i), 0.0, 0.0, 0.0]).collect();
        let hill = |p: &[f64; 4]| 6.0 - (p[0] - 10.0).abs();
        assert_eq!(stretches(&points, hill, [3.0, 1.0]), [[6.0, 15.0]]);
        assert_eq!(stretches(&points, |p| hill(p) - 4.0, [3.0, 1.0]), Vec::<[f64; 2]>::new());
        assert_eq!(joined(&[[30.0, 40.0], [-2.0, 5.0], [15.0, 20.0]], 36.0), [[0.0, 36.0]]);
    }
}
