//! Partial statistics: counts that add up over frames, agents and scenes.

use std::collections::BTreeMap;

use frames::to_deg;
use nalgebra::Vector3;
use schema::measures;
use schema::tables::{PartialRow, TrackFrameRow};
use schema::{BevClass, DetectionClass, Tag};

use crate::bev::BevMask;
use crate::voxels::VoxelGrid;

/// Which voxel grids are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// As voxelised.
    Hollow,
    /// After [`crate::fill`].
    Filled,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    agent: String,
    measure: String,
    class: String,
    bin: i32,
}

/// Counts as they grow.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    counts: BTreeMap<Key, u64>,
}

impl Counts {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds to one count. Measures, classes and bins are those of [`schema::measures`]; the agent is empty for counts
    /// that are not one agent's.
    pub fn add(&mut self, agent: &str, measure: &str, class: &str, bin: i32, count: u64) {
        let key = Key { agent: agent.to_owned(), measure: measure.to_owned(), class: class.to_owned(), bin };
        *self.counts.entry(key).or_default() += count;
    }

    /// Adds another's counts.
    pub fn merge(&mut self, other: Self) {
        for (key, count) in other.counts {
            *self.counts.entry(key).or_default() += count;
        }
    }

    /// One BEV mask of an agent: [`measures::BEV_GRIDS`] and the true cells of every class.
    pub fn add_bev(&mut self, agent: &str, mask: &BevMask) {
        self.add(agent, measures::BEV_GRIDS, "", 0, 1);
        for (class, cells) in BevClass::ALL.into_iter().zip(mask.counts()) {
            self.add(agent, measures::BEV_CELLS, class.name(), 0, cells);
        }
    }

    /// One voxel grid of an agent: cells per label (free space too), for labels that occur. A hollow grid also
    /// counts as one of [`measures::VOXEL_GRIDS`].
    pub fn add_voxels(&mut self, agent: &str, grid: &VoxelGrid, filling: Filling) {
        let measure = match filling {
            Filling::Hollow => {
                self.add(agent, measures::VOXEL_GRIDS, "", 0, 1);
                measures::VOXEL_CELLS
            }
            Filling::Filled => measures::VOXEL_CELLS_FILLED,
        };
        for (tag, cells) in Tag::ALL.into_iter().zip(grid.count()) {
            if cells > 0 {
                self.add(agent, measure, tag.name(), 0, cells);
            }
        }
    }

    /// The merged boxes of a scene of `frames` frames (numbered from 0): objects per class, valid ones, valid ones
    /// per frame (every class and frame counts, those without any too), headings, speeds and turning rates of
    /// valid ones, pedestrians and wheelchairs.
    pub fn add_tracks(&mut self, rows: &[TrackFrameRow], frames: u32) {
        self.add("", measures::FRAMES, "", 0, u64::from(frames));
        let mut per_frame: BTreeMap<(u32, DetectionClass), u32> = BTreeMap::new();
        for row in rows {
            // Every box has a class; a row of another origin counts nowhere.
            let Some(class) = DetectionClass::from_name(&row.class) else { continue };
            self.add("", measures::BOXES, class.name(), 0, 1);
            if row.valid_flag {
                self.add("", measures::BOXES_VALID, class.name(), 0, 1);
                *per_frame.entry((row.frame, class)).or_default() += 1;
                self.add_motion(class, row);
            }
            if class == DetectionClass::Pedestrian {
                self.add_pedestrian(row);
            }
        }
        let mut seen: BTreeMap<DetectionClass, u32> = BTreeMap::new();
        for ((frame, class), count) in per_frame {
            if frame < frames {
                *seen.entry(class).or_default() += 1;
            }
            self.add(
                "",
                measures::VALID_PER_FRAME,
                class.name(),
                measures::VALID_PER_FRAME_BINS.bin_of(f64::from(count)),
                1,
            );
        }
        for class in DetectionClass::ALL {
            let empty = frames - seen.get(&class).copied().unwrap_or(0);
            if empty > 0 {
                let bin = measures::VALID_PER_FRAME_BINS.bin_of(0.0);
                self.add("", measures::VALID_PER_FRAME, class.name(), bin, u64::from(empty));
            }
        }
    }

    fn add_motion(&mut self, class: DetectionClass, row: &TrackFrameRow) {
        let yaw_deg = to_deg(row.rpy_rad[2]);
        let yaw_deg = if yaw_deg >= 180.0 { yaw_deg - 360.0 } else { yaw_deg };
        self.add("", measures::YAW_DEG, class.name(), measures::YAW_BINS.bin_of(yaw_deg), 1);
        if measures::MOVING_CLASSES.contains(&class.name()) {
            let speed_mps = Vector3::from(row.velocity_mps.map(f64::from)).norm();
            self.add("", measures::SPEED_MPS, class.name(), measures::SPEED_BINS.bin_of(speed_mps), 1);
            let rate_dps = to_deg(f64::from(row.angular_velocity_radps[2]));
            self.add("", measures::YAW_RATE_DPS, class.name(), measures::YAW_RATE_BINS.bin_of(rate_dps), 1);
        }
    }

    fn add_pedestrian(&mut self, row: &TrackFrameRow) {
        let wheelchair = uses_wheelchair(&row.attributes);
        let valid = row.valid_flag.then_some(measures::VALID);
        for class in [Some(measures::ALL), valid].into_iter().flatten() {
            self.add("", measures::PEDESTRIANS, class, 0, 1);
            self.add("", measures::WHEELCHAIR, class, 0, u64::from(wheelchair));
        }
    }

    /// The counts as rows, by agent, measure, class, bin.
    #[must_use]
    pub fn rows(&self) -> Vec<PartialRow> {
        self.counts
            .iter()
            .map(|(key, &count)| PartialRow {
                agent: key.agent.clone(),
                measure: key.measure.clone(),
                class: key.class.clone(),
                bin: key.bin,
                count,
            })
            .collect()
    }
}

/// Whether an object's attributes (a JSON object of strings) say so; without a word about it, no.
fn uses_wheelchair(attributes: &str) -> bool {
    serde_json::from_str::<BTreeMap<String, serde_json::Value>>(attributes)
        .ok()
        .and_then(|map| {
            map.get("use_wheelchair").and_then(|value| value.as_str().map(|text| text != "false"))
        })
        .unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(rows: &[PartialRow], measure: &str, class: &str, bin: i32) -> u64 {
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
        let mut counts = Counts::new();
        counts.add_tracks(&rows, 10);
        let got = counts.rows();
        for class in DetectionClass::ALL {
            let frames: u64 = got
                .iter()
                .filter(|r| r.measure == measures::VALID_PER_FRAME && r.class == class.name())
                .map(|r| r.count)
                .sum();
            assert_eq!(frames, 10, "{class:?}");
        }
        assert_eq!(count(&got, measures::VALID_PER_FRAME, "car", 5), 1);
        assert_eq!(count(&got, measures::VALID_PER_FRAME, "car", 0), 9);
        assert_eq!(count(&got, measures::VALID_PER_FRAME, "pedestrian", 100), 1);
        assert_eq!(
            (count(&got, measures::BOXES, "car", 0), count(&got, measures::BOXES_VALID, "car", 0)),
            (8, 7)
        );
        assert_eq!(count(&got, measures::FRAMES, "", 0), 10);
    }

    #[test]
    fn motion_falls_into_the_named_bins() {
        let mut moving = row(0, 1, "car", true);
        moving.rpy_rad = [0.0, 0.0, std::f64::consts::PI];
        moving.velocity_mps = [3.0, 4.5, 0.0];
        moving.angular_velocity_radps = [0.0, 0.0, -0.1];
        let mut sign = moving.clone();
        sign.class = "traffic_sign".into();
        let mut counts = Counts::new();
        counts.add_tracks(&[moving, sign], 1);
        let got = counts.rows();
        assert_eq!(count(&got, measures::YAW_DEG, "car", -180), 1);
        assert_eq!(count(&got, measures::YAW_DEG, "traffic_sign", -180), 1);
        assert_eq!(count(&got, measures::SPEED_MPS, "car", 5), 1);
        assert_eq!(count(&got, measures::YAW_RATE_DPS, "car", -10), 1, "-5.7 degrees a second");
        assert!(!got.iter().any(|r| r.measure == measures::SPEED_MPS && r.class == "traffic_sign"));
    }

    #[test]
    fn wheelchairs_are_read_from_attributes() {
        let walker = |id, attributes: &str, valid| TrackFrameRow {
            attributes: attributes.into(),
            ..row(0, id, "pedestrian", valid)
        };
        let mut counts = Counts::new();
        counts.add_tracks(
            &[
                walker(1, r#"{"use_wheelchair": "true"}"#, false),
                walker(2, r#"{"use_wheelchair":"false"}"#, true),
                walker(3, "not json", true),
            ],
            1,
        );
        let got = counts.rows();
        let numbers =
            |measure| (count(&got, measure, measures::ALL, 0), count(&got, measure, measures::VALID, 0));
        assert_eq!(numbers(measures::PEDESTRIANS), (3, 2));
        assert_eq!(numbers(measures::WHEELCHAIR), (1, 0));
    }

    #[test]
    fn grids_add_up() {
        let mut grid = VoxelGrid::free([2, 2, 20]);
        grid.data[5] = Tag::Car as u8;
        grid.data[79] = Tag::Road as u8;
        let mut counts = Counts::new();
        counts.add_voxels("vehicle_0", &grid, Filling::Hollow);
        let mut again = Counts::new();
        again.add_voxels("vehicle_0", &grid, Filling::Hollow);
        counts.merge(again);
        let got = counts.rows();
        assert_eq!(count(&got, measures::VOXEL_CELLS, "car", 0), 2);
        assert_eq!(count(&got, measures::VOXEL_CELLS, "unlabeled", 0), 156);
        assert_eq!(count(&got, measures::VOXEL_GRIDS, "", 0), 2);
        assert!(!got.iter().any(|r| r.class == "bus"));
    }
}
