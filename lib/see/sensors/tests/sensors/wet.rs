//! Wet ground mirrors the objects on it; no other output of cameras depends on the rain.

use crate::common::{
    MeshBuilder, at, film, instance, optics, picture, set_view, sight, snapshot, standing_view, street,
    with_scene,
};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{Snapshot, Surface};
use schema::images::{Depth, Instance, Semantic};
use schema::tables::Weather;
use settings::CameraSettings;
use shading::Picture;

/// Rain has just stopped: all is wet, and there are puddles.
fn soaked() -> Weather {
    let Weather { sun_altitude_deg, .. } = Weather::default();
    Weather {
        wetness: 100.0,
        precipitation: 0.0,
        precipitation_deposits: 100.0,
        cloudiness: 100.0,
        fog_density: 0.0,
        sun_altitude_deg,
        ..Weather::default()
    }
}

/// Asphalt, and over it a board that faces the camera: how far away, its left and right end, its lower and
/// upper one.
fn board([away_m, left_m, right_m, low_m, high_m]: [f32; 5], rgb: [f32; 3]) -> Snapshot {
    let mut ground = MeshBuilder::default();
    let part = ground.part(Tag::Road, Surface::Asphalt, [0.1; 3]);
    let corner = |x: f32, y: f32| Vec3::new(90.0 * x, 90.0 * y, 0.0);
    ground.quad(part, [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let mut board = MeshBuilder::default();
    let part = board.part(Tag::Building, Surface::Plain, rgb);
    let corner = |y: f32, z: f32| Vec3::new(away_m, y, z);
    board.quad(
        part,
        [corner(right_m, low_m), corner(right_m, high_m), corner(left_m, high_m), corner(left_m, low_m)],
    );
    let here = at(0.0, 0.0, 0.0, 0.0);
    snapshot(vec![ground.finish(), board.finish()], vec![instance(0, 1, here), instance(1, 2, here)])
}

fn plain() -> CameraSettings {
    CameraSettings { bloom: 0.0, vignetting: 0.0, noise: 0.0, ..CameraSettings::default() }
}

#[test]
fn a_board_is_mirrored_where_the_law_of_reflection_has_it() {
    // The camera is 1.6 m over the ground and 0.6 m ahead of the agent.
    let (width, height) = (320u32, 180u32);
    let view = set_view([0.0; 3], [0.0; 3], optics(width, height), &plain());
    for size in [[12.6, 1.0, -1.5, 1.6, 2.6], [30.6, 9.0, 6.0, 0.4, 8.0], [8.6, -1.0, -3.0, 0.2, 1.2]] {
        let [white, black] = [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &soaked()));
        let seen = with_scene(&board(size, [0.5; 3]), |scene| sight(scene, &view, &soaked())).seen;
        // Where the colour of the board is seen on the ground.
        let (mut sums, mut weights) = ([0.0; 2], 0.0);
        let (mut within, focal) = (0.0, f64::from(seen.camera.fx));
        let [away, left, right, low, high] = size.map(f64::from);
        let away = away - 0.6;
        let place = |level: f64, across: f64| {
            [
                0.5 * f64::from(width) - focal * across / away,
                0.5 * f64::from(height) + focal * (level + 1.6) / away,
            ]
        };
        let ([x0, y0], [x1, y1]) = (place(low, left), place(high, right));
        for (pixel, (a, b)) in white.rgb.chunks(3).zip(black.rgb.chunks(3)).enumerate() {
            if seen.instance[pixel] != 0 {
                continue;
            }
            let (x, y) = ((pixel as u32 % width) as f64 + 0.5, (pixel as u32 / width) as f64 + 0.5);
            // Level water mirrors so much (Schlick).
            let down = (y - 0.5 * f64::from(height)) / focal;
            let grazing = 1.0 - down / (1.0 + down * down).sqrt();
            let share = 0.02 + 0.96 * frames::math::pow(grazing, 5.0);
            let more = (film(a[1]) - film(b[1])) / share;
            sums = [sums[0] + more * x, sums[1] + more * y];
            weights += more;
            // Rough places blur it, most of all up and down.
            if (x0 - 3.0..x1 + 3.0).contains(&x) && (y0 - 24.0..y1 + 24.0).contains(&y) {
                within += more;
            }
        }
        let (x, y) = (sums[0] / weights, sums[1] / weights);
        assert!(weights > 100.0 && within > 0.97 * weights, "{size:?}: {within} of {weights}");
        let (right_x, right_y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
        assert!((x - right_x).abs() < 2.0, "{size:?}: {x} {right_x}");
        assert!((y - right_y).abs() < 0.1 * (y1 - y0) + 2.0, "{size:?}: {y} {right_y}");
    }
}

#[test]
fn low_angles_mirror_most() {
    let view = set_view([0.0; 3], [0.0; 3], optics(320, 180), &plain());
    // A wall from the ground to the sky.
    let size = [40.6, 60.0, -60.0, 0.0, 60.0];
    let [white, black] = [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &soaked()));
    let more = |row: usize| -> i32 {
        let row = 3 * 320 * row..3 * 320 * (row + 1);
        white.rgb[row.clone()].iter().zip(&black.rgb[row]).map(|(a, b)| i32::from(*a) - i32::from(*b)).sum()
    };
    let falling = [105, 120, 140, 170].map(more);
    assert!(falling.windows(2).all(|w| w[0] > w[1]) && falling[3] > 0, "{falling:?}");
}

#[test]
fn dry_ground_mirrors_nothing() {
    let view = set_view([0.0; 3], [0.0; 3], optics(320, 180), &plain());
    let dry = Weather { wetness: 0.0, precipitation_deposits: 0.0, ..soaked() };
    let size = [12.6, 1.0, -1.5, 1.6, 2.6];
    let [white, black]: [Picture; 2] =
        [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &dry));
    assert!(white.rgb[3 * 320 * 100..] == black.rgb[3 * 320 * 100..]);
}

#[test]
fn labels_know_no_rain_and_pictures_no_threads() {
    let scene = street(false);
    let view = standing_view([0.0, -5.2, 0.0], [0.0, 0.0, 0.1], optics(320, 180));
    let rain = Weather { precipitation: 70.0, ..soaked() };
    let looked = |weather: &Weather| with_scene(&scene, |scene| sight(scene, &view, weather));
    let (wet, dry) = (looked(&rain), looked(&Weather::default()));
    assert!(wet.picture != dry.picture);
    assert!(wet.seen == dry.seen);
    assert!(crate::common::encoded::<Depth>(&scene, &wet) == crate::common::encoded::<Depth>(&scene, &dry));
    assert!(
        crate::common::encoded::<Semantic>(&scene, &wet) == crate::common::encoded::<Semantic>(&scene, &dry)
    );
    assert!(
        crate::common::encoded::<Instance>(&scene, &wet) == crate::common::encoded::<Instance>(&scene, &dry)
    );
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        assert!(pool.install(|| looked(&rain)).picture == wet.picture, "{threads} threads");
    }
}

/// Dark asphalt with a car on it, 25 m ahead, that has come so far since the frame before.
fn driven(came_m: f32) -> Snapshot {
    let mut scene = board([60.0, 30.0, -30.0, 0.0, 12.0], [0.05; 3]);
    let car = testkit::block([2.2, 0.9, 1.4], Tag::Car, Surface::Plain);
    let mut meshes = scene.meshes.to_vec();
    meshes.push(car);
    let placed = instance(2, 3, at(25.0, 0.0, 0.0, 0.0));
    scene.instances.push(schema::geometry::Instance {
        previous_local_from_object: at(25.0 - came_m, 0.0, 0.0, 0.0),
        ..placed
    });
    snapshot(meshes, scene.instances)
}

#[test]
fn who_drives_fast_on_a_wet_road_trails_spray_and_labels_do_not_know_it() {
    let view = set_view([0.0; 3], [0.0; 3], optics(320, 180), &plain());
    let seen = |came_m: f32, weather: &Weather| {
        with_scene(&driven(came_m), |scene| {
            let sight = sight(scene, &view, weather);
            (sight.picture.expect("in colour").rgb, sight.seen)
        })
    };
    let dry = Weather { wetness: 0.0, precipitation_deposits: 0.0, ..soaked() };
    let changed = |a: &[u8], b: &[u8]| a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count();
    let (stands, buffer) = seen(0.0, &soaked());
    for (came_m, least, most) in [(0.3, 0, 0), (0.8, 100, 30_000), (1.5, 500, 40_000)] {
        let (drives, other) = seen(came_m, &soaked());
        let count = changed(&drives, &stands);
        assert!((least..=most).contains(&count), "{came_m}: {count}");
        assert!(buffer.instance == other.instance && buffer.depth_m == other.depth_m);
        // Dark asphalt behind it becomes lighter; above nothing changes, and far to the side as good as
        // nothing.
        let mean = |rgb: &[u8], rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
            let (mut sum, mut count) = (0.0, 0.0);
            for row in rows {
                for pixel in rgb[3 * (320 * row + columns.start)..3 * (320 * row + columns.end)].chunks(3) {
                    sum += f64::from(pixel[1]);
                    count += 1.0;
                }
            }
            sum / count
        };
        let lighter = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
            mean(&drives, rows.clone(), columns.clone()) - mean(&stands, rows, columns)
        };
        assert_eq!(lighter(0..50, 0..320), 0.0);
        assert!(lighter(60..120, 0..60).abs() < 0.5, "{}", lighter(60..120, 0..60));
        assert!(came_m < 1.0 || lighter(104..109, 150..170) > 8.0, "{}", lighter(104..109, 150..170));
    }
    assert_eq!(seen(0.0, &dry).0, seen(1.5, &dry).0);
}

/// Keeps the tables of all sensors of a rig.
struct Kept<'a>(&'a sensors::Observation<'a>, Vec<(String, Vec<schema::table::Column>)>);

impl sensors::SensorVisitor for Kept<'_> {
    type Error = sensors::SensorError;

    fn visit<S: sensors::Sensor>(&mut self, sensor: S) -> Result<(), sensors::SensorError> {
        use schema::table::Row;
        self.1.push((sensor.table().name, S::Row::to_columns(&sensor.sense(self.0)?)));
        Ok(())
    }
}

#[test]
fn drops_on_the_lens_change_colour_alone_and_only_when_it_rains() {
    use settings::{CameraSpec, Mount, Rig};
    let tables = |lens_drops: f64, weather: &Weather, frame: u32| {
        let camera = CameraSettings { lens_drops, ..CameraSettings::default() };
        let spec = CameraSpec {
            name: "CAM".into(),
            mount: Mount::upright([0.6, 0.0, 1.6], 0.0),
            optics: optics(320, 180),
        };
        let rig = Rig { camera, cameras: vec![spec], lidars: Vec::new(), radars: Vec::new(), ..Rig::rsu() };
        with_scene(&street(false), |scene| {
            let still = sensors::Motion {
                world_from_agent: frames::Pose::from_xyz_rpy([0.0; 3], [0.0; 3]),
                velocity_mps: nalgebra::Vector3::zeros(),
                angular_velocity_radps: nalgebra::Vector3::zeros(),
            };
            let agent = sensors::AgentState { own: 1, motion: still, previous: None };
            let painter = shading::CpuPainter::default();
            let when = shading::FrameWeather { frame, ..crate::common::first_frame(weather) };
            let cameras = sensors::Cameras::of(&rig).expect("is a camera");
            let at =
                sensors::Observation::new(scene, Some(&painter), &cameras, &when, agent).expect("no device");
            let agent = schema::AgentId::vehicle(0);
            let carrier = sensors::SensorContext {
                seed: 3,
                scene: 1,
                agent,
                geo_origin: sensors::GeoOrigin::default(),
            };
            let mut kept = Kept(&at, Vec::new());
            sensors::visit_sensors(&rig, &carrier, &mut kept).expect("no device");
            kept.1
        })
    };
    let rain = Weather { precipitation: 90.0, ..soaked() };
    let (without, with) = (tables(0.0, &rain, 30), tables(2.0, &rain, 30));
    assert_eq!(without.len(), with.len());
    for ((name, without), (_, with)) in without.iter().zip(&with) {
        assert_eq!(without == with, !name.starts_with("RGB"), "{name}");
    }
    assert!(without.iter().any(|(name, _)| name.starts_with("RGB")) && without.len() > 1);
    assert_eq!(with, tables(2.0, &rain, 30));
    assert_eq!(tables(0.0, &soaked(), 30), tables(2.0, &soaked(), 30));
}
