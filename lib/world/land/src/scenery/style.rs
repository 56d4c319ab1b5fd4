//! Whether a town is furnished as in North America or as in Europe.

use random::Stream;

use crate::scenery::site::Site;

/// Towns have furniture of one style or of the other one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FurnitureStyle {
    /// In all towns.
    Any,
    /// As in North America.
    American,
    /// As in Europe.
    European,
}

/// Share of towns that are furnished as in North America.
const AMERICAN: f64 = 0.4;

impl Site<'_> {
    /// The style of the town.
    pub(crate) fn style(&self) -> FurnitureStyle {
        let roads = self.map.network().roads.len() as u64;
        let mut random = Stream::new(self.rules.seed, 0, "world/furniture/style", roads);
        if random.chance(AMERICAN) { FurnitureStyle::American } else { FurnitureStyle::European }
    }
}
