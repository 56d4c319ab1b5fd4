//! What holds for every table: it reads, its numbers are numbers in their ranges, its frames are all there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use arrow_array::ArrayRef;
use arrow_array::cast::AsArray;
use schema::{DetectionClass, FRAME_PERIOD_S};

use crate::files::{Batch, Npz, Table, Unreadable, extent, unreal};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{Named, Scene};
use crate::space::within;

/// Greatest difference of a time from its frame's, s.
const TIME_S: f64 = 1e-9;

/// The column that says whose table it is.
const SCENE: &str = "scene";

/// Half a turn and a hair, rad: angles of 32 bits may round upwards.
const HALF_TURN: f64 = std::f64::consts::PI + 1e-6;

/// Ranges of columns: part of the table's path, column, least and greatest value.
const RANGES: &[(&str, &str, f64, f64)] = &[
    ("", "frame", -1.0, 1e6),
    ("", "id", 0.0, 65_535.0),
    ("", "tag", 0.0, 31.0),
    ("", "semantic_tags", 0.0, 31.0),
    ("", "xyz_m", -1e6, 1e6),
    ("", "quaternion", -1.0 - 1e-9, 1.0 + 1e-9),
    ("", "velocity_mps", -150.0, 150.0),
    ("", "angular_velocity_radps", -60.0, 60.0),
    ("", "rpy_rad", -HALF_TURN, HALF_TURN),
    ("", "angle_rad", -HALF_TURN, HALF_TURN),
    ("", "distance_m", 0.0, 2000.0),
    ("boxes", "size_m", 1e-3, 200.0),
    ("tracks", "size_m", 1e-3, 200.0),
    // Nothing of what keeps its size.
    ("log/states", "size_m", 0.0, 200.0),
    ("", "num_lidar_pts", 0.0, 1e9),
    ("sensors/", "intensity", 0.0, 1.0),
    ("sensors/", "cos_angle", 0.0, 1.0),
    ("sensors/", "time_offset_s", -FRAME_PERIOD_S, 0.0),
    ("sensors/", "return_number", 1.0, 3.0),
    ("sensors/", "return_count", 1.0, 3.0),
    ("sensors/", "return_kind", 0.0, 3.0),
    ("sensors/", "altitude", -1.570_796_4, 1.570_796_4),
    ("sensors/", "azimuth", -1.570_796_4, 1.570_796_4),
    ("sensors/", "velocity", -200.0, 200.0),
    ("sensors/", "rcs_dbsm", -80.0, 60.0),
    ("sensors/", "snr_db", -80.0, 250.0),
    ("sensors/", "depth", 0.0, 4000.0),
    ("sensors/", "dx", -2.0, 2.0),
    ("sensors/", "dy", -2.0, 2.0),
    ("sensors/", "latitude_deg", -90.0, 90.0),
    ("sensors/", "longitude_deg", -180.0, 180.0),
    ("sensors/", "altitude_m", -1000.0, 10_000.0),
    ("sensors/", "acceleration_mps2", -2000.0, 2000.0),
    ("sensors/", "gyroscope_radps", -60.0, 60.0),
    ("sensors/", "compass_rad", 0.0, std::f64::consts::TAU),
    ("sensors/", "pixels", 1.0, 1e9),
    ("log/actors", "length_m", 0.0, 2000.0),
    ("log/actors", "width_m", 0.0, 2000.0),
    ("log/actors", "height_m", 0.0, 500.0),
    ("log/states", "lean_rad", -0.05, 0.05),
    ("log/states", "steer_rad", -1.6, 1.6),
    ("log/states", "seat_m", 0.0, 1.0),
    ("log/states", "door_rad", 0.0, 2.0),
    ("log/states", "lights", 0.0, 2047.0),
    ("log/frames", "cloudiness", 0.0, 100.0),
    ("log/frames", "precipitation", 0.0, 100.0),
    ("log/frames", "precipitation_deposits", 0.0, 100.0),
    ("log/frames", "wind_intensity", 0.0, 100.0),
    ("log/frames", "sun_azimuth_deg", 0.0, 360.0),
    ("log/frames", "sun_altitude_deg", -90.0, 90.0),
    ("log/frames", "wetness", 0.0, 100.0),
    ("log/frames", "fog_density", 0.0, 100.0),
    ("log/frames", "fog_distance_m", 0.0, 1e5),
    ("log/frames", "dust_storm", 0.0, 100.0),
    ("log/lamps", "flux_lm", 0.0, 1e9),
    ("hd_map", "lane_width_m", 0.0, 100.0),
    ("hd_map", "speed_limit_mps", 0.0, 100.0),
    ("hd_map", "sidewalk_m", 0.0, 50.0),
    ("hd_map", "stop_line_m", 0.0, 500.0),
    ("hd_map", "crosswalk_m", 0.0, 500.0),
    ("hd_map", "next_junction_m", 0.0, 500.0),
    ("tracks", "max_speed_mps", 0.0, 150.0),
];

/// Words of columns: part of the table's path, column, words.
const WORDS: &[(&str, &str, &[&str])] = &[
    ("boxes_valid", "difficulty", &["easy", "medium", "hard"]),
    ("tracks_frames", "difficulty", &["easy", "medium", "hard"]),
    ("boxes", "signal_state", &["Red", "Yellow", "Green", "Off"]),
    ("log/signals", "state", &["Red", "Yellow", "Green", "Off"]),
    ("log/lamps", "kind", &["street", "building"]),
    ("hd_map", "lane_change", &["NONE", "Left", "Right", "Both"]),
];

/// Looks at a table as such. `rate`: of how many of the scene's frames one has rows or a member; `every`: of
/// the row groups of sensors only each so many are looked at.
pub(crate) fn check(scene: &Scene, named: &Named, rate: u32, every: u32, ledger: &mut Ledger) {
    let (path, frames, rows) = (named.path.as_path(), scene.frames, named.rows);
    let name = path.to_string_lossy().replace('\\', "/");
    if name.ends_with(".npz") {
        if let Some(archive) = ledger.read(Npz::open(path)) {
            let names: Vec<&str> = archive.names().collect();
            let due = (0..frames).step_by(rate as usize);
            let wanted: Vec<String> = due.map(|k| format!("{k:04}.npy")).collect();
            ledger.expect(Rule::Times, names == wanted, || {
                format!("{name}: has {} members, not every {rate}. of {frames} frames", names.len())
            });
        }
        return;
    }
    let is_scene = name.rsplit_once("scenes/").map(|(_, rest)| rest);
    let (Some(inside), true) = (is_scene, name.ends_with(".parquet")) else { return };
    let Some(table) = ledger.read(Table::open(path)) else { return };
    let count = table.row_count();
    ledger.expect(Rule::Files, count == rows, || {
        format!("{inside}: has {count} rows, its manifest says {rows}")
    });
    // Tables of format 1 do not say whose they are.
    ledger.expect(Rule::Files, table.has(SCENE) || named.format < 2, || {
        format!("{inside}: has no column `{SCENE}`")
    });
    let is_sensor = inside.contains("sensors/");
    // Large tables have a row group a frame.
    let is_large = is_sensor && count > 1 && table.group_count() == count;
    let step = if is_large { every as usize } else { 1 };
    let read =
        if is_large { (0..count).step_by(step).map(|row| table.row(row)).collect() } else { table.batches() };
    let Some(batches) = ledger.read(read) else { return };
    for batch in &batches {
        if let Some(numbers) = ledger.read(batch.maybe_there(SCENE, Batch::ints)).flatten() {
            let other = numbers.iter().find(|number| **number != i64::from(scene.number));
            ledger.expect(Rule::Files, other.is_none(), || {
                format!("{inside}: has rows of scene {}", other.unwrap_or(&0))
            });
        }
        if inside.contains("/stats/") {
            continue;
        }
        for (column, values) in batch.columns() {
            check_column(inside, column, values, ledger);
        }
        if is_sensor {
            equally_long(inside, batch, ledger);
        }
    }
    if inside.contains("/stats/") {
        return;
    }
    let a_row_a_frame = is_sensor && !GAPPED.iter().any(|name| inside.ends_with(name));
    if let Some(found) = ledger.read(times(&batches)) {
        check_times(inside, &found, rate, if a_row_a_frame { Some((frames, step)) } else { None }, ledger);
    }
}

/// A column: numbers, ranges, words.
fn check_column(table: &str, column: &str, values: &ArrayRef, ledger: &mut Ledger) {
    if let Some((bad, all)) = unreal(values) {
        ledger.fine(Rule::Numbers, (all - bad) as u64);
        ledger.all_off(Rule::Numbers, bad as u64, &format!("{table} {column}"), || {
            format!("{table}: {bad} of {all} values of {column} are no numbers")
        });
    }
    for (_, _, least, greatest) in
        RANGES.iter().filter(|(part, name, ..)| *name == column && table.contains(part))
    {
        let Some((low, high)) = extent(values) else { continue };
        ledger.expect(Rule::Units, *least <= low && high <= *greatest, || {
            format!("{table}: {column} goes from {low} to {high}, allowed is {least} to {greatest}")
        });
    }
    let Some(texts) = values.as_string_opt::<i32>() else { return };
    let classes = DetectionClass::ALL.map(DetectionClass::name);
    let mut words: Vec<&[&str]> = Vec::new();
    words.extend(WORDS.iter().filter(|(part, name, _)| *name == column && table.contains(part)).map(|w| w.2));
    if column == "class" {
        words.push(&classes);
    }
    for known in words {
        for text in texts.iter().flatten() {
            ledger.expect(Rule::Units, known.contains(&text), || format!("{table}: {column} says {text:?}"));
        }
    }
}

/// Lists of one row of a sensor belong together.
fn equally_long(table: &str, batch: &Batch, ledger: &mut Ledger) {
    let lists: Vec<_> =
        batch.columns().filter_map(|(name, v)| Some((name, v.as_list_opt::<i32>()?))).collect();
    let Some(((first, one), others)) = lists.split_first() else { return };
    for row in 0..batch.len() {
        let lengths = others.iter().map(|(name, list)| (name, list.value_length(row)));
        let unlike = lengths.filter(|(_, len)| *len != one.value_length(row)).map(|(name, _)| *name).next();
        ledger.expect(Rule::Units, unlike.is_none(), || {
            format!("{table}: row {row}: {first} and {} are not equally long", unlike.unwrap_or_default())
        });
    }
}

/// Frames and times of a table's rows; none where it has no such columns.
fn times(batches: &[Batch]) -> Result<Vec<(i64, Option<f64>)>, Unreadable> {
    let mut found = Vec::new();
    for batch in batches {
        let has = |column: &str| batch.columns().any(|(name, _)| name == column);
        if !has("frame") {
            return Ok(found);
        }
        let times = if has("time_s") { batch.maybe_reals("time_s")? } else { vec![None; batch.len()] };
        found.extend(batch.ints("frame")?.into_iter().zip(times));
    }
    Ok(found)
}

/// Tables that may have no row of a frame: nothing is seen, or windows are some frames apart.
const GAPPED: [&str; 3] = ["visible.parquet", "boxes_2d.parquet", "tracks_windows.parquet"];

fn check_times(
    table: &str,
    found: &[(i64, Option<f64>)],
    rate: u32,
    each: Option<(u32, usize)>,
    ledger: &mut Ledger,
) {
    for &(frame, time) in found {
        let exact = time.is_none_or(|time| within(time - FRAME_PERIOD_S * frame as f64, TIME_S));
        ledger.expect(Rule::Times, exact, || {
            format!("{table}: frame {frame} is at {} s", time.unwrap_or(f64::NAN))
        });
    }
    if let Some((frames, step)) = each {
        let wanted = (0..i64::from(frames)).step_by(rate as usize * step);
        let all = wanted.eq(found.iter().map(|(frame, _)| *frame));
        ledger.expect(Rule::Times, all, || {
            format!(
                "{table}: {} rows do not count every {rate}. of the {frames} frames of the scene",
                found.len()
            )
        });
    } else if let (Some(least), Some(most)) =
        (found.iter().min_by_key(|f| f.0), found.iter().max_by_key(|f| f.0))
    {
        let mut per_frame: BTreeMap<i64, u32> = BTreeMap::new();
        for (frame, _) in found {
            *per_frame.entry(*frame).or_default() += 1;
        }
        let stray = per_frame.keys().find(|frame| rate > 1 && *frame % i64::from(rate) != 0);
        ledger.expect(Rule::Times, stray.is_none(), || {
            format!("{table}: has frame {}, only every {rate}. is wanted", stray.unwrap_or(&0))
        });
        let gap = (least.0..=most.0).step_by(rate as usize).find(|frame| !per_frame.contains_key(frame));
        let has_gaps = GAPPED.iter().any(|name| table.ends_with(name));
        ledger.expect(Rule::Times, gap.is_none() || has_gaps, || {
            format!("{table}: frame {} is missing", gap.unwrap_or(0))
        });
    }
}

/// Sensor files that a configuration asks for.
pub(crate) fn wanted(folder: &Path, names: &[String], ledger: &mut Ledger) {
    let missing: Vec<PathBuf> = names
        .iter()
        .map(|name| folder.join(format!("{name}.parquet")))
        .filter(|path| !path.is_file())
        .collect();
    ledger.fine(Rule::Files, (names.len() - missing.len()) as u64);
    for path in missing {
        ledger.off(Rule::Files, || format!("{}: the configuration asks for it", path.display()));
    }
}
