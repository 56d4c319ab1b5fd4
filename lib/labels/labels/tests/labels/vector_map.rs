//! The vector map against the map it is made from, and against itself.

use opendrive::{LaneId, Map, read_bytes, write};
use schema::tables::{VectorKind, VectorMapRow};
use std::collections::{BTreeMap, BTreeSet};

/// Our own town, and some real ones where they are at hand.
fn maps() -> Vec<(String, Map)> {
    let network = town::generate(&town::named("convoy/demo").expect("is named")).expect("is generated");
    let text = write(&network);
    let mut maps = vec![("convoy/demo".to_owned(), Map::new(read_bytes(text.as_bytes()).expect("our own")))];
    let towns = testkit::real_maps(&["Town03", "Town04", "Town10HD"]);
    maps.extend(towns.map(|(name, map)| (name.to_owned(), map)));
    maps
}

fn of(rows: &[VectorMapRow], kind: VectorKind) -> impl Iterator<Item = &VectorMapRow> {
    rows.iter().filter(move |r| r.kind == kind.name())
}

fn points(row: &VectorMapRow) -> Vec<[f64; 3]> {
    (0..row.x_m.len()).map(|i| [row.x_m[i], row.y_m[i], row.z_m[i]]).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[test]
fn every_element_is_in_its_place() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        assert!(rows.iter().enumerate().all(|(i, r)| r.id as usize == i), "{name}");
        let order: Vec<usize> = rows
            .iter()
            .map(|r| VectorKind::ALL.iter().position(|k| k.name() == r.kind).expect("a kind"))
            .collect();
        assert!(order.is_sorted(), "{name}: kinds are mixed");
        for row in &rows {
            let n = row.x_m.len();
            assert!(row.y_m.len() == n && row.z_m.len() == n && n >= 1, "{name} {}", row.id);
            assert!(row.s_m.is_empty() || row.s_m.len() == n, "{name} {}", row.id);
            assert!(row.x_m.iter().chain(&row.y_m).chain(&row.z_m).all(|v| v.is_finite()));
            let lines = row.rings.is_empty();
            assert_eq!(lines, row.kind != "crosswalk" && row.kind != "sidewalk" && row.kind != "junction");
            assert!(row.kind == "signal" || n >= 2, "{name} {}", row.id);
        }
        // As many elements of each kind as the map has.
        let count = |kind| of(&rows, kind).count();
        assert_eq!(count(VectorKind::Signal), map.signals().len());
        assert_eq!(count(VectorKind::Crosswalk), map.crosswalks().len());
        assert_eq!(count(VectorKind::StopLine), map.stop_lines().len());
        assert_eq!(count(VectorKind::Divider) + count(VectorKind::Kerb), map.stripes().len());
        let junctions: BTreeSet<_> = of(&rows, VectorKind::Junction).map(|r| r.junction_id.clone()).collect();
        assert_eq!(junctions.len(), map.junctions().len(), "{name}");
        for kind in [VectorKind::Signal, VectorKind::Divider, VectorKind::StopLine, VectorKind::Sidewalk] {
            assert!(count(kind) > 0, "{name} has no {}", kind.name());
        }
    }
}

#[test]
fn every_lane_is_there_once_with_its_graph() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        let lanes: Vec<&VectorMapRow> = of(&rows, VectorKind::LaneCentreline).collect();
        assert_eq!(lanes.len(), map.lanes().len());
        let keys: BTreeSet<_> = lanes.iter().map(|r| (&r.road_id, r.section_id, r.lane_id)).collect();
        assert_eq!(keys.len(), lanes.len(), "{name}: a lane is there twice");
        for (row, lane) in lanes.iter().zip(map.lanes()) {
            assert_eq!(row.lane_id, Some(i32::from(lane.id.lane)));
            // Straight from the map's graph, and symmetric.
            let ids = |numbers: &[u32]| {
                numbers.iter().map(|n| map.lanes()[*n as usize].id).collect::<Vec<LaneId>>()
            };
            assert_eq!(ids(&row.successors), map.successors(lane.id), "{name} {}", row.id);
            for next in &row.successors {
                assert!(rows[*next as usize].predecessors.contains(&row.id), "{name} {} {next}", row.id);
            }
            for before in &row.predecessors {
                assert!(rows[*before as usize].successors.contains(&row.id), "{name} {} {before}", row.id);
            }
            for beside in row.left.iter().chain(&row.right) {
                let other = &rows[*beside as usize];
                assert!(other.left.contains(&row.id) || other.right.contains(&row.id), "{name} {}", row.id);
            }
            for signal in &row.signals {
                let other = &rows[*signal as usize];
                assert!(other.kind == "signal" && other.lanes.contains(&row.id), "{name} {}", row.id);
            }
        }
        for row in rows.iter().filter(|r| r.kind != "lane_centreline") {
            assert!(row.lanes.iter().all(|n| rows[*n as usize].kind == "lane_centreline"));
            assert!(row.lanes.is_sorted_by(|a, b| a < b));
            assert!(row.signals.iter().all(|n| rows[*n as usize].kind == "signal"));
        }
    }
}

#[test]
fn lanes_go_on_where_they_end() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        let (mut links, mut loose) = (0, 0);
        for row in of(&rows, VectorKind::LaneCentreline).filter(|r| r.lane_type.as_deref() == Some("Driving"))
        {
            let end = points(row)[row.x_m.len() - 1];
            for next in row.successors.iter().map(|n| &rows[*n as usize]) {
                links += 1;
                loose += usize::from(distance(end, points(next)[0]) > 0.01);
            }
        }
        // One link of Town03 joins lanes that lie side by side.
        assert!(links > 100 && loose <= usize::from(name == "Town03"), "{name}: {loose} of {links}");
    }
}

#[test]
fn boundaries_are_a_lane_width_apart_and_on_their_sides() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        for (row, lane) in of(&rows, VectorKind::LaneCentreline).zip(map.lanes()) {
            let [left, right] = [&rows[row.boundaries[0] as usize], &rows[row.boundaries[1] as usize]];
            assert!(left.lanes.contains(&row.id) && right.lanes.contains(&row.id));
            // The lane's points are those of its boundaries, in the direction of travel.
            let backwards = row.travel.as_deref() == Some("backward") || lane.direction < 0.0;
            let along = |r: &VectorMapRow| {
                let mut points = points(r);
                if backwards {
                    points.reverse();
                }
                points
            };
            let (l, r, c) = (along(left), along(right), points(row));
            assert!(l.len() == c.len() && r.len() == c.len(), "{name} {}", row.id);
            let mut widths = Vec::new();
            for i in 0..c.len() {
                let middle = [0, 1, 2].map(|k| 0.5 * (l[i][k] + r[i][k]));
                assert!(distance(middle, c[i]) < 1e-6, "{name} {} {i}", row.id);
                let width = map.lane_width(lane.id, row.s_m[i]).expect("lane");
                assert!((distance(l[i], r[i]) - width).abs() < 1e-6, "{name} {} {i}", row.id);
                widths.push(width);
                // Not where the file lets the lane jump sideways.
                if i > 0 && width > 0.1 && (row.s_m[i] - row.s_m[i - 1]).abs() > 0.1 {
                    let (dx, dy) = (c[i][0] - c[i - 1][0], c[i][1] - c[i - 1][1]);
                    let side = dx * (l[i][1] - r[i][1]) - dy * (l[i][0] - r[i][0]);
                    assert!(side > 0.0, "{name} {}: left is right", row.id);
                }
            }
            let mean = row.width_m.expect("a width");
            let [least, most] = [
                widths.iter().copied().fold(f64::INFINITY, f64::min),
                widths.iter().copied().fold(0.0, f64::max),
            ];
            assert!(mean >= least - 1e-9 && mean <= most + 1e-9, "{name} {}: {mean}", row.id);
        }
    }
}

/// Whether two segments in plan cross at a point inside both.
fn cross(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> bool {
    let turn =
        |p: [f64; 3], q: [f64; 3], r: [f64; 3]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let (s, t) =
        (turn(a[0], a[1], b[0]) * turn(a[0], a[1], b[1]), turn(b[0], b[1], a[0]) * turn(b[0], b[1], a[1]));
    s < -1e-9 && t < -1e-9
}

fn rings(row: &VectorMapRow) -> Vec<Vec<[f64; 3]>> {
    let all = points(row);
    let starts = row.rings.iter().map(|i| *i as usize);
    let ends = row.rings.iter().skip(1).map(|i| *i as usize).chain([all.len()]);
    starts.zip(ends).map(|(a, b)| all[a..b].to_vec()).collect()
}

fn area(ring: &[[f64; 3]]) -> f64 {
    ring.windows(2)
        .map(|w| {
            0.5 * ((w[0][0] - ring[0][0]) * (w[1][1] - ring[0][1])
                - (w[1][0] - ring[0][0]) * (w[0][1] - ring[0][1]))
        })
        .sum()
}

fn inside(rings: &[Vec<[f64; 3]>], x: f64, y: f64) -> bool {
    rings.iter().flat_map(|r| r.windows(2)).fold(false, |odd, w| {
        let (a, b) = (w[0], w[1]);
        odd != ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    })
}

#[test]
fn polygons_are_closed_and_do_not_cross_themselves() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        for row in rows.iter().filter(|r| !r.rings.is_empty()) {
            assert_eq!(row.rings[0], 0);
            let rings = rings(row);
            for (i, ring) in rings.iter().enumerate() {
                assert!(ring.len() >= 4 && ring[0] == ring[ring.len() - 1], "{name} {} is open", row.id);
                assert_eq!(area(ring) > 0.0, i == 0, "{name} {} ring {i}: {}", row.id, area(ring));
            }
            let edges: Vec<[[f64; 3]; 2]> =
                rings.iter().flat_map(|r| r.windows(2)).map(|w| [w[0], w[1]]).collect();
            for (i, a) in edges.iter().enumerate() {
                assert!(
                    edges[i + 1..].iter().all(|b| !cross(*a, *b)),
                    "{name} {} {} crosses itself",
                    row.kind,
                    row.id
                );
            }
        }
    }
}

#[test]
fn junctions_contain_their_lanes_and_sidewalks_theirs() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        let mut of_junction: BTreeMap<Option<String>, BTreeSet<u32>> = BTreeMap::new();
        for row in rows.iter().filter(|r| r.kind == "junction" || r.kind == "sidewalk") {
            let rings = rings(row);
            for number in &row.lanes {
                let lane = &map.lanes()[*number as usize];
                for k in 1..20 {
                    let s = lane.s_start + lane.s_length() * f64::from(k) / 20.0;
                    let from_ends = (s - lane.s_start).min(lane.s_end - s);
                    let width = map.lane_width(lane.id, s).expect("lane");
                    // 5 cm from borders and ends.
                    if from_ends < 0.05 || width < 0.12 {
                        continue;
                    }
                    for side in [-0.5, 0.0, 0.5] {
                        let p = map.lane_point(lane.id, s, side * (width - 0.1)).expect("lane").position;
                        // Sidewalks of a road have a polygon for each part; a lane that is cut by no width is
                        // in two.
                        let here = inside(&rings, p.x, p.y)
                            || row.kind == "sidewalk"
                                && of(&rows, VectorKind::Sidewalk)
                                    .any(|r| r.lanes == row.lanes && inside(&self::rings(r), p.x, p.y));
                        assert!(here, "{name} {} {}: lane {number} at {s}", row.kind, row.id);
                    }
                }
            }
            if row.kind == "junction" {
                of_junction.entry(row.junction_id.clone()).or_default().extend(&row.lanes);
            }
        }
        // No paved lane of a junction is left out.
        for junction in map.junctions() {
            let found = &of_junction[&Some(junction.id.clone())];
            for id in &junction.lanes {
                let lane = map.lane(*id).expect("lane");
                let number = map.lane_number(*id).expect("lane") as u32;
                if lane.is_paved() && lane.width_range_m[0] > 0.3 && lane.s_length() > 0.3 {
                    assert!(found.contains(&number), "{name}: junction {} misses {id:?}", junction.id);
                }
            }
        }
    }
}

#[test]
fn stop_lines_hold_lanes_and_know_their_signals() {
    for (name, map) in maps() {
        let rows = labels::vector_map::rows(&map);
        let held: BTreeSet<u32> = of(&rows, VectorKind::StopLine).flat_map(|r| r.signals.clone()).collect();
        for signal in of(&rows, VectorKind::Signal) {
            let holds = matches!(signal.signal_type.as_deref(), Some("traffic_light" | "stop"))
                && !signal.lanes.is_empty();
            assert!(!holds || held.contains(&signal.id), "{name}: signal {} has no stop line", signal.id);
        }
        for line in of(&rows, VectorKind::StopLine) {
            assert!(!line.is_derived || (line.lanes.len() == 1 && !line.signals.is_empty()));
            assert_eq!(line.is_derived, line.opendrive_id.is_none());
        }
    }
}
