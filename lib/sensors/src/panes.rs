//! What is behind the panes of vehicles: the first surface there that is none.

use glam::Vec3;
use renderer::{Hit, RayBatch, RenderError, Scene};

/// Share of light that passes a pane: UN Regulation 43 wants 70 % of panes that a driver looks through.
pub(crate) const PASSES: f32 = 0.7;
/// Panes that are looked through one behind the other, at most.
const MOST_PANES: u8 = 6;
/// What is nearer behind a pane is the pane itself, metres; distances are told apart by a share of themselves.
const BEHIND_M: f32 = 1e-3;
const ROUNDING: f32 = 1e-5;

/// Panes that one sees through: those with something behind them.
pub(crate) struct Panes<'a> {
    scene: &'a dyn Scene,
    /// By number of the instance.
    has_panes: Vec<bool>,
}

/// What a ray meets behind a pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Behind {
    /// What it ends at; the sky if nothing. Instances are numbered as [`schema::geometry::Snapshot::behind`] has them.
    pub(crate) hit: Option<Hit>,
    /// Panes that it passed.
    pub(crate) panes: u8,
}

/// Rays that met panes.
#[derive(Debug, Default)]
pub(crate) struct Passing {
    /// Unit directions.
    pub(crate) directions: Vec<Vec3>,
    /// Where the panes are, metres.
    pub(crate) panes_m: Vec<f32>,
}

impl<'a> Panes<'a> {
    /// The panes of a scene; none where nothing stands behind any.
    pub(crate) fn of(scene: &'a dyn Scene) -> Option<Self> {
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
    pub(crate) fn is_pane(&self, instance: u32, triangle: u32) -> bool {
        self.has_panes.get(instance as usize) == Some(&true) && {
            let snapshot = self.scene.snapshot();
            let mesh = snapshot.mesh(&snapshot.instances[instance as usize]);
            mesh.part(triangle as usize).surface.is_window()
        }
    }

    /// What rays from a place meet behind the panes that they met, at a moment (0 is this frame, 1 the one before).
    ///
    /// # Errors
    /// The renderer failed.
    pub(crate) fn behind(
        &self,
        before: f32,
        origin: Vec3,
        reach_m: f32,
        rays: Passing,
    ) -> Result<Vec<Behind>, RenderError> {
        let Passing { mut directions, panes_m } = rays;
        let mut nearest_m: Vec<f32> = panes_m.into_iter().map(beyond).collect();
        let mut found = vec![Behind { hit: None, panes: 1 }; directions.len()];
        let mut places: Vec<usize> = (0..found.len()).collect();
        while !places.is_empty() {
            let range_m = [0.0, reach_m];
            let batch = RayBatch { origin, directions: &directions, range_m, nearest_m: &nearest_m };
            let hits = self.scene.trace_behind(before, &[batch])?;
            let mut left = 0;
            for (ray, hit) in hits.iter().flat_map(|hits| hits.iter()).enumerate() {
                let Some(hit) = hit else { continue };
                let behind = &mut found[places[ray]];
                if behind.panes < MOST_PANES && self.is_pane(hit.instance, hit.triangle) {
                    behind.panes += 1;
                    places[left] = places[ray];
                    directions[left] = directions[ray];
                    nearest_m[left] = beyond(hit.t);
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
}

/// The nearest distance of what is behind something.
fn beyond(distance_m: f32) -> f32 {
    distance_m * (1.0 + ROUNDING) + BEHIND_M
}
