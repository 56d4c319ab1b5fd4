//! What an agent's lidars saw of its voxel grids.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use codecs::Scalar;
use labels::carve::{Lattice, Sweep, carve};
use runner::frames::{FrameArray, FrameArrays, Labelled, write_labels};
use runner::{At, Job, Place, StageError};
use scene::{SceneError, SceneReader};
use schema::arrays::{ArrayKind, OBSERVED_VOXELS};
use schema::measures::counts::PartialCounts;
use schema::{AgentId, rate};
use settings::OccupancySettings;
use settings::stages::{RangeRig, ValiditySettings};

use crate::clouds::{Clouds, Readings};

/// Writes what the lidars of some agents saw of every grid.
///
/// # Errors
/// Lidar tables are missing or broken, or the store cannot be written.
pub(crate) fn observe_agents(
    job: &Job<'_, ValiditySettings>,
    scene: &SceneReader,
    agents: &[AgentId],
    frames: u32,
) -> Result<(), StageError> {
    let number = scene.scene();
    let labels = agents.iter().filter_map(|&agent| {
        let labelled = |unit| {
            let label = Observed::open(job.settings(), scene, agent, frames)?;
            Ok(Labelled { unit, scene: number, agent, counted: None, label })
        };
        Some(job.unit(&format!("observed.{agent}")).transpose()?.and_then(labelled))
    });
    write_labels(labels, frames, &job.progress())
}

/// Readings in the order of their tables, for threads that ask for neighbouring frames in any order.
struct Ahead {
    clouds: Clouds,
    next: u32,
    /// Frames between are read past.
    every_n_frames: u32,
    /// Read already, not yet asked for.
    waiting: BTreeMap<u32, Readings>,
}

impl Ahead {
    fn take(&mut self, frame: u32) -> Result<Readings, SceneError> {
        loop {
            if let Some(readings) = self.waiting.remove(&frame) {
                return Ok(readings);
            }
            let readings = self.clouds.next_frame(self.next)?;
            if rate::is_due(self.next, self.every_n_frames) {
                self.waiting.insert(self.next, readings);
            }
            self.next += 1;
        }
    }
}

/// What the lidars of an agent saw.
struct Observed<'a> {
    place: Place,
    grid: &'a OccupancySettings,
    ahead: Mutex<Ahead>,
}

impl<'a> Observed<'a> {
    fn open(
        settings: &'a ValiditySettings,
        scene: &SceneReader,
        agent: AgentId,
        frames: u32,
    ) -> Result<Self, StageError> {
        let place = Place::scene(scene.scene()).agent(agent);
        let (grid, rig) = (settings.occupancy.of(agent), settings.rigs.of(agent));
        let lidars = RangeRig { radars: Vec::new(), ..rig.clone() };
        let clouds = Clouds::open(scene, agent, &lidars, frames).at(|| place.clone())?;
        let every_n_frames = grid.every_n_frames;
        let ahead = Mutex::new(Ahead { clouds, next: 0, every_n_frames, waiting: BTreeMap::new() });
        Ok(Self { place, grid, ahead })
    }
}

impl FrameArrays for Observed<'_> {
    type Memory = Vec<u8>;

    fn every_n_frames(&self) -> u32 {
        self.grid.every_n_frames
    }

    fn comment(&self) -> Result<String, StageError> {
        self.grid.describe().at(|| self.place.clone())
    }

    fn memory(&self) -> Result<Vec<u8>, StageError> {
        Ok(Vec::new())
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        vec![&OBSERVED_VOXELS]
    }

    /// `[x, y, z]` of [`labels::carve::Seen`].
    fn arrays<'m>(
        &self,
        cells: &'m mut Vec<u8>,
        frame: u32,
        _: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        let readings = {
            let mut ahead = self.ahead.lock().unwrap_or_else(PoisonError::into_inner);
            ahead.take(frame).at(|| self.place.clone().frame(frame))?
        };
        let OccupancySettings { range_m, voxel_m, lower_m, mount_z_m, .. } = *self.grid;
        let lattice = Lattice {
            shape: self.grid.shape(),
            corner_m: [-range_m, -range_m, mount_z_m + lower_m],
            cell_m: voxel_m,
        };
        let sweeps: Vec<Sweep<'_>> = readings
            .lidars()
            .iter()
            .map(|(mount, [x, y, z])| Sweep { agent_from_sensor: mount.agent_from_sensor(), x, y, z })
            .collect();
        carve(&lattice, &sweeps, cells);
        Ok(vec![FrameArray { scalar: Scalar::U8, shape: lattice.shape.to_vec(), bytes: (&*cells).into() }])
    }
}
