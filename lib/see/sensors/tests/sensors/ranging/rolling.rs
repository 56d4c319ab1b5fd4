//! Rolling scans against ranges worked out by hand: one column at a time, objects that move at one speed.

use glam::{Affine3A, Vec3};
use render::{Renderer, Scene};
use schema::Tag;
use schema::geometry::{Instance, Snapshot, Surface};
use sensors::{Lidar, LidarMoment, LidarSweep, SensorPath};
use settings::{LidarSpec, RollingScan, ScanPattern};

use super::stream;
use crate::common::{at, block, instance, prepared, snapshot, street};

const COLUMNS: u32 = 120;
/// Half the field of view, radians.
const HALF_RAD: f64 = 1.0;

/// One level beam that looks ahead.
fn flat(slices: u32, compensated: bool) -> LidarSpec {
    let scan = ScanPattern {
        channels: 1,
        columns: COLUMNS,
        upper_rad: 0.0,
        lower_rad: 0.0,
        horizontal_fov_rad: 2.0 * HALF_RAD,
    };
    LidarSpec { scan, rolling: Some(RollingScan { slices, compensated }), ..LidarSpec::vehicle().semantic() }
}

/// A wall whose face is at x = 30 m at the frame's time.
fn wall() -> Instance {
    instance(0, 7, at(30.5, 0.0, -50.0, 0.0))
}

fn sweep(wall: Instance, spec: &LidarSpec, path: SensorPath) -> LidarSweep {
    let world = snapshot(vec![block([1.0, 400.0, 100.0], Tag::Building, Surface::Concrete)], vec![wall]);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let moment = LidarMoment { path, ..LidarMoment::standing(3, Affine3A::IDENTITY) };
    Lidar::new(spec).expect("is small").sweep(scene, &moment, &stream()).expect("has no device")
}

/// Expects a return of every column, at a point of its azimuth and of the share of a period that is left when
/// its slice is fired.
fn expect(sweep: &LidarSweep, slices: u32, wanted: impl Fn(f64, f64) -> [f64; 2]) {
    assert_eq!(sweep.len(), COLUMNS as usize);
    let in_slice = COLUMNS / slices;
    for column in 0..COLUMNS {
        let azimuth = HALF_RAD - 2.0 * HALF_RAD * f64::from(column) / f64::from(COLUMNS);
        let middle = f64::from(column / in_slice * in_slice) + 0.5 * f64::from(in_slice);
        let left = 1.0 - middle / f64::from(COLUMNS);
        let k = column as usize;
        assert!((f64::from(sweep.time_offset_s[k]) + 0.05 * left).abs() < 1e-8, "{column}");
        let [x, y] = wanted(azimuth, left);
        let off = frames::math::hypot(f64::from(sweep.x_m[k]) - x, f64::from(sweep.y_m[k]) - y);
        assert!(off < 1e-4, "column {column}: {} {} is not {x} {y}", sweep.x_m[k], sweep.y_m[k]);
    }
}

#[test]
fn a_wall_that_the_sensor_drives_towards() {
    // A metre a frame (20 m/s): when the share `left` of the period is left, the wall is that much farther.
    let path = SensorPath {
        local_from_sensor: at(0.0, 0.0, 1.8, 0.0),
        local_from_agent: at(-2.0, 1.0, 0.0, 0.0),
        previous_local_from_agent: at(-3.0, 1.0, 0.0, 0.0),
    };
    for slices in [COLUMNS, 8, 1] {
        let raw = |azimuth: f64, left: f64| {
            let range = (30.0 + left) / frames::math::cos(azimuth);
            [range * frames::math::cos(azimuth), range * frames::math::sin(azimuth)]
        };
        expect(&sweep(wall(), &flat(slices, false), path), slices, raw);
        let compensated = |azimuth, left| [30.0, raw(azimuth, left)[1]];
        expect(&sweep(wall(), &flat(slices, true), path), slices, compensated);
    }
}

#[test]
fn a_wall_that_comes_nearer() {
    // Half a metre a frame; the sensor stands, so nothing is taken out.
    let mut wall = wall();
    wall.previous_local_from_object.translation.x += 0.5;
    let path = SensorPath::standing(at(0.0, 0.0, 1.8, 0.0));
    for compensated in [false, true] {
        expect(&sweep(wall, &flat(COLUMNS, compensated), path), COLUMNS, |azimuth, left| {
            let x = 30.0 + 0.5 * left;
            [x, x * frames::math::tan(azimuth)]
        });
    }
}

#[test]
fn a_sensor_that_turns() {
    // The agent turns by 0.4 rad to the left about its origin; the sensor is a metre ahead of it.
    let agent = |yaw| at(0.0, 0.0, 0.0, yaw);
    let path = SensorPath {
        local_from_sensor: at(1.0, 0.0, 1.8, 0.0),
        local_from_agent: agent(0.0),
        previous_local_from_agent: agent(-0.4),
    };
    let hit = |azimuth: f64, left: f64| {
        let (sin, cos) = frames::math::sin_cos(-0.4 * left);
        let range = (30.0 - cos) / frames::math::cos(azimuth - 0.4 * left);
        (range, sin + range * frames::math::sin(azimuth - 0.4 * left))
    };
    expect(&sweep(wall(), &flat(COLUMNS, false), path), COLUMNS, |azimuth, left| {
        let (range, _) = hit(azimuth, left);
        [range * frames::math::cos(azimuth), range * frames::math::sin(azimuth)]
    });
    expect(&sweep(wall(), &flat(COLUMNS, true), path), COLUMNS, |azimuth, left| [29.0, hit(azimuth, left).1]);
}

#[test]
fn a_wall_that_turns_is_met_at_its_angle_of_the_moment() {
    // A radian a frame about a vertical axis 30 m ahead: straight across when half the period is left.
    let mut wall = instance(0, 7, at(30.0, 0.0, -50.0, 0.5));
    wall.previous_local_from_object = at(30.0, 0.0, -50.0, -0.5);
    let path = SensorPath::standing(Affine3A::IDENTITY);
    let sweep = sweep(wall, &flat(COLUMNS, false), path);
    assert!(sweep.len() > 100, "a few see the wall too far away");
    for k in 0..sweep.len() {
        let left = -f64::from(sweep.time_offset_s[k]) / 0.05;
        let azimuth = frames::math::atan2(f64::from(sweep.y_m[k]), f64::from(sweep.x_m[k]));
        // The normal of its face points along 0.5 - left.
        let want = frames::math::cos(azimuth - (0.5 - left));
        assert!((f64::from(sweep.cos_angle[k]) - want).abs() < 1e-5, "{k}");
    }
}

/// A street in which nothing moves.
fn still() -> Snapshot {
    let mut world = street(false);
    for instance in &mut world.instances {
        instance.previous_local_from_object = instance.local_from_object;
    }
    world
}

#[test]
fn where_nothing_moves_only_times_differ() {
    let world = still();
    let renderer = prepared(&world);
    let scene: &dyn Scene = &*renderer.place(&world).expect("all meshes are prepared");
    let base = LidarSpec {
        scan: ScanPattern { channels: 32, columns: 250, ..LidarSpec::vehicle().scan },
        ..LidarSpec::vehicle()
    };
    let moment = LidarMoment::standing(2, at(0.0, -5.0, 1.8, 0.2));
    let of = |spec: &LidarSpec| {
        Lidar::new(spec).expect("is small").sweep(scene, &moment, &stream()).expect("has no device")
    };
    for spec in [base.clone(), base.semantic()] {
        let snapshot = of(&spec);
        let rolling =
            of(&LidarSpec { rolling: Some(RollingScan { slices: 16, compensated: false }), ..spec });
        assert!(snapshot.time_offset_s.iter().all(|&t| t == 0.0) && snapshot.len() > 2000);
        // Sixteen moments, each in every ring.
        let mut times = rolling.time_offset_s.clone();
        times.sort_by(f32::total_cmp);
        times.dedup();
        assert_eq!(times.len(), 16);
        assert!(times[0] > -0.05 && times[15] < 0.0);
        assert_eq!(LidarSweep { time_offset_s: snapshot.time_offset_s.clone(), ..rolling }, snapshot);
    }
}

#[test]
fn rolling_scans_do_not_depend_on_threads() {
    let world = street(false);
    let renderer = prepared(&world);
    let scene: &dyn Scene = &*renderer.place(&world).expect("all meshes are prepared");
    let spec = LidarSpec {
        scan: ScanPattern { channels: 16, columns: 256, ..LidarSpec::vehicle().scan },
        rolling: Some(RollingScan { slices: 32, compensated: true }),
        ..LidarSpec::vehicle()
    };
    let lidar = Lidar::new(&spec).expect("is small");
    let mut moment = LidarMoment::standing(2, at(0.0, -5.0, 1.8, 0.2));
    moment.path.previous_local_from_agent = at(-0.7, -5.0, 1.8, 0.15);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        pool.install(|| lidar.sweep(scene, &moment, &stream()).expect("has no device"))
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert!(one.len() > 1000);
    let farthest =
        one.x_m.iter().zip(&one.y_m).zip(&one.z_m).map(|((&x, &y), &z)| Vec3::new(x, y, z).length());
    assert!(farthest.fold(0.0, f32::max) < 121.0);
}
