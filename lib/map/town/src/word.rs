//! What is written on lanes: STOP before the lines of stop signs, and bicycles where their lanes begin.

use std::f64::consts::PI;

use opendrive::{Object, Orientation};

use crate::arm::{Arm, runs};
use crate::ids::Ids;
use crate::section::{EndStrip, Use};
use crate::strips::Strips;

/// Length of a word along its lane, metres, and its middle before the end of its street: 1.6 m before the
/// stop line, behind arrows.
const WORD_M: f64 = 2.8;
const MIDDLE_M: f64 = 3.6;
/// Streets shorter than this have none, metres.
const SHORTEST_M: f64 = 15.0;
/// Length and width of a bicycle, and how far behind a junction it is, metres.
const BICYCLE_M: [f64; 2] = [1.9, 1.1];
const BEHIND_M: f64 = 14.0;

/// What is read on a lane, at a place along its road, for the traffic in or against the direction of s.
fn symbol(ids: &mut Ids, name: &str, s: f64, t: f64, along: bool, [length_m, width_m]: [f64; 2]) -> Object {
    Object {
        id: ids.next(),
        name: name.into(),
        kind: "roadMark".into(),
        s,
        t,
        hdg_rad: if along { 0.0 } else { PI },
        orientation: if along { Orientation::Along } else { Orientation::Against },
        length_m: Some(length_m),
        width_m: Some(width_m),
        ..Object::default()
    }
}

/// The word on each entering lane of an arm with a stop sign.
pub(crate) fn stops(ids: &mut Ids, arm: &Arm) -> Vec<Object> {
    if arm.length_m < SHORTEST_M || arm.is_rail() {
        return Vec::new();
    }
    let (s, orientation) = arm.before_end(MIDDLE_M);
    let word = |strip: &EndStrip| {
        let t = f64::from(arm.sign_in()) * (strip.inner_m + 0.5 * strip.width_m);
        symbol(ids, "STOP", s, t, orientation == Orientation::Along, [WORD_M, 0.6 * strip.width_m])
    };
    runs(&arm.lanes.entering).map(word).collect()
}

/// A bicycle where each lane for bicycles of a street begins, as cyclists see it who come from there.
pub(crate) fn bicycles(ids: &mut Ids, strips: &Strips) -> Vec<Object> {
    let mut objects = Vec::new();
    for right in [false, true] {
        let side = if right { &strips.right } else { &strips.left };
        for (index, strip) in side.iter().enumerate() {
            for (from, to, _) in strip.spans.iter().filter(|span| span.2 == Use::Bike) {
                if to - from < 2.0 * BEHIND_M {
                    continue;
                }
                let s = if right { from + BEHIND_M } else { to - BEHIND_M };
                objects.push(symbol(ids, "Bicycle", s, strips.centre_t(right, index, s), right, BICYCLE_M));
            }
        }
    }
    objects
}
