//! What rows of the log have in common.

use catalogue::{BaseType, Model};
use frames::{Object, Pose, World};
use nalgebra::Vector3;
use schema::tables::{ActorRow, StateRow};
use schema::{ActorKind, ActorRole, Attributes, FRAME_PERIOD_S, ObjectId, lights};

/// Braking above this lights the brake lamps, m/s2.
const BRAKE_LAMP_MPS2: f64 = 1.0;

/// Lamps of any vehicle, given those of the weather: brake lamps burn while it brakes or stands.
pub(crate) fn actor_lamps(weather: u32, along_mps2: f64, speed_mps: f64) -> u32 {
    let brakes = along_mps2 < -BRAKE_LAMP_MPS2 || speed_mps < 0.05;
    if brakes { weather | lights::BRAKE } else { weather }
}

/// Tags of a model's parts.
pub(crate) fn tags(base: BaseType) -> Vec<u8> {
    base.tags().iter().map(|&t| t as u8).collect()
}

/// The row of a vehicle or a walker of the catalogue.
pub(crate) fn moving(
    id: ObjectId,
    kind: ActorKind,
    role: ActorRole,
    model: &Model,
    color: &[u8],
    pose: &Pose<World, Object>,
    attributes: Attributes,
) -> ActorRow {
    ActorRow {
        id,
        kind,
        model: model.name.into(),
        role,
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
        attributes,
    }
}

/// State of one object, from its pose now and one step before.
pub(crate) struct Snapshot {
    pub(crate) id: ObjectId,
    pub(crate) world_from_object: Pose<World, Object>,
    pub(crate) world_from_object_before: Pose<World, Object>,
    /// Roll and pitch on its springs that are in both poses.
    pub(crate) lean_rad: [f64; 2],
    pub(crate) steer_rad: f64,
    pub(crate) phase_rad: f64,
    /// Height of the seat that a walker sits on, metres; 0 of others.
    pub(crate) seat_m: f64,
    pub(crate) lights: u32,
    pub(crate) door_rad: [f32; 4],
    pub(crate) dormant: bool,
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
            lean_rad: self.lean_rad.map(|angle| angle as f32),
            steer_rad: self.steer_rad as f32,
            phase_rad: self.phase_rad as f32,
            gait_mps: 0.0,
            seat_m: self.seat_m as f32,
            size_m: [0.0; 3],
            lights: self.lights,
            door_rad: self.door_rad,
            dormant: self.dormant,
        }
    }
}

/// The rotation that turns one orientation into another, as its axis in the world times its angle, radians:
/// the logarithm of the unit quaternion `now * before^-1`, the shorter way round.
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
            lean_rad: [0.0; 2],
            steer_rad: 0.0,
            phase_rad: 0.0,
            seat_m: 0.0,
            lights: 0,
            door_rad: [0.0; 4],
            dormant: false,
        };
        let rate = state.row(0).angular_velocity_radps;
        assert!(rate[0].abs() < 1e-6 && rate[1].abs() < 1e-6 && (rate[2] - 0.4).abs() < 1e-6, "{rate:?}");
    }
}
