//! Reference lines, heights, widths: continuous, and within limits. Evaluated here from the records
//! themselves.

use frames::math::{cos, sin};
use opendrive::{Cubic, Curve, Geometry, Network, Road};

/// Steepest slope of any road, rise over run.
const STEEPEST: f64 = 0.125;
/// Smallest radius of the middle of a driving lane in a junction, metres.
const TIGHTEST_M: f64 = 3.0;

pub(super) fn faults(network: &Network) -> Vec<String> {
    let mut faults = Vec::new();
    for road in &network.roads {
        let mut note = |what: String| faults.push(format!("road {} `{}`: {what}", road.id, road.name));
        reference_line(road, &mut note);
        for (name, records, smooth) in [
            ("elevation", &road.elevation, true),
            ("superelevation", &road.superelevation, true),
            ("lane offset", &road.lane_offset, true),
        ] {
            steps(name, records, road.length_m, smooth, &mut note);
        }
        slopes(road, &mut note);
        widths(road, &mut note);
    }
    faults
}

/// Where a piece ends: its heading is a quadratic of the length, integrated by Gauss and Legendre's five
/// points.
fn end_of(piece: &Geometry) -> Option<[f64; 3]> {
    let (k0, k1) = match piece.curve {
        Curve::Line => (0.0, 0.0),
        Curve::Arc { curvature } => (curvature, curvature),
        Curve::Spiral { curvature_start, curvature_end } => (curvature_start, curvature_end),
        _ => return None,
    };
    let heading = |s: f64| piece.hdg_rad + s * (k0 + 0.5 * (k1 - k0) * s / piece.length_m);
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189),
        (-0.538_469_310_105_683, 0.478_628_670_499_366),
        (0.0, 0.568_888_888_888_889),
        (0.538_469_310_105_683, 0.478_628_670_499_366),
        (0.906_179_845_938_664, 0.236_926_885_056_189),
    ];
    let turn = piece.length_m * k0.abs().max(k1.abs());
    let parts = (turn / 0.2).ceil().max(1.0) as usize;
    let step = piece.length_m / parts as f64;
    let (mut x, mut y) = (piece.x_m, piece.y_m);
    for i in 0..parts {
        for (node, weight) in NODES {
            let h = heading(step * (i as f64 + 0.5 + 0.5 * node));
            x += 0.5 * step * weight * cos(h);
            y += 0.5 * step * weight * sin(h);
        }
    }
    Some([x, y, heading(piece.length_m)])
}

fn reference_line(road: &Road, note: &mut impl FnMut(String)) {
    let mut s = 0.0;
    for (i, piece) in road.plan_view.iter().enumerate() {
        if (piece.s - s).abs() > 1e-6 {
            note(format!("piece {i} begins at {} instead of {s}", piece.s));
        }
        s += piece.length_m;
        let Some([x, y, heading]) = end_of(piece) else { continue };
        if let Some(next) = road.plan_view.get(i + 1) {
            let gap = (x - next.x_m).abs().max((y - next.y_m).abs());
            let kink = frames::wrap_pi(heading - next.hdg_rad).abs();
            if gap > 1e-6 || kink > 1e-6 {
                note(format!("gap of {gap:.2e} m and kink of {kink:.2e} rad at {s:.2}"));
            }
        }
        let tightest = match piece.curve {
            Curve::Arc { curvature } => curvature.abs(),
            Curve::Spiral { curvature_start, curvature_end } => {
                curvature_start.abs().max(curvature_end.abs())
            }
            _ => 0.0,
        };
        let kind = road.types.first().map_or("", |t| t.kind.as_str());
        let least = match (road.junction.is_some(), kind) {
            (true, _) => TIGHTEST_M,
            (false, "motorway") => 35.0,
            (false, "rural") => 20.0,
            _ => 8.0,
        };
        if tightest * least > 1.0 + 1e-9 {
            note(format!("radius of {:.2} m at {:.1}", 1.0 / tightest, piece.s));
        }
    }
    if (s - road.length_m).abs() > 1e-6 {
        note(format!("pieces add up to {s} m, the road has {}", road.length_m));
    }
}

fn at(c: &Cubic, s: f64) -> [f64; 2] {
    let d = s - c.s;
    [c.a + d * (c.b + d * (c.c + d * c.d)), c.b + d * (2.0 * c.c + 3.0 * d * c.d)]
}

/// Records join without jumps (and, where `smooth`, without kinks).
fn steps(name: &str, records: &[Cubic], length: f64, smooth: bool, note: &mut impl FnMut(String)) {
    for pair in records.windows(2) {
        let (a, b) = (at(&pair[0], pair[1].s), at(&pair[1], pair[1].s));
        if (a[0] - b[0]).abs() > 1e-6 {
            note(format!("{name} jumps by {:.2e} at {:.2}", b[0] - a[0], pair[1].s));
        }
        if smooth && (a[1] - b[1]).abs() > 1e-6 {
            note(format!("{name} has a kink of {:.2e} at {:.2}", b[1] - a[1], pair[1].s));
        }
        if pair[1].s > length {
            note(format!("a record of {name} begins behind the end"));
        }
    }
}

fn slopes(road: &Road, note: &mut impl FnMut(String)) {
    for (i, c) in road.elevation.iter().enumerate() {
        let end = road.elevation.get(i + 1).map_or(road.length_m, |n| n.s);
        for k in 0..=20 {
            let slope = at(c, c.s + (end - c.s) * f64::from(k) / 20.0)[1];
            if slope.abs() > STEEPEST {
                note(format!("slope of {slope:.3} near {:.1}", c.s));
                break;
            }
        }
    }
}

/// Widths are never negative and have no jumps, neither inside sections nor from one to the next.
fn widths(road: &Road, note: &mut impl FnMut(String)) {
    for (i, section) in road.sections.iter().enumerate() {
        let next = road.sections.get(i + 1);
        let length = next.map_or(road.length_m, |n| n.s) - section.s;
        if length < 0.1 {
            note(format!("section {i} is {length:.4} m long"));
        }
        for lane in section.lanes() {
            let name = format!("width of lane {} in section {i}", lane.id);
            steps(&name, &lane.widths, length, false, note);
            let width = |s: f64| {
                let after = lane.widths.partition_point(|c| c.s <= s);
                lane.widths.get(after.saturating_sub(1)).map_or(0.0, |c| at(c, s)[0])
            };
            for k in 0..=40 {
                let w = width(length * f64::from(k) / 40.0);
                if w < -1e-9 {
                    note(format!("{name} is {w:.2e}"));
                    break;
                }
            }
            // A lane that begins or ends inside the road has no width there.
            let (first, last) = (i == 0, next.is_none());
            if !first && lane.predecessors.is_empty() && width(0.0).abs() > 1e-6 {
                note(format!("{name} begins with {:.3} m out of nothing", width(0.0)));
            }
            if !last && lane.successors.is_empty() && width(length).abs() > 1e-6 {
                note(format!("{name} ends with {:.3} m in nothing", width(length)));
            }
        }
    }
}
