//! The dataset configuration: TOML in, [`DatasetSettings`] out, every fault at once with its line.

mod reader;
mod rigs;
mod scenario;
mod table_names;

use std::path::Path;

use schema::settings::{AnnotationSettings, BevSettings, DatasetSettings};

pub use reader::{ConfigKey, Fault};
use reader::{Section, with_document};

/// Reads a configuration file.
///
/// # Errors
/// All faults of the file, with line numbers.
pub fn load(path: &Path) -> Result<DatasetSettings, Vec<Fault>> {
    let file = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => parse(&text, &file),
        Err(e) => Err(vec![Fault { file, line: None, message: format!("cannot read: {e}") }]),
    }
}

/// Reads a configuration text; `file` is its name in messages.
///
/// # Errors
/// All faults of the text, with line numbers.
pub fn parse(text: &str, file: &str) -> Result<DatasetSettings, Vec<Fault>> {
    with_document(text, file, dataset).map(|(settings, _)| settings)
}

/// Every key with its type, default and meaning, in reading order: the source of `docs/configuration.md`.
#[must_use]
pub fn config_keys() -> Vec<ConfigKey> {
    reader::describe(dataset)
}

fn dataset(root: &Section<'_>) -> DatasetSettings {
    let name = root.text("name", "dataset", "name of the dataset, in reports");
    let seed = root.integer("seed", 27, 0, i64::MAX, "seed of every random stream") as u64;
    let (scenes, redraw) = scenario::scenes(root);
    let annotation = annotation(&root.section("annotation", "which objects are annotated"));
    let bev = bev(&root.section("bev", "bird's-eye-view masks"));
    let (vehicle_rig, vehicle_occupancy) =
        rigs::vehicle(&root.section("vehicle", "sensors and voxel grid of every data-collection vehicle"));
    let (rsu_rig, rsu_occupancy) = rigs::rsu(&root.section("rsu", "sensors and voxel grid of every RSU"));
    let own_rigs = rigs::own(root);
    let settings = DatasetSettings {
        name,
        seed,
        scenes,
        redraw,
        agents: scenario::agents(&root.section("agents", "data-collection vehicles and RSUs")),
        timing: scenario::timing(&root.section("timing", "warm-up and durations")),
        traffic: scenario::traffic(&root.section("traffic", "background vehicles and drivers")),
        walkers: scenario::walkers(&root.section("walkers", "pedestrians")),
        weather: scenario::weather(&root.section("weather", "weather draws and overrides")),
        lights: scenario::lights(&root.section("lights", "street lamps and lit windows at night")),
        world: scenario::world(&root.section("world", "scenery placed by rule")),
        vehicle_rig,
        rsu_rig,
        own_rigs,
        annotation,
        bev,
        vehicle_occupancy,
        rsu_occupancy,
    };
    if settings.agents.penetration.is_some() && settings.traffic.vehicles.is_none() {
        root.fault_at(
            "agents",
            "`agents.penetration` is a share of `traffic.vehicles`: say how many vehicles there are".into(),
        );
    }
    settings
}

fn annotation(section: &Section<'_>) -> AnnotationSettings {
    let d = AnnotationSettings::default();
    AnnotationSettings {
        box_radius_m: section.number(
            "box_radius_m",
            d.box_radius_m,
            1.0,
            2000.0,
            "boxes within this 3-D distance of an agent are collected, m",
        ),
        valid_by_image: section.flag(
            "valid_by_image",
            d.valid_by_image,
            "an object without points is valid when an instance image shows it",
        ),
    }
}

fn bev(section: &Section<'_>) -> BevSettings {
    let d = BevSettings::default();
    BevSettings {
        enabled: section.flag("enabled", d.enabled, "write BEV masks"),
        cells: section.integer("cells", d.cells.into(), 2, 4096, "rows and columns of the grid") as u32,
        cell_m: section.number("cell_m", d.cell_m, 0.01, 10.0, "cell size, m"),
    }
}

/// Default settings with one scene, for tests.
#[cfg(test)]
pub(crate) fn example_settings() -> DatasetSettings {
    parse("[scenes.train]\n\"convoy/demo\" = 1\n", "example.toml")
        .expect("the smallest configuration is valid")
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::AgentId;

    fn faults(text: &str) -> String {
        let faults = parse(text, "bad.toml").expect_err("has faults");
        faults.iter().map(|f| format!("{f}\n")).collect()
    }

    #[test]
    fn defaults_are_the_published_ones() {
        let s = example_settings();
        assert_eq!(s.agents, schema::settings::AgentSettings::default());
        assert_eq!(s.vehicle_rig, schema::settings::Rig::vehicle());
        assert_eq!(s.rsu_rig, schema::settings::Rig::rsu());
        assert_eq!(s.vehicle_occupancy, schema::settings::OccupancySettings::default());
        assert_eq!(s.weather, schema::settings::WeatherSettings::default());
    }

    #[test]
    fn all_faults_come_at_once_with_their_lines() {
        let text = "seed = -4\n\n[scenes.train]\n\"convoy/demo\" = 1\n\n[vehicle.camera]\nwidth = \"wide\"\nhieght = 900\n\
                    [agents]\nmin_vehicles = 5\nmax_vehicles = 3\n";
        insta::assert_snapshot!(faults(text), @r"
        bad.toml:1: `seed` is -4, expected 0 to 9223372036854775807
        bad.toml:7: `vehicle.camera.width` is a string, expected an integer
        bad.toml:8: unknown key `vehicle.camera.hieght` (did you mean `height`?)
        bad.toml:10: `agents.min_vehicles` is 5, more than `agents.max_vehicles` (3)
        ");
    }

    #[test]
    fn broken_toml_is_reported_with_its_line() {
        let text = faults("name = \"x\"\nseed = = 3\n[scenes.train]\n\"convoy/demo\" = 1\n");
        assert!(text.starts_with("bad.toml:2: "), "{text}");
    }

    #[test]
    fn a_dataset_without_scenes_is_a_fault() {
        assert!(faults("name = \"x\"\n").contains("no scenes"));
    }

    #[test]
    fn a_sensor_must_not_take_anothers_table() {
        let radar = |name: &str| format!("[[vehicle.radars]]\nname = \"{name}\"\n");
        let camera = |name: &str| format!("[[vehicle.cameras]]\nname = \"{name}\"\n");
        let with = |sensors: &[String]| {
            let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n{}", sensors.concat());
            parse(&text, "bad.toml").map_err(|f| f.iter().map(Fault::to_string).collect::<Vec<_>>())
        };
        for (name, other) in [
            ("LIDAR", "LIDAR"),
            ("lidar", "LIDAR"),
            ("SEG-LIDAR", "SEG-LIDAR"),
            ("GNSS", "GNSS"),
            ("IMU", "IMU"),
            ("visible", "visible"),
            ("RGB-CAM_FRONT", "RGB-CAM_FRONT"),
            ("flw-cam_back", "FLW-CAM_BACK"),
        ] {
            let faults = with(&[radar(name)]).expect_err("is taken");
            let want = format!(
                "bad.toml:4: `vehicle.radars[0].name` is \"{name}\": its table `{name}` would take the place of \
                 another sensor's `{other}`"
            );
            assert_eq!(faults, [want]);
        }
        // A camera called LIDAR would own the semantic lidar's table; one fault a sensor.
        for (sensors, line, path) in [
            (vec![camera("LIDAR")], 4, "vehicle.cameras[0].name"),
            (vec![camera("A"), camera("B"), camera("a")], 8, "vehicle.cameras[2].name"),
            (vec![camera("A"), radar("DPT-A")], 6, "vehicle.radars[0].name"),
            (vec![radar("A"), radar("A")], 6, "vehicle.radars[1].name"),
            // The second has no name of its own: the fault is at its table.
            (vec![radar("RAD_FRONT"), "[[vehicle.radars]]\n".to_owned()], 5, "vehicle.radars[1].name"),
        ] {
            let faults = with(&sensors).expect_err("is taken");
            assert_eq!(faults.len(), 1, "{faults:?}");
            assert!(faults[0].starts_with(&format!("bad.toml:{line}: `{path}` is ")), "{faults:?}");
        }
        assert!(with(&[camera("RAD_FRONT"), radar("CAM_FRONT"), radar("RGB"), radar("SEG-")]).is_ok());
    }

    #[test]
    fn sensor_names_are_file_names() {
        for name in ["", "a/b", "..", "a b", "\u{e4}", "a\\\\b", "x.y", &"x".repeat(65)] {
            let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n[[rsu.cameras]]\nname = \"{name}\"\n");
            let faults = faults(&text);
            assert!(faults.starts_with("bad.toml:4: `rsu.cameras[0].name` is "), "{faults}");
            assert!(faults.contains("letters, digits, _ and -"), "{faults}");
        }
    }

    #[test]
    fn what_the_sensors_refuse_is_refused_here() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n\
                    [vehicle.lidar]\nchannels = 1024\ncolumns = 65_536\n\
                    [vehicle.occupancy]\nrange_m = 1\nvoxel_m = 5\n\
                    [rsu.lidar]\ncolumns = 40_000\n\
                    [rsu.occupancy]\nupper_m = 60\n";
        insta::assert_snapshot!(faults(text), @r"
        bad.toml:5: `vehicle.lidar`: 1024 channels x 65536 columns are 67108864 rays a frame, at most 4194304 are possible
        bad.toml:8: `vehicle.occupancy`: 0 x 0 x 2 cells of 5 m: there must be one along every axis
        bad.toml:10: `rsu.lidar`: 128 channels x 40000 columns are 5120000 rays a frame, at most 4194304 are possible
        bad.toml:12: `rsu.occupancy`: 1280 x 1280 x 610 cells of 0.1 m: at most 512 layers are possible
        ");
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[rsu.occupancy]\nupper_m = -5\n";
        assert_eq!(faults(text), "bad.toml:4: `rsu.occupancy.lower_m` is not below upper_m\n");
    }

    #[test]
    fn agents_can_carry_rigs_of_their_own() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nchannels = 64\n\
                    [[rigs]]\nagents = [\"vehicle_1\", \"vehicle_3\"]\n[rigs.lidar]\nchannels = 16\n\
                    [[rigs.cameras]]\nname = \"CAM_ROOF\"\n[rigs.occupancy]\nenabled = false\n\
                    [[rigs]]\nagents = [\"rsu_0\"]\n[rigs.radar]\nenabled = false\n";
        let s = parse(text, "x.toml").expect("is valid");
        let channels = |i| s.rig_of(AgentId::vehicle(i)).lidars[0].scan.channels;
        assert_eq!([channels(0), channels(1), channels(2), channels(3)], [64, 16, 64, 16]);
        assert_eq!(s.rig_of(AgentId::vehicle(1)).cameras.len(), 1);
        assert!(!s.occupancy_of(AgentId::vehicle(3)).enabled && s.occupancy_of(AgentId::vehicle(0)).enabled);
        assert!(s.rig_of(AgentId::rsu(0)).radars.is_empty() && !s.rig_of(AgentId::rsu(1)).radars.is_empty());
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[[rigs]]\n\
                    [[rigs]]\nagents = [\"vehicle_1\", \"rsu_0\"]\n\
                    [[rigs]]\nagents = [\"bus_1\"]\n[[rigs]]\nagents = [\"vehicle_1\"]\n";
        insta::assert_snapshot!(faults(text), @r#"
        bad.toml:3: `rigs[0].agents` is empty: say which agents carry this rig, such as ["vehicle_1"]
        bad.toml:5: `rigs[1].agents` names vehicles and RSUs: a rig is for one kind
        bad.toml:7: `rigs[2].agents`: `bus_1` is no agent, expected vehicle_N or rsu_N
        bad.toml:9: `rigs[3].agents`: `vehicle_1` carries another rig already
        "#);
    }

    #[test]
    fn a_share_of_vehicles_needs_their_number() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[agents]\npenetration = 0.2\n";
        assert!(faults(text).starts_with("bad.toml:3: `agents.penetration` is a share"), "{}", faults(text));
        let s = parse(&format!("{text}[traffic]\nvehicles = 50\n"), "x.toml").expect("is valid");
        assert_eq!((s.agents.penetration, s.traffic.vehicles), (Some(0.2), Some(50)));
    }

    #[test]
    fn starts_are_read() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n\
                    [[agents.starts]]\nmap = \"convoy/demo\"\nxyz_m = [1, 2.5, 0]\nyaw_deg = 180\n";
        let starts = parse(text, "x.toml").expect("is valid").agents.starts;
        assert_eq!((starts[0].map.as_str(), starts[0].xyz_m), ("convoy/demo", [1.0, 2.5, 0.0]));
        assert!((starts[0].yaw_rad - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn sensors_can_be_moved_added_and_switched_off() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nsemantic = true\nchannels = 32\n\
                    [rsu.radar]\nenabled = false\n[vehicle.gnss]\nenabled = false\n\
                    [[vehicle.cameras]]\nname = \"CAM_ROOF\"\nxyz_m = [0, 0, 2.5]\nrpy_deg = [0, 15, 180]\n";
        let s = parse(text, "x.toml").expect("is valid");
        let names: Vec<&str> = s.vehicle_rig.lidars.iter().map(|l| l.name.as_str()).collect();
        assert_eq!(names, ["LIDAR", "SEG-LIDAR"]);
        assert_eq!(s.vehicle_rig.lidars[0].scan.channels, 32);
        assert_eq!(s.vehicle_rig.cameras.len(), 1);
        assert!((s.vehicle_rig.cameras[0].mount.rpy_rad[2] - std::f64::consts::PI).abs() < 1e-12);
        assert!(s.rsu_rig.radars.is_empty() && s.vehicle_rig.gnss.is_none());
    }
}
