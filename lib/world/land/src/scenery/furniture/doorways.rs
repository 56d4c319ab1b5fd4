//! Ways to doors.

use frames::OrientedRect;

use crate::scenery::claims::Candidate;
use crate::scenery::lots::House;

/// Half the width of the way to a door that stays free, metres.
pub(super) const HALF_WAY_M: f64 = 1.1;

/// The ground between a building's door and the street.
pub(super) fn doorway(house: &Candidate<House<'_>>) -> OrientedRect {
    let front_m = house.takes.half_m[0];
    let length_m = house.what.setback_m;
    // The first axis of a building leads to the street.
    let [ax, ay] = house.takes.axis;
    let [x, y] = house.takes.centre_m;
    let (ahead, aside) = (front_m + 0.5 * length_m, house.what.door_m());
    OrientedRect {
        centre_m: [x + ahead * ax - aside * ay, y + ahead * ay + aside * ax],
        axis: [ax, ay],
        half_m: [0.5 * length_m, HALF_WAY_M],
    }
}
