//! What is behind the panes of vehicles: the first surface there that is none.

use crate::{Hit, RayBatch, RayQuery, RenderError, Scene, pose_before};
use glam::Vec3;
use schema::geometry::{DOOR_M, Surface};

/// Share of light that passes a pane: UN Regulation 43 wants 70 % of panes that a driver looks through.
pub const PASSES: f32 = 0.7;
/// Panes and openings that are looked through one behind the other, at most.
const MOST_PANES: u8 = 8;
/// Openings are met as if at no smaller cosine of an angle than this: a view along a car looks past its
/// door's frame.
const LEAST_COS: f32 = 0.2;
/// What is nearer behind a pane is the pane itself, metres; distances are told apart by a share of
/// themselves.
const BEHIND_M: f32 = 1e-3;
const ROUNDING: f32 = 1e-5;

/// Panes that one sees through: those with something behind them.
pub struct Panes<'a> {
    scene: &'a dyn Scene,
    /// By number of the instance.
    has_panes: Vec<bool>,
}

/// What a ray meets behind a pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransmittedHit {
    /// What it ends at; the sky if nothing. Instances are numbered as [`schema::geometry::Snapshot::behind`]
    /// has them.
    pub hit: Option<Hit>,
    /// Panes that it passed.
    pub panes: u8,
    /// Whether what it met first is an open door.
    pub opened: bool,
}

/// Rays that met panes.
#[derive(Debug, Default)]
pub struct PaneRays {
    /// Unit directions.
    directions: Vec<Vec3>,
    /// The panes: instance, triangle, and how far off, metres.
    panes: Vec<(u32, u32, f32)>,
}

impl PaneRays {
    /// Adds a ray by its unit direction and the pane that it met: instance, triangle and distance in metres.
    pub fn push(&mut self, direction: Vec3, instance: u32, triangle: u32, distance_m: f32) {
        self.directions.push(direction);
        self.panes.push((instance, triangle, distance_m));
    }
}

impl<'a> Panes<'a> {
    /// The panes of a scene; none where nothing stands behind any.
    pub fn of(scene: &'a dyn Scene) -> Option<Self> {
        let snapshot = scene.snapshot();
        if snapshot.cabins.is_empty() {
            return None;
        }
        let instances = snapshot.instances.iter();
        let has_panes = instances.map(|instance| {
            snapshot.has_cabin(instance.object)
                && snapshot.mesh(instance).parts.iter().any(|part| part.surface.is_window())
        });
        Some(Self { scene, has_panes: has_panes.collect() })
    }

    /// Whether a triangle is a pane that one sees through.
    pub fn is_pane(&self, instance: u32, triangle: u32) -> bool {
        self.has_panes.get(instance as usize) == Some(&true) && {
            let snapshot = self.scene.snapshot();
            let mesh = snapshot.mesh(&snapshot.instances[instance as usize]);
            mesh.part(triangle as usize).surface.is_window()
        }
    }

    /// What rays from a place meet behind the panes that they met, at a moment (0 is this frame, 1 the one
    /// before).
    ///
    /// # Errors
    /// The renderer failed.
    pub fn behind(
        &self,
        before: f32,
        origin: Vec3,
        reach_m: f32,
        rays: PaneRays,
    ) -> Result<Vec<TransmittedHit>, RenderError> {
        let PaneRays { mut directions, panes } = rays;
        let mut nearest_m = Vec::with_capacity(panes.len());
        let mut found = Vec::with_capacity(panes.len());
        for (direction, pane) in directions.iter().zip(panes) {
            let (from_m, opened) = self.beyond(before, *direction, pane);
            nearest_m.push(from_m);
            found.push(TransmittedHit { hit: None, panes: u8::from(!opened), opened });
        }
        let mut passed = vec![1; found.len()];
        let mut places: Vec<usize> = (0..found.len()).collect();
        while !places.is_empty() {
            let range_m = [0.0, reach_m];
            let rays = RayBatch { origin, directions: &directions, range_m, nearest_m: &nearest_m };
            let hits = self.scene.trace(&[RayQuery { before, cabins: true, ..RayQuery::of(rays) }])?;
            let mut left = 0;
            for (ray, hit) in hits.iter().flat_map(|hits| hits.iter()).enumerate() {
                let Some(hit) = hit else { continue };
                let place = places[ray];
                let behind = &mut found[place];
                if passed[place] < MOST_PANES && self.is_pane(hit.instance, hit.triangle) {
                    let (from_m, opened) =
                        self.beyond(before, directions[ray], (hit.instance, hit.triangle, hit.t));
                    passed[place] += 1;
                    behind.panes += u8::from(!opened);
                    places[left] = place;
                    directions[left] = directions[ray];
                    nearest_m[left] = from_m;
                    left += 1;
                } else {
                    behind.hit = Some(hit);
                }
            }
            places.truncate(left);
            directions.truncate(left);
            nearest_m.truncate(left);
        }
        Ok(found)
    }

    /// From where on a ray looks for what is behind a pane (instance, triangle, distance), metres; and
    /// whether that is an opening.
    fn beyond(
        &self,
        before: f32,
        direction: Vec3,
        (instance, triangle, distance_m): (u32, u32, f32),
    ) -> (f32, bool) {
        let snapshot = self.scene.snapshot();
        let placed = &snapshot.instances[instance as usize];
        let mesh = snapshot.mesh(placed);
        if mesh.part(triangle as usize).surface != Surface::Opening {
            return (beyond(distance_m), false);
        }
        let [a, b, c] = mesh.corners(triangle as usize);
        let pose = pose_before(&placed.previous_local_from_object, &placed.local_from_object, before);
        let normal = pose.transform_vector3((b - a).cross(c - a)).normalize_or_zero();
        (beyond(distance_m + DOOR_M / normal.dot(direction).abs().max(LEAST_COS)), true)
    }
}

/// The nearest distance of what is behind something.
fn beyond(distance_m: f32) -> f32 {
    distance_m * (1.0 + ROUNDING) + BEHIND_M
}
