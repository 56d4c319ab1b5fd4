//! Chains of roads with every kind of curve, checked against slow and simple integration.

use nalgebra::{Point3, Vector3};
use opendrive::*;
use proptest::prelude::*;

/// Steps of the slow integration along one piece.
const STEPS: usize = 4000;

/// A pose in plan: x, y, heading.
type PlanPose = [f64; 3];

/// Where a piece of the reference line leads, `d` metres after its start, by Runge-Kutta steps along it.
fn walk(piece: &Geometry, d: f64) -> PlanPose {
    let h = d / STEPS as f64;
    // State: x, y, and the curve's own variable (the way for clothoids, p for polynomials).
    let rate = |state: [f64; 3]| -> ([f64; 3], f64) {
        let (heading, own) = match &piece.curve {
            Curve::Line => (piece.hdg_rad, 1.0),
            Curve::Arc { curvature } => (piece.hdg_rad + curvature * state[2], 1.0),
            Curve::Spiral { curvature_start, curvature_end } => {
                let way = state[2];
                let turn = curvature_start * way
                    + (curvature_end - curvature_start) / piece.length_m * way * way / 2.0;
                (piece.hdg_rad + turn, 1.0)
            }
            Curve::Poly3 { v } => {
                let slope = derivative(v, state[2]);
                (piece.hdg_rad + frames::math::atan(slope), 1.0 / (1.0 + slope * slope).sqrt())
            }
            Curve::ParamPoly3 { u, v, .. } => {
                let (du, dv) = (derivative(u, state[2]), derivative(v, state[2]));
                (piece.hdg_rad + frames::math::atan2(dv, du), 1.0 / (du * du + dv * dv).sqrt())
            }
        };
        ([frames::math::cos(heading), frames::math::sin(heading), own], heading)
    };
    let ahead = |state: [f64; 3], rate: [f64; 3], h: f64| [0, 1, 2].map(|i| state[i] + h * rate[i]);
    let mut state = [piece.x_m, piece.y_m, 0.0];
    for _ in 0..STEPS {
        let k1 = rate(state).0;
        let k2 = rate(ahead(state, k1, h / 2.0)).0;
        let k3 = rate(ahead(state, k2, h / 2.0)).0;
        let k4 = rate(ahead(state, k3, h)).0;
        state = [0, 1, 2].map(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    [state[0], state[1], rate(state).1]
}

fn derivative(c: &[f64; 4], p: f64) -> f64 {
    c[1] + 2.0 * c[2] * p + 3.0 * c[3] * p * p
}

/// Length of a parametric cubic up to p = `end`, by Simpson's rule.
fn arc_length(u: &[f64; 4], v: &[f64; 4], end: f64) -> f64 {
    let speed = |p: f64| (derivative(u, p) * derivative(u, p) + derivative(v, p) * derivative(v, p)).sqrt();
    let h = end / STEPS as f64;
    (0..STEPS)
        .map(|i| i as f64 * h)
        .map(|p| h / 6.0 * (speed(p) + 4.0 * speed(p + h / 2.0) + speed(p + h)))
        .sum()
}

fn value(records: &[Cubic], s: f64) -> f64 {
    let Some(c) = records.iter().rev().find(|c| c.s <= s) else { return 0.0 };
    let d = s - c.s;
    c.a + c.b * d + c.c * d * d + c.d * d * d * d
}

fn slope(records: &[Cubic], s: f64) -> f64 {
    let Some(c) = records.iter().rev().find(|c| c.s <= s) else { return 0.0 };
    let d = s - c.s;
    c.b + 2.0 * c.c * d + 3.0 * c.d * d * d
}

/// What a piece of a chain is made from: kind, length, and four numbers between -1 and 1.
type Recipe = (usize, f64, [f64; 4]);

fn piece(recipe: &Recipe, start: PlanPose, s: f64) -> Geometry {
    let (kind, length_m, [a, b, c, d]) = *recipe;
    let (curve, length_m) = match kind {
        0 => (Curve::Line, length_m),
        1 => (Curve::Arc { curvature: 0.03 * a }, length_m),
        2 => (Curve::Spiral { curvature_start: 0.03 * a, curvature_end: 0.03 * b }, length_m),
        3 => (Curve::Poly3 { v: [0.0, 0.0, 4e-3 * a, 5e-5 * b] }, length_m),
        _ => {
            // Over p in [0, 1], or with p stretched to the way along the curve; either way the stated length
            // is true.
            let l = length_m;
            let (u, v) = ([0.0, l, 0.1 * l * a, 0.05 * l * b], [0.0, 0.0, 0.15 * l * c, 0.1 * l * d]);
            let way = arc_length(&u, &v, 1.0);
            let normalised = kind == 4;
            let stretch = if normalised { 1.0 } else { way };
            let stretched = |c: [f64; 4]| {
                [c[0], c[1] / stretch, c[2] / (stretch * stretch), c[3] / (stretch * stretch * stretch)]
            };
            (Curve::ParamPoly3 { u: stretched(u), v: stretched(v), normalised }, way)
        }
    };
    Geometry { s, x_m: start[0], y_m: start[1], hdg_rad: start[2], length_m, curve }
}

/// Cubic pieces over `[0, length]` whose values and slopes fit each other, from values at equal distances.
fn smooth(values: &[f64], length: f64) -> Vec<Cubic> {
    let n = values.len() - 1;
    let h = length / n as f64;
    let slope = |i: usize| if i == 0 || i == n { 0.0 } else { (values[i + 1] - values[i - 1]) / (2.0 * h) };
    (0..n)
        .map(|i| {
            let (p, q, m, k) = (values[i], values[i + 1], slope(i), slope(i + 1));
            let (c, d) = ((3.0 * (q - p) / h - 2.0 * m - k) / h, (2.0 * (p - q) / h + m + k) / (h * h));
            Cubic { s: i as f64 * h, a: p, b: m, c, d }
        })
        .collect()
}

/// Records that hold in `[from, to)`, with starts counted from `from`.
fn within(records: &[Cubic], from: f64, to: f64) -> Vec<Cubic> {
    let first = records.iter().rposition(|c| c.s <= from).unwrap_or(0);
    let kept = records[first..].iter().filter(|c| c.s < to);
    // Cut records are developed anew about where they are cut.
    kept.map(|c| {
        let s = c.s.max(from);
        let e = s - c.s;
        let a = c.a + e * (c.b + e * (c.c + e * c.d));
        let b = c.b + e * (2.0 * c.c + e * 3.0 * c.d);
        Cubic { s: s - from, a, b, c: c.c + 3.0 * c.d * e, d: c.d }
    })
    .collect()
}

/// A chain of roads, each of some pieces, in two lane sections each.
fn chain(roads: &[Vec<Recipe>], profile: &[f64; 5], widths: &[[f64; 3]; 3]) -> Network {
    let mut network =
        Network { header: Header { revision: (1, 7), ..Header::default() }, ..Network::default() };
    let mut at = [5.0, -3.0, 0.4];
    for (i, recipes) in roads.iter().enumerate() {
        let (mut plan_view, mut s) = (Vec::new(), 0.0);
        for recipe in recipes {
            let next = piece(recipe, at, s);
            at = walk(&next, next.length_m);
            s += next.length_m;
            plan_view.push(next);
        }
        let cut = 0.37 * s;
        // Profiles begin and end with the same values, so that roads fit each other.
        let sides = |sign: i16| {
            widths
                .iter()
                .enumerate()
                .map(move |(k, w)| (sign * (k as i16 + 1), smooth(&[w[0], w[1], w[2], w[0]], s)))
        };
        let section = |from: f64, to: f64| {
            let lanes = |sign: i16| {
                sides(sign)
                    .map(|(id, records)| Lane {
                        id,
                        lane_type: LaneType::Driving,
                        widths: within(&records, from, to),
                        predecessors: if from > 0.0 || i > 0 { vec![id] } else { Vec::new() },
                        successors: if to < s || i + 1 < roads.len() { vec![id] } else { Vec::new() },
                        ..Lane::default()
                    })
                    .collect::<Vec<_>>()
            };
            LaneSection { s: from, left: lanes(1), right: lanes(-1), ..LaneSection::default() }
        };
        let name = |i: usize| i.to_string();
        network.roads.push(Road {
            id: name(i),
            length_m: s,
            plan_view,
            elevation: smooth(&[10.0, 10.0 + profile[0], 10.0 + profile[1], 10.0], s),
            superelevation: smooth(&[0.02, 0.02 + 0.02 * profile[2], 0.02], s),
            lane_offset: smooth(&[0.3, 0.3 + profile[3], 0.3 + profile[4], 0.3], s),
            sections: vec![section(0.0, cut), section(cut, s)],
            predecessor: (i > 0).then(|| RoadLink::Road { id: name(i - 1), contact: ContactPoint::End }),
            successor: (i + 1 < roads.len())
                .then(|| RoadLink::Road { id: name(i + 1), contact: ContactPoint::Start }),
            ..Road::default()
        });
    }
    network
}

fn recipes() -> impl Strategy<Value = Vec<Vec<Recipe>>> {
    let recipe = (0..6usize, 8.0..50.0f64, [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64]);
    prop::collection::vec(prop::collection::vec(recipe, 1..4), 1..4)
}

/// The surface at (s, t), evaluated directly.
fn surface(road: &Road, s: f64, t: f64) -> Point3<f64> {
    let piece = road.plan_view.iter().rev().find(|g| g.s <= s).expect("on the road");
    let [x, y, heading] = walk(piece, s - piece.s);
    let (z, rise) = (value(&road.elevation, s), slope(&road.elevation, s));
    let (forward, side) = (
        Vector3::new(frames::math::cos(heading), frames::math::sin(heading), 0.0),
        Vector3::new(-frames::math::sin(heading), frames::math::cos(heading), 0.0),
    );
    // Roll about the sloping tangent.
    let along = (forward + Vector3::z() * rise).normalize();
    let up = along.cross(&side);
    let roll = value(&road.superelevation, s);
    Point3::new(x, y, z) + (side * frames::math::cos(roll) + up * frames::math::sin(roll)) * t
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn chains_are_sound_for_the_reader_and_right_to_a_micrometre(
        roads in recipes(),
        profile in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64, -1.0..1.0f64, -1.0..1.0f64],
        widths in [[2.5..4.0f64, 0.0..4.0f64, 1.0..4.0f64], [0.0..3.0f64, 0.0..3.0f64, 0.0..3.0f64], [1.0..2.0f64, 1.0..2.0f64, 1.0..2.0f64]],
        part in 0.0..1.0f64,
    ) {
        let network = chain(&roads, &profile, &widths);
        // The reader measures gaps and kinks for itself; widths may dip below 0 between their stations.
        let read = Network::parse(&write(&network)).expect("our own file");
        for warning in &read.warnings {
            prop_assert!(warning.message.contains("negative width"), "{warning}");
        }
        let map = Map::new(read);
        for (r, road) in network.roads.iter().enumerate() {
            let s = part * road.length_m;
            for t in [-6.0, 0.0, 4.5] {
                let got = map.road_point(r as u32, s, t, 0.0).expect("there");
                let want = surface(road, s, t);
                prop_assert!((got - want).norm() < 1e-6, "road {r} s {s} t {t}: {got} {want} {:?}", road.plan_view);
            }
            // Borders: the lane offset and the sum of the widths, none of which is negative.
            let section = usize::from(s >= road.sections[1].s);
            for sign in [1, -1] {
                let mut t = value(&road.lane_offset, s);
                for (k, w) in widths.iter().enumerate() {
                    let id = LaneId { road: r as u32, section: section as u16, lane: sign * (k as i16 + 1) };
                    let width = value(&smooth(&[w[0], w[1], w[2], w[0]], road.length_m), s).max(0.0);
                    t += f64::from(sign) * width;
                    prop_assert!((map.lane_width(id, s).expect("there") - width).abs() < 1e-9);
                    let outer = map.lane_bounds(id, s).expect("there").outer;
                    prop_assert!((outer - surface(road, s, t)).norm() < 1e-6, "{id:?} {s}");
                }
            }
        }
    }

    #[test]
    fn borders_go_on_across_sections_and_links(
        roads in recipes(),
        profile in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64, -1.0..1.0f64, -1.0..1.0f64],
        widths in [[2.5..4.0f64, 1.0..4.0f64, 1.0..4.0f64], [1.0..3.0f64, 1.0..3.0f64, 1.0..3.0f64], [1.0..2.0f64, 1.0..2.0f64, 1.0..2.0f64]],
    ) {
        let map = Map::new(chain(&roads, &profile, &widths));
        let mut links = 0;
        for lane in map.lanes() {
            // No lane is narrower than nothing anywhere.
            for i in 0..=40 {
                let s = lane.s_start + lane.s_length() * f64::from(i) / 40.0;
                prop_assert!(map.lane_width(lane.id, s).expect("there") >= 0.0);
            }
            for next in map.successors(lane.id) {
                links += 1;
                let other = map.lane(*next).expect("there");
                let (end, start) = (lane.s_of_along(lane.s_length()), other.s_of_along(0.0));
                let (a, b) = (map.lane_bounds(lane.id, end).expect("there"), map.lane_bounds(*next, start).expect("there"));
                prop_assert!((a.left - b.left).norm() < 1e-6 && (a.right - b.right).norm() < 1e-6, "{:?} {next:?}", lane.id);
            }
        }
        let sections = 2 * roads.len();
        prop_assert_eq!(links, 6 * (sections - 1));
    }

    /// From (road, s, t) to the world and back: where lanes keep their width, the nearest point of a centre
    /// line is that of the same cross-section.
    #[test]
    fn places_can_be_found_again(
        roads in recipes(),
        profile in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64],
        part in 0.02..0.98f64, across in -0.45..0.45f64,
    ) {
        let profile = [profile[0], profile[1], profile[2], 0.0, 0.0];
        let map = Map::new(chain(&roads, &profile, &[[3.5; 3], [3.0; 3], [2.0; 3]]));
        for lane in map.lanes() {
            let s = lane.s_start + part * lane.s_length();
            let offset = across * map.lane_width(lane.id, s).expect("there");
            let place = map.lane_point(lane.id, s, offset).expect("there").position;
            let hit = map.nearest_lane(place, |l| l.id == lane.id).expect("there");
            prop_assert!((hit.s - s).abs() < 1e-5 && (hit.t_m - offset).abs() < 1e-6, "{:?} {s} {offset}: {hit:?}", lane.id);
        }
    }
}
