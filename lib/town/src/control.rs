//! Right of way: signals with their controllers, yield signs, stop lines.

use opendrive::{
    ContactPoint, Controller, JunctionController, LaneType, LaneValidity, Object, Orientation, Road, Signal,
    SignalReference,
};
use std::f64::consts::FRAC_PI_2;

use crate::assemble::Ids;
use crate::junction::Built;
use crate::marks::KERB_M;
use crate::movements::{Arm, opposite};
use crate::street::rectangle;

/// Distance of a post from the kerb, metres.
const POST_FROM_KERB_M: f64 = 0.6;
/// Distance of a post from the end of its street, metres.
const POST_FROM_END_M: f64 = 0.2;
/// Middle of a stop line before the end of its street, metres.
const STOP_LINE_AT_M: f64 = 0.4;
/// Width of a stop line, metres.
const STOP_LINE_M: f64 = 0.4;
/// Lower edge of a sign over the carriageway, metres.
const SIGN_AT_M: f64 = 2.3;

/// Who gives way to whom at a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Control {
    /// Traffic lights on every arm; arms that face each other share a controller.
    Signals,
    /// Arms that nothing faces yield to the street that goes straight on.
    Priority,
}

impl Control {
    /// Whether traffic from an arm has to stop or yield, and pedestrians may cross it.
    pub(crate) fn holds_back(self, faced: bool) -> bool {
        match self {
            Self::Signals => true,
            Self::Priority => !faced,
        }
    }
}

/// What control adds to the network.
#[derive(Debug, Default)]
pub(crate) struct Furniture {
    /// Controllers of the junction's signals.
    pub(crate) controllers: Vec<Controller>,
    /// Signals and objects at each arm's street, in the order of the arms.
    pub(crate) at_arms: Vec<(Option<Signal>, Option<Object>)>,
}

/// Puts up the signals or signs of a junction. `lengths_m`: length of each arm's street.
pub(crate) fn equip(
    ids: &mut Ids,
    built: &mut Built,
    arms: &[Arm],
    lengths_m: &[f64],
    control: Control,
) -> Furniture {
    let mut furniture = Furniture::default();
    for (index, (arm, length)) in arms.iter().zip(lengths_m).enumerate() {
        let faced = opposite(arms, index).is_some();
        if arm.incoming().0.lanes == 0 || !control.holds_back(faced) {
            furniture.at_arms.push((None, None));
            continue;
        }
        let signal = post(ids, arm, *length, control);
        for (movement, road) in built.movements.iter().zip(&mut built.roads) {
            if movement.from == index && movement.lanes > 0 {
                road.signal_references.push(reference(&signal.id, road));
            }
        }
        furniture.at_arms.push((Some(signal), Some(stop_line(ids, arm, *length))));
    }
    if control == Control::Signals {
        furniture.controllers = controllers(ids, arms, &furniture.at_arms);
        for (sequence, controller) in (0..).zip(&furniture.controllers) {
            let sequence = Some(sequence);
            built.junction.controllers.push(JunctionController {
                id: controller.id.clone(),
                sequence,
                ..JunctionController::default()
            });
        }
    }
    furniture
}

/// s at a distance before the end of an arm's street, and the direction of its entering traffic.
fn before_end(arm: &Arm, length_m: f64, distance_m: f64) -> (f64, Orientation) {
    match arm.contact {
        ContactPoint::End => (length_m - distance_m, Orientation::Along),
        ContactPoint::Start => (distance_m, Orientation::Against),
    }
}

/// A traffic light or yield sign on the sidewalk, right of the entering traffic. It names no lane of its own road: the
/// references on the connecting roads say what it controls.
fn post(ids: &mut Ids, arm: &Arm, length_m: f64, control: Control) -> Signal {
    let (side, sign) = arm.incoming();
    let (s, orientation) = before_end(arm, length_m, POST_FROM_END_M);
    let signal = Signal {
        id: ids.next(),
        s,
        t: f64::from(sign) * (side.kerb_m() + POST_FROM_KERB_M),
        orientation,
        country: "OpenDRIVE".into(),
        subtype: "-1".into(),
        validity: vec![LaneValidity { from: 0, to: 0 }],
        ..Signal::default()
    };
    match control {
        Control::Signals => Signal {
            name: "Signal_3Light_Post01".into(),
            z_offset_m: KERB_M,
            dynamic: true,
            kind: "1000001".into(),
            height_m: Some(1.16),
            width_m: Some(0.52),
            ..signal
        },
        Control::Priority => Signal {
            name: "Sign_Yield".into(),
            z_offset_m: SIGN_AT_M,
            kind: "205".into(),
            height_m: Some(0.9),
            width_m: Some(0.9),
            ..signal
        },
    }
}

/// Says on a connecting road that a signal controls all its driving lanes.
fn reference(signal: &str, road: &Road) -> SignalReference {
    let driving = road.sections.iter().flat_map(|s| &s.right).filter(|l| l.lane_type == LaneType::Driving);
    let ids: Vec<i16> = driving.map(|l| l.id).collect();
    let from = ids.iter().copied().min().unwrap_or_default();
    let to = ids.iter().copied().max().unwrap_or_default();
    SignalReference {
        id: signal.to_owned(),
        orientation: Orientation::Along,
        validity: vec![LaneValidity { from, to }],
        ..SignalReference::default()
    }
}

/// The stop line over the entering lanes.
fn stop_line(ids: &mut Ids, arm: &Arm, length_m: f64) -> Object {
    let (side, sign) = arm.incoming();
    let (s, orientation) = before_end(arm, length_m, STOP_LINE_AT_M);
    Object {
        id: ids.next(),
        name: "StopLine".into(),
        kind: "roadMark".into(),
        s,
        t: f64::from(sign) * 0.5 * side.driving_m(),
        // Its length runs across the street.
        hdg_rad: FRAC_PI_2,
        orientation,
        length_m: Some(side.driving_m()),
        width_m: Some(STOP_LINE_M),
        outlines: vec![rectangle(0.5 * side.driving_m(), 0.5 * STOP_LINE_M)],
        ..Object::default()
    }
}

/// One controller for each pair of facing arms, one for each arm that is left.
fn controllers(ids: &mut Ids, arms: &[Arm], at_arms: &[(Option<Signal>, Option<Object>)]) -> Vec<Controller> {
    let mut controllers: Vec<Controller> = Vec::new();
    let mut done = vec![false; arms.len()];
    for first in 0..arms.len() {
        if done[first] {
            continue;
        }
        let partner = opposite(arms, first).filter(|p| !done[*p] && opposite(arms, *p) == Some(first));
        let mut signals = Vec::new();
        for arm in [Some(first), partner].into_iter().flatten() {
            done[arm] = true;
            signals.extend(at_arms[arm].0.iter().map(|s| s.id.clone()));
        }
        if signals.is_empty() {
            continue;
        }
        let id = ids.next();
        let sequence = u32::try_from(controllers.len()).ok();
        controllers.push(Controller {
            name: format!("ctrl{id}"),
            id,
            sequence,
            signals,
            ..Controller::default()
        });
    }
    controllers
}
