//! Lidars: a table of beams, one sweep a frame.

mod air;
mod beam;
mod detect;
mod emit;
mod instrument;
mod patch;
mod path;
mod reflectance;
mod scan;
mod sensor;
mod shared_scan;
mod sweep;

pub use self::instrument::Lidar;
pub use self::path::{LidarMoment, SensorPath};
pub use self::scan::Scan;
pub(crate) use self::sensor::LidarSensor;
pub use self::shared_scan::SharedBeams;
pub(crate) use self::shared_scan::SharedScan;
pub(crate) use self::sweep::SweepRow;
pub use self::sweep::{LidarSweep, OfBeam};
