//! One thing that stands in a hazard.

use frames::math::{sin_cos, tan};
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use opendrive::LanePoint;
use schema::models::{BaseType, Model};
use schema::tables::ActorRow;
use schema::works::Item;
use schema::{ActorKind, ActorRole, Attribute, Attributes, ObjectId, Tag, lights};

use crate::scene::free_space::Footprint;
use crate::scene::rows::{Snapshot, tags};

/// Colour of what has no colour of its own (sRGB).
const PLAIN: [u8; 3] = [150, 135, 110];

/// Something that stands in a hazard.
#[derive(Clone, Debug)]
pub(crate) struct Thing {
    /// Number of its hazard.
    hazard: u32,
    kind: ActorKind,
    model: &'static str,
    tags: Vec<u8>,
    pub(crate) size_m: [f64; 3],
    color: [u8; 3],
    pub(crate) point: Point3<f64>,
    rpy_rad: [f64; 3],
    facts: Attributes,
    /// How far its doors stand open.
    doors: [f32; 4],
    /// Lamps that burn whatever the weather.
    lamps: u32,
    /// Whether a car that hits it is stopped by it.
    pub(crate) solid: bool,
}

/// A place to stand.
pub(super) struct Spot {
    point: Point3<f64>,
    rpy_rad: [f64; 3],
}

impl Spot {
    /// On a lane, turned and pushed aside (in the world's plane), level with the road as far as that is flat.
    pub(super) fn new(place: &LanePoint, turn_rad: f64, push_m: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(turn_rad);
        let pitch = place.pitch_rad * cos - place.roll_rad * sin;
        let roll = place.roll_rad * cos + place.pitch_rad * sin;
        let [x, y] = push_m;
        let (sin, cos) = sin_cos(place.heading_rad);
        let (ahead, left) = (x * cos + y * sin, y * cos - x * sin);
        let up = left * tan(place.roll_rad) - ahead * tan(place.pitch_rad);
        Self {
            point: place.position + Vector3::new(x, y, up),
            rpy_rad: [roll, pitch, frames::wrap_pi(place.heading_rad + turn_rad)],
        }
    }

    /// Upright at a place of the ground.
    pub(super) fn upright(point: Point3<f64>, yaw_rad: f64) -> Self {
        Self { point, rpy_rad: [0.0, 0.0, frames::wrap_pi(yaw_rad)] }
    }
}

impl Thing {
    fn new(kind: ActorKind, (model, size_m): Item, at: &Spot) -> Self {
        Self {
            hazard: 0,
            kind,
            model,
            tags: vec![Tag::Static as u8],
            size_m,
            color: PLAIN,
            point: at.point,
            rpy_rad: at.rpy_rad,
            facts: Attributes::new().with(Attribute::BaseType, kind).with(Attribute::SpecialType, ""),
            doors: [0.0; 4],
            lamps: 0,
            solid: true,
        }
    }

    pub(super) fn of_model(kind: ActorKind, model: &'static Model, color: [u8; 3], at: &Spot) -> Self {
        Self {
            tags: tags(model.base),
            color,
            facts: model.facts(),
            solid: model.base != BaseType::Cone,
            ..Self::new(kind, (model.name, model.size_m), at)
        }
    }

    /// A vehicle; those of police, ambulance and fire brigade flash.
    pub(super) fn vehicle(model: &'static Model, color: [u8; 3], doors: [f32; 4], at: &Spot) -> Self {
        let lamps = if model.special == "emergency" { lights::EMERGENCY } else { 0 };
        Self { doors, lamps, ..Self::of_model(ActorKind::Vehicle, model, color, at) }
    }

    /// A thing of road works without a class.
    pub(super) fn item(item: Item, at: &Spot) -> Self {
        Self::new(ActorKind::Prop, item, at)
    }

    /// A warning sign.
    pub(super) fn sign(sign: Item, at: &Spot) -> Self {
        Self {
            tags: vec![Tag::TrafficSign as u8],
            facts: Attributes::new(),
            solid: false,
            ..Self::new(ActorKind::Sign, sign, at)
        }
    }

    pub(super) fn of_hazard(self, hazard: u32) -> Self {
        Self { hazard, ..self }
    }

    pub(crate) fn yaw_rad(&self) -> f64 {
        self.rpy_rad[2]
    }

    pub(super) fn footprint(&self) -> Footprint {
        (self.point, self.yaw_rad(), self.size_m)
    }

    /// Whether drivers have to mind it: signs stand beside the lanes.
    pub(crate) fn is_on_lane(&self) -> bool {
        self.kind != ActorKind::Sign
    }

    fn pose(&self) -> Pose<World, Object> {
        Pose::from_xyz_rpy(self.point.into(), self.rpy_rad)
    }

    pub(crate) fn actor(&self, id: ObjectId) -> ActorRow {
        let pose = self.pose();
        ActorRow {
            id,
            kind: self.kind,
            model: self.model.into(),
            role: ActorRole::Hazard,
            semantic_tags: self.tags.clone(),
            length_m: self.size_m[0],
            width_m: self.size_m[1],
            height_m: self.size_m[2],
            color: self.color.to_vec(),
            fixed: !self.has_states(),
            xyz_m: pose.xyz(),
            quaternion: pose.wxyz(),
            attributes: self.facts.clone().with(Attribute::Hazard, self.hazard),
            ..ActorRow::default()
        }
    }

    /// Whether its state is logged at every frame: vehicles stand, but their lamps and doors are seen.
    pub(crate) fn has_states(&self) -> bool {
        self.kind == ActorKind::Vehicle
    }

    /// What is seen of a vehicle, given the lamps that the weather asks for.
    pub(crate) fn snapshot(&self, id: ObjectId, weather_lamps: u32) -> Snapshot {
        let pose = self.pose();
        Snapshot {
            id,
            world_from_object: pose,
            world_from_object_before: pose,
            steer_rad: 0.0,
            phase_rad: 0.0,
            lights: self.lamps | weather_lamps,
            door_rad: self.doors,
            dormant: false,
        }
    }
}
