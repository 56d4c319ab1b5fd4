//! Files of lidars and radars, and the returns that they are made of.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

schema::columns! {
    /// What an export needs of a sweep.
    Sweep of schema::tables::LidarRow {
        frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, intensity: Vec<f32>, ring: Vec<u16>, id: Vec<u16>, tag: Vec<u8>
    }
}

schema::columns! {
    /// What an export needs of a radar's returns.
    Returns of schema::tables::RadarRow {
        frame: u32, depth: Vec<f32>, altitude: Vec<f32>, azimuth: Vec<f32>, velocity: Vec<f32>, rcs_dbsm: Vec<f32>
    }
}

schema::framed!(Sweep, Returns);

/// Bytes of a lidar point.
pub(crate) const LIDAR_POINT_BYTES: u64 = 20;
/// Bytes of a radar return.
pub(crate) const RADAR_POINT_BYTES: u64 = 43;
/// Bodies whose own motion along the ray is slower than this stand, m/s.
const STANDING_MPS: f64 = 0.5;

/// The layout's lidar frame has x to the right and y ahead: a turn of -90 degrees about z takes its points to
/// ours.
pub(crate) fn sensor_from_layout() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2)
}

/// A sweep as the layout's file: x to the right, y ahead, z up (m), intensity of 0 to 255, ring, each an f32.
pub(crate) fn lidar_file(sweep: &Sweep) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(sweep.x.len() * LIDAR_POINT_BYTES as usize);
    let columns = sweep.x.iter().zip(&sweep.y).zip(&sweep.z).zip(&sweep.intensity).zip(&sweep.ring);
    for ((((x, y), z), intensity), ring) in columns {
        for value in [-y, *x, *z, 255.0 * intensity, f32::from(*ring)] {
            // Adding zero makes a plain one of -0.
            bytes.extend((value + 0.0).to_le_bytes());
        }
    }
    bytes
}

/// How a radar moves over the ground, m/s in its own frame: with its agent, which also turns.
pub(crate) fn radar_velocity(
    world_from_agent: &Isometry3<f64>,
    agent_from_radar: &Isometry3<f64>,
    velocity_mps: [f64; 3],
    angular_velocity_radps: [f64; 3],
) -> Vector3<f64> {
    let arm = world_from_agent.rotation * agent_from_radar.translation.vector;
    let in_world = Vector3::from(velocity_mps) + Vector3::from(angular_velocity_radps).cross(&arm);
    (world_from_agent.rotation * agent_from_radar.rotation).inverse() * in_world
}

/// Returns as the layout's file, in the radar's frame: places, cross-sections, radial velocities along the
/// rays, as measured and without the radar's own motion. A file has at least one point; of none it says so by
/// not-a-number.
pub(crate) fn radar_file(returns: &Returns, radar_mps: &Vector3<f64>) -> Vec<u8> {
    let points = returns.depth.len();
    let mut bytes = radar_header(points.max(1));
    if points == 0 {
        radar_point(&mut bytes, [f32::NAN; 3], 1, 0, [f32::NAN; 5]);
    }
    for i in 0..points {
        let (depth, altitude) = (f64::from(returns.depth[i]), f64::from(returns.altitude[i]));
        let (sin_up, cos_up) = frames::math::sin_cos(altitude);
        let (sin_left, cos_left) = frames::math::sin_cos(f64::from(returns.azimuth[i]));
        let ray = Vector3::new(cos_up * cos_left, cos_up * sin_left, sin_up);
        let measured = f64::from(returns.velocity[i]);
        let own = measured + radar_mps.dot(&ray);
        let at = ray * depth;
        let along = |speed: f64| [(speed * ray.x) as f32, (speed * ray.y) as f32];
        let ([vx, vy], [vx_comp, vy_comp]) = (along(measured), along(own));
        let moves = own.abs() > STANDING_MPS;
        let numbers = [returns.rcs_dbsm[i], vx, vy, vx_comp, vy_comp];
        radar_point(
            &mut bytes,
            [at.x as f32, at.y as f32, at.z as f32],
            u8::from(!moves),
            (i % 0x8000) as u16,
            numbers,
        );
    }
    // Devkits want a byte behind the last point.
    bytes.push(b'\n');
    bytes
}

/// Devkits take lines by their number.
fn radar_header(points: usize) -> Vec<u8> {
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\n\
         VERSION 0.7\n\
         FIELDS x y z dyn_prop id rcs vx vy vx_comp vy_comp is_quality_valid ambig_state x_rms y_rms invalid_state pdh0 \
         vx_rms vy_rms\n\
         SIZE 4 4 4 1 2 4 4 4 4 4 1 1 1 1 1 1 1 1\n\
         TYPE F F F I I F F F F F I I I I I I I I\n\
         COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n\
         WIDTH {points}\n\
         HEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\n\
         POINTS {points}\n\
         DATA binary\n"
    )
    .into_bytes()
}

/// `dyn_prop`: 0 moves, 1 stands. `id`: number of the return. Numbers: cross-section, then velocities.
fn radar_point(bytes: &mut Vec<u8>, at: [f32; 3], dyn_prop: u8, id: u16, numbers: [f32; 5]) {
    for value in at {
        bytes.extend(value.to_le_bytes());
    }
    bytes.push(dyn_prop);
    bytes.extend(id.to_le_bytes());
    for value in numbers {
        bytes.extend(value.to_le_bytes());
    }
    // Valid, unambiguous (3), no spread stated, state 0 (valid), artefact less likely than 25 % (1).
    bytes.extend([1, 3, 0, 0, 0, 1, 0, 0]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(bytes: &[u8]) -> Vec<f32> {
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    #[test]
    fn lidar_points_turn_right_and_come_back() {
        let sweep = Sweep {
            x: vec![10.0],
            y: vec![2.0],
            z: vec![-1.0],
            intensity: vec![0.2],
            ring: vec![7],
            ..Sweep::default()
        };
        // Two metres to the left are -2 to the right.
        let point = floats(&lidar_file(&sweep));
        assert_eq!(point, [-2.0, 10.0, -1.0, 51.0, 7.0]);
        let back = sensor_from_layout() * Vector3::new(-2.0, 10.0, -1.0);
        assert!((back - Vector3::new(10.0, 2.0, -1.0)).norm() < 1e-12);
    }

    #[test]
    fn radar_files_hold_places_and_velocities() {
        // 20 m at 30 degrees to the left and level, coming nearer by 5 m/s; the radar goes ahead by 2 m/s.
        let returns = Returns {
            depth: vec![20.0],
            altitude: vec![0.0],
            azimuth: vec![std::f32::consts::FRAC_PI_6],
            velocity: vec![-5.0],
            rcs_dbsm: vec![12.5],
            ..Returns::default()
        };
        let bytes = radar_file(&returns, &Vector3::new(2.0, 0.0, 0.0));
        let text = "DATA binary\n";
        let at = bytes.windows(text.len()).position(|w| w == text.as_bytes()).expect("a header") + text.len();
        assert_eq!(bytes[..at].iter().filter(|b| **b == b'\n').count(), 11);
        let point = &bytes[at..];
        assert_eq!(point.len() as u64, RADAR_POINT_BYTES + 1);
        let place = floats(&point[..12]);
        let half_root_3 = 0.5 * 3_f32.sqrt();
        for (got, want) in place.iter().zip([20.0 * half_root_3, 10.0, 0.0]) {
            assert!((got - want).abs() < 1e-5, "{place:?}");
        }
        assert_eq!(point[12..15], [0, 0, 0]);
        let own = -5.0 + 2.0 * half_root_3;
        let want = [12.5, -5.0 * half_root_3, -2.5, own * half_root_3, 0.5 * own];
        for (got, want) in floats(&point[15..35]).iter().zip(want) {
            assert!((got - want).abs() < 1e-5, "{got} {want}");
        }
        assert_eq!(point[35..], [1, 3, 0, 0, 0, 1, 0, 0, b'\n']);
    }

    #[test]
    fn no_returns_are_one_point_that_is_none() {
        let bytes = radar_file(&Returns::default(), &Vector3::zeros());
        let body = &bytes[bytes.len() - 44..];
        assert!(floats(&body[..12]).iter().all(|v| v.is_nan()));
        assert!(String::from_utf8_lossy(&bytes).contains("\nWIDTH 1\n"));
    }

    #[test]
    fn a_turning_agent_moves_its_radar_sideways() {
        // An agent that faces north (+y) and turns left by 0.5 rad/s; the radar is 2 m ahead and looks back.
        let quarter = |turns: f64| {
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turns * std::f64::consts::FRAC_PI_2)
        };
        let world_from_agent = Isometry3::from_parts(Vector3::new(5.0, 5.0, 0.0).into(), quarter(1.0));
        let agent_from_radar = Isometry3::from_parts(Vector3::new(2.0, 0.0, 0.5).into(), quarter(2.0));
        let found = radar_velocity(&world_from_agent, &agent_from_radar, [0.0, 3.0, 0.0], [0.0, 0.0, 0.5]);
        // Ahead by 3 is back by 3 for the radar; to the left by 1 is to its right.
        assert!((found - Vector3::new(-3.0, -1.0, 0.0)).norm() < 1e-12, "{found}");
    }
}
