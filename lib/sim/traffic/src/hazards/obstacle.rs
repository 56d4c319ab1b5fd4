//! One thing that stands in a hazard.

use catalogue::{Model, Special, roadside, works::Item};
use frames::math::{sin_cos, tan};
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use opendrive::LanePoint;
use schema::tables::ActorRow;
use schema::{ActorKind, ActorRole, Attribute, Attributes, ObjectId, Tag, lights};

use crate::bodies::PERSON_KG;
use crate::scene::free_space::Footprint;
use crate::scene::rows::{Snapshot, tags};
use crate::vehicle::attention::Class;

/// Colour of what has no colour of its own (sRGB).
const PLAIN: [u8; 3] = [150, 135, 110];

/// Cars drive over what is no higher than this, metres.
const UNDER_CARS_M: f64 = 0.15;
/// Mass over volume of the box about vehicles, and about cones, tools, barrels and boards, kg/m3; nothing is
/// lighter than this, kg.
const VEHICLE_KG_M3: f64 = 170.0;
const LIGHT_KG_M3: f64 = 60.0;
const LEAST_KG: f64 = 1.5;
/// Stone fills this share of the box about it, kg/m3.
const STONE_KG_M3: f64 = 0.6 * 2400.0;

/// The mass of a thing, kg.
fn mass_kg(kind: ActorKind, model: &str, size_m: [f64; 3]) -> f64 {
    let volume_m3 = size_m[0] * size_m[1] * size_m[2];
    match (kind, model) {
        (ActorKind::Walker, _) => PERSON_KG,
        (ActorKind::Vehicle, _) => VEHICLE_KG_M3 * volume_m3,
        (_, name) if name == roadside::CONCRETE.name => STONE_KG_M3 * volume_m3,
        (_, "prop.pipe" | "prop.pile" | "prop.stone_ring") => STONE_KG_M3 * volume_m3,
        (_, name) if name.starts_with("prop.concrete") => STONE_KG_M3 * volume_m3,
        (_, "prop.iron_plank" | "prop.construction_light") => 200.0 * volume_m3.max(1.0),
        _ => (LIGHT_KG_M3 * volume_m3).max(LEAST_KG),
    }
}

/// Something that stands in a hazard.
#[derive(Clone, Debug)]
pub(crate) struct Obstacle {
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
    /// Whether vehicles hit it: they drive over what is low, and signs stand beside the road.
    pub(crate) solid: bool,
    /// What there is to push away, kg.
    pub(crate) mass_kg: f64,
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

impl Obstacle {
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
            solid: size_m[2] > UNDER_CARS_M,
            mass_kg: mass_kg(kind, model, size_m),
        }
    }

    pub(super) fn of_model(kind: ActorKind, model: &'static Model, color: [u8; 3], at: &Spot) -> Self {
        Self {
            tags: tags(model.base),
            color,
            facts: model.facts(),
            ..Self::new(kind, (model.name, model.size_m), at)
        }
    }

    /// A vehicle; those of police, ambulance and fire brigade flash.
    pub(super) fn vehicle(model: &'static Model, color: [u8; 3], doors: [f32; 4], at: &Spot) -> Self {
        let lamps = if model.special == Special::Emergency { lights::EMERGENCY } else { 0 };
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

    pub(crate) fn footprint(&self) -> Footprint {
        (self.point, self.yaw_rad(), self.size_m)
    }

    /// What drivers take it for: a driver who sees no signs sees no cones and nothing else of road works
    /// either.
    pub(crate) fn class(&self) -> Class {
        match self.kind {
            ActorKind::Vehicle => Class::Vehicles,
            ActorKind::Walker => Class::Walkers,
            _ => Class::Signs,
        }
    }

    pub(crate) fn is_person(&self) -> bool {
        self.kind == ActorKind::Walker
    }

    /// Lies somewhere else on the plane that it stands on, turned.
    pub(crate) fn move_to(&mut self, [x_m, y_m]: [f64; 2], yaw_rad: f64) {
        let [roll, pitch, before_rad] = self.rpy_rad;
        let (sin, cos) = sin_cos(before_rad);
        let (dx, dy) = (x_m - self.point.x, y_m - self.point.y);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        self.point = Point3::new(x_m, y_m, self.point.z - ahead * tan(pitch) + left * tan(roll));
        let (sin, cos) = sin_cos(yaw_rad - before_rad);
        self.rpy_rad = [roll * cos + pitch * sin, pitch * cos - roll * sin, frames::wrap_pi(yaw_rad)];
    }

    /// Whether drivers have to mind it: signs stand beside the lanes.
    pub(crate) fn is_on_lane(&self) -> bool {
        self.kind != ActorKind::Sign
    }

    pub(super) fn pose(&self) -> Pose<World, Object> {
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

    /// What is seen of it, given its pose one step before and the lamps that the weather asks for.
    pub(super) fn snapshot(
        &self,
        id: ObjectId,
        before: &Pose<World, Object>,
        weather_lamps: u32,
    ) -> Snapshot {
        let weather_lamps = if self.has_states() { weather_lamps } else { 0 };
        Snapshot {
            id,
            world_from_object: self.pose(),
            world_from_object_before: *before,
            lean_rad: [0.0; 2],
            steer_rad: 0.0,
            phase_rad: 0.0,
            seat_m: 0.0,
            lights: self.lamps | weather_lamps,
            door_rad: self.doors,
            dormant: false,
        }
    }
}
