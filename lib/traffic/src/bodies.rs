//! Rigid bodies: what happens when something is hit.

use frames::LocalOrigin;
use glam::{Quat, Vec3};
use nalgebra::Point3;
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::{ColliderBuilder, ColliderHandle, Group, InteractionGroups, InteractionTestMode};
use rapier3d::pipeline::PhysicsWorld;
use schema::FRAME_PERIOD_S;

const DT: f32 = FRAME_PERIOD_S as f32;
/// Bodies hang this high over the road, so that they never touch decks or each other's slopes by rounding, metres.
const GROUND_CLEARANCE_M: f32 = 0.1;
/// Contacts weaker than this are grazes within rounding, N s.
const MIN_IMPULSE: f32 = 1.0;
/// Deceleration of a body that nobody drives any more, m/s2.
const SKID_MPS2: f32 = 6.0;
const VEHICLE: Group = Group::GROUP_1;
const WALKER: Group = Group::GROUP_2;
const FIXED: Group = Group::GROUP_3;

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
        owner: u128,
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
            .can_sleep(false);
        let handle = self.world.insert_body(body);
        let collider = collider
            .mass(mass_kg)
            .friction(0.4)
            .restitution(0.1)
            .user_data(owner)
            .collision_groups(InteractionGroups::new(groups[0], groups[1], InteractionTestMode::And));
        let shape = self.world.insert_collider(collider, Some(handle));
        Body(handle, shape)
    }

    /// A vehicle's body; `owner` is what [`Bodies::hits`] names it by.
    pub(crate) fn vehicle(
        &mut self,
        ground: &Point3<f64>,
        yaw_rad: f64,
        size_m: [f64; 3],
        owner: u32,
    ) -> Body {
        let half = Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
        // 170 kg per cubic metre of the box: 1.9 t for a saloon, 14 t for a bus.
        let mass = 170.0 * 8.0 * half.x * half.y * half.z;
        self.insert(ground, yaw_rad, half, mass, u128::from(owner), [VEHICLE, VEHICLE | WALKER | FIXED])
    }

    /// A walker's body, which nothing touches until it is on the road.
    pub(crate) fn walker(&mut self, ground: &Point3<f64>, size_m: [f64; 3], owner: u32) -> Body {
        let half = Vec3::new(0.5 * size_m[0] as f32, 0.5 * size_m[1].min(0.5) as f32, 0.5 * size_m[2] as f32);
        self.insert(ground, 0.0, half, 75.0, u128::from(owner), [WALKER, Group::NONE])
    }

    /// Something that does not move.
    pub(crate) fn fixed(&mut self, ground: &Point3<f64>, yaw_rad: f64, size_m: [f64; 3], owner: u32) -> Body {
        let half = Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
        self.insert(ground, yaw_rad, half, 0.0, u128::from(owner), [FIXED, VEHICLE])
    }

    /// Whether vehicles can hit a walker.
    pub(crate) fn set_on_road(&mut self, body: Body, on_road: bool) {
        let touched_by = if on_road { VEHICLE } else { Group::NONE };
        if let Some(collider) = self.world.colliders.get_mut(body.1) {
            collider.set_collision_groups(InteractionGroups::new(
                WALKER,
                touched_by,
                InteractionTestMode::And,
            ));
        }
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

    /// Owners of bodies that pushed each other in the last step, each pair once.
    pub(crate) fn hits(&self) -> Vec<(u32, u32)> {
        let owner = |handle| self.world.colliders.get(handle).map(|c| c.user_data as u32);
        let mut hits: Vec<(u32, u32)> = self
            .world
            .contact_pairs()
            .filter(|pair| pair.total_impulse_magnitude() > MIN_IMPULSE)
            .filter_map(|pair| Some((owner(pair.collider1)?, owner(pair.collider2)?)))
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        hits.sort_unstable();
        hits.dedup();
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
