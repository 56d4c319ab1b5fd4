//! KITTI's object and tracking benchmarks (Geiger et al., "Are we ready for autonomous driving?", 2012; files
//! as the benchmarks' development kits describe them): one set of each for every agent.
//!
//! ```text
//! AGENT/tracking/training/{image_02,velodyne}/SSSS/FFFFFF.{png,bin}   SSSS the scene, FFFFFF from 0 without gaps
//! AGENT/tracking/training/{label_02,calib,oxts}/SSSS.txt
//! AGENT/tracking/evaluate_tracking.seqmap.{train,val,test}
//! AGENT/object/training/{image_2,velodyne,label_2,calib}/NNNNNN.*     NNNNNN = 1000 x scene + number of the frame
//! AGENT/object/ImageSets/{train,val,test}.txt
//! ```
//!
//! The object benchmark's pictures and clouds are links to those of the tracking benchmark: the bytes are
//! there once.

mod calib;
mod label;
mod pair;
mod unit;

use std::collections::BTreeMap;

use clap::Args;
use scene::{SensorEntry, SensorKind};
use schema::table::Row;
use schema::tables::{BoxRow, CameraRow, ValidBoxRow};
use schema::{AgentId, ImageKind};
use serde::Serialize;
use settings::Lens;

use self::pair::{MOST, Pair, Sequence};
use crate::asked::by_option;
use crate::{Cost, ExportError, Layout, Omission, SceneSource, Source, UnitFiles, UnitName};

/// What a user may choose.
#[derive(Clone, Debug, Args, Serialize)]
pub struct KittiOptions {
    /// The camera that becomes image_2 and carries the labels.
    #[arg(long, value_name = "NAME", default_value = "CAM_FRONT")]
    pub camera: String,
    /// The lidar that becomes velodyne.
    #[arg(long, value_name = "NAME", default_value = "LIDAR")]
    pub lidar: String,
}

/// The layout.
#[derive(Clone, Debug)]
pub struct Kitti {
    options: KittiOptions,
}

impl Kitti {
    /// With options.
    #[must_use]
    pub fn new(options: KittiOptions) -> Self {
        Self { options }
    }

    /// The camera and the lidar of an agent, if it has both.
    fn pair(&self, scene: &SceneSource, agent: AgentId) -> Result<Option<Pair>, ExportError> {
        let table = ImageKind::Rgb.table(&self.options.camera);
        let (mut camera, mut lidar, mut others) = (None, None, Vec::new());
        for sensor in scene.sensors(agent)? {
            if sensor.name == table {
                camera = Some(sensor);
            } else if sensor.name == self.options.lidar && sensor.kind == SensorKind::Lidar {
                lidar = Some(sensor);
            } else if !matches!(sensor.kind, SensorKind::Gnss | SensorKind::Imu) {
                others.push(sensor);
            }
        }
        Ok(camera.zip(lidar).map(|(camera, lidar)| Pair { camera, lidar, others }))
    }

    fn wanted(&self, scene: &SceneSource, agent: AgentId) -> Result<Pair, ExportError> {
        self.pair(scene, agent)?.ok_or_else(|| {
            let KittiOptions { camera, lidar } = &self.options;
            let problem =
                format!("has not both RGB-{camera} and {lidar} (choose others with --camera and --lidar)");
            ExportError::Content {
                scene: scene.number(),
                frame: None,
                agent: Some(agent.to_string()),
                problem,
            }
        })
    }
}

impl Layout for Kitti {
    fn name(&self) -> &'static str {
        "kitti"
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
        let mut omissions = vec![
            Omission::new("roll and pitch of boxes", "labels have a heading alone"),
            Omission::new(
                "velocities, attributes, cones, barriers, lights and signs",
                "labels have no place for them",
            ),
            Omission::new("boxes that the camera does not show", "labels are of one picture"),
            Omission::new("other cameras", "one camera and one lidar are in it"),
            Omission::new("BEV masks, voxels, maps", "the layout has no place for them"),
        ];
        for scene in &source.scenes {
            if scene.number() >= MOST || scene.info().frames > MOST {
                return Err(ExportError::Refused(format!(
                    "scene {}: KITTI's names have six digits, for {MOST} scenes of {MOST} frames (choose with --scenes)",
                    scene.number()
                )));
            }
            let mut any = false;
            for agent in scene.agents() {
                let Some(pair) = self.pair(scene, *agent)? else {
                    let KittiOptions { camera, lidar } = &self.options;
                    omissions.push(Omission::new(
                        agent.to_string(),
                        format!("has not both RGB-{camera} and {lidar}; --camera and --lidar choose others"),
                    ));
                    continue;
                };
                any = true;
                if pair.camera.about.lens.is_some_and(|lens| lens != Lens::Pinhole) {
                    return Err(ExportError::Refused(format!(
                        "scene {} {agent}: {} has a lens that bends rays, and KITTI's calibration has none (choose another --camera)",
                        scene.number(),
                        self.options.camera
                    )));
                }
                for sensor in &pair.others {
                    let why = match sensor.kind {
                        SensorKind::Image(ImageKind::Rgb) => continue,
                        SensorKind::Image(_) => "labels are boxes",
                        _ => "one camera and one lidar are in it",
                    };
                    omissions.push(Omission::sensor(sensor, why));
                }
            }
            if !any {
                return Err(ExportError::Refused(format!(
                    "scene {}: no agent has both RGB-{} and {} (choose others with --camera and --lidar)",
                    scene.number(),
                    self.options.camera,
                    self.options.lidar
                )));
            }
        }
        omissions.sort();
        omissions.dedup();
        Ok(omissions)
    }

    fn units(&self, scene: &SceneSource) -> Vec<UnitName> {
        // Agents without these sensors were told of by the survey.
        let has = |agent: &&AgentId| self.pair(scene, **agent).is_ok_and(|pair| pair.is_some());
        let unit = |agent: &AgentId| UnitName { scene: scene.number(), agent: Some(*agent) };
        scene.agents().iter().filter(has).map(unit).collect()
    }

    fn cost(&self, scene: &SceneSource, unit: UnitName) -> Result<Cost, ExportError> {
        let Some(agent) = unit.agent else { return Ok(Cost::default()) };
        let pair = self.wanted(scene, agent)?;
        let frames = pair.frames(scene).len() as u64;
        let of_sensor = |sensor: &SensorEntry| {
            sensor.bytes
                / u64::from(schema::rate::count(scene.info().frames, sensor.about.every_n_frames).max(1))
        };
        let pixels = f64::from(pair.camera.about.width.unwrap_or(0))
            * f64::from(pair.camera.about.height.unwrap_or(0));
        // A PNG takes some 1.5 bytes a pixel; a point 16 where the store has about 14 with its labels.
        let bytes = (1.5 * pixels) as u64 + of_sensor(&pair.lidar) * 16 / 14 + 20_000;
        let cpu_s = frames as f64 * (0.012 + 6e-8 * pixels);
        Ok(Cost { agent_frames: frames, bytes: bytes * frames, cpu_s })
    }

    fn write_piece(
        &self,
        scene: &SceneSource,
        unit: UnitName,
        _piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError> {
        let Some(agent) = unit.agent else { return Ok(Vec::new()) };
        let sequence = unit::write(scene, agent, &self.wanted(scene, agent)?, files)?;
        serde_json::to_vec(&sequence).map_err(|e| ExportError::Refused(e.to_string()))
    }

    fn finish(
        &self,
        _: &Source,
        units: &[(UnitName, Vec<u8>)],
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        let mut lists: BTreeMap<(AgentId, String), [String; 2]> = BTreeMap::new();
        for (unit, fragment) in units {
            let Some(agent) = unit.agent else { continue };
            let sequence: Sequence = serde_json::from_slice(fragment).map_err(|e| {
                ExportError::Refused(format!("the record of {unit} is damaged ({e}): use --force"))
            })?;
            let [seqmap, images] = lists.entry((agent, sequence.split)).or_default();
            *seqmap += &format!("{:04} empty 000000 {:06}\n", unit.scene, sequence.frames);
            for frame in 0..sequence.frames {
                *images += &format!("{}\n", unit::object_name(unit.scene, frame));
            }
        }
        for ((agent, split), [seqmap, images]) in lists {
            files.put(&format!("{agent}/tracking/evaluate_tracking.seqmap.{split}"), seqmap.as_bytes())?;
            files.put(&format!("{agent}/object/ImageSets/{split}.txt"), images.as_bytes())?;
        }
        Ok(())
    }
}
