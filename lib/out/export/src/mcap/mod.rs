//! MCAP files (mcap.dev) of Foxglove's messages in protocol buffers: one for each scene, for Foxglove, Rerun
//! and other readers of robot recordings.
//!
//! ```text
//! SPLIT/scene_SSSS.mcap
//!   /tf /tf_static /map /weather /boxes
//!   /AGENT/state /AGENT/boxes /AGENT/bev /AGENT/occupancy
//!   /AGENT/SENSOR                                              lidars, radars, GNSS, IMU
//!   /AGENT/CAMERA/{image,semantic,instance,depth,calibration}
//! ```
//!
//! A scene is made by tracks (what is read together) that run side by side, a frame at a time; each makes a
//! chunk of its own of every frame, and the chunks are written in the tracks' order. So a reader of boxes
//! need not unpack pictures, and the bytes do not depend on the number of threads.

mod chunk;
mod clock;
mod container;
mod cost;
mod descriptor;
mod drawn;
mod map;
mod messages;
mod options;
mod packed;
mod preflight;
mod record;
mod topics;
mod tracks;
mod wire;
mod write;

use std::collections::BTreeMap;

use schema::table::Row;
use schema::tables::BoxRow;

pub use options::McapOptions;

use crate::asked::by_option;
use crate::{Cost, ExportError, Layout, Omission, SceneSource, Source, UnitFiles, UnitName};

/// The layout.
#[derive(Clone, Copy, Debug)]
pub struct Mcap {
    options: McapOptions,
}

impl Mcap {
    /// With options.
    ///
    /// # Errors
    /// The range is no length.
    pub fn new(options: McapOptions) -> Result<Self, ExportError> {
        if !(options.voxel_range_m.is_finite() && options.voxel_range_m >= 0.0) {
            let problem =
                format!("voxels cannot reach {} m: a length is wanted, or 0 for none", options.voxel_range_m);
            return Err(ExportError::Refused(problem));
        }
        Ok(Self { options })
    }
}

impl Layout for Mcap {
    fn name(&self) -> &'static str {
        "mcap"
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!(self.options)
    }

    fn by_option(&self) -> BTreeMap<String, String> {
        by_option(&self.options)
    }

    fn needs(&self) -> Vec<&'static str> {
        vec![BoxRow::STAGE]
    }

    fn is_parallel_inside(&self) -> bool {
        true
    }

    fn preflight(&self, source: &Source) -> Result<Vec<Omission>, ExportError> {
        preflight::omissions(source, self.options)
    }

    fn units(&self, scene: &SceneSource) -> Vec<UnitName> {
        vec![UnitName { scene: scene.number(), agent: None }]
    }

    fn cost(&self, scene: &SceneSource, _unit: UnitName) -> Result<Cost, ExportError> {
        cost::of_scene(scene, self.options)
    }

    fn write_piece(
        &self,
        scene: &SceneSource,
        _unit: UnitName,
        _piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError> {
        write::scene(scene, self.options, files)?;
        Ok(Vec::new())
    }

    fn finish(
        &self,
        _source: &Source,
        _units: &[(UnitName, Vec<u8>)],
        _files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        Ok(())
    }
}
