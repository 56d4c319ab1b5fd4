//! The log against itself and the agents' table.

use schema::FRAME_PERIOD_S;

use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{apart, norm, scale, sub, within};

/// Greatest difference of an agent's pose from the log's, m and rad.
const POSE: f64 = 1e-6;
/// Greatest difference of an agent's velocity from the log's (32 bits there), m/s and rad/s.
const VELOCITY: f64 = 1e-4;
/// Greatest difference of a velocity from the way of a frame, m/s: forces of a step act before or after it.
const WAY_MPS: f64 = 0.5;
/// The same of rates, rad/s.
const TURN_RADPS: f64 = 0.5;

/// Checks poses and velocities of agents and of everything that moves.
pub(crate) fn check(scene: &Scene, ledger: &mut Ledger) {
    for (name, agent) in &scene.agents {
        for (frame, row) in agent.rows.iter().enumerate() {
            let Some(pose) = scene.pose(agent.id, frame as i64) else {
                ledger.off(Rule::Poses, || format!("frame {frame}: the log has no {name}"));
                continue;
            };
            let way = apart(pose.origin, row.world_from_agent.origin);
            let turn = pose.turned_from(&row.world_from_agent);
            ledger.expect(Rule::Poses, within(way, POSE) && within(turn, POSE), || {
                format!("frame {frame}: {name} is {way:.6} m and {turn:.6} rad from where the log has it")
            });
            let (velocity, turning) = scene
                .state(agent.id, frame as i64)
                .map_or(([0.0; 3], [0.0; 3]), |state| (state.velocity_mps, state.turning_radps));
            let off = apart(velocity, row.velocity_mps).max(apart(turning, row.turning_radps));
            ledger.expect(Rule::Poses, within(off, VELOCITY), || {
                format!("frame {frame}: velocity of {name} differs by {off:.6} from the log's")
            });
        }
    }
    for frame in 0..i64::from(scene.frames) {
        for (id, state) in scene.moving(frame) {
            let Some(before) = scene.state(id, frame - 1) else {
                ledger.off(Rule::Poses, || format!("frame {frame}: object {id} comes from nowhere"));
                continue;
            };
            let now = &state.world_from_object;
            let way = scale(sub(now.origin, before.world_from_object.origin), 1.0 / FRAME_PERIOD_S);
            let off = apart(way, state.velocity_mps);
            ledger.expect(Rule::Poses, within(off, WAY_MPS), || {
                format!(
                    "frame {frame}: object {id} ({}) moves {:.2} m/s and says {:.2} m/s",
                    model(scene, id),
                    norm(way),
                    norm(state.velocity_mps)
                )
            });
            let turned = turn_between(&before.world_from_object.rows, &now.rows);
            let rate = scale(turned, 1.0 / FRAME_PERIOD_S);
            let off = apart(rate, state.turning_radps);
            ledger.expect(Rule::Poses, within(off, TURN_RADPS), || {
                format!(
                    "frame {frame}: object {id} ({}) turns {:.2} rad/s and says {:.2} rad/s",
                    model(scene, id),
                    norm(rate),
                    norm(state.turning_radps)
                )
            });
        }
    }
}

fn model(scene: &Scene, id: u16) -> &str {
    scene.actors.get(&id).map_or("", |actor| actor.model.as_str())
}

/// The vector of the rotation that takes one orientation to another, rad, exact for small ones.
fn turn_between(before: &[[f64; 3]; 3], now: &[[f64; 3]; 3]) -> [f64; 3] {
    // now * before^T = 1 + [w]x + ...; the antisymmetric part is sin(angle) axis.
    let entry = |i: usize, j: usize| (0..3).map(|k| now[i][k] * before[j][k]).sum::<f64>();
    let axis = [entry(2, 1) - entry(1, 2), entry(0, 2) - entry(2, 0), entry(1, 0) - entry(0, 1)];
    let sine = 0.5 * norm(axis);
    let angle = libm::atan2(sine, 0.5 * (entry(0, 0) + entry(1, 1) + entry(2, 2) - 1.0));
    if sine > 1e-12 { scale(axis, 0.5 * angle / sine) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Motion;

    #[test]
    fn a_turn_is_found_between_two_orientations() {
        let at = |yaw| Motion::of_angles([0.0; 3], [0.1, -0.2, yaw]).rows;
        let turn = turn_between(&at(0.3), &at(0.35));
        assert!(apart(turn, [0.0, 0.0, 0.05]) < 1e-12, "{turn:?}");
        assert_eq!(turn_between(&at(0.3), &at(0.3)), [0.0; 3]);
    }
}
