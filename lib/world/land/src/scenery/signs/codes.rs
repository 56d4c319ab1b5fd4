//! What the signs of a map say: by their code in a catalogue, or by their name.
//!
//! Numbers are those of the German catalogue (OpenDRIVE files use it by custom, whatever the country), words
//! like `R1-1` those of the North American one, letters with a number the Swedish ones. CARLA's towns have
//! most of their signs as objects that only their name tells.

use schema::speed_limit_type;

use super::plates::{BAN, BEND, OTHER, Plate, WARNING, plate_of};

/// What a sign says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meaning {
    /// One of [`schema::SIGN_TYPES`].
    pub(crate) sign_type: &'static str,
    pub(crate) plate: Plate,
    /// The number on it.
    pub(crate) value: Option<f64>,
}

impl Meaning {
    pub(crate) fn of(sign_type: &'static str) -> Self {
        Self { sign_type, plate: plate_of(sign_type), value: None }
    }

    fn unknown(plate: Plate) -> Self {
        Self { sign_type: "", plate, value: None }
    }

    /// A speed limit with a number, if it is known.
    pub(crate) fn limit(value: Option<f64>) -> Self {
        let value = value.filter(|v| *v > 0.0);
        Self { value, ..Self::of(value.map_or("speed_limit", speed_limit_type)) }
    }
}

/// Kinds of the German catalogue that are no boards: crossings, stop lines and other paint.
const NO_BOARDS: [&str; 6] = ["293", "294", "295", "297", "298", "299"];
/// Numbers from here on are lights and what else OpenDRIVE files list under no country.
const FIRST_LIGHT: u32 = 1_000_000;

/// What a signal that does not change says: none where it is no sign (paint, lights that are said not to
/// change). `kind` and `subtype` are those of the file, `value` its number.
pub(crate) fn of_signal(kind: &str, subtype: &str, value: Option<f64>, name: &str) -> Option<Meaning> {
    if kind.eq_ignore_ascii_case("roadmark") || is_paint(&plain(name)) {
        return None;
    }
    // Some files put both into one, with a dash or a dot between them.
    let kind = kind.trim().to_ascii_uppercase();
    let number = kind.parse::<u32>().or_else(|_| kind.replace('.', "").parse());
    let (main, sub) = match kind.split_once(['-', '.']) {
        Some((main, sub)) if main.parse::<u32>().is_ok() => (main, sub),
        _ => (kind.as_str(), subtype.trim()),
    };
    if NO_BOARDS.contains(&main) || number.is_ok_and(|n| n >= FIRST_LIGHT) {
        return None;
    }
    let known =
        german(main, sub, value).or_else(|| american(&kind, value)).or_else(|| swedish(main, sub, value));
    match known.or_else(|| of_name(name)) {
        None if is_crosswalk(&plain(name)) => None,
        said => Some(said.unwrap_or(Meaning::unknown(OTHER))),
    }
}

/// What an object of the map says, if its name is that of a sign. `kind` is its type in the file: signs have
/// none.
pub(crate) fn of_object(kind: &str, name: &str) -> Option<Meaning> {
    let plain = plain(name);
    let nothing = matches!(kind, "" | "-1") || kind.eq_ignore_ascii_case("none");
    (nothing && !is_paint(&plain)).then(|| of_name(name)).flatten()
}

fn german(main: &str, sub: &str, value: Option<f64>) -> Option<Meaning> {
    let word = match main {
        "101" if matches!(sub, "11" | "21") => "pedestrian_crossing",
        "112" => "uneven_road",
        "133" | "138" => "frequent_pedestrian_cyclist",
        "134" | "350" => "pedestrian_crossing",
        "136" => "school_zone",
        "140" | "142" => "animal_crossing",
        "205" => "yield",
        "206" => "stop",
        "215" => "roundabout",
        "220" | "353" => "one_way",
        "224" => "bus_stop_no_parking",
        "253" => "passenger_cars_only",
        "254" => "no_bicycles",
        "259" => "no_pedestrians",
        "267" => "do_not_enter",
        "283" => "no_standing",
        "286" | "290" => "no_parking",
        "314" | "315" => "parking",
        "330" | "331" => "highway",
        "437" => "street_name",
        "448" | "449" | "450" => "interchange",
        "531" => "lane_reduction",
        "274" => return Some(Meaning::limit(value.filter(|v| *v > 0.0).or_else(|| numbered(sub)))),
        "103" | "105" => return Some(Meaning::unknown(BEND)),
        "101" | "108" | "110" | "114" | "117" | "120" | "121" | "123" | "124" | "125" | "131" | "151"
        | "156" => {
            return Some(Meaning::unknown(WARNING));
        }
        "250" | "251" | "255" | "260" | "272" | "276" | "277" => return Some(Meaning::unknown(BAN)),
        _ => return None,
    };
    Some(Meaning::of(word))
}

/// The limit that a subtype of 274 names: 51 to 62 are 10 to 120 km/h, as 274-55; zones have theirs behind a
/// dot.
fn numbered(sub: &str) -> Option<f64> {
    match sub.parse::<u32>().ok()? {
        tens @ 51..=63 => Some(10.0 * f64::from(tens - 50)),
        1 => Some(30.0),
        _ => None,
    }
}

/// North America, by the manual's codes; a letter behind them tells apart versions of one.
fn american(kind: &str, value: Option<f64>) -> Option<Meaning> {
    let word = match kind.trim_end_matches(['A', 'B', 'C']) {
        "R1-1" => "stop",
        "R1-2" => "yield",
        "R1-5" => "yield_to_pedestrians",
        "R1-6" => "stop_for_pedestrians",
        "R2-1" => return Some(Meaning::limit(value)),
        "R3-2" => "no_left_turn",
        "R3-3" => "no_turns",
        "R5-1" => "do_not_enter",
        "R5-6" => "no_bicycles",
        "R6-1" | "R6-2" => "one_way",
        "R7-1" | "R7-2" | "R8-3" => "no_parking",
        "R7-4" => "no_standing",
        "R7-8" => "reserved_parking",
        "R7-5" | "R7-108" => "parking_time_limit",
        "R7-107" => "bus_stop_no_parking",
        "R7-201" => "tow_away_zone",
        "R9-2" => "cross_only_at_crosswalk",
        "R9-3" => "no_pedestrians",
        "R10-18" => "photo_enforced",
        "S1-1" => "school_zone",
        "W2-6" => "roundabout",
        "W4-2" => "lane_reduction",
        "W8-1" => "bump_ahead",
        "W8-8" => "uneven_road",
        "W11-1" | "W11-15" => "frequent_pedestrian_cyclist",
        "W11-2" => "pedestrian_crossing",
        "W11-3" | "W11-4" => "animal_crossing",
        "D3-1" => "street_name",
        _ => return None,
    };
    Some(Meaning::of(word))
}

/// Sweden: a letter, and the number as the subtype. Speeds are in tens of km/h in files that follow the
/// catalogue.
fn swedish(main: &str, sub: &str, value: Option<f64>) -> Option<Meaning> {
    let word = match (main, sub) {
        ("A", "8" | "9") => return Some(Meaning::unknown(BEND)),
        ("A", "13") => "pedestrian_crossing",
        ("A", "15") => "school_zone",
        ("A", "19") => "animal_crossing",
        ("B", "1") => "yield",
        ("B", "2") => "stop",
        ("B", "3") => "pedestrian_crossing",
        ("C", "1") => "do_not_enter",
        ("C", "10") => "no_bicycles",
        ("C", "15") => "no_pedestrians",
        ("C", "31") => {
            return Some(Meaning::limit(value.map(|v| if v <= 12.0 { 10.0 * v } else { v })));
        }
        ("C", "35") => "no_parking",
        ("C", "39") => "no_standing",
        ("D", "3") => "roundabout",
        ("E", "19") => "parking",
        ("E", "16") => "one_way",
        _ => return None,
    };
    Some(Meaning::of(word))
}

/// A name's letters and digits, small.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// Whether a plain name is that of something on the road, whatever else it says.
fn is_paint(plain: &str) -> bool {
    ["stopline", "stencil", "arrowtype", "chevronregion", "crosshatch", "sgrm"]
        .iter()
        .any(|word| plain.contains(word))
}

/// Whether a plain name, if nothing says that it is a sign, is that of stripes on the road.
fn is_crosswalk(plain: &str) -> bool {
    plain.contains("crosswalk")
}

/// Parts of plain names, most telling first, and what they say.
const NAMES: [(&str, &str); 41] = [
    ("stopforped", "stop_for_pedestrians"),
    ("yieldtoped", "yield_to_pedestrians"),
    ("onlyatcrosswalk", "cross_only_at_crosswalk"),
    ("signcrosswalk", "pedestrian_crossing"),
    ("crosswalkahead", "pedestrian_crossing"),
    ("busstop", "bus_stop_no_parking"),
    ("nostopping", "no_standing"),
    ("nostanding", "no_standing"),
    ("towingenforced", "no_parking_towing_enforced"),
    ("towaway", "tow_away_zone"),
    ("noparking", "no_parking"),
    ("parkingtimelimit", "parking_time_limit"),
    ("hourparking", "parking_time_limit"),
    ("reservedparking", "reserved_parking"),
    ("signparking", "parking"),
    ("parkingsign", "parking"),
    ("michigan", "michigan_left"),
    ("noturnleft", "no_left_turn"),
    ("noleftturn", "no_left_turn"),
    ("noturn", "no_turns"),
    ("donotenter", "do_not_enter"),
    ("noentry", "do_not_enter"),
    ("oneway", "one_way"),
    ("nobicycle", "no_bicycles"),
    ("nopedestrian", "no_pedestrians"),
    ("passengercarsonly", "passenger_cars_only"),
    ("pedestriancrossing", "pedestrian_crossing"),
    ("pedcrossing", "pedestrian_crossing"),
    ("schoolzone", "school_zone"),
    ("animalcrossing", "animal_crossing"),
    ("lanereduction", "lane_reduction"),
    ("photoenforced", "photo_enforced"),
    ("cleanupafterpet", "clean_up_after_pet"),
    ("roundabout", "roundabout"),
    ("bumpahead", "bump_ahead"),
    ("unevenroad", "uneven_road"),
    ("streetname", "street_name"),
    ("billboard", "billboard"),
    ("signyield", "yield"),
    ("yieldsign", "yield"),
    ("giveway", "yield"),
];

/// What a sign says by its name; none where it says nothing.
fn of_name(name: &str) -> Option<Meaning> {
    let plain = plain(name);
    if let Some(kph) = limit_of_name(name) {
        // The published set has the plain word where only the name has a number.
        return Some(Meaning { value: Some(kph), ..Meaning::of("speed_limit") });
    }
    if let Some((_, word)) = NAMES.iter().find(|(part, _)| plain.contains(part)) {
        return Some(Meaning::of(word));
    }
    if plain.starts_with("laner") && plain.contains("assembly") {
        return Some(Meaning::of("lane_reduction"));
    }
    let is_stop = ["signstop", "stopsign"].iter().any(|part| plain.contains(part));
    is_stop.then(|| Meaning::of("stop"))
}

/// The number of a speed limit that a name is about, as `Speed_30` or `SpeedLimit60Assembly`. Other things
/// have speed in their names, too, and counters behind them.
fn limit_of_name(name: &str) -> Option<f64> {
    const BETWEEN: [&str; 6] = ["", "limit", "sign", "limitsign", "highest", "max"];
    let small = name.to_ascii_lowercase();
    // One of CARLA's towns writes it with two p.
    let (_, rest) = ["speed", "spped"].iter().find_map(|word| small.split_once(word))?;
    let (words, rest) = rest.split_at(rest.find(|c: char| c.is_ascii_digit())?);
    // Numbers behind the first one tell apart files.
    let digits = rest.split(|c: char| !c.is_ascii_digit()).next()?;
    let number =
        digits.parse::<u32>().ok().filter(|n| !digits.starts_with('0') && n % 5 == 0 && *n <= 150)?;
    BETWEEN.contains(&plain(words).as_str()).then(|| f64::from(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::SIGN_TYPES;

    /// Type, subtype, number and name of a signal; what it says, its board's model and its number.
    type Case = (&'static str, &'static str, f64, &'static str, Option<(&'static str, &'static str, f64)>);

    #[test]
    fn signals_say_what_the_catalogues_say() {
        let cases: &[Case] = &[
            // CARLA's towns.
            ("206", "-1", -1.0, "Sign_Stop", Some(("stop", "sign.stop", 0.0))),
            ("205", "-1", -1.0, "Sign_Yield", Some(("yield", "sign.yield", 0.0))),
            ("roadMark", "", 0.0, "StopLine", None),
            ("1000001", "-1", -1.0, "Signal_3Light_Post01", None),
            // Our towns, and others with a number.
            ("274", "-1", 50.0, "Sign_Speed_50", Some(("speed_limit_50", "sign.speed", 50.0))),
            ("274", "-1", 35.0, "", Some(("speed_limit", "sign.speed", 35.0))),
            ("274", "-1", -1.0, "", Some(("speed_limit", "sign.speed", 0.0))),
            ("274", "57", 70.0, "Sg274Hoechstgeschw70_02.flt", Some(("speed_limit_70", "sign.speed", 70.0))),
            ("274", "55", 0.0, "", Some(("speed_limit_50", "sign.speed", 50.0))),
            ("274-60", "", 0.0, "", Some(("speed_limit_100", "sign.speed", 100.0))),
            ("274.1", "", 0.0, "", Some(("speed_limit_30", "sign.speed", 30.0))),
            ("201", "-1", -1.0, "Sign_StAndrewsCross", Some(("", "sign.other", 0.0))),
            // Paint and lights that files list among the signs.
            ("294", "-1", 0.0, "SgRMHoldingline-1Lane.flt", None),
            ("1000003", "-1", 4.0, "SgRMCrosswalk-2Lanes-4m.flt", None),
            ("1.000.011", "10", 0.0, "", None),
            ("-1", "-1", 0.0, "SgRMArrowLeft.flt", None),
            ("294-10", "", 0.0, "", None),
            ("299.1", "", 0.0, "", None),
            ("295", "10", 0.0, "", None),
            ("", "", 0.0, "SimpleCrosswalk", None),
            ("-1", "-1", -1.0, "Stencil_SchoolZone", None),
            // Names of crosswalks that are those of signs.
            ("350", "10", 0.0, "Sign_Crosswalk_3", Some(("pedestrian_crossing", "sign.crossing", 0.0))),
            ("R1-5", "", 0.0, "YieldAtCrosswalk", Some(("yield_to_pedestrians", "sign.info", 0.0))),
            ("-1", "", 0.0, "CrossOnlyAtCrosswalk", Some(("cross_only_at_crosswalk", "sign.info", 0.0))),
            // The German catalogue.
            ("101", "11", 0.0, "", Some(("pedestrian_crossing", "sign.crossing", 0.0))),
            ("101", "", 0.0, "", Some(("", "sign.warning", 0.0))),
            ("103", "20", 0.0, "", Some(("", "sign.bend", 0.0))),
            ("136", "10", 0.0, "", Some(("school_zone", "sign.warning", 0.0))),
            ("142", "10", 0.0, "", Some(("animal_crossing", "sign.warning", 0.0))),
            ("215", "", 0.0, "", Some(("roundabout", "sign.duty", 0.0))),
            ("220", "10", 0.0, "", Some(("one_way", "sign.one_way", 0.0))),
            ("259", "", 0.0, "", Some(("no_pedestrians", "sign.ban", 0.0))),
            ("267", "", 0.0, "", Some(("do_not_enter", "sign.no_entry", 0.0))),
            ("283", "30", 0.0, "", Some(("no_standing", "sign.no_parking", 0.0))),
            ("286-10", "", 0.0, "", Some(("no_parking", "sign.no_parking", 0.0))),
            ("306", "-1", 0.0, "Sg306Vorfahrtstrasse02.flt", Some(("", "sign.other", 0.0))),
            ("314", "", 0.0, "", Some(("parking", "sign.parking", 0.0))),
            ("330.1", "", 0.0, "", Some(("highway", "sign.guide", 0.0))),
            ("350", "10", 0.0, "", Some(("pedestrian_crossing", "sign.crossing", 0.0))),
            ("437", "", 0.0, "", Some(("street_name", "sign.name", 0.0))),
            ("449", "", 0.0, "", Some(("interchange", "sign.guide", 0.0))),
            // North America and Sweden.
            ("R1-1", "", 0.0, "", Some(("stop", "sign.stop", 0.0))),
            ("r2-1", "", 55.0, "", Some(("speed_limit_55", "sign.speed", 55.0))),
            ("R1-6a", "", 0.0, "", Some(("stop_for_pedestrians", "sign.info", 0.0))),
            ("W11-2", "", 0.0, "", Some(("pedestrian_crossing", "sign.crossing", 0.0))),
            ("c", "31", 5.0, "speed_50_1", Some(("speed_limit_50", "sign.speed", 50.0))),
            ("c", "28", 1.0, "overtaking_ban_end", Some(("", "sign.other", 0.0))),
            // No code that is known: the name tells, or nothing does.
            ("", "", 0.0, "speed_50_1", Some(("speed_limit", "sign.speed", 50.0))),
            ("-1", "-1", -1.0, "Sign_NoUTurn", Some(("", "sign.other", 0.0))),
            ("-1", "-1", -1.0, "MapStopSign_stopsign_2", Some(("stop", "sign.stop", 0.0))),
            ("9999", "", 0.0, "", Some(("", "sign.other", 0.0))),
        ];
        for (kind, subtype, value, name, want) in cases {
            let found = of_signal(kind, subtype, Some(*value), name);
            let found = found.map(|m| (m.sign_type, m.plate.model, m.value.unwrap_or(0.0)));
            assert_eq!(found, *want, "{kind} {subtype} {value} {name}");
            assert!(found.is_none_or(|(word, ..)| SIGN_TYPES.contains(&word)));
        }
    }

    #[test]
    fn objects_of_carlas_towns_say_it_by_their_names() {
        let cases = [
            ("-1", "Speed_30", Some(("speed_limit", 30.0))),
            ("-1", "speed_60", Some(("speed_limit", 60.0))),
            ("-1", "SppedLimit40Assembly", Some(("speed_limit", 40.0))),
            ("-1", "Speedlimit90Assembly", Some(("speed_limit", 90.0))),
            ("-1", "oneWayL_Assembly", Some(("one_way", 0.0))),
            ("-1", "NoTurnLeft_Round_Assembly", Some(("no_left_turn", 0.0))),
            ("-1", "NoTurn_Assembly", Some(("no_turns", 0.0))),
            ("-1", "DoNotEnter_Assembly", Some(("do_not_enter", 0.0))),
            ("-1", "MichiganTurnAssembly", Some(("michigan_left", 0.0))),
            ("-1", "LaneR_L0_Assembly", Some(("lane_reduction", 0.0))),
            ("-1", "LaneR_L3Assembly", Some(("lane_reduction", 0.0))),
            ("-1", "Sign_Crosswalk_01", Some(("pedestrian_crossing", 0.0))),
            ("-1", "Sign_Speed_Limit_100_2", Some(("speed_limit", 100.0))),
            ("-1", "speed_highest_70", Some(("speed_limit", 70.0))),
            // Other things with speed in their names, and counters.
            ("-1", "SpeedBump_01", None),
            ("-1", "SpeedBump_10", None),
            ("-1", "SpeedCamera_3", None),
            ("-1", "SpeedCamera30", None),
            ("-1", "SpeedSign_01", None),
            ("-1", "Speed_Sign_3", None),
            ("-1", "speed_lowest_50", None),
            ("-1", "LineMultipleSpeeds", None),
            ("-1", "PhotoEnforced_Speed", Some(("photo_enforced", 0.0))),
            // Posts, paint and other things.
            ("-1", "SignPost_10ft", None),
            ("-1", "Signal_Post_17ft", None),
            ("-1", "Stencil_STOP", None),
            ("-1", "StopLine", None),
            ("-1", "SolidSingleWhite", None),
            ("crosswalk", "SimpleCrosswalk", None),
            ("parkingSpace", "ParkingSpace", None),
            ("pole", "Speed_30", None),
        ];
        for (kind, name, want) in cases {
            let found = of_object(kind, name).map(|m| (m.sign_type, m.value.unwrap_or(0.0)));
            assert_eq!(found, want, "{kind} {name}");
        }
    }

    #[test]
    fn every_word_of_the_tables_is_one_of_the_vocabulary() {
        assert!(NAMES.iter().all(|(_, word)| SIGN_TYPES.contains(word)));
    }
}
