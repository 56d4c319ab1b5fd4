//! Checks within one road.

use super::lines::{RoadLines, line_of, note};
use crate::geometry::Plan;
use crate::model::{Cubic, Lane, LaneSection, Road};
use crate::read::context::Context;

/// Seams of the reference line wider than this are worth a warning, metres; also lengths that do not add up.
const GAP_M: f64 = 0.01;
/// Kinks of the reference line sharper than this are worth a warning, radians.
const KINK_RAD: f64 = 0.01;
/// Lanes may be narrower than nothing by this much, metres: rounding.
const NEGATIVE_M: f64 = 1e-3;

pub(super) fn reference_line(context: &mut Context, road: &Road, lines: &RoadLines) {
    for (i, (s, gap, kink)) in Plan::new(&road.plan_view, |x, y, h| (x, y, h)).seams().enumerate() {
        let line = line_of(&lines.geometry, i + 1);
        if gap > GAP_M {
            note(context, line, Some(road), Some(s), format!("the reference line has a gap of {gap:.3} m"));
        } else if kink > KINK_RAD {
            note(
                context,
                line,
                Some(road),
                Some(s),
                format!("the reference line has a kink of {kink:.4} rad"),
            );
        }
    }
    let sum: f64 = road.plan_view.iter().map(|g| g.length_m).sum();
    if (sum - road.length_m).abs() > GAP_M {
        let message =
            format!("geometry adds up to {sum:.3} m, but the road's length is {:.3} m", road.length_m);
        note(context, lines.road, Some(road), None, message);
    } else {
        // Lengths that add up may still leave one place twice and another not at all.
        let mut at = 0.0;
        for (i, piece) in road.plan_view.iter().enumerate() {
            if (piece.s - at).abs() > GAP_M {
                let message = format!("geometry begins at {:.3} m where {at:.3} m is expected", piece.s);
                note(context, line_of(&lines.geometry, i), Some(road), Some(piece.s), message);
                break;
            }
            at += piece.length_m;
        }
    }
}

/// Records that begin before the road or after its end.
pub(super) fn records(context: &mut Context, road: &Road, lines: &RoadLines) {
    let mut check_order = |what: &str, starts: &mut dyn Iterator<Item = f64>| {
        let mut beyond = starts.filter(|s| outside(*s, road));
        if let Some(s) = beyond.next() {
            let message = format!("a {what} record begins where there is no road");
            note(context, lines.road, Some(road), Some(s), message);
        }
    };
    check_order("elevation", &mut road.elevation.iter().map(|c| c.s));
    check_order("superelevation", &mut road.superelevation.iter().map(|c| c.s));
    check_order("crossfall", &mut road.crossfall.iter().map(|c| c.angle_rad.s));
    check_order("shape", &mut road.shape.iter().map(|c| c.s));
    check_order("laneOffset", &mut road.lane_offset.iter().map(|c| c.s));
    check_order("type", &mut road.types.iter().map(|c| c.s));
}

/// Whether an s is not on a road.
pub(super) fn outside(s: f64, road: &Road) -> bool {
    s < -GAP_M || s > road.length_m + GAP_M
}

/// Lane sections that begin in odd places, lanes of negative width, and links inside the road to lanes that
/// are not there.
pub(super) fn sections(context: &mut Context, road: &Road, lines: &RoadLines) {
    if let Some(first) = road.sections.first().filter(|s| s.s > GAP_M) {
        let line = line_of(&lines.sections, 0);
        note(context, line, Some(road), Some(first.s), "the first lane section begins late".to_owned());
    }
    for (i, section) in road.sections.iter().enumerate() {
        let line = line_of(&lines.sections, i);
        if section.s > road.length_m {
            let message = "a lane section begins after the road's end".to_owned();
            note(context, line, Some(road), Some(section.s), message);
        }
        let end = road.sections.get(i + 1).map_or(road.length_m, |next| next.s.min(road.length_m));
        widths(context, road, section, end - section.s, line);
    }
    for (i, pair) in road.sections.windows(2).enumerate() {
        let (before, after) = (&pair[0], &pair[1]);
        for lane in before.lanes() {
            for id in lane.successors.iter().filter(|id| !goes_on(after, **id)) {
                let message = format!("lane {} leads to lane {id}, which does not exist", lane.id);
                note(context, line_of(&lines.sections, i), Some(road), Some(after.s), message);
            }
        }
        for lane in after.lanes() {
            for id in lane.predecessors.iter().filter(|id| !goes_on(before, **id)) {
                let message = format!("lane {} follows lane {id}, which does not exist", lane.id);
                note(context, line_of(&lines.sections, i + 1), Some(road), Some(after.s), message);
            }
        }
    }
}

/// Whether a lane is there in a section, or goes on beside one that speaks of the other side only.
fn goes_on(section: &LaneSection, id: i16) -> bool {
    let side = if id > 0 { &section.left } else { &section.right };
    has_lane(section, id) || (section.single_side && side.is_empty() && id != 0)
}

/// Whether a section has a lane that one can be on.
pub(super) fn has_lane(section: &LaneSection, id: i16) -> bool {
    id != 0 && section.lane(id).is_some()
}

fn widths(context: &mut Context, road: &Road, section: &LaneSection, length_m: f64, line: u32) {
    for lane in section.lanes() {
        if let Some(first) = lane.widths.first().filter(|w| w.s > GAP_M) {
            let message = format!("lane {}: the first width record begins late", lane.id);
            note(context, line, Some(road), Some(section.s + first.s), message);
        }
        if let Some((offset, width)) = narrowest(lane, length_m).filter(|(_, width)| *width < -NEGATIVE_M) {
            let message = format!("lane {} has the negative width {width:.3} m: taken as 0", lane.id);
            note(context, line, Some(road), Some(section.s + offset), message);
        }
    }
}

/// Where a lane is narrowest within its section, and how wide it is there.
fn narrowest(lane: &Lane, length_m: f64) -> Option<(f64, f64)> {
    let ends = lane.widths.iter().skip(1).map(|w| w.s.min(length_m)).chain([length_m]);
    let each = lane.widths.iter().zip(ends).filter(|(w, end)| w.s <= *end).map(|(w, end)| {
        let (d, value) = lowest(w, end - w.s);
        (w.s + d, value)
    });
    each.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Where a cubic is lowest on `[0, reach]`, and its value there: at an end, or where its slope is 0.
fn lowest(c: &Cubic, reach: f64) -> (f64, f64) {
    // Slope: b + 2 c d + 3 d d^2.
    let (qa, qb, qc) = (3.0 * c.d, 2.0 * c.c, c.b);
    let root = (qb * qb - 4.0 * qa * qc).max(0.0).sqrt();
    // This form is stable, and its second quotient also serves straight slopes.
    let q = -0.5 * (qb + root.copysign(qb));
    let level = [q / qa, qc / q].into_iter().filter(|d| *d > 0.0 && *d < reach);
    let all = [0.0, reach].into_iter().chain(level).map(|d| (d, c.derivatives(d).0));
    all.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, c.a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_lowest_place_is_lowest(a in -2.0..4.0f64, b in -1.0..1.0f64, c in -0.1..0.1f64,
                                      d in prop::sample::select(vec![0.0, 1e-3, -2e-3]), reach in 0.0..30.0f64) {
            let cubic = Cubic { s: 0.0, a, b, c, d };
            let (at, value) = lowest(&cubic, reach);
            prop_assert!((0.0..=reach).contains(&at) && cubic.derivatives(at).0 == value);
            for i in 0..=200 {
                prop_assert!(cubic.derivatives(reach * f64::from(i) / 200.0).0 >= value - 1e-12);
            }
        }
    }
}
