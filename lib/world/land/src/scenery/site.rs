//! What placing rules look at.

use crate::surfaces::{AreaGround, GroundLevels};
use catalogue::Catalogue;
use opendrive::Map;
use settings::SceneryRules;

/// Half the side of the ground that a pole takes, metres.
pub(crate) const FOOT_M: f64 = 0.3;
/// Half the thickness of a pole, metres.
pub(crate) const POLE_M: f64 = 0.14;

/// Everything that placing rules look at.
pub(crate) struct Site<'a> {
    pub(crate) map: &'a Map,
    pub(crate) rules: &'a SceneryRules,
    pub(crate) catalogue: &'a Catalogue,
    pub(crate) ground: &'a AreaGround<'a>,
}

/// How far around the area candidates of each kind are looked at, metres. The objects in the area must be the
/// same for every area that contains them, so every kind is known as far out as it decides about the objects
/// there: its own candidates keep one another away ([`crate::scenery::claims`]), and the later kinds keep off
/// the earlier ones. From the last kind to the first, each distance is the next one's, and how far the two
/// kinds' ground can be apart and still meet.
pub(crate) mod reach_m {
    /// Things of the table of furniture: half diagonals of 2.4.
    pub(crate) const FURNITURE: f64 = 4.8;
    /// Signs: of 0.5.
    pub(crate) const SIGNS: f64 = FURNITURE + 2.9 + 1.0;
    /// Racks for bicycles: of 2.1.
    pub(crate) const RACKS: f64 = SIGNS + 2.6 + 4.2;
    /// Benches and bins: of 0.9.
    pub(crate) const SMALL: f64 = RACKS + 3.0 + 1.9;
    /// Bushes: of 1.6.
    pub(crate) const BUSHES: f64 = SMALL + 2.5 + 3.2;
    /// Trees: stems of 0.7, their room of 2.9.
    pub(crate) const TREES: f64 = BUSHES + 2.3 + 3.6;
    /// Pieces of fences: of 3.1.
    pub(crate) const FENCES: f64 = TREES + 6.0 + 6.2;
    /// Poles of lines: a pole and its wires in the area depend on the next one, up to 54 away.
    pub(crate) const UTILITY: f64 = 60.0;
    /// Street lamps: of 0.5.
    pub(crate) const LAMPS: f64 = UTILITY + 0.5 + 1.0;
    /// Parked vehicles: buses of 6.3.
    pub(crate) const PARKED: f64 = LAMPS + 6.8 + 12.6;
    /// Buildings that were kept: a border is up to 42 from the middle of its building.
    pub(crate) const BUILT: f64 = FENCES + 42.0;
    /// Buildings: half diagonals of 21.7 with what they keep free.
    pub(crate) const BUILDINGS: f64 = BUILT + 43.4;
    /// What the map itself puts there: beside buildings.
    pub(crate) const GIVEN: f64 = BUILDINGS + 25.0;
}

impl Site<'_> {
    pub(crate) fn levels(&self) -> &GroundLevels {
        &self.ground.levels
    }

    /// Whether a place belongs to the area.
    pub(crate) fn holds(&self, x: f64, y: f64) -> bool {
        self.ground.area.contains(x, y)
    }

    /// Whether a place is in the area or within some metres of it.
    pub(crate) fn near(&self, x: f64, y: f64, reach_m: f64) -> bool {
        self.ground.area.grown(reach_m).contains(x, y)
    }
}
