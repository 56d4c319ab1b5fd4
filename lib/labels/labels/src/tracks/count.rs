//! What is counted of a scene's tracks.

use std::collections::BTreeMap;

use frames::to_deg;
use nalgebra::Vector3;
use schema::measures::counts::PartialCounts;
use schema::measures::tracks as measures;
use schema::tables::TrackFrameRow;
use schema::{Attribute, DetectionClass, rate};

/// The merged boxes of a scene of `frames` frames (numbered from 0), every `every_n_frames`th of which is
/// annotated: objects per class, valid ones, valid ones per annotated frame (every class and frame counts,
/// those without any too), headings, speeds and turning rates of valid ones, pedestrians and wheelchairs.
#[must_use]
pub fn count(rows: &[TrackFrameRow], frames: u32, every_n_frames: u32) -> PartialCounts {
    let annotated = rate::count(frames, every_n_frames);
    let mut counts = PartialCounts::new();
    counts.add("", measures::FRAMES, "", 0, u64::from(annotated));
    let mut per_frame: BTreeMap<(u32, DetectionClass), u32> = BTreeMap::new();
    for row in rows {
        // Every box has a class; a row of another origin counts nowhere.
        let Some(class) = DetectionClass::from_name(&row.class) else { continue };
        counts.add("", measures::BOXES, class.name(), 0, 1);
        if row.valid_flag {
            counts.add("", measures::BOXES_VALID, class.name(), 0, 1);
            *per_frame.entry((row.frame, class)).or_default() += 1;
            add_motion(&mut counts, class, row);
        }
        if class == DetectionClass::Pedestrian {
            add_pedestrian(&mut counts, row);
        }
    }
    let mut seen: BTreeMap<DetectionClass, u32> = BTreeMap::new();
    for ((frame, class), count) in per_frame {
        if frame < frames && rate::is_due(frame, every_n_frames) {
            *seen.entry(class).or_default() += 1;
        }
        counts.add(
            "",
            measures::VALID_PER_FRAME,
            class.name(),
            measures::VALID_PER_FRAME_BINS.bin_of(f64::from(count)),
            1,
        );
    }
    for class in DetectionClass::ALL {
        let empty = annotated - seen.get(&class).copied().unwrap_or(0);
        if empty > 0 {
            let bin = measures::VALID_PER_FRAME_BINS.bin_of(0.0);
            counts.add("", measures::VALID_PER_FRAME, class.name(), bin, u64::from(empty));
        }
    }
    counts
}

fn add_motion(counts: &mut PartialCounts, class: DetectionClass, row: &TrackFrameRow) {
    let yaw_deg = to_deg(row.rpy_rad[2]);
    let yaw_deg = if yaw_deg >= 180.0 { yaw_deg - 360.0 } else { yaw_deg };
    counts.add("", measures::YAW_DEG, class.name(), measures::YAW_BINS.bin_of(yaw_deg), 1);
    if measures::MOVING_CLASSES.contains(&class.name()) {
        let speed_mps = Vector3::from(row.velocity_mps.map(f64::from)).norm();
        counts.add("", measures::SPEED_MPS, class.name(), measures::SPEED_BINS.bin_of(speed_mps), 1);
        let rate_dps = to_deg(f64::from(row.angular_velocity_radps[2]));
        counts.add("", measures::YAW_RATE_DPS, class.name(), measures::YAW_RATE_BINS.bin_of(rate_dps), 1);
    }
}

fn add_pedestrian(counts: &mut PartialCounts, row: &TrackFrameRow) {
    let wheelchair = row.attributes.is_true(&Attribute::UseWheelchair);
    let valid = row.valid_flag.then_some(measures::VALID_OBJECTS);
    for class in [Some(measures::ALL_OBJECTS), valid].into_iter().flatten() {
        counts.add("", measures::PEDESTRIANS, class, 0, 1);
        counts.add("", measures::WHEELCHAIR, class, 0, u64::from(wheelchair));
    }
}

#[cfg(test)]
mod tests {
    use schema::tables::PartialRow;

    use super::count as count_tracks;
    use super::*;

    fn total(rows: &[PartialRow], measure: &str, class: &str, bin: i32) -> u64 {
        rows.iter()
            .filter(|r| r.measure == measure && r.class == class && r.bin == bin)
            .map(|r| r.count)
            .sum()
    }

    fn row(frame: u32, id: u16, class: &str, valid_flag: bool) -> TrackFrameRow {
        TrackFrameRow { frame, id, class: class.into(), valid_flag, ..TrackFrameRow::default() }
    }

    #[test]
    fn every_class_counts_every_frame() {
        let mut rows: Vec<_> = (0..7).map(|id| row(1, id, "car", true)).collect();
        rows.push(row(1, 9, "car", false));
        rows.extend((100..220).map(|id| row(2, id, "pedestrian", true)));
        let counts = count_tracks(&rows, 10, 1);
        let got = counts.rows();
        for class in DetectionClass::ALL {
            let frames: u64 = got
                .iter()
                .filter(|r| r.measure == measures::VALID_PER_FRAME && r.class == class.name())
                .map(|r| r.count)
                .sum();
            assert_eq!(frames, 10, "{class:?}");
        }
        assert_eq!(total(&got, measures::VALID_PER_FRAME, "car", 5), 1);
        assert_eq!(total(&got, measures::VALID_PER_FRAME, "car", 0), 9);
        assert_eq!(total(&got, measures::VALID_PER_FRAME, "pedestrian", 100), 1);
        assert_eq!(
            (total(&got, measures::BOXES, "car", 0), total(&got, measures::BOXES_VALID, "car", 0)),
            (8, 7)
        );
        assert_eq!(total(&got, measures::FRAMES, "", 0), 10);
    }

    #[test]
    fn frames_without_annotation_do_not_count() {
        // Of frames 0 to 9 those numbered 0, 4 and 8; cars at the first two.
        let rows = [row(0, 1, "car", true), row(4, 1, "car", true), row(4, 2, "car", true)];
        let got = count_tracks(&rows, 10, 4).rows();
        assert_eq!(total(&got, measures::FRAMES, "", 0), 3);
        assert_eq!(total(&got, measures::VALID_PER_FRAME, "car", 0), 3);
        assert_eq!(total(&got, measures::VALID_PER_FRAME, "bus", 0), 3);
        assert_eq!(total(&got, measures::BOXES_VALID, "car", 0), 3);
    }

    #[test]
    fn motion_falls_into_the_named_bins() {
        let mut moving = row(0, 1, "car", true);
        moving.rpy_rad = [0.0, 0.0, std::f64::consts::PI];
        moving.velocity_mps = [3.0, 4.5, 0.0];
        moving.angular_velocity_radps = [0.0, 0.0, -0.1];
        let mut sign = moving.clone();
        sign.class = "traffic_sign".into();
        let counts = count_tracks(&[moving, sign], 1, 1);
        let got = counts.rows();
        assert_eq!(total(&got, measures::YAW_DEG, "car", -180), 1);
        assert_eq!(total(&got, measures::YAW_DEG, "traffic_sign", -180), 1);
        assert_eq!(total(&got, measures::SPEED_MPS, "car", 5), 1);
        assert_eq!(total(&got, measures::YAW_RATE_DPS, "car", -10), 1, "-5.7 degrees a second");
        assert!(!got.iter().any(|r| r.measure == measures::SPEED_MPS && r.class == "traffic_sign"));
    }

    #[test]
    fn wheelchairs_are_read_from_attributes() {
        let walker = |id, attributes: &str, valid| TrackFrameRow {
            attributes: attributes.parse().expect("an object of strings"),
            ..row(0, id, "pedestrian", valid)
        };
        let counts = count_tracks(
            &[
                walker(1, r#"{"use_wheelchair": "true"}"#, false),
                walker(2, r#"{"use_wheelchair":"false"}"#, true),
                walker(3, r#"{"crosses_anywhere":"true"}"#, true),
            ],
            1,
            1,
        );
        let got = counts.rows();
        let numbers = |measure| {
            (total(&got, measure, measures::ALL_OBJECTS, 0), total(&got, measure, measures::VALID_OBJECTS, 0))
        };
        assert_eq!(numbers(measures::PEDESTRIANS), (3, 2));
        assert_eq!(numbers(measures::WHEELCHAIR), (1, 0));
    }
}
