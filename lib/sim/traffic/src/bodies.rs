//! Rigid bodies: what happens when something is hit.

use frames::LocalOrigin;
use glam::{Quat, Vec3};
use nalgebra::Point3;
use rapier3d::dynamics::{GenericJointBuilder, JointAxesMask, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::{ColliderBuilder, ColliderHandle, Group, InteractionGroups, InteractionTestMode};
use rapier3d::pipeline::PhysicsWorld;
use schema::FRAME_PERIOD_S;

const DT: f32 = FRAME_PERIOD_S as f32;
/// Bodies hang this high over the road, so that they never touch decks or each other's slopes by rounding,
/// metres.
const GROUND_CLEARANCE_M: f32 = 0.1;
/// Contacts weaker than this are within rounding, N s.
const MIN_IMPULSE: f32 = 1.0;
/// Deceleration of a body that nobody drives any more, m/s2.
const SKID_MPS2: f32 = 6.0;
/// Density of the box about a vehicle, kg/m3: 1.9 t for a saloon, 14 t for a bus.
const VEHICLE_KG_M3: f32 = 170.0;
/// Mass of somebody, kg.
pub(crate) const PERSON_KG: f64 = 75.0;
const VEHICLE: Group = Group::GROUP_1;
const WALKER: Group = Group::GROUP_2;
const FIXED: Group = Group::GROUP_3;
/// Vehicles that nobody drives any more are of this group, too.
const ADRIFT: Group = Group::GROUP_4;
/// What stands about until something hits it.
const MOVABLE: Group = Group::GROUP_5;

/// Whose body it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Owner {
    /// By its index.
    Vehicle(u32),
    /// By its index.
    Walker(u32),
    /// A thing of a hazard, by its index.
    Obstacle(u32),
    /// Any parked vehicle.
    Parked,
    /// An actor on a given trajectory, by its index.
    Given(u32),
}

impl Owner {
    fn to_data(self) -> u128 {
        let (kind, index) = match self {
            Self::Vehicle(i) => (0, i),
            Self::Walker(i) => (1, i),
            Self::Obstacle(i) => (2, i),
            Self::Parked => (3, 0),
            Self::Given(i) => (4, i),
        };
        kind << 32 | u128::from(index)
    }

    fn from_data(data: u128) -> Self {
        let index = data as u32;
        match data >> 32 {
            0 => Self::Vehicle(index),
            1 => Self::Walker(index),
            2 => Self::Obstacle(index),
            4 => Self::Given(index),
            _ => Self::Parked,
        }
    }
}

/// Two bodies that pushed each other in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    pub(crate) owners: [Owner; 2],
    /// How much the push changed the velocity of each (no more than 0 where a body cannot move), m/s.
    pub(crate) change_mps: [f64; 2],
    /// The line along which they pushed, a unit vector in the plane.
    pub(crate) along: [f64; 2],
}

/// A body in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Body(RigidBodyHandle, ColliderHandle);

/// Where a body is and how it moves, in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyMotion {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) yaw_rad: f64,
    pub(crate) velocity_mps: [f64; 2],
}

/// All bodies of a scene, in single precision around the scene's middle.
pub(crate) struct Bodies {
    origin: LocalOrigin,
    world: PhysicsWorld,
}

impl Bodies {
    pub(crate) fn new(origin: LocalOrigin) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vec3::ZERO;
        world.integration_parameters.dt = DT;
        Self { origin, world }
    }

    fn translation(&self, ground: &Point3<f64>, half_height_m: f32) -> Vec3 {
        self.origin.local_from_world((*ground).into()) + Vec3::Z * (half_height_m + GROUND_CLEARANCE_M)
    }

    fn insert(
        &mut self,
        ground: &Point3<f64>,
        yaw_rad: f64,
        half: Vec3,
        mass_kg: f32,
        owner: Owner,
        groups: [Group; 2],
    ) -> Body {
        let collider = match groups[0] == WALKER {
            true => ColliderBuilder::capsule_z((half.z - half.y).max(0.05), half.y),
            false => ColliderBuilder::cuboid(half.x, half.y, half.z),
        };
        let builder =
            if groups[0] == FIXED { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
        let body = builder
            .translation(self.translation(ground, half.z))
            .rotation(Vec3::Z * yaw_rad as f32)
            .enabled_translations(true, true, false)
            .enabled_rotations(false, false, true)
            .can_sleep(groups[0] == MOVABLE);
        let handle = self.world.insert_body(body);
        let collider = collider
            .mass(mass_kg)
            .friction(if groups[0] == MOVABLE { 0.1 } else { 0.4 })
            .restitution(if groups[0] == MOVABLE { 0.5 } else { 0.1 })
            .user_data(owner.to_data())
            .collision_groups(InteractionGroups::new(groups[0], groups[1], InteractionTestMode::And));
        let shape = self.world.insert_collider(collider, Some(handle));
        Body(handle, shape)
    }

    /// A vehicle's body.
    pub(crate) fn vehicle(
        &mut self,
        ground: &Point3<f64>,
        yaw_rad: f64,
        size_m: [f64; 3],
        owner: Owner,
    ) -> Body {
        let half = Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
        let mass = VEHICLE_KG_M3 * 8.0 * half.x * half.y * half.z;
        self.insert(ground, yaw_rad, half, mass, owner, [VEHICLE, VEHICLE | WALKER | FIXED | MOVABLE])
    }

    /// Joins two bodies at a place, so many metres ahead of the middle of each: they turn about it, and do
    /// not touch each other.
    pub(crate) fn couple(&mut self, [lead, towed]: [Body; 2], ahead_m: [f64; 2]) {
        // Heights are those of the road under each.
        let joint = GenericJointBuilder::new(JointAxesMask::LIN_X | JointAxesMask::LIN_Y)
            .local_anchor1(Vec3::X * ahead_m[0] as f32)
            .local_anchor2(Vec3::X * ahead_m[1] as f32)
            .contacts_enabled(false);
        self.world.insert_impulse_joint(lead.0, towed.0, joint);
    }

    /// A walker's body, which only what is adrift touches until it is on the road.
    pub(crate) fn walker(&mut self, ground: &Point3<f64>, size_m: [f64; 3], owner: Owner) -> Body {
        let half = Vec3::new(0.5 * size_m[0] as f32, 0.5 * size_m[1].min(0.5) as f32, 0.5 * size_m[2] as f32);
        self.insert(ground, 0.0, half, PERSON_KG as f32, owner, [WALKER, ADRIFT])
    }

    /// Something that does not move.
    pub(crate) fn fixed(
        &mut self,
        ground: &Point3<f64>,
        yaw_rad: f64,
        size_m: [f64; 3],
        owner: Owner,
    ) -> Body {
        let half = Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
        self.insert(ground, yaw_rad, half, 0.0, owner, [FIXED, VEHICLE | MOVABLE])
    }

    /// Something that stands until something hits it.
    pub(crate) fn movable(
        &mut self,
        ground: &Point3<f64>,
        yaw_rad: f64,
        size_m: [f64; 3],
        mass_kg: f64,
        owner: Owner,
    ) -> Body {
        let half = Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
        self.insert(ground, yaw_rad, half, mass_kg as f32, owner, [MOVABLE, VEHICLE | FIXED | MOVABLE])
    }

    fn set_groups(&mut self, body: Body, groups: [Group; 2]) {
        if let Some(collider) = self.world.colliders.get_mut(body.1) {
            let [of, with] = groups;
            collider.set_collision_groups(InteractionGroups::new(of, with, InteractionTestMode::And));
        }
    }

    /// Whether vehicles that are driven can hit a walker.
    pub(crate) fn set_on_road(&mut self, body: Body, on_road: bool) {
        self.set_groups(body, [WALKER, if on_road { VEHICLE } else { ADRIFT }]);
    }

    /// A vehicle is not driven any more: it hits walkers wherever they are.
    pub(crate) fn set_adrift(&mut self, body: Body) {
        self.set_groups(body, [VEHICLE | ADRIFT, VEHICLE | WALKER | FIXED | MOVABLE]);
    }

    /// Gives a body the velocity that takes it to a place within one step.
    pub(crate) fn drive(&mut self, body: Body, ground: &Point3<f64>, yaw_rad: f64, half_height_m: f64) {
        let to = self.translation(ground, half_height_m as f32);
        let Some(body) = self.world.bodies.get_mut(body.0) else { return };
        let mut at = body.translation();
        let turn = frames::wrap_pi(yaw_rad - f64::from(yaw_of(body.rotation()))) as f32;
        body.set_linvel(Vec3::new((to.x - at.x) / DT, (to.y - at.y) / DT, 0.0), true);
        body.set_angvel(Vec3::Z * (turn / DT), true);
        if to.z != at.z {
            at.z = to.z;
            body.set_translation(at, true);
        }
    }

    /// Lets a body skid to rest.
    pub(crate) fn skid(&mut self, body: Body) {
        let Some(body) = self.world.bodies.get_mut(body.0) else { return };
        let velocity = body.linvel();
        let speed = velocity.length();
        let kept = if speed > SKID_MPS2 * DT { 1.0 - SKID_MPS2 * DT / speed } else { 0.0 };
        let rate = body.angvel();
        body.set_linvel(velocity * kept, true);
        body.set_angvel(rate * (0.85 * kept), true);
    }

    /// Leaves a body where it is.
    pub(crate) fn rest(&mut self, body: Body) {
        let Some(body) = self.world.bodies.get_mut(body.0) else { return };
        body.set_linvel(Vec3::ZERO, true);
        body.set_angvel(Vec3::ZERO, true);
    }

    pub(crate) fn step(&mut self) {
        self.world.step();
    }

    /// Bodies that pushed each other in the last step, each pair once, by their owners.
    pub(crate) fn hits(&self) -> Vec<Hit> {
        let owner_and_share = |handle| {
            let collider = self.world.colliders.get(handle)?;
            let body = self.world.bodies.get(collider.parent()?)?;
            let share = if body.is_dynamic() { 1.0 / f64::from(body.mass().max(1e-3)) } else { 0.0 };
            Some((Owner::from_data(collider.user_data), share))
        };
        let mut hits: Vec<Hit> = self
            .world
            .contact_pairs()
            .filter(|pair| pair.total_impulse_magnitude() > MIN_IMPULSE)
            .filter_map(|pair| {
                let (a, b) = (owner_and_share(pair.collider1)?, owner_and_share(pair.collider2)?);
                let (first, second) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                let push = pair.total_impulse();
                let length = f64::from(push.length());
                let way = f64::from((push.x * push.x + push.y * push.y).sqrt()).max(1e-9);
                Some(Hit {
                    owners: [first.0, second.0],
                    change_mps: [length * first.1, length * second.1],
                    along: [f64::from(push.x) / way, f64::from(push.y) / way],
                })
            })
            .collect();
        hits.sort_by(|a, b| a.owners.cmp(&b.owners).then(b.change_mps[0].total_cmp(&a.change_mps[0])));
        hits.dedup_by_key(|hit| hit.owners);
        hits
    }

    pub(crate) fn motion(&self, body: Body) -> Option<BodyMotion> {
        let body = self.world.bodies.get(body.0)?;
        let at = self.origin.world_from_local(body.translation());
        let velocity = body.linvel();
        Some(BodyMotion {
            x_m: at[0],
            y_m: at[1],
            yaw_rad: f64::from(yaw_of(body.rotation())),
            velocity_mps: [f64::from(velocity.x), f64::from(velocity.y)],
        })
    }
}

/// Yaw of a rotation about z.
fn yaw_of(rotation: &Quat) -> f32 {
    2.0 * frames::math::f32::atan2(rotation.z, rotation.w)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR_M: [f64; 3] = [4.0, 2.0, 1.5];

    fn bodies() -> Bodies {
        Bodies::new(LocalOrigin::near([0.0; 3]))
    }

    /// Lets a car drive at 10 m/s to the east for a second, or skid after 0.2 s.
    fn drive(bodies: &mut Bodies, car: Body, skids: bool) -> Vec<Hit> {
        let mut hits = Vec::new();
        for k in 1..=20 {
            match skids && k > 4 {
                true => bodies.skid(car),
                false => bodies.drive(car, &Point3::new(0.5 * f64::from(k), 0.0, 0.0), 0.0, 0.75),
            }
            bodies.step();
            hits.extend(bodies.hits());
        }
        hits
    }

    #[test]
    fn a_push_keeps_the_momentum() {
        for mass_kg in [3.0, 300.0] {
            let mut bodies = bodies();
            let car = bodies.vehicle(&Point3::origin(), 0.0, CAR_M, Owner::Vehicle(0));
            let ahead = Point3::new(2.6, 0.2, 0.0);
            let cone = bodies.movable(&ahead, 0.3, [0.4, 0.4, 0.8], mass_kg, Owner::Obstacle(7));
            // 0.4 m of free way: within it after the first step, pushed in the second one.
            for x_m in [0.5, 1.0] {
                bodies.drive(car, &Point3::new(x_m, 0.0, 0.0), 0.0, 0.75);
                bodies.step();
            }
            let [hit] = bodies.hits()[..] else { panic!("{:?}", bodies.hits()) };
            assert_eq!(hit.owners, [Owner::Vehicle(0), Owner::Obstacle(7)]);
            assert!(hit.along[0].abs() > 0.95, "{hit:?}");
            let car_kg = 170.0 * 12.0;
            let speeds = [car, cone].map(|body| bodies.motion(body).expect("a body").velocity_mps[0]);
            let before = 10.0 * car_kg;
            let after = car_kg * speeds[0] + mass_kg * speeds[1];
            assert!((after - before).abs() < 1e-3 * before, "{before} {after}");
            assert!((10.0 - speeds[0] - hit.change_mps[0] * hit.along[0].abs()).abs() < 0.1, "{hit:?}");
            // Faster than the car after it, no faster than a perfectly elastic push makes it.
            assert!(
                speeds[1] > speeds[0] && speeds[1] < 20.0 * car_kg / (car_kg + mass_kg) + 1e-3,
                "{speeds:?}"
            );
        }
    }

    #[test]
    fn beside_the_road_only_cars_adrift_hit_people() {
        for (adrift, on_road, hits) in
            [(false, false, false), (true, false, true), (false, true, true), (true, true, true)]
        {
            let mut bodies = bodies();
            let car = bodies.vehicle(&Point3::origin(), 0.0, CAR_M, Owner::Vehicle(0));
            let person = bodies.walker(&Point3::new(5.0, 0.0, 0.0), [0.4, 0.5, 1.7], Owner::Walker(3));
            if on_road {
                bodies.set_on_road(person, true);
            }
            if adrift {
                bodies.set_adrift(car);
            }
            let found = drive(&mut bodies, car, adrift);
            let pair = [Owner::Vehicle(0), Owner::Walker(3)];
            assert_eq!(found.iter().any(|hit| hit.owners == pair), hits, "{adrift} {on_road}");
        }
    }

    #[test]
    fn nothing_is_driven_into_what_is_parked() {
        let mut bodies = bodies();
        let car = bodies.vehicle(&Point3::origin(), 0.0, CAR_M, Owner::Vehicle(0));
        bodies.fixed(&Point3::new(8.3, 0.0, 0.0), 0.0, CAR_M, Owner::Parked);
        let found = drive(&mut bodies, car, false);
        assert!(found.iter().any(|hit| hit.owners == [Owner::Vehicle(0), Owner::Parked]));
        let at = bodies.motion(car).expect("a body").x_m;
        assert!((4.0..4.9).contains(&at), "{at}");
    }
}
