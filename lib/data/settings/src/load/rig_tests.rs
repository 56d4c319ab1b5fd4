//! Rigs: files that configurations name, cameras and their lenses.

use crate::{DatasetSettings, Lens, Optics, Rig};
use schema::ImageKind;

use super::{Fault, example_settings, load, parse, rigs_named_in};

/// A folder with a configuration that names a rig, `rigs/x.toml`; what the whole is read as.
fn with_rig(config: &str, rig: &str) -> Result<DatasetSettings, String> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("rigs")).expect("a folder");
    std::fs::write(folder.path().join("rigs/x.toml"), rig).expect("writes");
    let path = folder.path().join("config.toml");
    std::fs::write(&path, format!("[scenes.train]\n\"convoy/demo\" = 1\n{config}")).expect("writes");
    let told = |fault: &Fault| fault.to_string().replace(&format!("{}/", folder.path().display()), "");
    load(&path)
        .map(|(settings, _)| settings)
        .map_err(|faults| faults.iter().map(|fault| told(fault) + "\n").collect())
}

#[test]
fn keys_of_a_configuration_go_before_those_of_a_rig_file() {
    let rig = "[camera]\nwidth = 640\nheight = 480\nevery_n_frames = 4\n[[cameras]]\nname = \"A\"\n[[cameras]]\nname = \"B\"\nfx = 500\ncx = 300\n[lidar]\nchannels = 16\n[occupancy]\nenabled = false\n";
    let config = "[vehicle]\nrig = \"rigs/x.toml\"\nradars = []\n[vehicle.camera]\nheight = 360\n\
                  [[rigs]]\nagents = [\"rsu_0\"]\nrig = \"rigs/x.toml\"\ncameras = []\n";
    let settings = with_rig(config, rig).expect("is good");
    let cameras = &settings.scenario.vehicle_rig.cameras;
    assert_eq!(cameras.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["A", "B"]);
    assert_eq!(cameras[0].optics, Optics::pinhole(640, 360, frames::deg(80.0)));
    let Optics { width, height, fx, fy, cx, cy, .. } = cameras[1].optics;
    assert_eq!((width, height, [fx, fy, cx, cy]), (640, 360, [500.0, 500.0, 300.0, 180.0]));
    assert_eq!(
        (settings.scenario.vehicle_rig.camera.every_n_frames, settings.scenario.vehicle_rig.radars.len()),
        (4, 0)
    );
    assert_eq!(settings.scenario.vehicle_rig.lidars[0].scan.channels, 16);
    assert!(!settings.scenario.vehicle_occupancy.enabled && settings.scenario.rsu_occupancy.enabled);
    let own = &settings.scenario.own_rigs[0];
    assert_eq!((own.rig.cameras.len(), own.rig.lidars[0].scan.channels), (0, 16));
    assert_eq!(own.rig.radars.len(), 1, "an RSU's, which nobody named");
    // What is read is what counts: the same keys without a file are the same settings.
    let plain = format!(
        "[vehicle]\nradars = []\n{}",
        rig.replace("[[", "[[vehicle.")
            .replace("\n[", "\n[vehicle.")
            .replace("[vehicle.[", "[[")
            .replace("[camera]", "[vehicle.camera]")
            .replace("= 480", "= 360")
    );
    let plain = with_rig(&plain, "").expect("is good");
    assert_eq!(
        (plain.scenario.vehicle_rig, plain.scenario.vehicle_occupancy),
        (settings.scenario.vehicle_rig, settings.scenario.vehicle_occupancy)
    );
}

#[test]
fn files_of_rigs_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let named = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("writes");
        rigs_named_in(&folder.path().join(name)).expect("is read").into_iter().collect::<Vec<_>>()
    };
    let text = "[rsu]\nrig = \"\"\n[vehicle]\nrig = \"b.toml\"\n[[rigs]]\nrig = \"rigs/a.toml\"\n[[rigs]]\nrig = \"b.toml\"\n";
    assert_eq!(named("config.toml", text), ["b.toml", "rigs/a.toml"]);
    assert_eq!(named("config.yaml", "rig: b.toml\n"), Vec::<String>::new());
    assert!(rigs_named_in(&folder.path().join("other.toml")).is_err());
}

#[test]
fn lenses_are_read_as_opencv_orders_them() {
    let with = |camera: &str| with_rig(&format!("[[vehicle.cameras]]\nname = \"A\"\n{camera}\n"), "");
    let lens = |camera: &str| with(camera).expect("is good").scenario.vehicle_rig.cameras[0].optics.lens;
    assert_eq!(
        lens("lens = \"brown\"\ndistortion = [-0.3, 0.1, 1e-3, 2e-3, -0.01]"),
        Lens::Brown { k: [-0.3, 0.1, -0.01], p: [1e-3, 2e-3] }
    );
    assert_eq!(lens("lens = \"brown\""), Lens::Brown { k: [0.0; 3], p: [0.0; 2] });
    let wide = with("lens = \"fisheye\"\nfov_deg = 190\nwidth = 1000").expect("is good");
    let optics = &wide.scenario.vehicle_rig.cameras[0].optics;
    // Equidistant: half of the picture is half of the angle.
    assert!((optics.fx - 500.0 / frames::deg(95.0)).abs() < 1e-9 && optics.fy == optics.fx, "{optics:?}");
    for (camera, fault) in [
        ("fov_deg = 190", "config.toml:5: `vehicle.cameras[0].fov_deg` is more than 170: that takes"),
        ("distortion = [0.1]", "has 1 numbers, expected none: a pinhole bends nothing"),
        ("lens = \"fisheye\"\ndistortion = [0.1, 0.2]", "has 2 numbers, expected k1, k2, k3, k4"),
        ("lens = \"brown\"\ndistortion = [-0.9, 0, 0, 0]", "pixel (0, 0) looks nowhere"),
        ("fx = 100\nfov_deg = 50", "name one of them"),
    ] {
        let told = with(camera).expect_err("is bad");
        assert!(told.contains(fault), "{told}");
    }
}

#[test]
fn faults_of_a_rig_file_are_told_with_its_lines() {
    let rig = "rig = \"y.toml\"\n[camera]\nwidht = 640\nheight = \"low\"\n[[cameras]]\nname = \"A\"\nfx = 0\n[lidars]\n";
    insta::assert_snapshot!(with_rig("[vehicle]\nrig = \"rigs/x.toml\"\ncamera = 3\n[rsu]\nrig = \"rigs/y.toml\"\n[[rigs]]\nagents = [\"rsu_0\"]\nrig = 7\n", rig).expect_err("is bad"), @r"
    config.toml:5: `vehicle.camera` is an integer, expected a table
    config.toml:7: `rsu.rig`: rigs/y.toml: cannot read: No such file or directory (os error 2)
    config.toml:10: `rigs[0].rig` is an integer, expected a string
    rigs/x.toml:1: `vehicle.rig`: such a file names no other
    rigs/x.toml:3: unknown key `vehicle.camera.widht` (did you mean `width`?)
    rigs/x.toml:4: `vehicle.camera.height` is a string, expected an integer
    rigs/x.toml:7: `vehicle.cameras[0].fx` is 0, expected 1 to 1000000
    rigs/x.toml:8: `vehicle.lidars` is a table, expected a list of tables
    ");
    let broken =
        with_rig("[vehicle]\nrig = \"rigs/x.toml\"\n", "[camera]\nwidth = = 3\n").expect_err("is no TOML");
    assert!(broken.contains("rigs/x.toml:2: "), "{broken}");
}

#[test]
fn the_shipped_rigs_are_read() {
    let of = |rig: &str| {
        let configs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../configs/some.toml");
        let text = format!(
            "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle]\nrig = \"rigs/{rig}.toml\"\n[rsu]\nrig = \"rigs/{rig}.toml\"\n"
        );
        parse(&text, configs).unwrap_or_else(|faults| panic!("{faults:?}"))
    };
    let usual = example_settings();
    let published = of("simbev2x-vehicle");
    assert_eq!(
        (published.scenario.vehicle_rig, published.scenario.vehicle_occupancy),
        (usual.scenario.vehicle_rig, usual.scenario.vehicle_occupancy)
    );
    let published = of("simbev2x-rsu");
    assert_eq!(
        (published.scenario.rsu_rig, published.scenario.rsu_occupancy),
        (usual.scenario.rsu_rig, usual.scenario.rsu_occupancy)
    );
    let opv2v = of("opv2v").scenario.vehicle_rig;
    // 800 / (2 tan 50 degrees), as OPV2V's files have it.
    assert!(opv2v.cameras.iter().all(|c| (c.optics.fx - 335.64).abs() < 0.01 && c.optics.height == 600));
    assert_eq!((opv2v.cameras.len(), opv2v.radars.len(), opv2v.lidars[0].every_n_frames), (4, 0, 2));
    // Ahead, right, left, back; where OPV2V has y to the right, ours is to the left.
    let places = [[2.5, 0.0, 1.0], [0.0, -0.3, 1.8], [0.0, 0.3, 1.8], [-2.0, 0.0, 1.5]];
    let yaws_deg = [0.0, -100.0, 100.0, 180.0];
    for (number, camera) in opv2v.cameras.iter().enumerate() {
        assert_eq!((camera.name.as_str(), camera.mount.xyz_m), (&*format!("camera{number}"), places[number]));
        let [roll, pitch, yaw] = camera.mount.rpy_rad.map(frames::to_deg);
        assert!(roll == 0.0 && pitch == 0.0 && (yaw - yaws_deg[number]).abs() < 1e-9, "{camera:?}");
    }
    let lidar = &opv2v.lidars[0];
    let scan_deg = [lidar.scan.upper_rad, lidar.scan.lower_rad].map(|v| frames::to_deg(v).round());
    assert_eq!((lidar.mount.xyz_m, lidar.scan.channels, lidar.range_m), ([-0.5, 0.0, 1.9], 64, 120.0));
    assert_eq!((scan_deg, opv2v.camera.images.has(ImageKind::Instance)), ([2.0, -25.0], true));
    // The RSU's look down, with the nose 35 degrees below the horizon.
    let rsu = of("opv2v-rsu").scenario.rsu_rig;
    assert_eq!((rsu.cameras.len(), rsu.radars.len(), &rsu.lidars[0].scan), (4, 0, &lidar.scan));
    for (camera, yaw_deg) in rsu.cameras.iter().zip(yaws_deg) {
        let [roll, pitch, yaw] = camera.mount.rpy_rad.map(frames::to_deg);
        assert!(roll == 0.0 && (pitch - 35.0).abs() < 1e-9 && (yaw - yaw_deg).abs() < 1e-9, "{camera:?}");
        assert_eq!((&camera.optics, camera.mount.xyz_m[2]), (&opv2v.cameras[0].optics, 3.0));
    }
    let nuscenes = of("nuscenes");
    let Rig { cameras, radars, lidars, .. } = &nuscenes.scenario.vehicle_rig;
    assert_eq!(
        (cameras.len(), radars.len(), lidars[0].scan.channels, lidars[0].every_n_frames),
        (6, 5, 32, 1)
    );
    assert!(cameras.iter().all(|c| c.optics.cx != 800.0) && !nuscenes.scenario.vehicle_occupancy.enabled);
}

#[test]
fn a_lidar_sweeps_whenever_there_is_a_grid_of_what_was_seen() {
    let with = |lidars: &str, every: u32| {
        let grid = format!("[vehicle.occupancy]\nobserved = true\nevery_n_frames = {every}\n");
        with_rig(&format!("{grid}{lidars}"), "").map(|all| all.scenario.vehicle_occupancy.every_n_frames)
    };
    let at = |every: u32| format!("[vehicle.lidar]\nevery_n_frames = {every}\n");
    assert_eq!(with(&at(2), 4), Ok(4));
    assert_eq!(with(&at(5), 5), Ok(5));
    let fault = with(&at(2), 1).expect_err("half of the grids would be empty");
    assert_eq!(
        fault,
        "config.toml:5: `vehicle.occupancy.every_n_frames` (1) is no multiple of `vehicle.lidar.every_n_frames` (LIDAR: 2): \
         there is no sweep at some frames for `vehicle.occupancy.observed`\n"
    );
    // Two of three frames have a sweep of one or the other; a third lidar has one at all of them.
    let second = "[[vehicle.lidars]]\nname = \"B\"\nevery_n_frames = 3\n";
    let fault = with(&format!("{}{second}", at(2)), 1).expect_err("frames 1, 5, 7, ... have none");
    assert!(fault.contains("(LIDAR: 2, B: 3)"), "{fault}");
    let third = "[[vehicle.lidars]]\nname = \"C\"\n";
    assert_eq!(with(&format!("{}{second}{third}", at(2)), 1), Ok(1));
    // One with labels does not help.
    let labelled = "[vehicle.lidar]\nevery_n_frames = 2\nsemantic = true\nsemantic_every_n_frames = 1\n";
    assert!(with(labelled, 1).is_err());
}

#[test]
fn a_rig_without_a_name_is_a_fault() {
    let told = with_rig("[vehicle]\nrig = \"\"\n", "").expect_err("names no file");
    assert_eq!(told, "config.toml:4: `vehicle.rig` is empty, expected the name of a file\n");
}
