//! What `merge-tracks` counts.

use super::bins::Bins;

/// Annotated frames of a scene (each once, whatever the number of agents).
pub const FRAMES: &str = "frames";
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
/// Object-frames of pedestrians. Class: [`ALL_OBJECTS`] (or empty) or [`VALID_OBJECTS`].
pub const PEDESTRIANS: &str = "pedestrians";
/// Those of them who use a wheelchair. Class: as [`PEDESTRIANS`].
pub const WHEELCHAIR: &str = "wheelchair";
/// Class of counts over every object.
pub const ALL_OBJECTS: &str = "all";
/// Class of counts over valid objects.
pub const VALID_OBJECTS: &str = "valid";
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
