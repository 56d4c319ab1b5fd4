//! Tables over boxes as agents saw them: points by distance, places around agents.

use std::collections::BTreeMap;

use schema::DetectionClass;
use schema::measures::sightings::{
    LEVELS, LEVELS_PER_DECADE, LIDAR_POINTS_AT, PLACE_M, PLACES, POINTS_STEP_M, POINTS_STEPS,
    RADAR_POINTS_AT, SEEN_BY_RSUS, SEEN_BY_VEHICLES,
};

use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

/// Tables of points by distance: name, title, measure.
pub(crate) const POINT_TABLES: [(&str, &str, &str); 2] = [
    ("lidar_points_by_distance", "Lidar points on an object, by its distance", LIDAR_POINTS_AT),
    ("radar_points_by_distance", "Radar points on an object, by its distance", RADAR_POINTS_AT),
];

/// Tables of all of them: name, title, measure.
pub(crate) const SPREAD_TABLES: [(&str, &str, &str); 2] = [
    ("lidar_points_spread", "Lidar points on objects, by distance", LIDAR_POINTS_AT),
    ("radar_points_spread", "Radar points on objects, by distance", RADAR_POINTS_AT),
];

/// Tables of places around agents: name, title, measure.
pub(crate) const PLACE_TABLES: [(&str, &str, &str); 2] = [
    ("seen_by_vehicles", "Valid objects around data-collection vehicles", SEEN_BY_VEHICLES),
    ("seen_by_rsus", "Valid objects around road-side units", SEEN_BY_RSUS),
];

/// Shares of the objects that have fewer points.
const SHARES: [(&str, f64); 3] = [("tenth", 0.1), ("median", 0.5), ("nine_tenths", 0.9)];

pub(super) fn tables(counts: &MeasureTotals) -> Vec<Table> {
    let points = POINT_TABLES.iter().map(|(name, title, measure)| points(name, title, measure, counts));
    let spread = SPREAD_TABLES.iter().map(|(name, title, measure)| spread(name, title, measure, counts));
    let places = PLACE_TABLES.iter().map(|(name, title, measure)| places(name, title, measure, counts));
    points.chain(spread).chain(places).collect()
}

/// One row a class and distance at which any object has points.
fn points(name: &str, title: &str, measure: &str, counts: &MeasureTotals) -> Table {
    let known = DetectionClass::ALL.map(DetectionClass::name);
    let mut rows: Vec<(&str, f64, Vec<u64>)> = Vec::new();
    for class in counts.classes_in_order(&[measure], &known) {
        let mut levels = vec![vec![0_u64; LEVELS as usize]; POINTS_STEPS as usize];
        for (bin, count) in counts.bins(measure, class) {
            let place = usize::try_from(bin / LEVELS).ok().zip(usize::try_from(bin % LEVELS).ok());
            if let Some(level) = place.and_then(|(step, level)| levels.get_mut(step)?.get_mut(level)) {
                *level = level.saturating_add(count);
            }
        }
        let steps = levels.into_iter().enumerate().filter(|(_, levels)| levels.iter().any(|n| *n > 0));
        rows.extend(steps.map(|(step, levels)| (class, POINTS_STEP_M * step as f64, levels)));
    }
    let note = "Valid objects with a point, agent by agent. How many points a tenth, a half and nine tenths of them have at most, \
                to a third of a factor of two.";
    let mut table = Table::new(name, Section::Sightings, title, note)
        .with_strings("class", rows.iter().map(|row| row.0))
        .with_numbers("from_m", 0, rows.iter().map(|row| Some(row.1)))
        .with_counts("objects", rows.iter().map(|row| row.2.iter().sum()));
    for (column, share) in SHARES {
        table = table.with_numbers(column, 0, rows.iter().map(|row| quantile(&row.2, share)));
    }
    table
}

/// The number of points at which a share of the objects is reached: the geometric middle of its level.
fn quantile(levels: &[u64], share: f64) -> Option<f64> {
    let total: u64 = levels.iter().sum();
    let mut below = 0;
    let level = levels.iter().position(|count| {
        below += count;
        total > 0 && below as f64 >= share * total as f64
    })?;
    let edge = |level: usize| frames::math::pow(10.0, level as f64 / LEVELS_PER_DECADE);
    // Levels of few points hold one whole number each, or none.
    Some((edge(level) * edge(level + 1)).sqrt().floor().max(edge(level).ceil()))
}

/// One row a square in which anything was seen, one column a class.
fn places(name: &str, title: &str, measure: &str, counts: &MeasureTotals) -> Table {
    let known = DetectionClass::ALL.map(DetectionClass::name);
    let classes = counts.classes_in_order(&[measure], &known);
    let mut squares: BTreeMap<i32, Vec<u64>> = BTreeMap::new();
    for (k, class) in classes.iter().enumerate() {
        for (bin, count) in counts.bins(measure, class).filter(|(bin, _)| (0..PLACES * PLACES).contains(bin))
        {
            squares.entry(bin).or_insert_with(|| vec![0; classes.len()])[k] = count;
        }
    }
    let note =
        "Object-frames in squares of 5 m around the agent, agent by agent; the place of a square's middle.";
    let from_middle = |square: i32| Some((0.5 * f64::from(PLACES - 1) - f64::from(square)) * PLACE_M);
    let mut table = Table::new(name, Section::Sightings, title, note)
        .with_numbers("ahead_m", 1, squares.keys().map(|bin| from_middle(bin / PLACES)))
        .with_numbers("left_m", 1, squares.keys().map(|bin| from_middle(bin % PLACES)));
    for (k, class) in classes.iter().enumerate() {
        table = table.with_counts(class, squares.values().map(|counts| counts[k]));
    }
    table
}

/// Objects by distance and points, one row a distance and level, one column a class: what the figures show.
fn spread(name: &str, title: &str, measure: &str, counts: &MeasureTotals) -> Table {
    let known = DetectionClass::ALL.map(DetectionClass::name);
    let classes = counts.classes_in_order(&[measure], &known);
    let mut bins: BTreeMap<i32, Vec<u64>> = BTreeMap::new();
    for (k, class) in classes.iter().enumerate() {
        for (bin, count) in
            counts.bins(measure, class).filter(|(bin, _)| (0..POINTS_STEPS * LEVELS).contains(bin))
        {
            bins.entry(bin).or_insert_with(|| vec![0; classes.len()])[k] = count;
        }
    }
    let note = "Object-frames from a distance on (steps of 5 m) and from a number of points on (eight steps to a factor of ten).";
    let points = |bin: &i32| Some(frames::math::pow(10.0, f64::from(bin % LEVELS) / LEVELS_PER_DECADE));
    let mut table = Table::new(name, Section::Sightings, title, note)
        .with_numbers("from_m", 0, bins.keys().map(|bin| Some(POINTS_STEP_M * f64::from(bin / LEVELS))))
        .with_numbers("from_points", 1, bins.keys().map(points));
    for (k, class) in classes.iter().enumerate() {
        table = table.with_counts(class, bins.values().map(|counts| counts[k]));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_levels_that_reach_their_share() {
        let mut levels = vec![0; LEVELS as usize];
        // 90 objects with one point, 10 with 100 points.
        (levels[0], levels[16]) = (90, 10);
        assert_eq!(quantile(&levels, 0.5), Some(1.0));
        assert_eq!(quantile(&levels, 0.9), Some(1.0));
        // From 100 to 133 points: 115 in the middle.
        assert_eq!(quantile(&levels, 0.95), Some(115.0));
        assert_eq!(quantile(&[0; 4], 0.5), None);
    }
}
