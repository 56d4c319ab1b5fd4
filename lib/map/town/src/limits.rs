//! Speed limit signs: where traffic leaves a junction for a road with another limit than the one it came
//! from.

use opendrive::{ContactPoint, LaneValidity, Orientation, Road, Signal, SpeedUnit};

use crate::arm::{Arm, runs};
use crate::ids::Ids;

/// Distance of a sign behind the junction, metres.
const BEHIND_M: f64 = 8.0;
/// Distance of a post from the edge of the carriageway, metres.
const BESIDE_M: f64 = 0.6;
/// Lower edge of a sign over the carriageway, metres.
const SIGN_AT_M: f64 = 2.3;
/// Streets shorter than this have no signs, metres.
const SHORTEST_M: f64 = 40.0;

/// The sign at the beginning of an arm's street, if the limit changes there.
pub(crate) fn limit_sign(ids: &mut Ids, arms: &[Arm], index: usize, road: &Road) -> Option<Signal> {
    let arm = arms.get(index)?;
    let limit = arm.shape.limit_kmh;
    let others = arms.iter().enumerate().filter(|(i, other)| *i != index && !other.entering().is_empty());
    let changes = others.map(|(_, other)| other.shape.limit_kmh).any(|l| l != limit);
    let lanes: Vec<i16> = runs(&arm.lanes.leaving).map(|s| s.lane).collect();
    if !changes || arm.is_rail() || arm.length_m < SHORTEST_M || lanes.is_empty() {
        return None;
    }
    let (s, orientation, section) = match arm.contact {
        ContactPoint::Start => (BEHIND_M, Orientation::Along, road.sections.first()?),
        ContactPoint::End => (arm.length_m - BEHIND_M, Orientation::Against, road.sections.last()?),
    };
    // The lanes at the sign must be those of the street's end.
    let within = match arm.contact {
        ContactPoint::Start => road.sections.get(1).is_none_or(|next| next.s > s),
        ContactPoint::End => section.s < s,
    };
    let from = lanes.iter().copied().min()?;
    let to = lanes.iter().copied().max()?;
    let sign = f64::from(-arm.sign_in());
    within.then(|| Signal {
        id: ids.next(),
        name: format!("Sign_Speed_{limit}"),
        s,
        t: sign * (arm.paved()[1] + BESIDE_M),
        z_offset_m: SIGN_AT_M,
        orientation,
        country: "OpenDRIVE".into(),
        kind: "274".into(),
        subtype: "-1".into(),
        value: Some(limit),
        unit: Some(SpeedUnit::KilometresPerHour),
        text: format!("{limit}"),
        height_m: Some(0.8),
        width_m: Some(0.8),
        validity: vec![LaneValidity { from, to }],
        ..Signal::default()
    })
}
