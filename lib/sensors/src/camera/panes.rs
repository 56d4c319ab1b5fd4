//! What is seen through the panes of vehicles: the first surface behind them that is none.

use glam::{Mat3, Vec3};
use renderer::{RayBatch, RenderError, SKY, Scene, VisibilityBuffer};
use schema::geometry::Snapshot;

/// Share of light that passes a pane: UN Regulation 43 wants 70 % of panes that a driver looks through.
const PASSES: f32 = 0.7;
/// Panes that are looked through one behind the other, at most.
const MOST_PANES: usize = 6;
/// What is nearer behind a pane is the pane itself, metres; distances are told apart by a share of themselves.
const BEHIND_M: f32 = 1e-3;
const ROUNDING: f32 = 1e-5;

/// What a pixel shows behind the pane that it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Behind {
    /// Number of an instance, as [`Snapshot::behind`] has them, or [`SKY`].
    pub(super) instance: u32,
    /// Index into the triangles of its mesh, or [`SKY`].
    pub(super) triangle: u32,
    /// Share of light that passes all panes before it.
    pub(super) passes: f32,
}

/// Panes that one sees through.
pub(super) struct Panes<'a> {
    scene: &'a dyn Scene,
    /// By number of the instance: whether it has panes with something behind them.
    has_panes: Vec<bool>,
}

impl<'a> Panes<'a> {
    /// The panes of a scene; none where nothing stands behind any.
    pub(super) fn of(scene: &'a dyn Scene) -> Option<Self> {
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
    pub(super) fn is_pane(&self, instance: u32, triangle: u32) -> bool {
        self.has_panes.get(instance as usize) == Some(&true)
            && is_window(self.scene.snapshot(), instance, triangle)
    }

    /// What is behind the pixels of a row that see panes, from left to right.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn behind(&self, buffer: &VisibilityBuffer, y: u32) -> Result<Vec<Behind>, RenderError> {
        let camera = &buffer.camera;
        let turn = Mat3::from(camera.local_from_optical.matrix3);
        let (mut directions, mut nearest_m) = (Vec::new(), Vec::new());
        for x in 0..buffer.width {
            let at = buffer.index(x, y);
            if self.is_pane(buffer.instance[at], buffer.triangle[at]) {
                let direction = turn * buffer.direction_optical(x, y);
                let length = direction.length();
                directions.push(direction / length);
                nearest_m.push(beyond(buffer.depth_m[at] * length));
            }
        }
        let origin = Vec3::from(camera.local_from_optical.translation);
        let mut found = vec![Behind { instance: SKY, triangle: SKY, passes: PASSES }; directions.len()];
        let mut places: Vec<usize> = (0..found.len()).collect();
        for looked_through in 1.. {
            if places.is_empty() {
                break;
            }
            let range_m = [0.0, f32::INFINITY];
            let rays = RayBatch { origin, directions: &directions, range_m, nearest_m: &nearest_m };
            let hits = self.scene.trace_behind(0.0, &[rays])?;
            let mut left = 0;
            for (ray, hit) in hits.iter().flat_map(|hits| hits.iter()).enumerate() {
                let Some(hit) = hit else { continue };
                let place = places[ray];
                if looked_through < MOST_PANES && self.is_pane(hit.instance, hit.triangle) {
                    found[place].passes *= PASSES;
                    places[left] = place;
                    directions[left] = directions[ray];
                    nearest_m[left] = beyond(hit.t);
                    left += 1;
                } else {
                    (found[place].instance, found[place].triangle) = (hit.instance, hit.triangle);
                }
            }
            places.truncate(left);
            directions.truncate(left);
            nearest_m.truncate(left);
        }
        Ok(found)
    }
}

fn is_window(snapshot: &Snapshot, instance: u32, triangle: u32) -> bool {
    let Some(instance) = snapshot.instances.get(instance as usize) else { return false };
    snapshot.mesh(instance).part(triangle as usize).surface.is_window()
}

/// The nearest distance of what is behind something.
fn beyond(distance_m: f32) -> f32 {
    distance_m * (1.0 + ROUNDING) + BEHIND_M
}
