//! What `postprocess-valid` sees.

use schema::tables::VISIBLE_TABLE;
use serde::Serialize;

use crate::{Mount, OccupancySettings, PerAgent};

/// A sensor whose points are counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RangeSensor {
    /// Name, as in file names.
    pub name: String,
    /// Where it sits.
    pub mount: Mount,
    /// It gives points at frames 0, n, 2 n, ...
    pub every_n_frames: u32,
    /// Whether its table tells which returns are of rain and fog.
    pub tells_returns: bool,
}

/// Sensors of an agent that tell whether an object was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RangeRig {
    /// Lidars without labels.
    pub lidars: Vec<RangeSensor>,
    /// Radars.
    pub radars: Vec<RangeSensor>,
    /// Whether there are instance images.
    pub instance: bool,
}

impl RangeRig {
    /// Whether a table of the agent is read, by its name.
    #[must_use]
    pub fn reads(&self, table: &str) -> bool {
        self.lidars.iter().chain(&self.radars).any(|sensor| sensor.name == table)
            || self.instance && table == VISIBLE_TABLE
    }
}

/// What boxes are judged and voxel grids are filled from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValiditySettings {
    /// An object without points counts as valid when an instance image shows it.
    pub valid_by_image: bool,
    /// Sensors of each agent.
    pub rigs: PerAgent<RangeRig>,
    /// Voxel grid of each agent.
    pub occupancy: PerAgent<OccupancySettings>,
}
