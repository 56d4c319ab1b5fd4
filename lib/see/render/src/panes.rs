//! What is behind the panes of vehicles: the first surface there that is none.

use crate::{Hit, Hits, RayBatch, RayQuery, RenderError, Scene, pose_before};
use glam::Vec3;
use rayon::prelude::*;
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

/// Rays from one place, at one moment, that met panes.
#[derive(Debug)]
pub struct PaneRays {
    origin: Vec3,
    /// The moment: 0 is this frame, 1 the one before.
    before: f32,
    reach_m: f32,
    /// Unit directions.
    directions: Vec<Vec3>,
    /// The panes: instance, triangle, and how far off, metres.
    panes: Vec<(u32, u32, f32)>,
}

impl PaneRays {
    /// None yet: of a place, a moment (0 is this frame, 1 the one before) and how far they reach, metres.
    #[must_use]
    pub fn new(origin: Vec3, before: f32, reach_m: f32) -> Self {
        Self { origin, before, reach_m, directions: Vec::new(), panes: Vec::new() }
    }

    /// Adds a ray by its unit direction and the pane that it met: instance, triangle and distance in metres.
    pub fn push(&mut self, direction: Vec3, instance: u32, triangle: u32, distance_m: f32) {
        self.directions.push(direction);
        self.panes.push((instance, triangle, distance_m));
    }

    /// Adds rays from the same place at the same moment.
    pub fn append(&mut self, mut others: Self) {
        self.directions.append(&mut others.directions);
        self.panes.append(&mut others.panes);
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Whether none met a pane.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }
}

/// Rays of a place that are followed behind panes.
struct Onward {
    origin: Vec3,
    before: f32,
    reach_m: f32,
    /// Of the rays that are still followed: which they are, their directions, and from where they look on.
    places: Vec<usize>,
    directions: Vec<Vec3>,
    nearest_m: Vec<f32>,
    /// Of all: panes and openings passed, and what was found.
    passed: Vec<u8>,
    found: Vec<TransmittedHit>,
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

    /// What rays meet behind the panes that they met, in their order. All are followed at once, pane after
    /// pane.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn behind(&self, rays: Vec<PaneRays>) -> Result<Vec<Vec<TransmittedHit>>, RenderError> {
        let mut onward: Vec<Onward> = rays.into_par_iter().map(|rays| self.start(rays)).collect();
        loop {
            let mut under_way: Vec<&mut Onward> =
                onward.iter_mut().filter(|rays| !rays.places.is_empty()).collect();
            if under_way.is_empty() {
                break;
            }
            let queries: Vec<RayQuery<'_>> = under_way.iter().map(|rays| rays.query()).collect();
            let hits = self.scene.trace(&queries)?;
            under_way.par_iter_mut().zip(hits).for_each(|(rays, hits)| self.pass(rays, &hits));
        }
        Ok(onward.into_iter().map(|rays| rays.found).collect())
    }

    fn start(&self, rays: PaneRays) -> Onward {
        let PaneRays { origin, before, reach_m, directions, panes } = rays;
        let mut nearest_m = Vec::with_capacity(panes.len());
        let mut found = Vec::with_capacity(panes.len());
        for (direction, pane) in directions.iter().zip(panes) {
            let (from_m, opened) = self.beyond(before, *direction, pane);
            nearest_m.push(from_m);
            found.push(TransmittedHit { hit: None, panes: u8::from(!opened), opened });
        }
        let (passed, places) = (vec![1; found.len()], (0..found.len()).collect());
        Onward { origin, before, reach_m, places, directions, nearest_m, passed, found }
    }

    /// Notes what rays met; those that met another pane go on behind it.
    fn pass(&self, rays: &mut Onward, hits: &Hits) {
        let mut left = 0;
        for (ray, hit) in hits.iter().enumerate() {
            let Some(hit) = hit else { continue };
            let place = rays.places[ray];
            let behind = &mut rays.found[place];
            if rays.passed[place] < MOST_PANES && self.is_pane(hit.instance, hit.triangle) {
                let pane = (hit.instance, hit.triangle, hit.t);
                let (from_m, opened) = self.beyond(rays.before, rays.directions[ray], pane);
                rays.passed[place] += 1;
                behind.panes += u8::from(!opened);
                rays.places[left] = place;
                rays.directions[left] = rays.directions[ray];
                rays.nearest_m[left] = from_m;
                left += 1;
            } else {
                behind.hit = Some(hit);
            }
        }
        rays.places.truncate(left);
        rays.directions.truncate(left);
        rays.nearest_m.truncate(left);
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

impl Onward {
    fn query(&self) -> RayQuery<'_> {
        let (directions, nearest_m) = (&self.directions, &self.nearest_m);
        let rays = RayBatch { origin: self.origin, directions, range_m: [0.0, self.reach_m], nearest_m };
        RayQuery { before: self.before, cabins: true, ..RayQuery::of(rays) }
    }
}

/// The nearest distance of what is behind something.
fn beyond(distance_m: f32) -> f32 {
    distance_m * (1.0 + ROUNDING) + BEHIND_M
}
