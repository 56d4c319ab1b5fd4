//! nuScenes 1.x, as nuscenes-devkit reads it: a scene of it for every agent of a scene.
//!
//! ```text
//! VERSION/{category,attribute,visibility,instance,sensor,calibrated_sensor,ego_pose,log,scene,sample,sample_data,
//!          sample_annotation,map,lidarseg}.json    one row a line
//! VERSION/splits.json                              {"convoy_train": [names of scenes], ...}
//! VERSION/cooperation.json                         samples of the agents of a scene that are of the same moment
//! samples/CHANNEL/NNNN-AGENT__CHANNEL__TIME.*      readings of samples; sweeps/ likewise, on demand
//! lidarseg/VERSION/TOKEN_lidarseg.bin              a category for each point of LIDAR_TOP
//! infos/mmdet3d_SPLIT.pkl                      what mmdet3d reads, and mmdet3d_0x_SPLIT.pkl; on demand
//! maps/MAP.png                                     where one may drive, 0.1 m a pixel
//! ```
//!
//! A VERSION is `v1.0-SPLIT-MAP`. The global frame of a map is the world moved by whole metres, so that all
//! coordinates are positive and the mask begins where the scenes do; how far it is moved stands in `map.json`
//! (`global_from_world_m`).

mod boxes;
mod clouds;
mod finish;
mod infos;
mod mask;
mod options;
mod parts;
mod pickle;
mod preflight;
mod rig;
mod rows;
mod unit;
mod vocabulary;

use std::collections::BTreeMap;

use schema::table::Row;
use schema::tables::{BoxRow, CameraRow, ValidBoxRow};

pub use options::NuScenesOptions;
pub use vocabulary::Modality;

use unit::Fragment;

use crate::asked::by_option;
use crate::{Cost, ExportError, Layout, Omission, SceneSource, Source, UnitFiles, UnitName};

/// The layout.
#[derive(Clone, Debug)]
pub struct NuScenes {
    options: NuScenesOptions,
}

impl NuScenes {
    /// With options.
    #[must_use]
    pub fn new(mut options: NuScenesOptions) -> Self {
        options.sweeps.sort_unstable();
        options.sweeps.dedup();
        Self { options }
    }
}

impl Layout for NuScenes {
    fn name(&self) -> &'static str {
        "nuscenes"
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!(self.options)
    }

    fn by_option(&self) -> BTreeMap<String, String> {
        by_option(&self.options)
    }

    fn needs(&self) -> Vec<&'static str> {
        vec![BoxRow::STAGE, CameraRow::STAGE, ValidBoxRow::STAGE]
    }

    fn preflight(&self, source: &Source) -> Result<Vec<Omission>, ExportError> {
        self.options.check()?;
        preflight::preflight(source, &self.options)
    }

    fn cost(&self, scene: &SceneSource, unit: UnitName) -> Result<Cost, ExportError> {
        preflight::cost(scene, unit, &self.options)
    }

    fn write_piece(
        &self,
        scene: &SceneSource,
        unit: UnitName,
        _piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError> {
        let Some(agent) = unit.agent else { return Ok(Vec::new()) };
        let fragment = unit::write(scene, agent, &self.options, files)?;
        // Texts and finite numbers: they can always be written down.
        Ok(serde_json::to_vec(&fragment).unwrap_or_default())
    }

    fn finish(
        &self,
        source: &Source,
        units: &[(UnitName, Vec<u8>)],
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        let read = |(unit, bytes): &(UnitName, Vec<u8>)| {
            serde_json::from_slice::<Fragment>(bytes).map_err(|e| {
                ExportError::Refused(format!("{unit}: its record is damaged ({e}); run again with --force"))
            })
        };
        let fragments = units.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        finish::write(source, &fragments, &self.options, files)
    }
}
