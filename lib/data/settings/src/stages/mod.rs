//! What each stage sees of the configuration: nothing else can reach its output, and just this is hashed in
//! its manifests.

mod masks;
mod plan;
mod sensors;
mod simulation;
mod statistics;
mod validity;

pub use masks::MaskSettings;
pub use plan::PlanSettings;
pub use sensors::{SensorSettings, SensorTableSettings};
pub use simulation::SimulationSettings;
pub use statistics::StatisticsSettings;
pub use validity::{RangeRig, RangeSensor, ValiditySettings};
