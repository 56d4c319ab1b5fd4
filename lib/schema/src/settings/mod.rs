//! The dataset configuration as plain, validated values, in SI units and radians.
//!
//! `pipeline` reads these from TOML (and says where a fault is); the cores take the parts they need. Default
//! values are those of the published dataset unless a field says otherwise.

mod rig;
mod scenario;

use serde::Serialize;

use crate::{AgentId, AgentKind};

pub use rig::{CameraSettings, CameraSpec, GnssSpec, ImuSpec, LidarSpec, Mount, RadarSpec, Rig, ScanPattern};
pub use scenario::{
    AgentSettings, GivenStart, HazardSettings, LightSettings, SceneCount, SpawnMode, Split, TimingSettings,
    TrafficSettings, WalkerSettings, WeatherSettings, WorldSettings,
};

/// Everything that determines a dataset, besides maps and code.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DatasetSettings {
    /// Name of the dataset, in reports.
    pub name: String,
    /// Seed of every random stream.
    pub seed: u64,
    /// How many scenes on which map, in split order.
    pub scenes: Vec<SceneCount>,
    /// Scenes to draw anew, by number: which further draw is meant, from 1.
    pub redraw: Vec<(u32, u32)>,
    /// Data-collection vehicles and RSUs.
    pub agents: AgentSettings,
    /// Warm-up and durations.
    pub timing: TimingSettings,
    /// Background vehicles and drivers.
    pub traffic: TrafficSettings,
    /// Pedestrians.
    pub walkers: WalkerSettings,
    /// Weather draws and overrides.
    pub weather: WeatherSettings,
    /// Street lamps and lit windows.
    pub lights: LightSettings,
    /// Accidents and road works.
    pub hazards: HazardSettings,
    /// Scenery placed by rule.
    pub world: WorldSettings,
    /// Sensors of every data-collection vehicle.
    pub vehicle_rig: Rig,
    /// Sensors of every RSU.
    pub rsu_rig: Rig,
    /// Agents that carry something else.
    pub own_rigs: Vec<OwnRig>,
    /// Which objects are annotated.
    pub annotation: AnnotationSettings,
    /// BEV masks.
    pub bev: BevSettings,
    /// Voxel grids of vehicles.
    pub vehicle_occupancy: OccupancySettings,
    /// Voxel grids of RSUs.
    pub rsu_occupancy: OccupancySettings,
}

impl DatasetSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self {
            name: "dataset".into(),
            seed: 27,
            scenes,
            redraw: Vec::new(),
            agents: AgentSettings::default(),
            timing: TimingSettings::default(),
            traffic: TrafficSettings::default(),
            walkers: WalkerSettings::default(),
            weather: WeatherSettings::default(),
            lights: LightSettings::default(),
            hazards: HazardSettings::default(),
            world: WorldSettings::default(),
            vehicle_rig: Rig::vehicle(),
            rsu_rig: Rig::rsu(),
            own_rigs: Vec::new(),
            annotation: AnnotationSettings::default(),
            bev: BevSettings::default(),
            vehicle_occupancy: OccupancySettings::default(),
            rsu_occupancy: OccupancySettings::default(),
        }
    }

    fn own_rig(&self, agent: AgentId) -> Option<&OwnRig> {
        let name = agent.to_string();
        self.own_rigs.iter().find(|own| own.agents.contains(&name))
    }

    /// Sensors of an agent.
    #[must_use]
    pub fn rig_of(&self, agent: AgentId) -> &Rig {
        match (self.own_rig(agent), agent.kind) {
            (Some(own), _) => &own.rig,
            (None, AgentKind::Vehicle) => &self.vehicle_rig,
            (None, AgentKind::Rsu) => &self.rsu_rig,
        }
    }

    /// Voxel grid of an agent.
    #[must_use]
    pub fn occupancy_of(&self, agent: AgentId) -> &OccupancySettings {
        match (self.own_rig(agent), agent.kind) {
            (Some(own), _) => &own.occupancy,
            (None, AgentKind::Vehicle) => &self.vehicle_occupancy,
            (None, AgentKind::Rsu) => &self.rsu_occupancy,
        }
    }
}

/// Sensors and voxel grid of some agents, instead of those of their kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnRig {
    /// `vehicle_1`, `rsu_0`, ...; all of one kind.
    pub agents: Vec<String>,
    /// Sensors.
    pub rig: Rig,
    /// Voxel grid.
    pub occupancy: OccupancySettings,
}

/// Which objects are annotated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnnotationSettings {
    /// Boxes within this 3-D distance of an agent are collected, metres (200).
    pub box_radius_m: f64,
    /// An object without points counts as valid when an instance image shows it.
    pub valid_by_image: bool,
}

impl Default for AnnotationSettings {
    fn default() -> Self {
        Self { box_radius_m: 200.0, valid_by_image: true }
    }
}

/// The BEV grid: square, centred on the agent, row 0 ahead, column 0 left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BevSettings {
    /// Write BEV masks.
    pub enabled: bool,
    /// Rows and columns (400).
    pub cells: u32,
    /// Cell size, metres (0.4).
    pub cell_m: f64,
}

impl Default for BevSettings {
    fn default() -> Self {
        Self { enabled: true, cells: 400, cell_m: 0.4 }
    }
}

impl BevSettings {
    /// Half the grid's side, metres.
    #[must_use]
    pub fn half_extent_m(&self) -> f64 {
        0.5 * f64::from(self.cells) * self.cell_m
    }
}

/// A voxel grid around an agent, turning fully with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OccupancySettings {
    /// Write voxel grids.
    pub enabled: bool,
    /// The grid reaches this far ahead, behind, left and right, metres (64).
    pub range_m: f64,
    /// Cell size, metres (0.1).
    pub voxel_m: f64,
    /// Lower face above the grid origin, metres (-1).
    pub lower_m: f64,
    /// Upper face above the grid origin, metres (7).
    pub upper_m: f64,
    /// Height of the grid origin above the agent's origin, metres (0.02).
    pub mount_z_m: f64,
    /// Leave out the carrying agent's own body.
    pub ignore_self: bool,
}

impl Default for OccupancySettings {
    fn default() -> Self {
        Self {
            enabled: true,
            range_m: 64.0,
            voxel_m: 0.1,
            lower_m: -1.0,
            upper_m: 7.0,
            mount_z_m: 0.02,
            ignore_self: false,
        }
    }
}

impl OccupancySettings {
    /// Most cells of a grid: 1 GiB, next to a stage's other data.
    pub const MAX_CELLS: u64 = 1 << 30;
    /// Most cells along one axis, so that positions in cells are exact to a thousandth in `f32`.
    pub const MAX_AXIS: usize = 8192;
    /// Most layers: filling holds a column of cells in registers.
    pub const MAX_LAYERS: usize = 512;

    /// Why no such grid can be made, if none can.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        if !(self.voxel_m.is_finite() && self.voxel_m > 0.0 && self.lower_m.is_finite()) {
            return Some("cell size and lower face must be finite, the size above 0".into());
        }
        let shape = self.shape();
        let [x, y, z] = shape;
        let rule = if shape.contains(&0) {
            "there must be one along every axis".to_owned()
        } else if z > Self::MAX_LAYERS {
            format!("at most {} layers are possible", Self::MAX_LAYERS)
        } else if x > Self::MAX_AXIS || shape.iter().map(|&n| n as u64).product::<u64>() > Self::MAX_CELLS {
            format!("at most {} along an axis and {} in all are possible", Self::MAX_AXIS, Self::MAX_CELLS)
        } else {
            return None;
        };
        Some(format!("{x} x {y} x {z} cells of {} m: {rule}", self.voxel_m))
    }

    /// Cells along x, y, z: `(2 range / voxel, 2 range / voxel, (upper - lower) / voxel)`, rounded.
    #[must_use]
    pub fn shape(&self) -> [usize; 3] {
        let across = (2.0 * self.range_m / self.voxel_m).round() as usize;
        [across, across, ((self.upper_m - self.lower_m) / self.voxel_m).round() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_included() {
        let problem = |range_m, voxel_m, lower_m, upper_m| {
            OccupancySettings { range_m, voxel_m, lower_m, upper_m, ..OccupancySettings::default() }.problem()
        };
        assert_eq!(OccupancySettings::default().problem(), None);
        assert_eq!(problem(16.0, 0.5, -56.0, 200.0), None, "512 layers");
        assert!(problem(16.0, 0.5, -56.5, 200.0).is_some_and(|p| p.contains("64 x 64 x 513")));
        assert_eq!(problem(2048.0, 0.5, 0.0, 8.0), None, "8192 x 8192 x 16 are 2^30 cells");
        assert!(problem(2048.0, 0.5, 0.0, 8.5).is_some(), "one layer more");
        assert!(problem(2048.25, 0.5, 0.0, 1.0).is_some(), "8193 along an axis");
        assert!(problem(1.0, 5.0, -1.0, 7.0).is_some_and(|p| p.contains("0 x 0 x 2")));
        assert!(problem(64.0, 0.1, 7.0, -1.0).is_some(), "upside down");
        let (lidar, rays) = (Rig::vehicle().lidars[0].scan.clone(), ScanPattern::MAX_RAYS as u32);
        assert_eq!(ScanPattern { channels: 1024, columns: rays / 1024, ..lidar.clone() }.problem(), None);
        let more = ScanPattern { channels: 1024, columns: rays / 1024 + 1, ..lidar };
        assert!(more.problem().is_some_and(|p| p.contains("4195328 rays")));
    }
}
