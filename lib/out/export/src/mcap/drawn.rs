//! Boxes as things that are drawn: a cube with its name above and an arrow for its motion.

use frames::{Object, Pose as TypedPose, World, math};
use schema::DetectionClass;

use super::messages::{
    ArrowPrimitive, Color, CubePrimitive, Duration, KeyValuePair, Pose, SceneEntity, TextPrimitive, Timestamp,
};

/// Opacity of boxes that sensors saw, and of others.
const SEEN_ALPHA: f64 = 0.5;
const UNSEEN_ALPHA: f64 = 0.12;
/// Slower things have no arrow, m/s.
const ARROW_FROM_MPS: f64 = 0.5;
/// Height of names, m.
const NAME_M: f64 = 0.6;
/// Colour of boxes without a class of ours.
const GREY: [u8; 3] = [160; 3];

/// A box in the world.
pub(crate) struct Drawn<'a> {
    pub(crate) id: u16,
    pub(crate) class: &'a str,
    pub(crate) center_m: [f64; 3],
    pub(crate) size_m: [f64; 3],
    pub(crate) rpy_rad: [f64; 3],
    pub(crate) velocity_mps: [f32; 3],
    /// Whether some sensor saw it; none where that is not known.
    pub(crate) is_seen: Option<bool>,
}

impl Drawn<'_> {
    /// As a thing that is drawn for so many frames.
    pub(crate) fn entity(&self, frame: u32, for_frames: u32, metadata: Vec<KeyValuePair>) -> SceneEntity {
        let rgb = DetectionClass::from_name(self.class).map_or(GREY, DetectionClass::rgb);
        let alpha = if self.is_seen == Some(false) { UNSEEN_ALPHA } else { SEEN_ALPHA };
        let world_from_box: TypedPose<World, Object> = TypedPose::from_xyz_rpy(self.center_m, self.rpy_rad);
        let cube = CubePrimitive {
            pose: Pose::of(&world_from_box),
            size: self.size_m.into(),
            color: Color::of(rgb, alpha),
        };
        let [x, y, z] = self.center_m;
        let above = [x, y, z + 0.5 * self.size_m[2] + NAME_M];
        let name = TextPrimitive {
            pose: Pose::of(&TypedPose::<World, Object>::from_xyz_rpy(above, [0.0; 3])),
            billboard: true,
            font_size: NAME_M,
            color: Color::of(rgb, 1.0),
            text: format!("{} {}", self.class, self.id),
            ..TextPrimitive::default()
        };
        SceneEntity {
            timestamp: Timestamp::at(frame),
            frame_id: "world".into(),
            id: self.id.to_string(),
            lifetime: Duration::of_frames(for_frames),
            metadata,
            cubes: vec![cube],
            arrows: self.arrow(rgb).into_iter().collect(),
            texts: vec![name],
            ..SceneEntity::default()
        }
    }

    /// The way of a second.
    fn arrow(&self, rgb: [u8; 3]) -> Option<ArrowPrimitive> {
        let [vx, vy, vz] = self.velocity_mps.map(f64::from);
        let level = math::hypot(vx, vy);
        let speed = math::hypot(level, vz);
        if speed < ARROW_FROM_MPS {
            return None;
        }
        let along = [0.0, -math::atan2(vz, level), math::atan2(vy, vx)];
        Some(ArrowPrimitive {
            pose: Pose::of(&TypedPose::<World, Object>::from_xyz_rpy(self.center_m, along)),
            shaft_length: speed,
            shaft_diameter: 0.15,
            head_length: 0.5,
            head_diameter: 0.4,
            color: Color::of(rgb, 1.0),
        })
    }
}

/// How fast something is, as text.
pub(crate) fn speed_text(velocity_mps: [f32; 3]) -> String {
    let [x, y, z] = velocity_mps.map(f64::from);
    format!("{:.2}", math::hypot(math::hypot(x, y), z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_that_climbs_to_the_left_has_its_arrow_there() {
        let car = Drawn {
            id: 7,
            class: "car",
            center_m: [1.0, 2.0, 3.0],
            size_m: [4.0, 2.0, 1.5],
            rpy_rad: [0.0, 0.0, std::f64::consts::FRAC_PI_2],
            velocity_mps: [0.0, 3.0, 3.0],
            is_seen: Some(false),
        };
        let entity = car.entity(2, 1, Vec::new());
        assert_eq!((entity.id.as_str(), entity.texts[0].text.as_str()), ("7", "car 7"));
        assert_eq!(entity.texts[0].pose.position.z, 3.0 + 0.75 + NAME_M);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turn = &entity.cubes[0].pose.orientation;
        assert!((turn.w - half).abs() < 1e-12 && (turn.z - half).abs() < 1e-12);
        assert_eq!(entity.cubes[0].color.a, UNSEEN_ALPHA);
        // Along the arrow's x axis: forward turned by its orientation is (0, 1, 1) / sqrt 2.
        let arrow = &entity.arrows[0];
        let q = &arrow.pose.orientation;
        let forward = [
            1.0 - 2.0 * (q.y * q.y + q.z * q.z),
            2.0 * (q.x * q.y + q.w * q.z),
            2.0 * (q.x * q.z - q.w * q.y),
        ];
        assert!(forward.iter().zip([0.0, half, half]).all(|(a, b)| (a - b).abs() < 1e-12), "{forward:?}");
        assert!((arrow.shaft_length - 18.0_f64.sqrt()).abs() < 1e-12);
        let standing = Drawn { velocity_mps: [0.1, 0.0, 0.0], ..car };
        assert!(standing.entity(2, 1, Vec::new()).arrows.is_empty());
    }
}
