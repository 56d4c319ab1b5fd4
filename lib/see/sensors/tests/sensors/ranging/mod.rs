//! Lidar and radar against closed forms and statistics.

mod beams;
mod rolling;
mod sections;
mod twins;
mod weather;

use crate::common::{at, block, instance, plane, prepared, snapshot, street, with_scene};
use glam::{Affine3A, Vec3};
use random::Stream;
use render::{RayBatch, RayQuery, Renderer, Scene};
use schema::Tag;
use schema::geometry::{Surface, Wall};
use sensors::{Lidar, LidarMoment, LidarSweep, RadarMotion, RadarQuery, RadarReturns, SensorError};
use settings::{LidarSpec, RadarSpec, Rig, ScanPattern};

fn stream() -> Stream {
    Stream::new(27, 0, "test/sensors", 1)
}

fn sweep(spec: &LidarSpec, scene: &dyn Scene, pose: Affine3A, frame: u32) -> LidarSweep {
    let lidar = Lidar::new(spec).expect("is small");
    lidar.sweep(scene, &LidarMoment::standing(frame, pose), &stream()).expect("has no device")
}

fn radar(scene: &dyn Scene, spec: &RadarSpec, motion: &RadarMotion, frame: u32) -> RadarReturns {
    let query = RadarQuery { spec, motion: *motion, stream: &stream() };
    sensors::radars(scene, &[query], frame).expect("has no device").remove(0)
}

fn small(spec: LidarSpec) -> LidarSpec {
    LidarSpec { scan: ScanPattern { channels: 32, columns: 256, ..spec.scan }, ..spec }
}

#[test]
fn ranges_on_a_plane_follow_the_beam_angles() {
    let snapshot = snapshot(
        vec![plane(400.0, 0.0, Tag::Road, Surface::Asphalt)],
        vec![instance(0, 9, Affine3A::IDENTITY)],
    );
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let spec = small(LidarSpec::vehicle().semantic());
    let sweep = sweep(&spec, scene, at(5.0, 2.0, 1.8, 0.4), 0);
    let mut count = 0;
    for channel in 0..32u32 {
        let elevation =
            spec.scan.upper_rad - f64::from(channel) * (spec.scan.upper_rad - spec.scan.lower_rad) / 31.0;
        let range = 1.8 / -frames::math::sin(elevation);
        if elevation >= 0.0 || range > 120.0 {
            continue;
        }
        for column in 0..256u32 {
            let azimuth = std::f64::consts::PI - f64::from(column) * std::f64::consts::TAU / 256.0;
            let flat = range * frames::math::cos(elevation);
            let (y, x) = (flat * frames::math::sin(azimuth), flat * frames::math::cos(azimuth));
            if x.abs() <= 2.44 && y.abs() <= 1.04 {
                continue;
            }
            let got = Vec3::new(sweep.x_m[count], sweep.y_m[count], sweep.z_m[count]);
            let want = Vec3::new(x as f32, y as f32, -1.8);
            assert!((got - want).length() < 2e-4 * range as f32, "{got} {want}");
            let cosine = 1.8 / range;
            assert!((f64::from(sweep.cos_angle[count]) - cosine).abs() < 1e-4);
            assert_eq!((u32::from(sweep.ring[count]), sweep.id[count], sweep.tag[count]), (channel, 9, 1));
            count += 1;
        }
    }
    assert_eq!(sweep.len(), count, "nothing else came back");
    assert!(count > 3000);
}

#[test]
fn drops_and_noise_have_the_stated_rates() {
    // A wall all around at one distance: every ray would return.
    let distance = 100.0f32;
    let mut walls = Vec::new();
    for i in 0..64 {
        let yaw = std::f32::consts::TAU * i as f32 / 64.0;
        walls.push(instance(0, 3, Affine3A::from_rotation_z(yaw) * at(distance + 0.5, 0.0, -50.0, 0.0)));
    }
    let snapshot = snapshot(vec![block([1.0, 12.0, 100.0], Tag::Building, Surface::Concrete)], walls);
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let spec = LidarSpec {
        scan: ScanPattern {
            channels: 64,
            columns: 1024,
            upper_rad: 0.05,
            lower_rad: -0.05,
            ..LidarSpec::vehicle().scan
        },
        ..LidarSpec::vehicle()
    };
    let of = |spec: &LidarSpec, frame| sweep(spec, scene, Affine3A::IDENTITY, frame);
    let all = of(&spec.semantic(), 4);
    assert_eq!(all.len(), 64 * 1024);
    let sweep = of(&spec, 4);
    let intensity = frames::math::exp(-0.004 * f64::from(distance));
    let want = 0.86 * (1.0 - 0.4 + 0.5 * intensity);
    let got = sweep.len() as f64 / all.len() as f64;
    assert!((got - want).abs() < 0.006, "{got} {want}");

    // Noise: against the noiseless ranges of the same directions.
    let quiet = LidarSpec { noise_m: 0.0, ..spec.clone() };
    let quiet = of(&quiet, 4);
    assert_eq!(quiet.len(), sweep.len(), "noise drops nothing");
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..sweep.len() {
        let range = |s: &sensors::LidarSweep| f64::from(Vec3::new(s.x_m[i], s.y_m[i], s.z_m[i]).length());
        let error = range(&sweep) - range(&quiet);
        sum += error;
        squares += error * error;
    }
    let n = sweep.len() as f64;
    assert!((sum / n).abs() < 5e-4);
    assert!(((squares / n).sqrt() - 0.03).abs() < 6e-4);

    assert_ne!(of(&spec, 5), sweep, "another frame draws other numbers");
}

#[test]
fn sweeps_equal_single_rays_and_do_not_depend_on_threads() {
    let snapshot = street(false);
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let pose = at(0.0, -5.0, 1.8, 0.2);
    let lidar = Lidar::new(&small(LidarSpec::vehicle().semantic())).expect("is small");
    let sweep = lidar.sweep(scene, &LidarMoment::standing(1, pose), &stream()).expect("has no device");
    let mut next = 0;
    for direction in lidar.directions() {
        let ray = RayBatch {
            origin: Vec3::from(pose.translation),
            directions: &[pose.transform_vector3(*direction).normalize()],
            range_m: [0.0, 120.0],
            nearest_m: &[],
        };
        let Some(hit) = scene.trace(&[RayQuery::of(ray)]).expect("has no device")[0].get(0) else { continue };
        let p = *direction * hit.t;
        if p.x.abs() <= 2.44 && p.y.abs() <= 1.04 {
            continue;
        }
        assert_eq!(sweep.x_m[next], p.x);
        assert_eq!(sweep.id[next], snapshot.instances[hit.instance as usize].object);
        next += 1;
    }
    assert_eq!(next, sweep.len());

    let noisy = Lidar::new(&small(LidarSpec::rsu())).expect("is small");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        let moment = LidarMoment::standing(2, pose);
        pool.install(|| noisy.sweep(scene, &moment, &stream()).expect("has no device"))
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert!(one.y_m.iter().zip(&one.x_m).all(|(_, &x)| x > -0.2), "180 degrees ahead");
    assert!(one.intensity.iter().all(|i| (0.0..=1.0).contains(i)));
}

#[test]
fn too_many_rays_are_refused() {
    let scan = ScanPattern { channels: 60_000, columns: 60_000, ..LidarSpec::vehicle().scan };
    let result = Lidar::new(&LidarSpec { scan, ..LidarSpec::vehicle() });
    assert!(matches!(result, Err(SensorError::ScanPattern { .. })));
    let none = ScanPattern { channels: 0, columns: 0, ..LidarSpec::vehicle().scan };
    let lidar = Lidar::new(&LidarSpec { scan: none, ..LidarSpec::vehicle() }).expect("is empty");
    assert!(lidar.directions().is_empty());
}

#[test]
fn doppler_is_positive_for_what_recedes() {
    // A wall ahead that moves away at 10 m/s, a radar that drives towards it at 4 m/s.
    let mut wall = instance(0, 2, at(40.0, 0.0, -50.0, 0.0));
    wall.previous_local_from_object = at(39.5, 0.0, -50.0, 0.0);
    let snapshot = snapshot(vec![block([1.0, 400.0, 100.0], Tag::Truck, Surface::Metal)], vec![wall]);
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let spec = &Rig::vehicle().radars[1];
    let motion = RadarMotion {
        local_from_sensor: at(0.2, 0.0, 0.6, 0.0),
        previous_local_from_sensor: at(0.0, 0.0, 0.6, 0.0),
        own: None,
    };
    let returns = radar(scene, spec, &motion, 3);
    assert_eq!(returns.len(), spec.rays as usize, "the wall fills the cone");
    let (mut left, mut high) = (0, 0);
    for i in 0..returns.len() {
        let (sin_az, cos_az) = frames::math::f32::sin_cos(returns.azimuth_rad[i]);
        let (sin_alt, cos_alt) = frames::math::f32::sin_cos(returns.altitude_rad[i]);
        let along = cos_az * cos_alt;
        assert!((returns.velocity_mps[i] - 6.0 * along).abs() < 2e-3);
        assert!((returns.depth_m[i] * along - 39.3).abs() < 1e-3, "the wall's face is 39.3 m ahead");
        // Inside the elliptic cone.
        let y = sin_az / cos_az / frames::math::f32::tan(0.5 * spec.horizontal_fov_rad as f32);
        let z = sin_alt / along / frames::math::f32::tan(0.5 * spec.vertical_fov_rad as f32);
        assert!(y * y + z * z <= 1.0 + 1e-4);
        left += i32::from(y > 0.0);
        high += i32::from(z > 0.0);
    }
    // Evenly to both sides; radii evenly from 0 to 1.
    assert!((left - 1000).abs() < 110 && (high - 1000).abs() < 110, "{left} {high}");
}

#[test]
fn wheels_turn_for_radars_only_when_asked() {
    // A car body that stands 20 m ahead with a wheel before it (so that all rays meet the wheel) which turns
    // by 0.2 rad.
    let body = instance(0, 5, at(20.0, 0.0, 0.0, 0.0));
    let mut wheel = instance(1, 5, at(18.0, 0.0, 0.0, 0.0));
    wheel.previous_local_from_object = wheel.local_from_object * Affine3A::from_rotation_y(-0.2);
    let snapshot = snapshot(
        vec![
            block([1.0, 2.0, 1.0], Tag::Car, Surface::Paint),
            block([0.1, 200.0, 200.0], Tag::Car, Surface::Rubber),
        ],
        vec![body, wheel],
    );
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let pose = at(0.0, 0.0, 0.6, 0.0);
    let motion = RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: None };
    let calm = Rig::vehicle().radars[1].clone();
    let micro = RadarSpec { micro_motion: true, ..calm.clone() };
    assert!(radar(scene, &calm, &motion, 0).velocity_mps.iter().all(|&v| v == 0.0), "the body stands");
    let returns = radar(scene, &micro, &motion, 0);
    assert!(!returns.is_empty());
    for i in 0..returns.len() {
        let (sin_az, cos_az) = frames::math::f32::sin_cos(returns.azimuth_rad[i]);
        let (sin_alt, cos_alt) = frames::math::f32::sin_cos(returns.altitude_rad[i]);
        let along = Vec3::new(cos_alt * cos_az, cos_alt * sin_az, sin_alt);
        let now = along * returns.depth_m[i] + Vec3::new(0.0, 0.0, 0.6);
        // The wheel's point a frame before: turned back about its axle at (18, y, 0).
        let axle = Vec3::new(18.0, 0.0, 0.0);
        let was = axle + glam::Quat::from_rotation_y(-0.2) * (now - axle);
        let want = (now - was).dot(along) / 0.05;
        assert!((returns.velocity_mps[i] - want).abs() < 2e-2, "{} {want}", returns.velocity_mps[i]);
    }
}

#[test]
fn cross_sections_of_rays_add_up_to_that_of_the_plate() {
    // A metal plate of 4 m x 2 m that faces the radar 30 m ahead: (4 r cos + s (n + 1) cos^2n) w d^2 added up
    // over its small angles by squares of a centimetre, with r = 0.15, s = 0.8, n = 20.
    let snapshot = snapshot(
        vec![block([0.1, 4.0, 2.0], Tag::Truck, Surface::Metal)],
        vec![instance(0, 2, at(30.05, 0.0, -0.4, 0.0))],
    );
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let spec = RadarSpec { rays: 200_000, snr_db: 7.0, ..Rig::vehicle().radars[1].clone() };
    let pose = at(0.0, 0.0, 0.6, 0.0);
    let motion = RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: None };
    let returns = radar(scene, &spec, &motion, 0);
    let m2 = |dbsm: f32| frames::math::pow(10.0, 0.1 * f64::from(dbsm));
    let sum: f64 = returns.rcs_dbsm.iter().map(|&rcs| m2(rcs)).sum();
    let square = |i: i32, j: i32| {
        let (y, z) = (0.01 * f64::from(i) + 0.005, 0.01 * f64::from(j) + 0.005);
        let cos2 = 900.0 / (900.0 + y * y + z * z);
        (0.6 * cos2 + 16.8 * cos2.sqrt() * frames::math::pow(cos2, 20.0)) * 1e-4
    };
    let want: f64 = (-200..200).flat_map(|i| (-100..100).map(move |j| square(i, j))).sum();
    assert!((sum / want - 1.0).abs() < 0.04, "{sum}, not {want}, of {} rays", returns.len());
    for i in 0..returns.len() {
        let way = 40.0 * frames::math::log10(f64::from(returns.depth_m[i]) / 100.0);
        let want = 7.0 + f64::from(returns.rcs_dbsm[i]) - way;
        assert!((f64::from(returns.snr_db[i]) - want).abs() < 1e-3);
    }
}

#[test]
fn the_own_body_is_looked_through() {
    let snapshot = snapshot(
        vec![
            block([5.0, 2.0, 1.5], Tag::Car, Surface::Paint),
            block([1.0, 200.0, 60.0], Tag::Building, Surface::Facade(Wall::Brick)),
        ],
        vec![instance(0, 1, at(0.0, 0.0, 0.0, 0.0)), instance(1, 2, at(30.0, 0.0, -30.0, 0.0))],
    );
    let renderer = prepared(&snapshot);
    let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
    let pose = at(2.4, 0.0, 0.6, 0.0);
    let motion = |own| RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own };
    let spec = &Rig::vehicle().radars[1];
    let blocked = radar(scene, spec, &motion(None), 0);
    assert!(blocked.id.iter().all(|&id| id == 1));
    let through = radar(scene, spec, &motion(Some(1)), 0);
    assert_eq!(through.len(), spec.rays as usize);
    assert!(through.id.iter().all(|&id| id == 2));
    assert!(through.velocity_mps.iter().all(|&v| v == 0.0));
}

#[test]
fn brightness_is_the_surfaces_reflectance_at_905_nm() {
    // Walls 10 m ahead, seen straight and at 60 degrees: intensity = exp(-0.004 d) (r (1/4 + 3/4 cos) + what
    // is mirrored straight back, of which nothing is left at 60 degrees). Sheeting is as bright as can be up
    // to 30 degrees, and at 60 sends back 0.397.
    let dark = [0.0; 3];
    let cases = [
        (Tag::Road, Surface::Asphalt, dark, 0.15, 0.0),
        (Tag::RoadLine, Surface::RoadMarking, dark, 0.8, 0.0),
        (Tag::Sidewalk, Surface::Concrete, dark, 0.35, 0.0),
        (Tag::Building, Surface::Facade(Wall::Brick), dark, 0.35, 0.0),
        (Tag::Vegetation, Surface::Foliage, dark, 0.5, 0.0),
        (Tag::Terrain, Surface::Grass, dark, 0.5, 0.0),
        (Tag::Car, Surface::Glass, [1.0; 3], 0.05, 0.3),
        // The pigment of the paint counts, not the part's own colour, and the clear coat.
        (Tag::Car, Surface::Paint, dark, 0.12 + 0.5 * 0.5, 0.3),
        (Tag::Car, Surface::Paint, [1.0; 3], 0.12 + 0.5 * 0.5, 0.3),
        (Tag::Car, Surface::Rubber, dark, 0.06, 0.0),
        // Cloth: it does, green most.
        (Tag::Pedestrian, Surface::Cloth, dark, 0.15, 0.0),
        (Tag::Pedestrian, Surface::Cloth, [0.0, 1.0, 0.0], 0.15 + 0.6 * 0.7152, 0.0),
        (Tag::Pedestrian, Surface::Cloth, [9.0; 3], 0.75, 0.0),
        (Tag::Wall, Surface::Plain, [1.0; 3], 0.75, 0.0),
        // Faces of signs and number plates send light back where it came from, ink and poles do not.
        (Tag::TrafficSign, Surface::Reflector, dark, 0.15, 1.0),
        (Tag::Car, Surface::Reflector, [0.78; 3], 0.15 + 0.6 * 0.78, 1.0),
        (Tag::TrafficSign, Surface::Plain, dark, 0.15, 0.0),
        (Tag::TrafficSign, Surface::Metal, dark, 0.4, 0.2),
    ];
    let one_ray = LidarSpec {
        scan: ScanPattern {
            channels: 1,
            columns: 1,
            upper_rad: 0.0,
            lower_rad: 0.0,
            horizontal_fov_rad: 0.0,
        },
        dropoff_rate: 0.0,
        dropoff_zero_intensity: 0.0,
        noise_m: 0.0,
        ..LidarSpec::vehicle()
    };
    for (tag, surface, rgb, reflectance, mirrored) in cases {
        for turn_deg in [0.0, 60.0] {
            let mut wall = crate::common::MeshBuilder::default();
            let part = wall.part(tag, surface, rgb);
            wall.cuboid(part, [0.0, -20.0, -5.0], [0.1, 20.0, 5.0]);
            let turn = frames::deg(turn_deg);
            let snapshot =
                snapshot(vec![wall.finish()], vec![instance(0, 4, at(10.0, 0.0, 0.0, turn as f32))]);
            let sweep = with_scene(&snapshot, |scene| sweep(&one_ray, scene, Affine3A::IDENTITY, 0));
            assert_eq!(sweep.len(), 1);
            let cosine = frames::math::cos(turn);
            let left =
                if surface == Surface::Reflector { (0.5 - 0.258_819) / (0.866_025 - 0.258_819) } else { 0.0 };
            let back: f64 = if turn_deg == 0.0 { mirrored } else { left };
            let seen = (reflectance * (0.25 + 0.75 * cosine) + back).min(1.0);
            let want = frames::math::exp(-0.004 * 10.0) * seen;
            let got = f64::from(sweep.intensity[0]);
            assert!((got - want).abs() < 1e-5, "{tag:?} {surface:?} {turn_deg}: {got} {want}");
        }
    }
}
