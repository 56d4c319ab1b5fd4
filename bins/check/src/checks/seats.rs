//! People on benches.

use std::collections::BTreeSet;

use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{Actor, Scene, State};
use crate::space::{norm, within};

/// The model of benches, as stores name it.
const BENCH: &str = "prop.bench";
/// Height of the seat, as a share of the bench's.
const SEAT: f64 = 0.50;
/// The front of the back rest is so far before the bench's rear end, metres.
const REST_M: f64 = 0.09;
/// Where people sit, as shares of the bench's width from its middle to the left.
const PLACES: [f64; 2] = [0.22, -0.22];

/// How far the rear of a box may be from the back rest, m: it follows the pose, the place does not.
const BACK_M: f64 = 0.05;
/// How far the middle of a box may be from its place, and the height of the seat from the bench's, m.
const PLACE_M: f64 = 0.01;
/// The greatest angle between a sitting person and the bench, rad, and the greatest velocity of the person,
/// m/s.
const TURN_RAD: f64 = 1e-3;
const STILL_MPS: f64 = 1e-3;

/// Checks that people who sit are on a bench.
pub(crate) fn check(scene: &Scene, ledger: &mut Ledger) {
    let benches: Vec<(u16, &Actor)> = scene
        .actors
        .iter()
        .filter(|(_, actor)| actor.fixed && actor.model == BENCH)
        .map(|(&id, actor)| (id, actor))
        .collect();
    for frame in 0..i64::from(scene.frames) {
        let mut taken = BTreeSet::new();
        let mut sitters: Vec<(u16, &State)> = scene.moving(frame).filter(|(_, s)| s.seat_m > 0.0).collect();
        sitters.sort_unstable_by_key(|(id, _)| *id);
        for (id, state) in sitters {
            let walks = scene.actors.get(&id).is_some_and(|actor| actor.role == "walker");
            ledger.expect(Rule::Seats, walks && within(norm(state.velocity_mps), STILL_MPS), || {
                format!("frame {frame}: object {id} sits and is no walker, or moves")
            });
            let place = benches.iter().find_map(|(bench, actor)| Some((*bench, place_on(actor, state)?)));
            ledger.expect(Rule::Seats, place.is_some(), || {
                format!("frame {frame}: object {id} sits, but on no bench")
            });
            ledger.expect(Rule::Seats, place.is_none_or(|place| taken.insert(place)), || {
                format!("frame {frame}: object {id} sits where somebody else does")
            });
        }
    }
}

/// The place of a bench that somebody sits on.
fn place_on(bench: &Actor, state: &State) -> Option<usize> {
    let [length, width, height] = bench.size_m;
    let pose = &state.world_from_object;
    let at = bench.world_from_object.inward(pose.origin);
    let back = at[0] - 0.5 * state.size_m[0] - (REST_M - 0.5 * length);
    let seat = at[2] + state.seat_m - SEAT * height;
    let leans = within(back, BACK_M) && within(seat, PLACE_M);
    let turned = within(pose.turned_from(&bench.world_from_object), TURN_RAD);
    let place = PLACES.iter().position(|left| within(at[1] - left * width, PLACE_M));
    place.filter(|_| leans && turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Motion;
    use serde_json::Value;

    #[test]
    fn places_are_those_before_the_back_rest() {
        let bench = Actor {
            model: "prop.bench".into(),
            role: "scenery".into(),
            tags: vec![20],
            size_m: [0.55, 1.7, 0.85],
            fixed: true,
            world_from_object: Motion::of_angles([10.0, 5.0, 2.0], [0.0, 0.0, 0.5]),
            attributes: Value::Null,
        };
        let sits = |ahead: f64, left: f64, yaw: f64, seat_m: f64| {
            let origin = bench.world_from_object.outward([ahead, left, 0.0]);
            let world_from_object = Motion::of_angles(origin, [0.0, 0.0, yaw]);
            let state = State {
                world_from_object,
                velocity_mps: [0.0; 3],
                turning_radps: [0.0; 3],
                size_m: [0.7, 0.5, 1.3],
                seat_m,
                open_door: false,
            };
            place_on(&bench, &state)
        };
        // The rear of a box of 0.7 at 0.185 behind the middle.
        assert_eq!(sits(0.165, 0.374, 0.5, 0.425), Some(0));
        assert_eq!(sits(0.205, -0.374, 0.5, 0.425), Some(1));
        let off = [
            sits(0.265, 0.374, 0.5, 0.425),
            sits(0.165, 0.0, 0.5, 0.425),
            sits(0.165, 0.374, -0.5, 0.425),
            sits(0.165, 0.374, 0.5, 0.5),
        ];
        assert_eq!(off, [None; 4]);
    }
}
