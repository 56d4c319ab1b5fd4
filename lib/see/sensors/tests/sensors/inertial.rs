//! GNSS and IMU against closed forms.

use frames::{Agent, Pose, World};
use nalgebra::Vector3;
use proptest::prelude::*;
use random::Stream;
use sensors::{GeoOrigin, Motion, gnss, imu};
use settings::{GnssSpec, ImuSpec, Mount};

fn quiet() -> ImuSpec {
    ImuSpec { noise_accel_mps2: 0.0, gyro_bias_radps: 0.0, noise_gyro_radps: 0.0, ..ImuSpec::default() }
}

fn stream() -> Stream {
    Stream::new(27, 0, "test/inertial", 0)
}

/// On a circle to the left about the origin, at an angle.
fn circling(radius_m: f64, speed_mps: f64, angle: f64) -> Motion {
    let (sin, cos) = frames::math::sin_cos(angle);
    Motion {
        world_from_agent: Pose::<World, Agent>::from_xyz_rpy(
            [radius_m * cos, radius_m * sin, 0.0],
            [0.0, 0.0, angle + std::f64::consts::FRAC_PI_2],
        ),
        velocity_mps: Vector3::new(-sin, cos, 0.0) * speed_mps,
        angular_velocity_radps: Vector3::new(0.0, 0.0, speed_mps / radius_m),
    }
}

fn close(got: [f64; 3], want: [f64; 3], tolerance: f64) {
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() < tolerance, "{got} {want}");
    }
}

#[test]
fn at_rest_only_gravity_is_felt() {
    let still = |rpy| Motion {
        world_from_agent: Pose::from_xyz_rpy([3.0, 4.0, 5.0], rpy),
        velocity_mps: Vector3::zeros(),
        angular_velocity_radps: Vector3::zeros(),
    };
    let level = still([0.0, 0.0, 1.0]);
    let row = imu(&quiet(), &level, Some(&level), &stream(), 4);
    close(row.acceleration_mps2, [0.0, 0.0, 9.81], 1e-12);
    close(row.gyroscope_radps, [0.0; 3], 1e-12);
    // Nose down by 0.1: gravity pulls forward, so the felt force points backward.
    let tilted = still([0.0, 0.1, 0.0]);
    let row = imu(&quiet(), &tilted, None, &stream(), 0);
    let (sin, cos) = frames::math::sin_cos(0.1);
    close(row.acceleration_mps2, [-9.81 * sin, 0.0, 9.81 * cos], 1e-9);
}

#[test]
fn a_left_turn_pushes_left_and_turns_positive() {
    let (radius, speed) = (25.0, 10.0);
    let step = speed / radius * schema::FRAME_PERIOD_S;
    let (before, now) = (circling(radius, speed, 0.3 - step), circling(radius, speed, 0.3));
    let row = imu(&quiet(), &now, Some(&before), &stream(), 7);
    // The difference over a frame lags half a frame: v^2 / r turned by half a step.
    close(row.acceleration_mps2, [0.5 * step * 4.0, 4.0, 9.81], 2e-3);
    close(row.gyroscope_radps, [0.0, 0.0, 0.4], 1e-9);
    // Two metres ahead of the origin the circle is wider: more to the left by nothing, backward by w^2 x.
    let ahead = ImuSpec { mount: Mount::upright([2.0, 0.0, 0.0], 0.0), ..quiet() };
    let row = imu(&ahead, &now, Some(&before), &stream(), 7);
    close(row.acceleration_mps2, [0.5 * step * 4.0 - 0.16 * 2.0, 4.0, 9.81], 5e-3);
    // A sensor turned to the left feels the push from its front.
    let turned = ImuSpec { mount: Mount::upright([0.0; 3], 90.0), ..quiet() };
    let row = imu(&turned, &now, Some(&before), &stream(), 7);
    assert!((row.acceleration_mps2[0] - 4.0).abs() < 5e-3);
}

#[test]
fn the_compass_turns_clockwise_from_north() {
    for (yaw_deg, want_deg) in [(90.0, 0.0), (0.0, 90.0), (-90.0, 180.0), (180.0, 270.0), (45.0, 45.0)] {
        let motion = Motion {
            world_from_agent: Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, frames::deg(yaw_deg)]),
            velocity_mps: Vector3::zeros(),
            angular_velocity_radps: Vector3::zeros(),
        };
        let row = imu(&quiet(), &motion, None, &stream(), 0);
        let off = frames::wrap_pi(row.compass_rad - frames::deg(want_deg));
        assert!(off.abs() < 1e-9 && (0.0..std::f64::consts::TAU).contains(&row.compass_rad));
    }
}

#[test]
fn noise_has_the_stated_spread() {
    let spec = ImuSpec { noise_gyro_radps: 1e-3, gyro_bias_radps: 5e-3, ..ImuSpec::default() };
    let still = Motion {
        world_from_agent: Pose::identity(),
        velocity_mps: Vector3::zeros(),
        angular_velocity_radps: Vector3::zeros(),
    };
    let gnss_spec = GnssSpec::default();
    let origin = GeoOrigin { latitude_deg: 49.0, longitude_deg: 8.0, altitude_m: 100.0 };
    let n = 4000;
    let (mut rate, mut altitude, mut force) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..n {
        let row = imu(&spec, &still, None, &stream(), frame);
        rate.extend(row.gyroscope_radps);
        force.push(row.acceleration_mps2[0]);
        altitude.push(gnss(&gnss_spec, &origin, &still.world_from_agent, &stream(), frame).altitude_m);
    }
    let check = |values: &[f64], mean: f64, std_dev: f64| {
        let m = values.iter().sum::<f64>() / values.len() as f64;
        let v = values.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / values.len() as f64;
        assert!((m - mean).abs() < 0.06 * std_dev, "{m} {mean}");
        assert!((v.sqrt() - std_dev).abs() < 0.05 * std_dev, "{} {std_dev}", v.sqrt());
    };
    check(&rate, 5e-3, 1e-3);
    check(&force, 0.0, 1.7e-4);
    check(&altitude, 100.0, 0.04);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn geodetic_coordinates_invert(x in -2e4..2e4f64, y in -2e4..2e4f64, z in -100.0..800.0f64,
                                   latitude in -70.0..70.0f64, longitude in -170.0..170.0f64) {
        let origin = GeoOrigin { latitude_deg: latitude, longitude_deg: longitude, altitude_m: 5.0 };
        let back = origin.world_from_geodetic(origin.geodetic_from_world([x, y, z]));
        for (got, want) in back.iter().zip([x, y, z]) {
            prop_assert!((got - want).abs() < 1e-6, "{got} {want}");
        }
        // Near the origin a degree is a degree of the sphere.
        let [lat, lon, _] = origin.geodetic_from_world([100.0, 100.0, 0.0]);
        let per_deg = frames::deg(1.0) * 6_378_137.0;
        prop_assert!(((lat - latitude) * per_deg - 100.0).abs() < 0.01);
        let cos = frames::math::cos(frames::deg(latitude));
        prop_assert!(((lon - longitude) * per_deg * cos - 100.0).abs() < 0.01);
    }
}
