//! Lidars: a table of beams, one sweep a frame.

mod air;
mod beam;
mod fire;
mod instrument;
mod patch;
mod path;
mod receive;
mod reflectance;
mod scan;
mod sensor;
mod sweep;
mod twins;

pub use self::instrument::Lidar;
pub use self::path::{LidarMoment, SensorPath};
pub use self::scan::Scan;
pub(crate) use self::sensor::LidarSensor;
pub(crate) use self::sweep::SweepRow;
pub use self::sweep::{LidarSweep, OfBeam};
pub use self::twins::SharedBeams;
pub(crate) use self::twins::SharedScan;
