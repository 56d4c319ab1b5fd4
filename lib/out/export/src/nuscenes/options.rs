//! What a user may choose.

use super::mask::Canvas;
use super::vocabulary::Modality;
use crate::ExportError;

/// What a user may choose.
#[derive(Clone, Debug, PartialEq)]
pub struct NuScenesOptions {
    /// The name of one version for all splits and maps; none for one each.
    pub version: Option<String>,
    /// Samples stand at least so many frames apart: 10 frames are half a second.
    pub sample_every_n_frames: u32,
    /// Channels of these have files between the samples, too.
    pub sweeps: Vec<Modality>,
    /// Boxes whose centre is farther from the agent in plan are not annotated, m.
    pub radius_m: f64,
    /// Whether boxes without a lidar or radar point are annotated.
    pub empty_boxes: bool,
    /// Whether points have labels.
    pub lidarseg: bool,
    /// Whether maps have masks; else these are blank.
    pub map_mask: bool,
}

impl Default for NuScenesOptions {
    fn default() -> Self {
        Self {
            version: None,
            sample_every_n_frames: 10,
            sweeps: Vec::new(),
            radius_m: 60.0,
            empty_boxes: false,
            lidarseg: true,
            map_mask: true,
        }
    }
}

impl NuScenesOptions {
    /// The folder of the tables of a split and map.
    pub(crate) fn version_of(&self, split: &str, map: &str) -> String {
        self.version.clone().unwrap_or_else(|| format!("v1.0-{split}-{}", plain(map)))
    }

    /// Refuses a version that is no name of a folder, and a radius that is no distance.
    pub(crate) fn check(&self) -> Result<(), ExportError> {
        if let Some(version) = &self.version
            && (version.is_empty() || plain(version) != *version || version.starts_with('.'))
        {
            return Err(ExportError::Refused(format!(
                "version `{version}`: take letters, digits, `_`, `-` and `.`, such as v1.0-trainval"
            )));
        }
        if !(self.radius_m > 0.0 && self.radius_m.is_finite()) {
            return Err(ExportError::Refused(format!("radius {}: is no distance", self.radius_m)));
        }
        Ok(())
    }

    /// The canvas of a map for a piece of ground; too large a one is refused.
    pub(crate) fn canvas(&self, map: &str, ground: [f64; 4]) -> Result<Canvas, ExportError> {
        if !self.map_mask {
            return Ok(Canvas::blank(ground));
        }
        Canvas::of(ground).map_err(|problem| ExportError::Refused(format!("map {map}: {problem}")))
    }
}

/// A name of a file from the name of a map: all but letters, digits, `-` and `.` become `_`.
pub(crate) fn plain(map: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' };
    map.chars().map(keep).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_named_by_split_and_map() {
        let mut options = NuScenesOptions::default();
        assert_eq!(options.version_of("val", "convoy/demo"), "v1.0-val-convoy_demo");
        options.version = Some("v1.0-trainval".into());
        assert_eq!(options.version_of("val", "convoy/demo"), "v1.0-trainval");
        assert!(options.check().is_ok());
        for version in ["", "a/b", "..", "x y"] {
            options.version = Some(version.into());
            assert!(options.check().is_err(), "{version}");
        }
        for radius_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                NuScenesOptions { radius_m, ..NuScenesOptions::default() }.check().is_err(),
                "{radius_m}"
            );
        }
    }
}
