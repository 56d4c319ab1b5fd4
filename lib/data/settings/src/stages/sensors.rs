//! What `render-sensors` sees.

use serde::Serialize;

use crate::{PerAgent, Rig};

/// What sensors are rendered from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorSettings {
    /// Seed of every random stream.
    pub seed: u64,
    /// Sensors of each agent.
    pub rigs: PerAgent<Rig>,
}
