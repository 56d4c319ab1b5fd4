//! The configuration as `dataset.json` has it: what sensors there are and what exempts from a check.

use schema::{BevClass, FRAME_PERIOD_S};
use serde_json::Value;

use crate::optics::Optics;
use crate::space::{Motion, V3};

/// The resolved configuration.
#[derive(Clone, Debug)]
pub(crate) struct Config(Value);

/// Where a sensor is mounted, and what it is called.
#[derive(Clone, Debug)]
pub(crate) struct Mounted {
    pub(crate) name: String,
    pub(crate) agent_from_sensor: Motion,
}

/// A lidar.
#[derive(Clone, Debug)]
pub(crate) struct LidarConfig {
    pub(crate) mounted: Mounted,
    pub(crate) range_m: f64,
    pub(crate) channels: u64,
    /// Standard deviation of the distance, m.
    pub(crate) noise_m: f64,
    pub(crate) semantic: bool,
    /// It sweeps at frames 0, n, 2 n, ...
    pub(crate) every: u32,
    pub(crate) scan: ScanConfig,
}

/// How a lidar's beams leave and what comes back of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScanConfig {
    pub(crate) columns: f64,
    pub(crate) horizontal_fov_rad: f64,
    /// Moments at which columns are fired over the frame; none if all are at once.
    pub(crate) slices: Option<f64>,
    /// Whether points are given from where the sensor is at the frame's time.
    pub(crate) compensated: bool,
    /// Whether the table tells beams' returns apart.
    pub(crate) tells_returns: bool,
    /// How far from a beam's axis its light goes, rad.
    pub(crate) beam_rad: f64,
    /// Most returns of a beam.
    pub(crate) returns: u64,
    /// Whether rain and fog send light back.
    pub(crate) weather: bool,
    /// Whether light passes panes.
    pub(crate) glass: bool,
}

fn scan(lidar: &Value) -> ScanConfig {
    let (rolling, beam) = (&lidar["rolling"], &lidar["beam"]);
    let many = beam["rays"].as_u64().unwrap_or(1) > 1;
    let weather = lidar["weather"].is_object();
    let glass = lidar["glass"] == Value::Bool(true);
    let kinds = ["first", "strongest", "last"];
    let returned = kinds.iter().filter(|kind| beam["returned"][**kind] == Value::Bool(true)).count() as u64;
    ScanConfig {
        columns: number(&lidar["scan"], "columns"),
        horizontal_fov_rad: number(&lidar["scan"], "horizontal_fov_rad"),
        slices: rolling.is_object().then(|| number(rolling, "slices")),
        compensated: rolling["compensated"].as_bool().unwrap_or(true),
        tells_returns: many || weather || glass,
        beam_rad: if many { 0.5 * number(beam, "divergence_rad") } else { 0.0 },
        returns: returned,
        weather,
        glass,
    }
}

/// A radar.
#[derive(Clone, Debug)]
pub(crate) struct RadarConfig {
    pub(crate) mounted: Mounted,
    pub(crate) range_m: f64,
    pub(crate) horizontal_fov_rad: f64,
    pub(crate) vertical_fov_rad: f64,
    /// Whether velocities are those of turning wheels and swinging limbs, too.
    pub(crate) micro_motion: bool,
    /// It measures at frames 0, n, 2 n, ...
    pub(crate) every: u32,
}

/// A voxel grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridConfig {
    pub(crate) enabled: bool,
    pub(crate) range_m: f64,
    pub(crate) voxel_m: f64,
    pub(crate) lower_m: f64,
    pub(crate) upper_m: f64,
    pub(crate) mount_z_m: f64,
    pub(crate) ignore_self: bool,
    /// Whether occupied cells are listed instead of whole grids.
    pub(crate) sparse: bool,
    /// Whether there are rows of whose each occupied cell is, and how it moves.
    pub(crate) ids: bool,
    pub(crate) flow: bool,
    /// Whether a cell has all that touches it; else what sweeps meet first.
    pub(crate) full_sweep: bool,
    /// Whether there are grids of what lidars saw.
    pub(crate) observed: bool,
    /// There is one at frames 0, n, 2 n, ...
    pub(crate) every: u32,
}

/// Windows of tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WindowConfig {
    /// Frames between two places.
    pub(crate) step: i64,
    /// Frames between two windows of an object.
    pub(crate) every: i64,
    /// Places before and after the present one.
    pub(crate) past: i64,
    pub(crate) future: i64,
}

/// What an agent carries.
#[derive(Clone, Debug)]
pub(crate) struct AgentConfig {
    rig: Value,
    pub(crate) grid: GridConfig,
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::NAN)
}

/// Something is made at frames 0, n, 2 n, ...: n.
fn every(value: &Value) -> u32 {
    value["every_n_frames"].as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(1).max(1)
}

fn vector(value: &Value) -> V3 {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap_or(f64::NAN))
}

fn mounted(sensor: &Value) -> Mounted {
    let mount = &sensor["mount"];
    Mounted {
        name: sensor["name"].as_str().unwrap_or_default().to_owned(),
        agent_from_sensor: Motion::of_angles(vector(&mount["xyz_m"]), vector(&mount["rpy_rad"])),
    }
}

impl Config {
    /// Of the text of `dataset.json`; none if it has no configuration.
    pub(crate) fn of(dataset: &Value) -> Option<Self> {
        let config = dataset.get("config")?;
        config.get("vehicle_rig")?;
        Some(Self(config.clone()))
    }

    pub(crate) fn name(&self) -> &str {
        self.0["name"].as_str().unwrap_or("dataset")
    }

    /// What an agent carries: its own rig, or that of its kind.
    pub(crate) fn agent(&self, name: &str) -> AgentConfig {
        let own = self.0["own_rigs"].as_array().into_iter().flatten().find(|own| {
            own["agents"].as_array().is_some_and(|agents| agents.iter().any(|agent| agent == name))
        });
        let kind = if name.starts_with("rsu_") { "rsu" } else { "vehicle" };
        let (rig, grid) = own.map_or_else(
            || (&self.0[format!("{kind}_rig")], &self.0[format!("{kind}_occupancy")]),
            |own| (&own["rig"], &own["occupancy"]),
        );
        let grid = GridConfig {
            enabled: grid["enabled"].as_bool().unwrap_or(false),
            range_m: number(grid, "range_m"),
            voxel_m: number(grid, "voxel_m"),
            lower_m: number(grid, "lower_m"),
            upper_m: number(grid, "upper_m"),
            mount_z_m: number(grid, "mount_z_m"),
            ignore_self: grid["ignore_self"].as_bool().unwrap_or(false),
            sparse: grid["sparse"].as_bool().unwrap_or(false),
            ids: grid["ids"].as_bool().unwrap_or(false),
            flow: grid["flow"].as_bool().unwrap_or(false),
            full_sweep: grid["full_sweep"].as_bool().unwrap_or(true),
            observed: grid["observed"].as_bool().unwrap_or(false),
            every: every(grid),
        };
        AgentConfig { rig: rig.clone(), grid }
    }

    pub(crate) fn box_radius_m(&self) -> f64 {
        number(&self.0["annotation"], "box_radius_m")
    }

    pub(crate) fn valid_by_image(&self) -> bool {
        self.0["annotation"]["valid_by_image"].as_bool().unwrap_or(true)
    }

    /// Cells along a side and their size, m; none when no masks are written.
    pub(crate) fn bev(&self) -> Option<(usize, f64)> {
        let bev = &self.0["bev"];
        let cells = usize::try_from(bev["cells"].as_u64()?).ok()?;
        (bev["enabled"] != Value::Bool(false)).then(|| (cells, number(bev, "cell_m")))
    }

    /// Boxes and map records are at frames 0, n, 2 n, ...: n; and the same of masks.
    pub(crate) fn label_every(&self) -> u32 {
        every(&self.0["annotation"])
    }

    pub(crate) fn bev_every(&self) -> u32 {
        every(&self.0["bev"])
    }

    /// At every how many frames a file of a scene (its path in the scene's folder) has rows or members.
    pub(crate) fn every_of(&self, inside: &str) -> u32 {
        let parts: Vec<&str> = inside.split('/').collect();
        match parts.as_slice() {
            ["boxes.parquet" | "boxes_valid.parquet" | "hd_map.parquet" | "tracks_frames.parquet"] => {
                self.label_every()
            }
            ["sensors", agent, file] => self.agent(agent).every_of(file.trim_end_matches(".parquet")),
            [folder, _] if folder.starts_with("bev") => self.bev_every(),
            [folder, file] if folder.starts_with("occupancy") => {
                self.agent(file.trim_end_matches(".npz")).grid.every
            }
            _ => 1,
        }
    }

    /// Whether masks have further arrays beside them: `paint`, `ids`, `heights`.
    pub(crate) fn has_bev(&self, layer: &str) -> bool {
        self.0["bev"][layer].as_bool().unwrap_or(false)
    }

    /// Windows of tracks; none when they are not written.
    pub(crate) fn windows(&self) -> Option<WindowConfig> {
        let tracks = &self.0["tracks"];
        let step_s = number(tracks, "step_s");
        let frames = |key: &str| (number(tracks, key) / FRAME_PERIOD_S).round().max(1.0) as i64;
        let places = |key: &str| (number(tracks, key) / step_s + 1e-9).floor() as i64;
        tracks["windows"].as_bool().unwrap_or(false).then(|| WindowConfig {
            step: frames("step_s"),
            every: frames("every_s"),
            past: places("past_s"),
            future: places("future_s"),
        })
    }

    /// Whether masks have all classes in their own order.
    pub(crate) fn has_all_bev_classes(&self) -> bool {
        let Some(classes) = self.0["bev"]["classes"].as_array() else { return true };
        let names = BevClass::ALL.iter().map(|class| class.name());
        classes.len() == BevClass::COUNT && names.zip(classes).all(|(name, told)| told == name)
    }

    /// The rule that masks follow.
    pub(crate) fn bev_rule(&self) -> &str {
        self.0["bev"]["rule"].as_str().unwrap_or_default()
    }

    /// The same, when it is not ours.
    pub(crate) fn foreign_bev_rule(&self) -> Option<&str> {
        Some(self.bev_rule()).filter(|rule| *rule != "exact")
    }
}

impl AgentConfig {
    fn list(&self, key: &str) -> impl Iterator<Item = &Value> {
        self.rig[key].as_array().into_iter().flatten()
    }

    /// Its cameras' pictures are at frames 0, n, 2 n, ...: n.
    pub(crate) fn camera_every(&self) -> u32 {
        every(&self.rig["camera"])
    }

    /// The same of any of its tables.
    fn every_of(&self, table: &str) -> u32 {
        let of = |list: &str| {
            let mut sensors = self.list(list);
            sensors.find(|sensor| sensor["name"] == *table).map(every)
        };
        match table {
            "GNSS" => every(&self.rig["gnss"]),
            "IMU" => every(&self.rig["imu"]),
            _ => of("lidars").or_else(|| of("radars")).unwrap_or(self.camera_every()),
        }
    }

    /// Names, poses (FLU) and optics of its cameras.
    pub(crate) fn cameras(&self) -> Vec<(Mounted, Optics)> {
        self.list("cameras").map(|camera| (mounted(camera), Optics::of(&camera["optics"]))).collect()
    }

    /// Whether its cameras take a kind of image (`rgb`, `semantic`, `instance`, `depth`, `flow`), or another
    /// flag of theirs is on.
    pub(crate) fn takes(&self, kind: &str) -> bool {
        self.rig["camera"][kind].as_bool().unwrap_or(false)
    }

    pub(crate) fn lidars(&self) -> Vec<LidarConfig> {
        let lidar = |lidar: &Value| LidarConfig {
            mounted: mounted(lidar),
            range_m: number(lidar, "range_m"),
            channels: lidar["scan"]["channels"].as_u64().unwrap_or(0),
            noise_m: number(lidar, "noise_m"),
            semantic: lidar["semantic"].as_bool().unwrap_or(false),
            every: every(lidar),
            scan: scan(lidar),
        };
        self.list("lidars").map(lidar).collect()
    }

    pub(crate) fn radars(&self) -> Vec<RadarConfig> {
        let radar = |radar: &Value| RadarConfig {
            mounted: mounted(radar),
            range_m: number(radar, "range_m"),
            horizontal_fov_rad: number(radar, "horizontal_fov_rad"),
            vertical_fov_rad: number(radar, "vertical_fov_rad"),
            micro_motion: radar["micro_motion"].as_bool().unwrap_or(false),
            every: every(radar),
        };
        self.list("radars").map(radar).collect()
    }

    /// The receiver's place, and its noise: latitude and longitude (degrees), altitude (m).
    pub(crate) fn gnss(&self) -> Option<(Motion, V3)> {
        let gnss = self.rig.get("gnss").filter(|gnss| gnss.is_object())?;
        let noise = &gnss["noise_deg"];
        let noise = [noise[0].as_f64()?, noise[1].as_f64()?, gnss["noise_altitude_m"].as_f64()?];
        Some((mounted(gnss).agent_from_sensor, noise))
    }

    /// The unit's place, and its noise: acceleration (m/s2), bias and noise of rates (rad/s).
    pub(crate) fn imu(&self) -> Option<(Motion, V3)> {
        let imu = self.rig.get("imu").filter(|imu| imu.is_object())?;
        let keys = ["noise_accel_mps2", "gyro_bias_radps", "noise_gyro_radps"];
        Some((mounted(imu).agent_from_sensor, keys.map(|key| number(imu, key))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_file_has_its_rate() {
        let rig = json!({"camera": {"every_n_frames": 10}, "cameras": [{"name": "CAM"}], "gnss": {"every_n_frames": 4},
            "lidars": [{"name": "LIDAR", "every_n_frames": 2}], "radars": [{"name": "RAD"}]});
        let config =
            Config::of(&json!({"config": {"vehicle_rig": rig, "rsu_rig": {}, "bev": {"every_n_frames": 5},
            "vehicle_occupancy": {"every_n_frames": 7}, "annotation": {"every_n_frames": 20}}}))
            .expect("is one");
        for (file, want) in [
            ("sensors/vehicle_0/RGB-CAM.parquet", 10),
            ("sensors/vehicle_0/visible.parquet", 10),
            ("sensors/vehicle_0/LIDAR.parquet", 2),
            ("sensors/vehicle_0/RAD.parquet", 1),
            ("sensors/vehicle_0/GNSS.parquet", 4),
            ("sensors/rsu_0/RGB-CAM.parquet", 1),
            ("bev/vehicle_0.npz", 5),
            ("bev_ids/rsu_0.npz", 5),
            ("occupancy_filled/vehicle_0.npz", 7),
            ("occupancy/rsu_0.npz", 1),
            ("hd_map.parquet", 20),
            ("log/states.parquet", 1),
            ("agents.parquet", 1),
        ] {
            assert_eq!(config.every_of(file), want, "{file}");
        }
    }

    #[test]
    fn windows_are_told_in_frames() {
        let tracks =
            json!({"windows": true, "past_s": 0.75, "future_s": 6.0, "step_s": 0.25, "every_s": 0.5});
        let config = Config::of(&json!({"config": {"vehicle_rig": {}, "tracks": tracks}})).expect("is one");
        assert_eq!(config.windows(), Some(WindowConfig { step: 5, every: 10, past: 3, future: 24 }));
        let none = json!({"config": {"vehicle_rig": {}, "tracks": {"windows": false}}});
        assert_eq!(Config::of(&none).expect("is one").windows(), None);
    }

    #[test]
    fn an_agents_own_rig_goes_before_that_of_its_kind() {
        let rig = |noise: f64| json!({"lidars": [{"name": "LIDAR", "mount": {"xyz_m": [0, 0, 2], "rpy_rad": [0, 0, 0]}, "range_m": 9, "noise_m": noise, "semantic": false, "scan": {"channels": 4}}], "gnss": null});
        let dataset = json!({"config": {
            "vehicle_rig": rig(0.1), "rsu_rig": rig(0.2), "vehicle_occupancy": {"enabled": true}, "rsu_occupancy": {},
            "own_rigs": [{"agents": ["vehicle_1"], "rig": rig(0.3), "occupancy": {}}]}});
        let config = Config::of(&dataset).expect("is one");
        let noise = |agent: &str| config.agent(agent).lidars()[0].noise_m;
        assert_eq!(["vehicle_0", "rsu_1", "vehicle_1"].map(noise), [0.1, 0.2, 0.3]);
        assert!(config.agent("vehicle_0").grid.enabled && !config.agent("vehicle_1").grid.enabled);
        assert!(config.agent("vehicle_0").gnss().is_none());
        assert_eq!(config.agent("rsu_0").lidars()[0].mounted.agent_from_sensor.origin, [0.0, 0.0, 2.0]);
        assert!(Config::of(&json!({})).is_none());
    }
}
