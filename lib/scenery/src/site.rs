//! What placing rules look at.

use opendrive::Map;
use schema::settings::WorldSettings;
use surfaces::GroundLevels;

/// Everything that placing rules look at.
pub(crate) struct Site<'a> {
    pub(crate) map: &'a Map,
    pub(crate) settings: &'a WorldSettings,
    pub(crate) seed: u64,
    pub(crate) centres: &'a [[f64; 3]],
    pub(crate) ground: &'a GroundLevels,
}

impl Site<'_> {
    /// Whether a place is near enough to a centre.
    pub(crate) fn near(&self, x: f64, y: f64) -> bool {
        let radius = self.settings.radius_m;
        self.centres.iter().any(|c| {
            let (dx, dy) = (x - c[0], y - c[1]);
            dx * dx + dy * dy <= radius * radius
        })
    }
}
