//! What `stats` sees.

use serde::Serialize;

use crate::{AnnotationSettings, BevSettings, CardSettings, OccupancySettings, PerAgent, Rig};

/// What the statistics and the dataset's card say of the configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatisticsSettings {
    /// Name of the dataset.
    pub name: String,
    /// Words of its card.
    pub card: CardSettings,
    /// Seed of every random stream.
    pub seed: u64,
    /// Sensors of each agent.
    pub rigs: PerAgent<Rig>,
    /// Which objects are annotated.
    pub annotation: AnnotationSettings,
    /// BEV masks.
    pub bev: BevSettings,
    /// Voxel grid of each agent.
    pub occupancy: PerAgent<OccupancySettings>,
    /// The same of each group of scenes, by its name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<(String, StatisticsSettings)>,
    /// The same of older editions, by number.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub older: Vec<StatisticsSettings>,
}
