//! Rows of the scene log.

use frames::{Object, Pose, World};
use nalgebra::Vector3;
use schema::lights;
use schema::models::Model;
use schema::tables::{ActorRow, PlanAgentRow, StateRow, Weather};
use schema::{FRAME_PERIOD_S, ObjectId};

use crate::change::Shift;
use crate::net::Net;
use crate::sides::Side;
use crate::spawn::{Start, tags};
use crate::vehicles::Vehicle;
use crate::walkers::Walker;

/// Braking above this lights the brake lamps, m/s2.
const BRAKE_LAMP_MPS2: f64 = 1.0;
/// Blinkers go on this far before a junction, metres.
const BLINK_M: f64 = 15.0;
/// Size of an RSU's body, metres.
const RSU_SIZE_M: [f64; 3] = [0.3, 0.3, 3.4];

/// A JSON object of strings; keys and values are plain words.
pub(crate) fn attributes(pairs: &[(&str, &str)]) -> String {
    let members: Vec<String> = pairs.iter().map(|(key, value)| format!("\"{key}\":\"{value}\"")).collect();
    format!("{{{}}}", members.join(","))
}

fn moving(
    id: ObjectId,
    kind: &str,
    role: &str,
    model: &Model,
    color: &[u8],
    pose: &Pose<World, Object>,
) -> ActorRow {
    ActorRow {
        id,
        kind: kind.into(),
        model: model.name.into(),
        role: role.into(),
        semantic_tags: tags(model.base),
        length_m: model.size_m[0],
        width_m: model.size_m[1],
        height_m: model.size_m[2],
        color: color.to_vec(),
        fixed: false,
        xyz_m: pose.xyz(),
        quaternion: pose.wxyz(),
        variant: 0,
        parent: None,
        opendrive_id: None,
        attributes: String::new(),
    }
}

pub(crate) fn vehicle_actor(id: ObjectId, start: &Start) -> ActorRow {
    let pose = Pose::from_xyz_rpy(start.point.coords.into(), [0.0, 0.0, start.yaw_rad]);
    let word = |b: bool| if b { "true" } else { "false" };
    let facts = attributes(&[
        ("base_type", start.model.base.name()),
        ("special_type", start.model.special),
        ("reckless", word(start.driver.reckless)),
        ("distracted", word(start.driver.distracted)),
    ]);
    ActorRow { attributes: facts, ..moving(id, "vehicle", &start.role, start.model, &start.color, &pose) }
}

pub(crate) fn walker_actor(id: ObjectId, walker: &Walker, crosses_anywhere: bool) -> ActorRow {
    let pose = Pose::from_xyz_rpy(walker.point.coords.into(), [0.0, 0.0, walker.yaw_rad]);
    let word = |b: bool| if b { "true" } else { "false" };
    let facts = attributes(&[
        ("crosses_anywhere", word(crosses_anywhere)),
        ("use_wheelchair", word(walker.model.special == "wheelchair")),
    ]);
    ActorRow { attributes: facts, ..moving(id, "walker", "walker", walker.model, &walker.color, &pose) }
}

pub(crate) fn rsu_actor(id: ObjectId, agent: &PlanAgentRow) -> ActorRow {
    let pose = Pose::<World, Object>::from_xyz_rpy(agent.xyz_m, agent.rpy_rad);
    ActorRow {
        id,
        kind: "rsu".into(),
        model: agent.model.clone(),
        role: agent.agent.clone(),
        semantic_tags: vec![schema::Tag::Pole as u8],
        length_m: RSU_SIZE_M[0],
        width_m: RSU_SIZE_M[1],
        height_m: RSU_SIZE_M[2],
        color: agent.color.clone(),
        fixed: true,
        xyz_m: pose.xyz(),
        quaternion: pose.wxyz(),
        variant: 0,
        parent: None,
        opendrive_id: agent.signal.clone(),
        attributes: attributes(&[]),
    }
}

/// Lamps that the weather and the time of day ask for.
pub(crate) fn weather_lamps(weather: &Weather) -> u32 {
    let mut lamps = 0;
    if weather.sun_altitude_deg < 35.0 {
        lamps |= lights::POSITION;
    }
    if weather.sun_altitude_deg < 15.0 || weather.precipitation > 80.0 {
        lamps |= lights::POSITION | lights::LOW_BEAM;
    }
    if weather.fog_density > 20.0 {
        lamps |= lights::POSITION | lights::LOW_BEAM | lights::FOG;
    }
    lamps
}

/// Lamps of a vehicle: those of the weather, brake lamps, blinkers before and in junctions, flashing lights.
pub(crate) fn vehicle_lamps(net: &Net, vehicle: &Vehicle, weather: u32, emergency: bool) -> u32 {
    let mut lamps = weather;
    if vehicle.acceleration_mps2 < -BRAKE_LAMP_MPS2 || vehicle.speed_mps < 0.05 {
        lamps |= lights::BRAKE;
    }
    if emergency {
        lamps |= lights::EMERGENCY;
    }
    let side = |side: Side| if side == Side::Left { lights::BLINK_LEFT } else { lights::BLINK_RIGHT };
    let meant = vehicle.shift.as_ref().map(Shift::side).or_else(|| vehicle.means_side(net));
    if let Some(meant) = meant {
        return lamps | side(meant);
    }
    let mut turn = 0;
    for (lane, start) in vehicle.lanes_ahead(net) {
        if start - vehicle.half_length_m() > BLINK_M {
            break;
        }
        turn = net.lanes[lane].turn;
        if net.lanes[lane].junction.is_some() {
            break;
        }
    }
    match turn {
        1 => lamps | lights::BLINK_LEFT,
        -1 => lamps | lights::BLINK_RIGHT,
        _ => lamps,
    }
}

/// State of one object, from its pose now and one step before.
pub(crate) struct Snapshot {
    pub(crate) id: ObjectId,
    pub(crate) world_from_object: Pose<World, Object>,
    pub(crate) world_from_object_before: Pose<World, Object>,
    pub(crate) steer_rad: f64,
    pub(crate) phase_rad: f64,
    pub(crate) lights: u32,
    pub(crate) door_rad: [f32; 4],
}

impl Snapshot {
    pub(crate) fn row(&self, frame: i32) -> StateRow {
        let (now, before) = (&self.world_from_object, &self.world_from_object_before);
        let moved = now.translation() - before.translation();
        let turned = rotation_vector(before, now);
        let rate = |v: Vector3<f64>| <[f64; 3]>::from(v / FRAME_PERIOD_S).map(|r| r as f32);
        StateRow {
            frame,
            id: self.id,
            xyz_m: now.xyz(),
            quaternion: now.wxyz(),
            velocity_mps: rate(moved),
            angular_velocity_radps: rate(turned),
            steer_rad: self.steer_rad as f32,
            phase_rad: self.phase_rad as f32,
            lights: self.lights,
            door_rad: self.door_rad,
        }
    }
}

/// The rotation that turns one orientation into another, as its axis in the world times its angle, radians: the
/// logarithm of the unit quaternion `now * before^-1`, the shorter way round.
fn rotation_vector(before: &Pose<World, Object>, now: &Pose<World, Object>) -> Vector3<f64> {
    let turn = now.isometry().rotation * before.isometry().rotation.inverse();
    let (half_cos, axis) = (turn.w, turn.imag());
    let half_sin = axis.norm();
    let half_angle = frames::math::atan2(half_sin, half_cos.abs());
    let scale = if half_sin > 1e-12 { half_angle / half_sin } else { 1.0 };
    axis * (2.0 * scale.copysign(half_cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use frames::math::{cos, sin, sin_cos};

    /// Rodrigues' formula, column by column.
    fn turned(axis: Vector3<f64>, angle: f64, v: Vector3<f64>) -> Vector3<f64> {
        v * cos(angle) + axis.cross(&v) * sin(angle) + axis * (axis.dot(&v) * (1.0 - cos(angle)))
    }

    #[test]
    fn a_turn_about_any_axis_is_found_again() {
        for (axis, angle) in [
            (Vector3::new(1.0, 0.0, 0.0), 0.002),
            (Vector3::new(0.6, -0.8, 0.0), 0.3),
            (Vector3::new(-0.48, 0.6, 0.64), 3.1),
            (Vector3::new(0.0, 0.0, 1.0), -1e-7),
        ] {
            let before = Pose::<World, Object>::from_xyz_rpy([3.0, 2.0, 1.0], [0.1, -0.2, 2.9]);
            // The turned body's axes, as roll, pitch and yaw: Rz(yaw) Ry(pitch) Rx(roll).
            let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()]
                .map(|body| turned(axis, angle, before.rotate(body)));
            let rpy =
                [frames::math::atan2(y.z, z.z), frames::math::asin(-x.z), frames::math::atan2(x.y, x.x)];
            let now = Pose::from_xyz_rpy([3.0, 2.0, 1.0], rpy);
            let found = rotation_vector(&before, &now);
            assert!((found - axis * angle).norm() < 1e-12, "{found} instead of {}", axis * angle);
        }
        let still = Pose::<World, Object>::from_xyz_rpy([0.0; 3], [0.3, 0.2, -1.0]);
        assert_eq!(rotation_vector(&still, &still), Vector3::zeros());
    }

    #[test]
    fn on_a_ramp_that_winds_up_the_yaw_turns_about_the_vertical() {
        // A helix: roll and pitch stay, so in the world all of the rate is about the vertical.
        let at = |angle: f64| {
            let (y, x) = sin_cos(angle);
            Pose::<World, Object>::from_xyz_rpy([20.0 * x, 20.0 * y, angle], [0.05, -0.1, angle + 1.5])
        };
        let state = Snapshot {
            id: 1,
            world_from_object: at(0.52),
            world_from_object_before: at(0.5),
            steer_rad: 0.0,
            phase_rad: 0.0,
            lights: 0,
            door_rad: [0.0; 4],
        };
        let rate = state.row(0).angular_velocity_radps;
        assert!(rate[0].abs() < 1e-6 && rate[1].abs() < 1e-6 && (rate[2] - 0.4).abs() < 1e-6, "{rate:?}");
    }
}
