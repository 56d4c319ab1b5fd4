//! How high the ground is.

use crate::surfaces::cover::Cover;
use crate::surfaces::terrain::Terrain;
use crate::surfaces::water::Water;

/// Heights of the ground.
#[derive(Debug)]
pub struct GroundLevels {
    /// Lane surfaces, and paving between lanes.
    pub cover: Cover,
    pub(crate) terrain: Terrain,
    /// Rivers and lakes.
    pub waters: Vec<Water>,
}

/// Surfaces this far above or below the height asked for count as the same level, metres.
const LEVEL_M: f64 = 2.5;

impl GroundLevels {
    /// Height of the ground at a point: of lanes on the level of `near_z` the nearest, else the terrain if it
    /// is on that level, else whatever is nearest.
    #[must_use]
    pub fn height(&self, x: f64, y: f64, near_z: f64) -> f64 {
        let terrain = self.terrain.height(x, y);
        let off = |z: f64| (z - near_z).abs();
        let lanes = self.cover.at(x, y).map(|(_, z)| z);
        match lanes.min_by(|a, b| off(*a).total_cmp(&off(*b))) {
            // Lanes lie over the terrain, so on one level they are what is stood on.
            Some(lane) if off(lane) <= LEVEL_M || off(lane) <= off(terrain) => lane,
            _ => terrain,
        }
    }
}
