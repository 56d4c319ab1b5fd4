//! Tables over sensor data.

use schema::measures;

use super::share::{percent, ratio};
use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

pub(super) fn tables(counts: &MeasureTotals) -> Vec<Table> {
    vec![points(counts), images(counts), bytes(counts)]
}

fn points(counts: &MeasureTotals) -> Table {
    let rows: Vec<(&str, &str, u64, u64)> =
        [("lidar", measures::sensors::LIDAR_POINTS), ("radar", measures::sensors::RADAR_POINTS)]
            .into_iter()
            .flat_map(|(kind, measure)| {
                counts.classes(measure).map(move |sensor| {
                    (sensor, kind, counts.of(measures::sensors::SWEEPS, sensor), counts.of(measure, sensor))
                })
            })
            .collect();
    let note = "A sweep is one reading of one agent's sensor.";
    Table::new("points_per_sensor", Section::Sensors, "Lidar and radar points", note)
        .with_strings("sensor", rows.iter().map(|row| row.0))
        .with_strings("kind", rows.iter().map(|row| row.1))
        .with_counts("sweeps", rows.iter().map(|row| row.2))
        .with_counts("points", rows.iter().map(|row| row.3))
        .with_numbers("points_per_sweep", 1, rows.iter().map(|row| ratio(row.3, row.2)))
}

fn images(counts: &MeasureTotals) -> Table {
    let kinds: Vec<&str> = counts.classes(measures::sensors::IMAGES).collect();
    let agent_frames = counts.total(measures::simulation::AGENT_FRAMES);
    let images = |kind: &&str| counts.of(measures::sensors::IMAGES, kind);
    Table::new("images_per_kind", Section::Sensors, "Images", "")
        .with_strings("kind", kinds.iter().copied())
        .with_counts("images", kinds.iter().map(images))
        .with_numbers("images_per_agent_frame", 2, kinds.iter().map(|kind| ratio(images(kind), agent_frames)))
}

fn bytes(counts: &MeasureTotals) -> Table {
    let sensors: Vec<&str> = counts.classes(measures::sensors::SENSOR_BYTES).collect();
    let total = counts.total(measures::sensors::SENSOR_BYTES);
    let of = |sensor: &&str| counts.of(measures::sensors::SENSOR_BYTES, sensor);
    let note = "Sizes of the finished tables, compressed; images by kind, all cameras together.";
    Table::new("bytes_per_sensor", Section::Sensors, "Bytes on disk", note)
        .with_strings("sensor", sensors.iter().copied())
        .with_counts("bytes", sensors.iter().map(of))
        .with_numbers("percent", 2, sensors.iter().map(|sensor| percent(of(sensor), total)))
}
