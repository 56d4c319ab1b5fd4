//! Names of the counts in [`PartialRow::measure`](crate::tables::PartialRow), and the bins of the histograms.
//!
//! A stage writes rows of these measures while it has the data in hand; the statistics stage adds up the rows
//! of one (measure, class, bin). Unless said otherwise `class` is empty and `bin` is 0.

/// Recorded frames of a scene (each once, whatever the number of agents).
pub const FRAMES: &str = "frames";
/// Frames times agents. Rows carry the agent.
pub const AGENT_FRAMES: &str = "agent_frames";

/// Unique objects per frame (merged over the agents). Class: detection class.
pub const BOXES: &str = "boxes";
/// The same, valid ones alone. Class: detection class.
pub const BOXES_VALID: &str = "boxes_valid";
/// Frames by number of valid objects in them. Class: detection class; bin: [`VALID_PER_FRAME_BINS`].
/// Frames without any valid object of a class may be left out: they are the rest up to [`FRAMES`].
pub const VALID_PER_FRAME: &str = "valid_per_frame";
/// Valid objects by heading, degrees. Class: detection class; bin: [`YAW_BINS`].
pub const YAW_DEG: &str = "yaw_deg";
/// Valid objects by speed (3-D), m/s. Class: one of [`MOVING_CLASSES`]; bin: [`SPEED_BINS`].
pub const SPEED_MPS: &str = "speed_mps";
/// Valid objects by turning rate, degrees a second. Class: one of [`MOVING_CLASSES`]; bin: [`YAW_RATE_BINS`].
pub const YAW_RATE_DPS: &str = "yaw_rate_dps";

/// Object-frames of pedestrians. Class: [`ALL`] (or empty) or [`VALID`].
pub const PEDESTRIANS: &str = "pedestrians";
/// Those of them who use a wheelchair. Class: as [`PEDESTRIANS`].
pub const WHEELCHAIR: &str = "wheelchair";
/// Class of counts over every object.
pub const ALL: &str = "all";
/// Class of counts over valid objects.
pub const VALID: &str = "valid";

/// True cells of BEV masks. Class: BEV class.
pub const BEV_CELLS: &str = "bev_cells";
/// BEV masks (one has all channels).
pub const BEV_GRIDS: &str = "bev_grids";

/// Cells of voxel grids before filling. Class: tag name; `unlabeled` is free space.
pub const VOXEL_CELLS: &str = "voxel_cells";
/// Cells of voxel grids after filling. Class: tag name; `unlabeled` is free space.
pub const VOXEL_CELLS_FILLED: &str = "voxel_cells_filled";
/// Voxel grids (before filling; there are as many after it).
pub const VOXEL_GRIDS: &str = "voxel_grids";

/// Lidar points. Class: sensor name. Rows carry the agent, and exist even when nothing was hit.
pub const LIDAR_POINTS: &str = "lidar_points";
/// Radar points. Class: sensor name. Rows carry the agent, and exist even when nothing was hit.
pub const RADAR_POINTS: &str = "radar_points";
/// Images. Class: kind (`RGB`, `SEG`, ...).
pub const IMAGES: &str = "images";
/// Bytes of the finished tables of sensors. Class: sensor name, or kind of image, or the name of another table
/// (`visible`). Rows carry the agent.
pub const SENSOR_BYTES: &str = "sensor_bytes";

/// Classes that have speed and turning-rate histograms.
pub const MOVING_CLASSES: [&str; 6] = ["car", "truck", "bus", "motorcycle", "bicycle", "pedestrian"];

/// Bins of [`VALID_PER_FRAME`]: 0-4, 5-9, ..., 95-99, and 100 for all above.
pub const VALID_PER_FRAME_BINS: Bins = Bins { lower: 0, upper: 100, width: 5 };
/// Bins of [`YAW_DEG`]: 10 degrees over [-180, 180). Wrap headings before binning: exactly 180 is -180.
pub const YAW_BINS: Bins = Bins { lower: -180, upper: 180, width: 10 };
/// Bins of [`SPEED_MPS`]: 1 m/s, and 40 for all above.
pub const SPEED_BINS: Bins = Bins { lower: 0, upper: 40, width: 1 };
/// Bins of [`YAW_RATE_DPS`]: 5 degrees a second over [-50, 50), with -55 for all below and 50 for all above.
pub const YAW_RATE_BINS: Bins = Bins { lower: -50, upper: 50, width: 5 };

/// Half-open bins `[lower, lower + width)`, ..., `[upper - width, upper)`, each named by its lower edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bins {
    /// Lower edge of the first bin.
    pub lower: i32,
    /// Upper edge of the last bin, and name of the bin for all values from there on.
    pub upper: i32,
    /// Width of a bin.
    pub width: i32,
}

impl Bins {
    /// Name (lower edge) of the bin that holds a value: `lower - width` for all values below, `upper` for all
    /// values above. NaN counts as above.
    #[must_use]
    pub fn bin_of(&self, value: f64) -> i32 {
        if value < f64::from(self.lower) {
            self.lower - self.width
        } else if value < f64::from(self.upper) {
            self.lower + ((value - f64::from(self.lower)) / f64::from(self.width)).floor() as i32 * self.width
        } else {
            self.upper
        }
    }

    /// Lower edges of the bins between the limits, in order.
    pub fn edges(&self) -> impl Iterator<Item = i32> + use<> {
        (self.lower..self.upper).step_by(self.width.unsigned_abs() as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_belong_to_the_bin_above() {
        assert_eq!(YAW_BINS.bin_of(-180.0), -180);
        assert_eq!(YAW_BINS.bin_of(-170.000_001), -180);
        assert_eq!(YAW_BINS.bin_of(-170.0), -170);
        assert_eq!(YAW_BINS.bin_of(179.99), 170);
        assert_eq!(VALID_PER_FRAME_BINS.bin_of(4.0), 0);
        assert_eq!(VALID_PER_FRAME_BINS.bin_of(5.0), 5);
        assert_eq!(VALID_PER_FRAME_BINS.bin_of(99.0), 95);
        assert_eq!(VALID_PER_FRAME_BINS.bin_of(100.0), 100);
        assert_eq!(SPEED_BINS.bin_of(1e9), 40);
        assert_eq!(YAW_RATE_BINS.bin_of(-50.1), -55);
        assert_eq!(YAW_RATE_BINS.bin_of(50.0), 50);
        assert_eq!(YAW_RATE_BINS.bin_of(f64::NAN), 50);
    }

    #[test]
    fn bins_cover_their_range() {
        assert_eq!(YAW_BINS.edges().count(), 36);
        assert_eq!(SPEED_BINS.edges().last(), Some(39));
        assert_eq!(VALID_PER_FRAME_BINS.edges().count(), 20);
        for bins in [YAW_BINS, SPEED_BINS, YAW_RATE_BINS, VALID_PER_FRAME_BINS] {
            for edge in bins.edges() {
                assert_eq!(bins.bin_of(f64::from(edge)), edge);
            }
        }
    }
}
