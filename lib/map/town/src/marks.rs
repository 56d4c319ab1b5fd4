//! What is painted on lane borders, and where.

use opendrive::{MarkChange, MarkColour, MarkType, RoadMark};

/// Width of a painted line, metres.
const LINE_M: f64 = 0.12;
/// Height of a kerb over the carriageway, metres.
pub(crate) const KERB_M: f64 = 0.15;

/// A marking from some s of a road on.
pub(crate) type MarkFrom = (f64, RoadMark);

/// A painted line.
pub(crate) fn line(mark_type: MarkType, colour: MarkColour) -> RoadMark {
    let lane_change = if mark_type == MarkType::Broken { MarkChange::Both } else { MarkChange::None };
    RoadMark {
        mark_type,
        colour,
        width_m: Some(LINE_M),
        lane_change: Some(lane_change),
        ..RoadMark::default()
    }
}

/// A broken line that must not be crossed to change lanes: between opposite directions it means overtaking
/// only.
pub(crate) fn overtaking_line() -> RoadMark {
    RoadMark { lane_change: Some(MarkChange::None), ..line(MarkType::Broken, MarkColour::Yellow) }
}

/// A kerb stone.
pub(crate) fn kerb() -> RoadMark {
    RoadMark {
        mark_type: MarkType::Curb,
        width_m: Some(LINE_M),
        height_m: Some(KERB_M),
        lane_change: Some(MarkChange::None),
        ..RoadMark::default()
    }
}

/// No marking.
pub(crate) fn none() -> RoadMark {
    RoadMark { mark_type: MarkType::None, lane_change: Some(MarkChange::None), ..RoadMark::default() }
}

/// The records that hold on `[start, end)` of the road, with offsets from `start`. `records` ascend by s.
pub(crate) fn clipped(records: &[MarkFrom], start: f64, end: f64) -> Vec<RoadMark> {
    let mut marks: Vec<RoadMark> = Vec::new();
    for (s, mark) in records {
        // The last record that begins before the section gives its first mark.
        if *s <= start {
            marks.clear();
        }
        if *s < end {
            marks.push(RoadMark { s_offset: (s - start).max(0.0), ..mark.clone() });
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_keeps_what_holds_in_the_section() {
        let solid = line(MarkType::Solid, MarkColour::White);
        let broken = line(MarkType::Broken, MarkColour::White);
        let all = [(0.0, solid.clone()), (20.0, broken.clone()), (60.0, solid.clone())];
        let at = |s_offset, mark: &RoadMark| RoadMark { s_offset, ..mark.clone() };
        assert_eq!(clipped(&all, 0.0, 12.0), [at(0.0, &solid)]);
        assert_eq!(clipped(&all, 12.0, 50.0), [at(0.0, &solid), at(8.0, &broken)]);
        assert_eq!(clipped(&all, 20.0, 80.0), [at(0.0, &broken), at(40.0, &solid)]);
        assert_eq!(clipped(&all, 70.0, 80.0), [at(0.0, &solid)]);
    }
}
