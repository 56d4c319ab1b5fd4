//! The boards of signs.

/// A kind of board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Model name.
    pub model: &'static str,
    /// Depth, width, height, metres.
    pub size_m: [f64; 3],
    /// Bottom over the ground, metres.
    pub bottom_m: f64,
}

const fn plate(model: &'static str, width_m: f64, height_m: f64, bottom_m: f64) -> Plate {
    Plate { model, size_m: [0.08, width_m, height_m], bottom_m }
}

/// An octagon.
pub(crate) const STOP: Plate = plate("sign.stop", 0.76, 0.76, 2.2);
/// A triangle on its tip.
pub(crate) const YIELD: Plate = plate("sign.yield", 0.76, 0.76, 2.2);
/// A number in a red ring.
pub(crate) const SPEED: Plate = plate("sign.speed", 0.76, 0.76, 2.2);
/// A device in a red ring, struck out.
pub(crate) const BAN: Plate = plate("sign.ban", 0.64, 0.64, 2.2);
/// A white bar on a red disc.
pub(crate) const NO_ENTRY: Plate = plate("sign.no_entry", 0.64, 0.64, 2.2);
/// A blue disc in a red ring, struck out.
pub(crate) const NO_PARKING: Plate = plate("sign.no_parking", 0.60, 0.60, 2.2);
/// Arrows on a blue disc.
pub(crate) const DUTY: Plate = plate("sign.duty", 0.64, 0.64, 2.2);
/// A black device in a red triangle.
pub(crate) const WARNING: Plate = plate("sign.warning", 0.90, 0.79, 2.2);
/// A bend in a red triangle.
pub(crate) const BEND: Plate = plate("sign.bend", 0.90, 0.79, 2.2);
/// Somebody on a crossing, on a blue square.
pub(crate) const CROSSING: Plate = plate("sign.crossing", 0.70, 0.70, 2.2);
/// A letter on a blue square.
pub(crate) const PARKING: Plate = plate("sign.parking", 0.60, 0.60, 2.2);
/// An arrow on a blue bar.
pub(crate) const ONE_WAY: Plate = plate("sign.one_way", 0.80, 0.30, 2.3);
/// Lines of text on a white board.
pub(crate) const INFO: Plate = plate("sign.info", 0.45, 0.60, 2.1);
/// A word on a blue strip.
pub(crate) const NAME: Plate = plate("sign.name", 0.90, 0.22, 2.5);
/// Lines of text on a large blue board.
pub(crate) const GUIDE: Plate = plate("sign.guide", 1.60, 1.10, 2.2);
/// Whatever else.
pub(crate) const OTHER: Plate = plate("sign.other", 0.76, 0.76, 2.2);

/// All kinds of boards.
pub const PLATES: [Plate; 16] = [
    STOP, YIELD, SPEED, BAN, NO_ENTRY, NO_PARKING, DUTY, WARNING, BEND, CROSSING, PARKING, ONE_WAY, INFO,
    NAME, GUIDE, OTHER,
];

/// The board that says something ([`schema::SIGN_TYPES`]).
pub(crate) fn plate_of(sign_type: &str) -> Plate {
    match sign_type {
        "stop" => STOP,
        "yield" => YIELD,
        "do_not_enter" => NO_ENTRY,
        "no_left_turn" | "no_turns" | "no_bicycles" | "no_pedestrians" => BAN,
        "no_parking" | "no_standing" | "no_parking_towing_enforced" => NO_PARKING,
        "roundabout" | "michigan_left" => DUTY,
        "pedestrian_crossing" => CROSSING,
        "parking" => PARKING,
        "one_way" => ONE_WAY,
        "highway" | "interchange" | "billboard" => GUIDE,
        "street_name" => NAME,
        "accident_ahead"
        | "animal_crossing"
        | "bump_ahead"
        | "uneven_road"
        | "school_zone"
        | "frequent_pedestrian_cyclist"
        | "lane_reduction" => WARNING,
        "" => OTHER,
        limit if limit.starts_with("speed_limit") => SPEED,
        _ => INFO,
    }
}
