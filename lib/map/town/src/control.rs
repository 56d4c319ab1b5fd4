//! Right of way: signals with their controllers, signs, stop lines.

use opendrive::{
    Controller, JunctionController, LaneValidity, Object, Orientation, Road, Signal, SignalReference,
};
use std::f64::consts::FRAC_PI_2;

use crate::arm::{Arm, major, pairs, runs};
use crate::arrow::arrows;
use crate::ids::Ids;
use crate::junction::Built;
use crate::layout::{Control, NodeKind};
use crate::marks::KERB_M;
use crate::movements::Movement;
use crate::path::Path;
use crate::section::{EndStrip, Turn, Use};
use crate::street::rectangle;
use crate::word::stops;

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
/// Turns sharper than this are turns to the left, radians.
const LEFT_RAD: f64 = 0.4;
/// Medians at least this wide carry the signal of a turn pocket, metres.
const POST_MEDIAN_M: f64 = 0.8;

/// What holds the traffic of an arm back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hold {
    /// Nothing.
    Free,
    /// A traffic light.
    Light,
    /// A stop sign.
    Stop,
    /// A yield sign.
    Yield,
    /// A yield sign for the left pocket alone.
    YieldPocket,
    /// A St Andrew's cross.
    Rail,
}

impl Hold {
    /// Whether there is a stop line.
    fn has_line(self) -> bool {
        !matches!(self, Self::Free)
    }

    /// Name, type in the German catalogue (which OpenDRIVE files use by custom), height and width in metres.
    fn sign(self) -> (&'static str, &'static str, f64, f64) {
        match self {
            Self::Free | Self::Light => ("Signal_3Light_Post01", "1000001", 1.16, 0.52),
            Self::Stop => ("Sign_Stop", "206", 0.9, 0.9),
            Self::Yield | Self::YieldPocket => ("Sign_Yield", "205", 0.9, 0.9),
            Self::Rail => ("Sign_StAndrewsCross", "201", 1.2, 1.2),
        }
    }
}

/// What holds back the traffic of each arm.
pub(crate) fn holds(kind: NodeKind, arms: &[Arm]) -> Vec<Hold> {
    let minor = |hold: Hold| {
        let major = major(arms);
        (0..arms.len()).map(|i| if major.contains(&i) { Hold::Free } else { hold }).collect()
    };
    match kind {
        NodeKind::Crossing(Control::Signals) => vec![Hold::Light; arms.len()],
        NodeKind::Crossing(Control::AllStop) => vec![Hold::Stop; arms.len()],
        NodeKind::Crossing(Control::MinorStop) => minor(Hold::Stop),
        NodeKind::Crossing(Control::MinorYield) => minor(Hold::Yield),
        NodeKind::Ring => (0..arms.len()).map(|i| if i == 2 { Hold::Yield } else { Hold::Free }).collect(),
        NodeKind::Crossover => vec![Hold::YieldPocket; arms.len()],
        NodeKind::RailCrossing => {
            arms.iter().map(|arm| if arm.is_rail() { Hold::Free } else { Hold::Rail }).collect()
        }
        _ => vec![Hold::Free; arms.len()],
    }
}

/// Whether pedestrians may cross an arm that is held back so.
pub(crate) fn is_walked(kind: NodeKind, hold: Hold) -> bool {
    matches!(kind, NodeKind::Crossing(_) | NodeKind::Ring) && hold != Hold::Free
}

/// What control adds at the end of a street.
#[derive(Debug, Default)]
pub(crate) struct Furniture {
    pub(crate) signals: Vec<Signal>,
    pub(crate) objects: Vec<Object>,
}

/// Puts up the signals or signs of a junction: its controllers, and the lights or signs at each arm.
pub(crate) fn equip(
    ids: &mut Ids,
    built: &mut Built,
    arms: &[Arm],
    holds: &[Hold],
) -> (Vec<Controller>, Vec<Furniture>) {
    let mut all: Vec<Furniture> = Vec::new();
    // Signal ids of each arm: for the left pockets, and for everything else.
    let mut lights: Vec<[Option<String>; 2]> = Vec::new();
    for (index, (arm, hold)) in arms.iter().zip(holds).enumerate() {
        let mut here = Furniture::default();
        let mut own: [Option<String>; 2] = [None, None];
        let entering = arm.entering();
        let pockets = entering.iter().take_while(|t| **t == Turn::Left).count() as u8;
        let uses =
            |m: &Movement, pocket: bool| m.from == index && m.lanes > 0 && (m.from_lane < pockets) == pocket;
        for pocket in [true, false] {
            let wanted = match hold {
                Hold::Free => false,
                Hold::YieldPocket => pocket,
                // Signs hold for all lanes together.
                Hold::Stop | Hold::Yield | Hold::Rail => !pocket,
                Hold::Light => true,
            };
            let meant = |m: &Movement| match hold {
                Hold::Light | Hold::YieldPocket => uses(m, pocket),
                _ => m.from == index && m.lanes > 0,
            };
            if !wanted || !built.movements.iter().any(meant) {
                continue;
            }
            let signal = post(ids, arm, *hold, pocket);
            for (movement, road) in built.movements.iter().zip(&mut built.roads) {
                if meant(movement) {
                    road.signal_references.push(reference(&signal.id, road));
                }
            }
            own[usize::from(!pocket)] = Some(signal.id.clone());
            here.signals.push(signal);
        }
        if hold.has_line() && !here.signals.is_empty() {
            let lanes: Vec<&EndStrip> = runs(&arm.lanes.entering)
                .filter(|s| *hold != Hold::YieldPocket || s.kind == Use::Lane(Turn::Left))
                .collect();
            here.objects.extend(stop_line(ids, arm, &lanes));
        }
        if *hold == Hold::Stop && !here.signals.is_empty() {
            here.objects.extend(stops(ids, arm));
        }
        if matches!(hold, Hold::Light | Hold::Stop | Hold::Yield) && entering.len() > 1 {
            here.objects.extend(arrows(ids, arms, index, &built.movements));
        }
        all.push(here);
        lights.push(if *hold == Hold::Light { own } else { [None, None] });
    }
    let controllers = controllers(ids, arms, &lights, built);
    for (sequence, controller) in (0..).zip(&controllers) {
        built.junction.controllers.push(JunctionController {
            id: controller.id.clone(),
            sequence: Some(sequence),
            ..JunctionController::default()
        });
    }
    (controllers, all)
}

/// A traffic light or sign beside the entering traffic: right of it, or for a pocket on the median. It names
/// no lane of its own road: the references on the connecting roads say what it controls.
fn post(ids: &mut Ids, arm: &Arm, hold: Hold, pocket: bool) -> Signal {
    let [kerb, _] = arm.paved();
    let mut distance_m = POST_FROM_END_M;
    let mut right_m = kerb + POST_FROM_KERB_M;
    if pocket {
        let median =
            arm.lanes.entering.first().filter(|s| {
                matches!(s.kind, Use::Median { raised: true }) && s.width_m >= 0.5 * POST_MEDIAN_M
            });
        match median {
            Some(strip) => right_m = strip.inner_m + 0.5 * strip.width_m,
            // Without a median the two lights stand side by side.
            None => (right_m, distance_m) = (right_m + 0.5, distance_m + 0.6),
        }
    }
    let (s, orientation) = arm.before_end(distance_m);
    let (name, kind, height_m, width_m) = hold.sign();
    let light = hold == Hold::Light;
    Signal {
        id: ids.next(),
        name: name.into(),
        s,
        t: f64::from(arm.sign_in()) * right_m,
        z_offset_m: if light { KERB_M } else { SIGN_AT_M },
        orientation,
        dynamic: light,
        country: "OpenDRIVE".into(),
        kind: kind.into(),
        subtype: "-1".into(),
        height_m: Some(height_m),
        width_m: Some(width_m),
        validity: vec![LaneValidity { from: 0, to: 0 }],
        ..Signal::default()
    }
}

/// Says on a connecting road that a signal controls all its driving lanes.
fn reference(signal: &str, road: &Road) -> SignalReference {
    let driving = road.sections.iter().flat_map(|s| &s.right).filter(|l| l.lane_type.is_drivable());
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
fn stop_line(ids: &mut Ids, arm: &Arm, lanes: &[&EndStrip]) -> Option<Object> {
    let (first, last) = (lanes.first()?, lanes.last()?);
    let (from, to) = (first.inner_m, last.inner_m + last.width_m);
    let (s, orientation) = arm.before_end(STOP_LINE_AT_M);
    Some(Object {
        id: ids.next(),
        name: "StopLine".into(),
        kind: "roadMark".into(),
        s,
        t: f64::from(arm.sign_in()) * 0.5 * (from + to),
        // Its length runs across the street.
        hdg_rad: FRAC_PI_2,
        orientation,
        length_m: Some(to - from),
        width_m: Some(STOP_LINE_M),
        outlines: vec![rectangle(0.5 * (to - from), 0.5 * STOP_LINE_M)],
        ..Object::default()
    })
}

/// Phases: for each pair of facing arms one for everything but the left pockets, then one for the left
/// pockets of both; the same for each arm that is left. Turns to the left without a pocket are green together
/// with the oncoming traffic and yield to it. Where the turns to the left of two arms would cut each other,
/// they never are green together.
fn controllers(
    ids: &mut Ids,
    arms: &[Arm],
    lights: &[[Option<String>; 2]],
    built: &Built,
) -> Vec<Controller> {
    let mut controllers: Vec<Controller> = Vec::new();
    for (first, partner) in pairs(arms) {
        let of = |group: usize, arm: usize| lights.get(arm).and_then(|l| l[group].clone());
        let phases: Vec<Vec<Option<String>>> = match partner {
            // An arm that nothing faces has no oncoming traffic: its pockets are green with the rest of it.
            None => vec![vec![of(1, first), of(0, first)]],
            Some(partner) => {
                let cut = lefts_cut(arms, built, first, partner);
                let pocket = |arm| of(0, arm).is_some();
                match (cut, pocket(first) || pocket(partner)) {
                    (false, _) => {
                        vec![vec![of(1, first), of(1, partner)], vec![of(0, first), of(0, partner)]]
                    }
                    (true, true) if pocket(first) && pocket(partner) => {
                        vec![vec![of(1, first), of(1, partner)], vec![of(0, first)], vec![of(0, partner)]]
                    }
                    (true, _) => vec![vec![of(1, first), of(0, first)], vec![of(1, partner), of(0, partner)]],
                }
            }
        };
        let phases = phases.into_iter().map(|phase| phase.into_iter().flatten().collect::<Vec<String>>());
        for signals in phases.filter(|signals| !signals.is_empty()) {
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
    }
    controllers
}

/// Whether some turn to the left of one arm cuts one of another's.
fn lefts_cut(arms: &[Arm], built: &Built, a: usize, b: usize) -> bool {
    let lefts = |arm: usize| -> Vec<Vec<[f64; 2]>> {
        let turns = built
            .movements
            .iter()
            .zip(&built.roads)
            .filter(|(m, _)| m.from == arm && m.lanes > 0 && arms[arm].turn_to(&arms[m.to]) > LEFT_RAD);
        turns
            .flat_map(|(m, road)| tracks(road, arms[arm].shape.entering(arms[arm].contact).lane_m, m.lanes))
            .collect()
    };
    let (of_a, of_b) = (lefts(a), lefts(b));
    of_a.iter().any(|a| of_b.iter().any(|b| cut(a, b)))
}

/// The middles of a connecting road's lanes, as chains of points.
fn tracks(road: &Road, lane_m: f64, lanes: u8) -> Vec<Vec<[f64; 2]>> {
    let path = Path::of(road);
    (0..lanes)
        .map(|k| {
            let right_m = (f64::from(k) + 0.5) * lane_m;
            let at = |i: u32| {
                let p = path.pose_at(path.length_m * f64::from(i) / 40.0).moved(0.0, -right_m);
                [p.x_m, p.y_m]
            };
            (0..=40).map(at).collect()
        })
        .collect()
}

/// Whether two chains of points cut one another.
fn cut(a: &[[f64; 2]], b: &[[f64; 2]]) -> bool {
    let side = |p: &[[f64; 2]], r: [f64; 2]| {
        (p[1][0] - p[0][0]) * (r[1] - p[0][1]) - (p[1][1] - p[0][1]) * (r[0] - p[0][0])
    };
    let split = |p: &[[f64; 2]], q: &[[f64; 2]]| side(p, q[0]) * side(p, q[1]) < 0.0;
    a.windows(2).any(|p| b.windows(2).any(|q| split(p, q) && split(q, p)))
}
