//! What of a fixed object stands in the way of somebody who walks.
//!
//! Boxes of lights, signs, lamps and other poles are those of the housing, the board, the whole lamp, the
//! pole with its arms; on the ground stands a pole. A tree's box is its crown's; on the ground stands a
//! trunk.

use frames::math::sin_cos;
use frames::{Pose, World};

use crate::tables::ActorRow;
use crate::{ActorKind, ActorRole, Tag};

/// Nothing lower than this over the ground is in the way, and nothing higher than [`WALKING_HEIGHT_M`],
/// metres.
pub const WALKING_HEIGHT_M: f64 = 1.9;
/// Half width of a traffic light's foot, metres.
const LIGHT_FOOT_M: f64 = 0.17;
/// Distance of a traffic light's pole behind the housing, metres.
const LIGHT_BEHIND_M: f64 = 0.07;
/// Radius of a sign's pole, metres.
const SIGN_POLE_M: f64 = 0.03;
/// Half width of a street lamp's foot as a part of the lamp's width, and the most it is, metres.
const LAMP_FOOT: (f64, f64) = (0.393, 0.14);
/// Half width of the foot of any other pole, metres.
const POLE_FOOT_M: f64 = 0.2;

/// How a traffic light is held, as the variant of its row says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightMount {
    /// Bottom of the housing over the ground at the pole, metres (0..=40.95).
    pub height_m: f32,
    /// Distance from the pole to the housing along the arm, metres (0..=25.5); 0: on the pole itself.
    pub arm_m: f32,
    /// Whether the pole stands at the right of the traffic that looks at the light.
    pub pole_right: bool,
    /// Whether it hangs on something else's pole and has none of its own.
    pub hangs: bool,
}

impl LightMount {
    /// The variant that says it: whole centimetres of height, whole decimetres of arm.
    #[must_use]
    pub fn to_variant(self) -> u32 {
        let height = (self.height_m * 100.0).round().clamp(0.0, 4095.0) as u32;
        let arm = (self.arm_m * 10.0).round().clamp(0.0, 255.0) as u32;
        height | arm << 12 | u32::from(self.pole_right) << 20 | u32::from(self.hangs) << 21
    }

    /// What a variant says.
    #[must_use]
    pub fn from_variant(variant: u32) -> Self {
        Self {
            height_m: (variant & 0xfff) as f32 / 100.0,
            arm_m: (variant >> 12 & 0xff) as f32 / 10.0,
            pole_right: variant >> 20 & 1 == 1,
            hangs: variant >> 21 & 1 == 1,
        }
    }
}

/// An upright box in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Its middle in plan, and the ground it stands on, metres.
    pub xyz_m: [f64; 3],
    /// Direction of its first half extent, radians from east.
    pub yaw_rad: f64,
    /// Half extents along and across, metres.
    pub half_m: [f64; 2],
    /// Height, metres.
    pub height_m: f64,
}

/// Lower things lie flat: people step on them, metres.
const FLAT_M: f64 = 0.06;

/// Whether something is ground to walk on: a surface, paving, or what lies flat.
fn is_ground(actor: &ActorRow) -> bool {
    let is_paving = actor.semantic_tags == [Tag::Sidewalk as u8];
    actor.kind == ActorKind::Surface
        || actor.kind == ActorKind::Prop && (is_paving || actor.height_m < FLAT_M)
}

/// What of a fixed object is in the way at walking height; none for what is ground itself or hangs on
/// another thing.
#[must_use]
pub fn footprint(actor: &ActorRow) -> Option<Footprint> {
    if is_ground(actor) {
        return None;
    }
    let pose = Pose::<World, frames::Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
    let yaw_rad = pose.yaw();
    let half = [0.5 * actor.length_m, 0.5 * actor.width_m];
    let family = actor.model.split('.').next().unwrap_or_default();
    // Where the box's middle is in the object's frame, how far below its origin the ground is, and how wide
    // it is.
    let (at, below_m, half_m) = match actor.kind {
        ActorKind::TrafficLight => {
            let mount = LightMount::from_variant(actor.variant);
            if mount.hangs {
                return None;
            }
            let side = if mount.pole_right { 1.0 } else { -1.0 } * f64::from(mount.arm_m);
            ([-half[0] - LIGHT_BEHIND_M, side], f64::from(mount.height_m), [LIGHT_FOOT_M; 2])
        }
        // Signs before hazards stand on the ground.
        ActorKind::Sign if actor.role == ActorRole::Hazard => ([0.0; 2], 0.0, half),
        ActorKind::Sign => ([-half[0], 0.0], f64::from(actor.variant & 0xfff) / 100.0, [SIGN_POLE_M; 2]),
        ActorKind::Pole if actor.model == "pole.lamp" => {
            let (share, most_m) = LAMP_FOOT;
            let foot_m = (share * actor.width_m).min(most_m);
            ([-half[0] + foot_m, 0.0], 0.0, [foot_m; 2])
        }
        ActorKind::Pole if actor.model == "pole.wires" => return None,
        // Others stand in the middle of their boxes; arms and flags are overhead.
        ActorKind::Pole => ([0.0; 2], 0.0, half.map(|half| half.min(POLE_FOOT_M))),
        ActorKind::Vegetation if family == "tree" => {
            // The stem's radius at its foot, and how crooked it is below walking height.
            let radius = 1.25 * (0.012 * actor.height_m + 0.025) + 0.1;
            ([0.0; 2], 0.0, [radius.min(half[0]), radius.min(half[1])])
        }
        ActorKind::Surface
        | ActorKind::Vehicle
        | ActorKind::Walker
        | ActorKind::Rsu
        | ActorKind::Prop
        | ActorKind::Parked
        | ActorKind::Building
        | ActorKind::Vegetation => ([0.0; 2], 0.0, half),
    };
    let (sin, cos) = sin_cos(yaw_rad);
    let [x, y, z] = actor.xyz_m;
    Some(Footprint {
        xyz_m: [x + at[0] * cos - at[1] * sin, y + at[0] * sin + at[1] * cos, z - below_m],
        yaw_rad,
        half_m,
        height_m: actor.height_m + below_m,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_stands_where_its_arm_ends() {
        // It looks west from (10, 5); the pole is at the right of those who see it, 4 m to the south.
        let mount = LightMount { height_m: 5.2, arm_m: 4.0, pole_right: true, hangs: false };
        let actor = ActorRow {
            kind: ActorKind::TrafficLight,
            model: "light.signal".into(),
            length_m: 0.36,
            width_m: 0.42,
            height_m: 1.1,
            xyz_m: [10.0, 5.0, 8.2],
            quaternion: [0.0, 0.0, 0.0, 1.0],
            variant: mount.to_variant(),
            ..ActorRow::default()
        };
        assert_eq!(LightMount::from_variant(actor.variant), mount);
        let found = footprint(&actor).expect("a pole");
        let want = [10.25, 1.0, 3.0];
        assert!(found.xyz_m.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        assert!(found.half_m == [0.17; 2] && (found.height_m - 6.3).abs() < 1e-6);
        assert_eq!(footprint(&ActorRow { kind: ActorKind::Surface, ..ActorRow::default() }), None);
        let hangs = LightMount { hangs: true, ..mount };
        assert_eq!(LightMount::from_variant(hangs.to_variant()), hangs);
        assert_eq!(footprint(&ActorRow { variant: hangs.to_variant(), ..actor }), None);
    }
}
