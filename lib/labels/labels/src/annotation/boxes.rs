//! Raw 3-D boxes: which objects are near an agent, and where.

use frames::{Agent, Object, OrientedBox, Pose, World, math};
use nalgebra::Vector3;
use schema::tables::{ActorRow, BoxRow};
use schema::{ActorRole, AgentId, DetectionClass, ObjectId, SignalState, Tag};

/// Traffic-light housings are annotated when their half height exceeds this, metres.
const LIGHT_MIN_HALF_HEIGHT_M: f64 = 0.3;
/// Housings are annotated at least this half length and half width, metres.
const LIGHT_MIN_HALF_ACROSS_M: f64 = 0.12;
/// Fixed objects (parked vehicles, signs, ...) are annotated below this half height, metres.
const FIXED_MAX_HALF_HEIGHT_M: f64 = 3.2;
/// Fixed objects are annotated at least this half extent along every axis, metres: sign boards are thin.
const FIXED_MIN_HALF_M: f64 = 0.03;

/// An agent that collects boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// Who.
    pub agent: AgentId,
    /// Its object id.
    pub id: ObjectId,
    /// Where it is.
    pub world_from_agent: Pose<World, Agent>,
}

/// An object of the scene at one frame.
#[derive(Clone, Copy, Debug)]
pub struct ObservedObject<'a> {
    /// What it is.
    pub actor: &'a ActorRow,
    /// Length, width and height of its box now, metres: of walkers that of their pose.
    pub size_m: [f64; 3],
    /// Where it is: the origin is the centre of its footprint on the ground (of a traffic light: of the
    /// housing's bottom face).
    pub world_from_object: Pose<World, Object>,
    /// Velocity in the world, m/s.
    pub velocity_mps: [f32; 3],
    /// Angular velocity in the world, rad/s.
    pub angular_velocity_radps: [f32; 3],
    /// State of a traffic light.
    pub signal_state: Option<SignalState>,
    /// Whether it is not simulated at the moment.
    pub dormant: bool,
}

/// The boxes of a frame: for each agent (in [`AgentId`] order), the objects with a detection class whose
/// origin is nearer than `radius_m` (strictly, in three dimensions), by object id. The agent itself is among
/// them.
///
/// Two-wheelers and their riders are one object. Traffic lights with a housing of at most 0.6 m and fixed
/// objects of at least 6.4 m height are left out.
#[must_use]
pub fn collect(
    frame: u32,
    observers: &[Observer],
    objects: &[ObservedObject<'_>],
    radius_m: f64,
) -> Vec<BoxRow> {
    let mut candidates: Vec<Annotated<'_>> = objects.iter().filter_map(Annotated::new).collect();
    candidates.sort_by_key(|c| c.object.actor.id);
    let mut observers: Vec<&Observer> = observers.iter().collect();
    observers.sort_by_key(|o| o.agent);

    let mut rows = Vec::new();
    for observer in observers {
        let name = observer.agent.to_string();
        let forward = observer.world_from_agent.forward();
        let agent_origin = observer.world_from_agent.translation();
        for candidate in &candidates {
            let to_object = candidate.location() - agent_origin;
            let distance_m = to_object.norm();
            // A NaN distance is not below the radius either.
            if distance_m < radius_m {
                let itself = candidate.object.actor.id == observer.id;
                let angle_rad = if itself { None } else { signed_angle(forward, to_object) };
                rows.push(BoxRow {
                    is_ego: itself,
                    ..candidate.row(frame, name.clone(), distance_m, angle_rad)
                });
            }
        }
    }
    rows
}

/// The 3-D angle between two directions, radians in (-pi, pi], negative where `to_object` lies to the right
/// of `forward`; none for a zero vector.
fn signed_angle(forward: Vector3<f64>, to_object: Vector3<f64>) -> Option<f64> {
    if to_object.norm_squared() == 0.0 {
        return None;
    }
    let cross = forward.cross(&to_object);
    let angle = math::atan2(cross.norm(), forward.dot(&to_object));
    Some(if cross.z < 0.0 { -angle } else { angle })
}

/// An object with a class and its box.
struct Annotated<'a> {
    object: &'a ObservedObject<'a>,
    class: DetectionClass,
    tags: Vec<u8>,
    bounds: OrientedBox,
}

impl<'a> Annotated<'a> {
    fn new(object: &'a ObservedObject<'a>) -> Option<Self> {
        let actor = object.actor;
        let tags = named(&actor.semantic_tags);
        let class = DetectionClass::from_tags(&tags)?;
        let mut half = 0.5 * Vector3::from(object.size_m);
        if class == DetectionClass::TrafficLight {
            if half.z <= LIGHT_MIN_HALF_HEIGHT_M {
                return None;
            }
            half.x = half.x.max(LIGHT_MIN_HALF_ACROSS_M);
            half.y = half.y.max(LIGHT_MIN_HALF_ACROSS_M);
        } else if actor.fixed {
            if half.z >= FIXED_MAX_HALF_HEIGHT_M {
                return None;
            }
            half = half.map(|h| h.max(FIXED_MIN_HALF_M));
        }
        let bounds =
            OrientedBox::standing(object.world_from_object, 2.0 * half.x, 2.0 * half.y, 2.0 * half.z);
        Some(Self { object, class, tags, bounds })
    }

    /// Where the object is said to be: its origin, of people the middle of the body.
    fn location(&self) -> Vector3<f64> {
        if self.class == DetectionClass::Pedestrian {
            return self.bounds.centre().coords;
        }
        self.object.world_from_object.translation()
    }

    fn row(&self, frame: u32, agent: String, distance_m: f64, angle_rad: Option<f64>) -> BoxRow {
        let actor = self.object.actor;
        let mut corners_m = [0.0; 24];
        for (to, corner) in corners_m.chunks_exact_mut(3).zip(self.bounds.corners()) {
            to.copy_from_slice(corner.coords.as_slice());
        }
        BoxRow {
            frame,
            agent,
            id: actor.id,
            is_ego: false,
            class: self.class.name().to_owned(),
            model: actor.model.clone(),
            semantic_tags: self.tags.clone(),
            corners_m,
            center_m: self.bounds.centre().coords.into(),
            size_m: (2.0 * self.bounds.half_m).into(),
            rpy_rad: self.object.world_from_object.rpy(),
            velocity_mps: self.object.velocity_mps,
            angular_velocity_radps: self.object.angular_velocity_radps,
            distance_m,
            angle_rad,
            signal_state: self.object.signal_state,
            is_alive: actor.role != ActorRole::Scenery,
            is_active: actor.role != ActorRole::Scenery && !self.object.dormant,
            is_dormant: self.object.dormant,
            opendrive_id: actor.opendrive_id.clone(),
            attributes: actor.attributes.clone(),
        }
    }
}

/// The tags of an object's parts that its box is around, without repeats, riders first: the last tag with a
/// class names the object's. A pole is no part of a sign's box.
fn named(tags: &[u8]) -> Vec<u8> {
    let mut out: Vec<u8> = Vec::with_capacity(tags.len());
    let boxed = |tag: u8| tag == Tag::Rider as u8 || DetectionClass::from_tags(&[tag]).is_some();
    for &tag in tags {
        if boxed(tag) && !out.contains(&tag) {
            out.push(tag);
        }
    }
    out.sort_by_key(|&tag| tag != Tag::Rider as u8);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use schema::ActorKind;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn actor(id: u16, tags: &[Tag]) -> ActorRow {
        ActorRow {
            id,
            kind: ActorKind::Vehicle,
            model: "m".into(),
            semantic_tags: tags.iter().map(|&t| t as u8).collect(),
            length_m: 4.0,
            width_m: 2.0,
            height_m: 1.5,
            ..ActorRow::default()
        }
    }

    fn at(actor: &ActorRow, xyz_m: [f64; 3]) -> ObservedObject<'_> {
        ObservedObject {
            actor,
            size_m: [actor.length_m, actor.width_m, actor.height_m],
            world_from_object: Pose::from_xyz_rpy(xyz_m, [0.0; 3]),
            velocity_mps: [1.0, 0.0, 0.0],
            angular_velocity_radps: [0.0; 3],
            signal_state: None,
            dormant: false,
        }
    }

    fn observer(index: u16, id: u16, yaw: f64) -> Observer {
        Observer {
            agent: AgentId::vehicle(index),
            id,
            world_from_agent: Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, yaw]),
        }
    }

    #[test]
    fn boxes_of_walkers_are_those_of_their_poses() {
        let a = actor(5, &[Tag::Pedestrian]);
        let strides = ObservedObject { size_m: [1.2, 0.6, 1.4], ..at(&a, [3.0, 0.0, 0.5]) };
        let row = collect(0, &[observer(0, 1, 0.0)], &[strides], 200.0).remove(0);
        assert_eq!((row.size_m, row.center_m), ([1.2, 0.6, 1.4], [3.0, 0.0, 1.2]));
    }

    #[test]
    fn angles_are_positive_to_the_left() {
        let a = actor(5, &[Tag::Car]);
        let angle =
            |xyz| collect(0, &[observer(0, 1, 0.0)], &[at(&a, xyz)], 200.0)[0].angle_rad.expect("not itself");
        assert!((angle([0.0, 10.0, 0.0]) - FRAC_PI_2).abs() < 1e-12);
        assert!((angle([0.0, -10.0, 0.0]) + FRAC_PI_2).abs() < 1e-12);
        assert!((angle([-10.0, 0.0, 0.0]) - PI).abs() < 1e-12);
        // Elevation counts: straight ahead and as high as far is 45 degrees.
        assert!((angle([10.0, 0.0, 10.0]) - PI / 4.0).abs() < 1e-12);
    }

    #[test]
    fn itself_is_listed_without_an_angle_and_the_radius_is_open() {
        let own = actor(1, &[Tag::Car]);
        let far = actor(2, &[Tag::Car]);
        let near = actor(3, &[Tag::Car]);
        let objects = [at(&near, [99.999, 0.0, 0.0]), at(&far, [100.0, 0.0, 0.0]), at(&own, [0.0; 3])];
        let rows = collect(7, &[observer(0, 1, 0.3)], &objects, 100.0);
        assert_eq!(rows.iter().map(|r| r.id).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(rows[0].angle_rad, None);
        assert_eq!(rows.iter().map(|r| r.is_ego).collect::<Vec<_>>(), [true, false]);
        assert_eq!(rows[0].distance_m, 0.0);
        assert_eq!(rows[0].frame, 7);
        assert_eq!(&rows[0].corners_m[..3], &[-2.0, 1.0, 0.0], "corner 0 is rear, left, bottom");
        assert_eq!(rows[0].center_m, [0.0, 0.0, 0.75]);
    }

    #[test]
    fn people_are_where_the_middle_of_their_body_is() {
        let mut walker = actor(3, &[Tag::Pedestrian]);
        walker.height_m = 1.8;
        let car = actor(4, &[Tag::Car]);
        let rows = collect(
            0,
            &[observer(0, 1, 0.0)],
            &[walker, car].each_ref().map(|a| at(a, [3.0, 4.0, 0.0])),
            50.0,
        );
        assert!((rows[0].distance_m - (25.0_f64 + 0.81).sqrt()).abs() < 1e-12);
        assert_eq!(rows[1].distance_m, 5.0);
    }

    #[test]
    fn scenery_is_no_actor_and_sleepers_are_not_active() {
        let mut parked = actor(2, &[Tag::Car]);
        parked.role = ActorRole::Scenery;
        let mut driven = actor(3, &[Tag::Car]);
        driven.role = ActorRole::Background;
        let sleeper = ObservedObject { dormant: true, ..at(&driven, [9.0, 0.0, 0.0]) };
        let objects = [at(&parked, [3.0, 0.0, 0.0]), sleeper, at(&driven, [6.0, 0.0, 0.0])];
        let rows = collect(0, &[observer(0, 1, 0.0)], &objects, 50.0);
        let facts: Vec<_> = rows.iter().map(|r| (r.is_alive, r.is_active, r.is_dormant)).collect();
        assert_eq!(facts, [(false, false, false), (true, false, true), (true, true, false)]);
    }

    #[test]
    fn only_objects_with_a_class_are_listed() {
        let building = actor(1, &[Tag::Building]);
        let bike = actor(2, &[Tag::Bicycle, Tag::Rider, Tag::Bicycle]);
        let mut small_light = actor(3, &[Tag::Pole, Tag::TrafficLight]);
        small_light.height_m = 0.6;
        let mut light = actor(4, &[Tag::Pole, Tag::TrafficLight]);
        (light.length_m, light.width_m, light.height_m) = (0.1, 0.3, 0.9);
        let mut gantry = actor(5, &[Tag::TrafficSign]);
        (gantry.fixed, gantry.height_m) = (true, 6.4);
        let mut board = actor(6, &[Tag::TrafficSign]);
        (board.fixed, board.length_m) = (true, 0.01);
        let all = [&building, &bike, &small_light, &light, &gantry, &board].map(|a| at(a, [5.0, 0.0, 0.0]));
        let rows = collect(0, &[observer(0, 9, 0.0)], &all, 200.0);
        assert_eq!(rows.iter().map(|r| r.id).collect::<Vec<_>>(), [2, 4, 6]);
        assert_eq!(
            (rows[0].semantic_tags.as_slice(), rows[0].class.as_str()),
            ([13u8, 19].as_slice(), "bicycle")
        );
        assert_eq!(rows[1].semantic_tags, [Tag::TrafficLight as u8], "its pole is not in the box");
        assert_eq!(rows[1].size_m, [0.24, 0.3, 0.9]);
        assert_eq!(rows[2].size_m[0], 0.06);
    }

    proptest! {
        #[test]
        fn agreed_with_a_plain_double_loop(places in proptest::collection::vec((-80.0..80.0f64, -80.0..80.0f64), 0..20), radius in 1.0..120.0f64) {
            let actors: Vec<_> = (0..places.len()).map(|i| actor(100 - i as u16, &[Tag::Truck])).collect();
            let objects: Vec<_> = actors.iter().zip(&places).map(|(a, p)| at(a, [p.0, p.1, 0.0])).collect();
            let rows = collect(0, &[observer(1, 500, 0.0), observer(0, 501, 1.0)], &objects, radius);
            let inside = places.iter().filter(|p| (p.0 * p.0 + p.1 * p.1).sqrt() < radius).count();
            prop_assert_eq!(rows.len(), 2 * inside);
            let keys: Vec<_> = rows.iter().map(|r| (r.agent.clone(), r.id)).collect();
            let mut sorted = keys.clone();
            sorted.sort();
            prop_assert_eq!(keys, sorted);
        }
    }
}
