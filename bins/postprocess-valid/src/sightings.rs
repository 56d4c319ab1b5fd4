//! What is counted of the boxes that agents saw.

use std::collections::BTreeMap;

use schema::measures::counts::PartialCounts;
use schema::measures::sightings::{
    LEVELS, LIDAR_POINTS_AT, PLACES, POINTS_STEPS, RADAR_POINTS_AT, SEEN_BY_RSUS, SEEN_BY_VEHICLES,
    bin_of_place, bin_of_points,
};
use schema::tables::ValidBoxRow;

/// Counts of valid boxes: points by distance, and places around agents, their own boxes left out.
pub(crate) fn count(boxes: &[ValidBoxRow]) -> PartialCounts {
    let mut grids: BTreeMap<(&str, &str), Vec<u32>> = BTreeMap::new();
    let mut add = |measure, class, bin: Option<i32>, bins: i32| {
        let Some(bin) = bin.and_then(|bin| usize::try_from(bin).ok()) else { return };
        grids.entry((measure, class)).or_insert_with(|| vec![0; bins as usize])[bin] += 1;
    };
    for row in boxes.iter().filter(|row| row.valid_flag) {
        let class = row.class.as_str();
        for (measure, points) in [(LIDAR_POINTS_AT, row.num_lidar_pts), (RADAR_POINTS_AT, row.num_radar_pts)]
        {
            add(measure, class, bin_of_points(row.distance_m, points), POINTS_STEPS * LEVELS);
        }
        let measure = if row.agent.starts_with("rsu_") { SEEN_BY_RSUS } else { SEEN_BY_VEHICLES };
        let place = row.angle_rad.and_then(|angle| bin_of_place(angle, row.distance_m));
        add(measure, class, place, PLACES * PLACES);
    }
    let mut counts = PartialCounts::new();
    for ((measure, class), bins) in &grids {
        counts.add_bins("", measure, class, bins);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valid_boxes_are_counted_by_what_was_seen_of_them() {
        let row = |agent: &str, points: [u32; 2], angle_rad, valid_flag| ValidBoxRow {
            agent: agent.into(),
            class: "car".into(),
            num_lidar_pts: points[0],
            num_radar_pts: points[1],
            valid_flag,
            distance_m: 12.0,
            angle_rad,
            ..ValidBoxRow::default()
        };
        let counts = count(&[
            row("vehicle_0", [30, 2], Some(0.02), true),
            row("vehicle_1", [30, 0], Some(0.01), true),
            row("rsu_0", [0, 0], Some(0.02), true),
            row("vehicle_0", [9, 9], None, true),
            row("vehicle_0", [9, 9], Some(0.0), false),
        ]);
        let bin = |points| bin_of_points(12.0, points).unwrap_or(-1);
        let ahead = bin_of_place(0.02, 12.0).unwrap_or(-1);
        let mut wanted = vec![
            (LIDAR_POINTS_AT, bin(9), 1),
            (LIDAR_POINTS_AT, bin(30), 2),
            (RADAR_POINTS_AT, bin(2), 1),
            (RADAR_POINTS_AT, bin(9), 1),
            (SEEN_BY_RSUS, ahead, 1),
            (SEEN_BY_VEHICLES, ahead, 2),
        ];
        wanted.sort_unstable();
        let rows = counts.rows();
        let found: Vec<_> = rows.iter().map(|row| (row.measure.as_str(), row.bin, row.count)).collect();
        assert_eq!(found, wanted);
    }
}
