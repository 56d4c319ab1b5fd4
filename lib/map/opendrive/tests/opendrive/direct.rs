//! Accuracy: every answer about places and widths against direct evaluation of the file's polynomials,
//! written down here a second time, the slow and plain way.

use crate::common;

use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Rotation3, Vector3};
use opendrive::*;

/// What the project promises for x, y, z and lane widths, metres.
const PROMISED_M: f64 = 1e-3;

/// The last record at or before s.
fn last<T>(records: &[T], s: f64, start: impl Fn(&T) -> f64) -> Option<&T> {
    records.iter().rev().find(|r| start(r) <= s)
}

fn cubic(records: &[Cubic], s: f64) -> [f64; 2] {
    last(records, s, |r| r.s).map_or([0.0; 2], |r| {
        let d = s - r.s;
        [r.a + r.b * d + r.c * d * d + r.d * d * d * d, r.b + 2.0 * r.c * d + 3.0 * r.d * d * d]
    })
}

/// Position and heading on the reference line.
fn plan(road: &Road, s: f64) -> Option<[f64; 3]> {
    let g = last(&road.plan_view, s, |g| g.s)?;
    let d = s - g.s;
    let [u, v, turn] = match g.curve {
        Curve::Line => [d, 0.0, 0.0],
        Curve::Arc { curvature: k } if k.abs() > 1e-9 => {
            let (sin, cos) = sin_cos(k * d);
            [sin / k, (1.0 - cos) / k, k * d]
        }
        Curve::Arc { .. } => [d, 0.0, 0.0],
        Curve::Spiral { curvature_start, curvature_end } => {
            // Midpoint sums of the heading's direction.
            let rate = (curvature_end - curvature_start) / g.length_m;
            let turn = |x: f64| curvature_start * x + 0.5 * rate * x * x;
            let n = 20_000;
            let h = d / f64::from(n);
            let sum = (0..n).fold([0.0; 2], |sum, i| {
                let (sin, cos) = sin_cos(turn((f64::from(i) + 0.5) * h));
                [sum[0] + h * cos, sum[1] + h * sin]
            });
            [sum[0], sum[1], turn(d)]
        }
        Curve::Poly3 { v } => along([0.0, 1.0, 0.0, 0.0], v, g.length_m, d),
        Curve::ParamPoly3 { u, v, normalised } => {
            // s is the way along the curve; a stated length that is not the curve's stretches it.
            let end = if normalised { 1.0 } else { g.length_m };
            let whole = chords(u, v, end);
            along(u, v, end, d * whole / g.length_m)
        }
    };
    let (sin, cos) = sin_cos(g.hdg_rad);
    Some([g.x_m + cos * u - sin * v, g.y_m + sin * u + cos * v, g.hdg_rad + turn])
}

fn poly(c: [f64; 4], p: f64) -> [f64; 2] {
    [c[0] + c[1] * p + c[2] * p * p + c[3] * p * p * p, c[1] + 2.0 * c[2] * p + 3.0 * c[3] * p * p]
}

/// Length of a parametric curve as a sum of small chords.
fn chords(u: [f64; 4], v: [f64; 4], end: f64) -> f64 {
    let at = |i: u32| [poly(u, end * f64::from(i) / 20_000.0)[0], poly(v, end * f64::from(i) / 20_000.0)[0]];
    (0..20_000)
        .map(|i| (at(i), at(i + 1)))
        .map(|(a, b)| ((b[0] - a[0]).powi_2() + (b[1] - a[1]).powi_2()).sqrt())
        .sum()
}

trait Square {
    fn powi_2(self) -> f64;
}

impl Square for f64 {
    fn powi_2(self) -> f64 {
        self * self
    }
}

/// The point `way` metres along a parametric curve, and its direction, in small steps.
fn along(u: [f64; 4], v: [f64; 4], end: f64, way: f64) -> [f64; 3] {
    let step = end / 20_000.0;
    let (mut p, mut left) = (0.0, way);
    loop {
        let middle = p + 0.5 * step;
        let speed = (poly(u, middle)[1].powi_2() + poly(v, middle)[1].powi_2()).sqrt();
        if speed * step >= left {
            p += left / speed;
            break;
        }
        left -= speed * step;
        p += step;
    }
    [poly(u, p)[0], poly(v, p)[0], atan2(poly(v, p)[1], poly(u, p)[1])]
}

/// The surface point at (s, t): turned by heading, pitch and roll about the reference line.
fn surface(network: &Network, road: &Road, s: f64, t: f64) -> Option<Point3<f64>> {
    let [x, y, heading] = plan(road, s)?;
    let [z, slope] = cubic(&road.elevation, s);
    let roll = cubic(&road.superelevation, s)[0];
    let turn = Rotation3::from_euler_angles(roll, -atan2(slope, 1.0), heading);
    let at = Point3::new(x, y, z) + turn * Vector3::new(0.0, t, 0.0);
    // The header's offset: first moved, then turned.
    let o = network.header.offset;
    let moved = Point3::new(at.x + o.x_m, at.y + o.y_m, at.z + o.z_m);
    Some(Rotation3::from_euler_angles(0.0, 0.0, o.hdg_rad) * moved)
}

/// t of a lane's inner and outer border.
fn borders(road: &Road, section: &LaneSection, lane: i16, s: f64) -> Option<[f64; 2]> {
    let (side, sign) = if lane > 0 { (&section.left, 1.0) } else { (&section.right, -1.0) };
    let mut t = cubic(&road.lane_offset, s)[0];
    for l in side {
        let first = l.widths.first()?;
        let ds = (s - section.s).max(first.s);
        let outer = t + sign * cubic(&l.widths, ds)[0].max(0.0);
        if l.id == lane {
            return Some([t, outer]);
        }
        t = outer;
    }
    None
}

/// Compares a map with the formulas at a few places of every lane; answers with the number of places.
fn compare(map: &Map, name: &str) -> usize {
    let network = map.network();
    let zero = |c: &Cubic| c.a == 0.0 && c.b == 0.0 && c.c == 0.0 && c.d == 0.0;
    let mut places = 0;
    for lane in map.lanes() {
        let road = &network.roads[lane.id.road as usize];
        // Shapes across the road are tested where they are implemented.
        if !road.shape.iter().all(|s| zero(&s.cubic_of_t)) {
            continue;
        }
        let section = &road.sections[usize::from(lane.id.section)];
        for part in [0.0, 0.21, 0.5, 0.83, 1.0] {
            let s = lane.s_start + part * lane.s_length();
            let Some([inner, outer]) = borders(road, section, lane.id.lane, s) else { continue };
            let want = |t: f64| surface(network, road, s, t);
            let (Some(a), Some(b), Some(c)) = (want(inner), want(outer), want(0.5 * (inner + outer))) else {
                continue;
            };
            let bounds = map.lane_bounds(lane.id, s).expect("lane");
            let centre = map.lane_point(lane.id, s, 0.0).expect("lane");
            for (got, want) in [(bounds.inner, a), (bounds.outer, b), (centre.position, c)] {
                assert!((got - want).norm() < PROMISED_M, "{name} {:?} at {s}: {got} is not {want}", lane.id);
            }
            assert!(
                (centre.width_m - (outer - inner).abs()).abs() < PROMISED_M,
                "{name} {:?} at {s}",
                lane.id
            );
            places += 1;
        }
    }
    places
}

#[test]
fn a_winding_road_lies_where_its_polynomials_say() {
    let network = common::winding(&[[3.0, 0.01, 1e-3, -1e-5], [2.5, -0.01, 0.0, 1e-5]], 0.03);
    assert_eq!(compare(&Map::new(network), "winding"), 20);
    assert!(compare(&Map::new(common::network()), "hand-made") > 50);
    let mut moved = common::network();
    moved.header.offset = HeaderOffset { x_m: 100.0, y_m: -50.0, z_m: 3.0, hdg_rad: 0.6 };
    assert!(compare(&Map::new(moved), "moved") > 50);
    let poly = |curve: Curve| {
        let mut network = common::winding(&[[3.0, 0.01, 1e-3, -1e-5]], 0.03);
        network.roads[0].plan_view[0].curve = curve;
        network
    };
    let (u, v) = ([0.0, 60.0, -4.0, 1.0], [0.0, 0.0, 12.0, -5.0]);
    assert_eq!(compare(&Map::new(poly(Curve::ParamPoly3 { u, v, normalised: true })), "normalised"), 10);
    let (u, v) = ([0.0, 1.0, -1e-3, 0.0], [0.0, 0.0, 5e-3, -4e-5]);
    assert_eq!(compare(&Map::new(poly(Curve::ParamPoly3 { u, v, normalised: false })), "by length"), 10);
    assert_eq!(compare(&Map::new(poly(Curve::Poly3 { v: [0.0, 0.0, 4e-3, -3e-5] })), "a function of u"), 10);
}

#[test]
fn real_roads_lie_where_their_polynomials_say() {
    let files = testkit::map_files();
    if files.is_empty() {
        return;
    }
    let mut places = 0;
    for path in files {
        let bytes = std::fs::read(&path).expect("a file");
        let Ok(network) = read_bytes(&bytes) else { continue };
        places += compare(&Map::new(network), &path.display().to_string());
    }
    assert!(places > 50_000, "{places}");
}
