//! How the bodies of vehicles lean on their springs: forward when they brake, outward in curves. Wheels stay on the road.

use actors::{Joint, Piece};
use frames::math::f32::{atan2, sin_cos};
use frames::{Object, Pose, World};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use schema::FRAME_PERIOD_S;
use schema::tables::StateRow;

/// Bodies answer to the mean acceleration of so many frames: as far apart are the states that it follows from.
pub const LEAN_FRAMES: i64 = 16;
/// How far a body pitches and rolls, radians for 1 m/s2: 2.5 and 5 degrees for the acceleration of gravity, usual for cars.
const PITCH: f32 = 0.0045;
const ROLL: f32 = 0.0089;
/// It never leans farther than this, radians: 2 degrees.
const MOST_RAD: f32 = 0.035;
/// No part of it goes farther than this from where it is at rest, metres.
const MOST_M: f32 = 0.03;
/// Neither axis of leaning lets it reach over the box that it has at rest by more than this, metres.
const OVER_M: f32 = 0.016;
/// Height of the axes about which it leans, metres.
const AXIS_M: f32 = 0.5;
/// Tries for the greatest angle.
const STEPS: i32 = 28;

/// Roll and pitch, radians, as rotations about x (ahead) and y (to the left).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lean {
    pub(crate) roll_rad: f32,
    pub(crate) pitch_rad: f32,
}

impl Lean {
    /// The greatest angles to either side for a vehicle of these pieces; nothing leans that has fewer than three wheels or none.
    pub(crate) fn most(pieces: &[Piece]) -> Self {
        let is_wheel = |piece: &&Piece| matches!(piece.joint, Joint::Wheel { .. });
        if pieces.iter().filter(is_wheel).count() < 3 {
            return Self::default();
        }
        let fixed = pieces.iter().filter(|piece| piece.joint == Joint::Fixed);
        let body: Vec<Vec3> = fixed.flat_map(|piece| piece.mesh.positions.iter().copied()).collect();
        let most = |of: &dyn Fn(f32) -> Self| {
            let fits = |angle: &f32| of(*angle).keeps(&body) && of(-angle).keeps(&body);
            let angle = |step: i32| MOST_RAD * step as f32 / STEPS as f32;
            (1..=STEPS).map(angle).take_while(fits).last().unwrap_or(0.0)
        };
        Self {
            roll_rad: most(&|roll_rad| Self { roll_rad, pitch_rad: 0.0 }),
            pitch_rad: most(&|pitch_rad| Self { roll_rad: 0.0, pitch_rad }),
        }
    }

    /// That of a vehicle in a state, [`LEAN_FRAMES`] after an earlier one.
    pub(crate) fn of(most: Self, state: &StateRow, earlier: &StateRow) -> Self {
        if most == Self::default() {
            return most;
        }
        let [now, then] = [state, earlier].map(|state| {
            let pose = Pose::<World, Object>::from_xyz_wxyz(state.xyz_m, state.quaternion);
            let ahead = pose.forward();
            let ahead = Vec3::new(ahead.x as f32, ahead.y as f32, ahead.z as f32);
            (ahead, ahead.dot(Vec3::from_array(state.velocity_mps)))
        });
        let over_s = LEAN_FRAMES as f32 * FRAME_PERIOD_S as f32;
        let turned = atan2(then.0.x * now.0.y - then.0.y * now.0.x, then.0.truncate().dot(now.0.truncate()));
        let (forward, left) = ((now.1 - then.1) / over_s, 0.5 * (now.1 + then.1) * turned / over_s);
        let within = |angle: f32, most: f32| if angle.is_finite() { angle.clamp(-most, most) } else { 0.0 };
        Self {
            roll_rad: within(ROLL * left, most.roll_rad),
            pitch_rad: within(-PITCH * forward, most.pitch_rad),
        }
    }

    /// Takes points of the body at rest to where they are, object frame.
    pub(crate) fn object_from_rest(self) -> Affine3A {
        if self == Self::default() {
            return Affine3A::IDENTITY;
        }
        let ((sr, cr), (sp, cp)) = (sin_cos(self.roll_rad), sin_cos(self.pitch_rad));
        let about_x = Mat3A::from_cols(Vec3A::X, Vec3A::new(0.0, cr, sr), Vec3A::new(0.0, -sr, cr));
        let about_y = Mat3A::from_cols(Vec3A::new(cp, 0.0, -sp), Vec3A::Y, Vec3A::new(sp, 0.0, cp));
        let matrix3 = about_y * about_x;
        let axis = Vec3A::Z * AXIS_M;
        Affine3A { matrix3, translation: axis - matrix3 * axis }
    }

    /// Whether a body goes no farther than it may.
    fn keeps(self, body: &[Vec3]) -> bool {
        let bounds = frames::Aabb::from_points(body);
        let pose = self.object_from_rest();
        body.iter().all(|at| {
            let to = pose.transform_point3(*at);
            let over = (to - bounds.max).max(bounds.min - to);
            (to - *at).length() <= MOST_M && over.x.max(over.y).max(over.z) <= OVER_M && to.z >= 0.0
        })
    }
}
