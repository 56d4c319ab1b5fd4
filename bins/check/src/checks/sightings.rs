//! What was counted of the boxes that agents saw, against a recount.

use std::collections::BTreeMap;

use crate::checks::boxes::Labelled;
use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;

/// Points are counted up to this distance, m, in steps of 5 m of 40 bins each.
const POINTS_REACH_M: f64 = 120.0;
/// Places are counted in rows and columns of so many squares of 5 m.
const SQUARES: i64 = 80;
const SQUARE_M: f64 = 5.0;

/// Measure and class, and for places whether they are ahead and to the left, for points how many steps away.
type Key = (String, String, i64);

/// Checks the counts of a scene's boxes: of all agents' lists, frame by frame.
pub(crate) fn check(scene: &Scene, lists: &BTreeMap<String, Vec<Vec<Labelled>>>, ledger: &mut Ledger) {
    let path = scene.file("stats/postprocess-valid.boxes.parquet");
    if !scene.done.contains("postprocess-valid") || !path.is_file() {
        return;
    }
    let told = Table::open(&path).and_then(|table| told(&table));
    let Some(told) = ledger.read(told) else { return };
    let mut counted: BTreeMap<Key, u64> = BTreeMap::new();
    for (agent, frames) in lists {
        for labelled in frames.iter().flatten() {
            for key in keys_of(agent, labelled) {
                *counted.entry(key).or_default() += 1;
            }
        }
    }
    let keys: Vec<&Key> = told.keys().chain(counted.keys()).collect();
    for key in keys {
        let [said, wanted] = [&told, &counted].map(|counts| counts.get(key).copied().unwrap_or(0));
        ledger.expect(Rule::Counts, said == wanted, || {
            format!("partial statistics: {} {} is {said} in part {}, counted {wanted}", key.0, key.1, key.2)
        });
    }
}

/// What the stage counted.
fn told(table: &Table) -> Result<BTreeMap<Key, u64>, Unreadable> {
    let mut told: BTreeMap<Key, u64> = BTreeMap::new();
    for rows in table.batches()? {
        let (measures, classes) = (rows.texts("measure")?, rows.texts("class")?);
        let (bins, counts) = (rows.ints("bin")?, rows.ints("count")?);
        for (((measure, class), bin), count) in measures.into_iter().zip(classes).zip(bins).zip(counts) {
            let part = if measure.starts_with("seen_by_") {
                quarter(bin / SQUARES, bin % SQUARES)
            } else {
                bin / 40
            };
            *told.entry((measure, class, part)).or_default() += count.unsigned_abs();
        }
    }
    Ok(told)
}

/// Which quarter a square is in.
fn quarter(row: i64, column: i64) -> i64 {
    2 * i64::from(row < SQUARES / 2) + i64::from(column < SQUARES / 2)
}

/// As what a box is counted.
fn keys_of(agent: &str, labelled: &Labelled) -> Vec<Key> {
    let Some(seen) = labelled.seen.as_ref().filter(|seen| seen.valid) else { return Vec::new() };
    let key = |measure: &str, part| (measure.to_owned(), labelled.class.name().to_owned(), part);
    let mut keys = Vec::new();
    for (measure, points) in [("lidar_points_at", seen.lidar), ("radar_points_at", seen.radar)] {
        if points > 0 && labelled.distance_m < POINTS_REACH_M {
            keys.push(key(measure, (labelled.distance_m / 5.0) as i64));
        }
    }
    if let Some(angle) = labelled.angle_rad {
        let square = |way_m: f64| (0.5 * SQUARES as f64 - way_m / SQUARE_M).floor() as i64;
        let (sin, cos) = libm::sincos(angle);
        let (row, column) = (square(labelled.distance_m * cos), square(labelled.distance_m * sin));
        let measure = if agent.starts_with("rsu") { "seen_by_rsus" } else { "seen_by_vehicles" };
        if (0..SQUARES).contains(&row) && (0..SQUARES).contains(&column) {
            keys.push(key(measure, quarter(row, column)));
        }
    }
    keys
}
