//! Radars.

mod instrument;
mod sensor;
mod together;

pub use instrument::{RadarMotion, RadarQuery, RadarReturns, radars};
pub(crate) use sensor::Radar;
pub use together::Radars;
