//! What a user may choose.

use clap::{ArgAction, Args};
use serde::Serialize;

use super::mask::MapMask;
use super::vocabulary::Modality;
use crate::ExportError;

/// What a user may choose.
#[derive(Clone, Debug, PartialEq, Args, Serialize)]
pub struct NuScenesOptions {
    /// One version for all, by its name, such as v1.0-trainval (default: one for each split and map,
    /// v1.0-SPLIT-MAP).
    #[arg(long = "version-name", value_name = "NAME")]
    pub version: Option<String>,
    /// Samples (annotated keyframes) stand at least so many frames apart.
    #[arg(long = "sample-every", value_name = "N", default_value_t = 10,
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub sample_every_n_frames: u32,
    /// Write the readings between samples, too, of these: lidar,radar,camera.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub sweeps: Vec<Modality>,
    /// Annotate boxes within this distance of the agent in plan, m.
    #[arg(long = "radius", value_name = "M", default_value_t = 60.0)]
    pub radius_m: f64,
    /// Annotate boxes without a lidar or radar point, too.
    #[arg(long)]
    pub empty_boxes: bool,
    /// Leave labels of points out.
    #[arg(long = "no-lidarseg", action = ArgAction::SetFalse)]
    pub lidarseg: bool,
    /// Write what mmdet3d reads, too: a file of samples for each split, as its versions from 1.1 on have it,
    /// and as 0.x and BEVFusion do.
    #[arg(long, value_name = "FORM", value_parser = ["mmdet3d"])]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub infos: Option<String>,
    /// Write blank map masks: for scenes that lie kilometres apart.
    #[arg(long = "no-map-mask", action = ArgAction::SetFalse)]
    pub map_mask: bool,
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

    /// The mask of a map for a piece of ground; too large a one is refused.
    pub(crate) fn mask_of(&self, map: &str, ground: [f64; 4]) -> Result<MapMask, ExportError> {
        if !self.map_mask {
            return Ok(MapMask::blank(ground));
        }
        MapMask::of(map, ground)
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
    use crate::command::usual;

    #[test]
    fn versions_are_named_by_split_and_map() {
        let mut options = usual::<NuScenesOptions>();
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
                NuScenesOptions { radius_m, ..usual::<NuScenesOptions>() }.check().is_err(),
                "{radius_m}"
            );
        }
    }
}
