//! Where bodies are between two frames.

use glam::{Affine3A, Mat3A, Quat, Vec3};

/// The pose of a body at a moment between the previous frame's and this one's: `before` is 0 at this frame
/// and 1 at the previous one. Its origin goes straight at one speed; it turns evenly about one axis, by less
/// than half a turn.
///
/// Exactly `now` at 0, for what does not move and for what came from nowhere (a pose that is not finite).
/// Every renderer places instances by it.
///
/// ```
/// use glam::{Affine3A, Vec3};
///
/// let at = |x: f32, yaw: f32| Affine3A::from_translation(Vec3::X * x) * Affine3A::from_rotation_z(yaw);
/// let pose = render::pose_before(&at(1.0, 0.1), &at(3.0, 0.5), 0.25);
/// assert!((pose.transform_point3(Vec3::ZERO) - Vec3::X * 2.5).length() < 1e-6);
/// assert!((pose.transform_vector3(Vec3::X) - at(0.0, 0.4).transform_vector3(Vec3::X)).length() < 1e-6);
/// ```
#[must_use]
pub fn pose_before(previous: &Affine3A, now: &Affine3A, before: f32) -> Affine3A {
    if before == 0.0 || previous == now || !previous.is_finite() {
        return *now;
    }
    let translation = now.translation + (previous.translation - now.translation) * before;
    let matrix3 = if previous.matrix3 == now.matrix3 {
        now.matrix3
    } else {
        let turn = Quat::from_mat3a(&(previous.matrix3 * now.matrix3.transpose()));
        Mat3A::from_quat(part_of(turn, before)) * now.matrix3
    };
    Affine3A { matrix3, translation }
}

/// A part of a rotation, the shorter way round.
fn part_of(turn: Quat, share: f32) -> Quat {
    use frames::math::f32::{atan2, sin_cos};
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let way = Vec3::new(turn.x, turn.y, turn.z);
    let sine = way.length();
    let (sin, cos) = sin_cos(share * atan2(sine, turn.w));
    let axis = if sine > 0.0 { way / sine } else { Vec3::ZERO };
    Quat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}
