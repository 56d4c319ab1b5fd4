//! Where objects came from and where they go: windows for forecasting.

use std::collections::BTreeMap;

use schema::ObjectId;
use schema::measures::tracks::MOVING_CLASSES;
use schema::tables::{TrackFrameRow, WindowRow};
use settings::TrackSettings;

/// Windows of all objects of moving classes, by frame, then id, from the merged boxes of a scene (by frame,
/// then id). The first windows are of frame 0; an object has one wherever it is in some agent's list at the
/// moment.
#[must_use]
pub fn windows(rows: &[TrackFrameRow], settings: &TrackSettings) -> Vec<WindowRow> {
    let moving = |row: &&TrackFrameRow| MOVING_CLASSES.contains(&row.class.as_str());
    let places: BTreeMap<(ObjectId, u32), &TrackFrameRow> =
        rows.iter().filter(moving).map(|row| ((row.id, row.frame), row)).collect();
    let (step, [before, after]) = (i64::from(settings.step_frames()), settings.places().map(i64::from));
    let present = rows.iter().filter(moving).filter(|row| row.frame.is_multiple_of(settings.every_frames()));
    present
        .map(|row| {
            let at = |k: i64| {
                let frame = u32::try_from(i64::from(row.frame) + k * step).ok()?;
                places.get(&(row.id, frame)).copied()
            };
            let past = Way::of((-before..0).map(at));
            let future = Way::of((1..=after).map(at));
            WindowRow {
                frame: row.frame,
                id: row.id,
                class: row.class.clone(),
                size_m: row.size_m,
                valid_flag: row.valid_flag,
                center_m: row.center_m,
                yaw_rad: row.rpy_rad[2],
                velocity_mps: row.velocity_mps,
                past_center_m: past.center_m,
                past_yaw_rad: past.yaw_rad,
                past_mask: past.mask,
                past_valid: past.valid,
                future_center_m: future.center_m,
                future_yaw_rad: future.yaw_rad,
                future_mask: future.mask,
                future_valid: future.valid,
            }
        })
        .collect()
}

/// Places of an object at some moments, as columns.
#[derive(Default)]
struct Way {
    center_m: Vec<f64>,
    yaw_rad: Vec<f64>,
    mask: Vec<u8>,
    valid: Vec<u8>,
}

impl Way {
    fn of<'a>(places: impl Iterator<Item = Option<&'a TrackFrameRow>>) -> Self {
        let mut way = Self::default();
        for place in places {
            way.center_m.extend(place.map_or([0.0; 3], |row| row.center_m));
            way.yaw_rad.push(place.map_or(0.0, |row| row.rpy_rad[2]));
            way.mask.push(place.is_some().into());
            way.valid.push(place.is_some_and(|row| row.valid_flag).into());
        }
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(frame: u32, id: u16, class: &str, x: f64) -> TrackFrameRow {
        TrackFrameRow {
            frame,
            id,
            class: class.into(),
            center_m: [x, 0.0, 1.0],
            rpy_rad: [0.0, 0.0, x / 10.0],
            valid_flag: frame.is_multiple_of(20),
            ..TrackFrameRow::default()
        }
    }

    #[test]
    fn a_window_has_the_places_of_its_steps() {
        // In a list from frame 4 to frame 33, at x = frame; windows each 10 frames, places 5 frames apart.
        let settings = TrackSettings {
            past_s: 0.75,
            future_s: 0.5,
            step_s: 0.25,
            every_s: 0.5,
            ..TrackSettings::default()
        };
        let mut rows: Vec<_> = (4..34).map(|frame| row(frame, 7, "car", f64::from(frame))).collect();
        rows.extend((0..40).map(|frame| row(frame, 9, "traffic_cone", 0.0)));
        let got = windows(&rows, &settings);
        assert_eq!(got.iter().map(|w| (w.frame, w.id)).collect::<Vec<_>>(), [(10, 7), (20, 7), (30, 7)]);
        let first = &got[0];
        // Frames -5, 0 and 5; the first two are before it came.
        assert_eq!(first.past_mask, [0, 0, 1]);
        assert_eq!(first.past_center_m, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 1.0]);
        assert_eq!(first.past_yaw_rad, [0.0, 0.0, 0.5]);
        assert_eq!((first.future_mask.as_slice(), first.future_center_m[0]), ([1, 1].as_slice(), 15.0));
        assert_eq!(first.future_valid, [0, 1], "frame 20 is seen, frame 15 is not");
        assert_eq!((first.valid_flag, got[1].valid_flag), (false, true));
        assert_eq!(got[2].future_mask, [0, 0], "frames 35 and 40 are after it went");
        assert_eq!(got[2].past_mask, [1, 1, 1]);
    }

    #[test]
    fn windows_have_their_length_whatever_the_scene_has() {
        let settings = TrackSettings::default();
        let got = windows(&[row(0, 1, "pedestrian", 2.0)], &settings);
        assert_eq!((got[0].past_mask.len(), got[0].future_mask.len()), (4, 12));
        assert_eq!((got[0].past_center_m.len(), got[0].future_center_m.len()), (12, 36));
    }
}
