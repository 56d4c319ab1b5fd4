//! Draws the boards of signs: `cargo run -p convoy-sensors --example signs -- FOLDER`. From near by, and as a
//! driver has them 20 and 40 m away.

mod stage;

use std::error::Error;
use std::path::Path;

use glam::{Affine3A, Vec3};
use schema::{SIGN_TYPES, SignFace};

use stage::{Stage, at};

/// Model, width and height in metres, what it says, and a number.
const BOARDS: [(&str, [f64; 2], &str, u16); 32] = [
    ("sign.stop", [0.76, 0.76], "stop", 0),
    ("sign.yield", [0.76, 0.76], "yield", 0),
    ("sign.speed", [0.76, 0.76], "speed_limit_30", 30),
    ("sign.speed", [0.76, 0.76], "speed_limit", 45),
    ("sign.speed", [0.76, 0.76], "speed_limit_120", 120),
    ("sign.speed", [0.76, 0.76], "speed_limit", 68),
    ("sign.speed", [0.76, 0.76], "speed_limit", 97),
    ("sign.no_entry", [0.64, 0.64], "do_not_enter", 0),
    ("sign.ban", [0.64, 0.64], "no_left_turn", 0),
    ("sign.ban", [0.64, 0.64], "no_bicycles", 0),
    ("sign.ban", [0.64, 0.64], "no_pedestrians", 0),
    ("sign.no_parking", [0.60, 0.60], "no_parking", 0),
    ("sign.no_parking", [0.60, 0.60], "no_standing", 0),
    ("sign.duty", [0.64, 0.64], "roundabout", 0),
    ("sign.warning", [0.90, 0.79], "", 0),
    ("sign.warning", [0.90, 0.79], "school_zone", 0),
    ("sign.warning", [0.90, 0.79], "animal_crossing", 0),
    ("sign.warning", [0.90, 0.79], "bump_ahead", 0),
    ("sign.warning", [0.90, 0.79], "lane_reduction", 0),
    ("sign.bend", [0.90, 0.79], "", 0),
    ("sign.crossing", [0.70, 0.70], "pedestrian_crossing", 0),
    ("sign.parking", [0.60, 0.60], "parking", 0),
    ("sign.one_way", [0.80, 0.30], "one_way", 0),
    ("sign.info", [0.45, 0.60], "tow_away_zone", 0),
    ("sign.info", [0.45, 0.60], "bus_stop_no_parking", 0),
    ("sign.info", [0.45, 0.60], "parking_time_limit", 0),
    ("sign.info", [0.45, 0.60], "cross_only_at_crosswalk", 0),
    ("sign.name", [0.90, 0.22], "street_name", 5),
    ("sign.name", [0.90, 0.22], "street_name", 18),
    ("sign.guide", [1.60, 1.10], "interchange", 300),
    ("sign.guide", [1.60, 1.10], "highway", 4711),
    ("sign.other", [0.76, 0.76], "", 0),
];
const COLUMNS: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let folder = Path::new(&folder);
    for (name, away_m, fov_deg) in [("signs", 12.0, 60.0), ("signs-20", 20.0, 80.0), ("signs-40", 40.0, 80.0)]
    {
        let mut stage = Stage::new();
        for (k, (model, [width, height], word, number)) in BOARDS.iter().enumerate() {
            let (column, row) = (k % COLUMNS, k / COLUMNS);
            let sign_type = SIGN_TYPES.iter().position(|known| known == word).unwrap_or(0) as u8;
            let said = SignFace { bottom_cm: 20, sign_type, number: *number };
            let place = at(1.75 * (column as f32 - 3.5), 0.0, -90.0);
            let up = Affine3A::from_translation(Vec3::Z * (0.3 + 1.3 * (3 - row) as f32));
            stage.add_thing(model, [0.08, *width, *height], said.variant(), up * place);
        }
        stage.save(&folder.join(format!("{name}.jpg")), [0.0, -away_m, 1.2], 0.0, [1600, 900], fov_deg)?;
    }
    Ok(())
}
