//! Poses and points of CARLA's world: left-handed (x as ours, y to the other side, z up), metres and degrees.
//!
//! A pose is `[x, y, z, roll, yaw, pitch]`, in this order, and stands for the matrix Rz(yaw) Ry(-pitch)
//! Rx(-roll) beside x, y, z. With M = diag(1, -1, 1, 1) that matrix is M T M for a transform T of ours:
//! points, axes and cameras are mirrored alike.

use frames::{Frame, Pose, to_deg, wrap_pi};
use nalgebra::{Matrix4, UnitQuaternion, Vector3};

/// Digits after the point in what is written: micrometres, and millionths of a degree (2 um at 120 m).
const DECIMALS: f64 = 1e6;

/// Boxes whose heading is nearer than this to the opposite of a lidar's are turned away from it, degrees:
/// loaders average the directions of four edges as numbers, and half of them may read 180, half -180.
const OPPOSITE_DEG: f64 = 1e-4;

/// `[x, y, z, roll, yaw, pitch]`.
pub(super) type LeftPose = [f64; 6];

/// Rounded as written, without a negative zero.
pub(super) fn rounded(value: f64) -> f64 {
    (value * DECIMALS).round() / DECIMALS + 0.0
}

/// A point or direction of ours in the left-handed frame of the same name.
pub(super) fn left([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, z]
}

/// Roll, pitch, yaw of ours as `[roll, yaw, pitch]`, degrees.
pub(super) fn left_angles([roll, pitch, yaw]: [f64; 3]) -> [f64; 3] {
    [rounded(to_deg(roll)), rounded(-to_deg(yaw)), rounded(-to_deg(pitch))]
}

/// A pose of ours.
pub(super) fn left_pose<To: Frame, From: Frame>(pose: &Pose<To, From>) -> LeftPose {
    let ([x, y, z], [roll, yaw, pitch]) = (left(pose.xyz()), left_angles(pose.rpy()));
    [rounded(x), rounded(y), rounded(z), roll, yaw, pitch]
}

/// The matrix of a transform between left-handed frames whose right-handed transform is given: M T M.
pub(super) fn left_matrix<To: Frame, From: Frame>(pose: &Pose<To, From>) -> Matrix4<f64> {
    let mirror = Matrix4::from_diagonal(&nalgebra::Vector4::new(1.0, -1.0, 1.0, 1.0));
    mirror * pose.isometry().to_homogeneous() * mirror
}

/// The rotation that loaders make of `[roll, yaw, pitch]`.
fn rotation([roll, yaw, pitch]: [f64; 3]) -> UnitQuaternion<f64> {
    let rad = frames::deg;
    UnitQuaternion::from_euler_angles(-rad(roll), -rad(pitch), rad(yaw))
}

/// Angles of a box, turned a little where its heading is the opposite of that of one of the lidars.
pub(super) fn turned_away(mut angles: [f64; 3], lidars: &[LeftPose]) -> [f64; 3] {
    // Always the same way round, so each lidar is passed once.
    for _ in 0..=lidars.len() {
        let rotation = rotation(angles);
        let near = lidars.iter().find_map(|lidar| {
            let ahead = rotation_of(lidar).inverse() * (rotation * Vector3::x());
            let heading_deg = to_deg(frames::math::atan2(ahead.y, ahead.x));
            // Past the opposite this is negative.
            let missing_deg = to_deg(wrap_pi(frames::deg(180.0 - heading_deg)));
            (missing_deg.abs() < OPPOSITE_DEG).then_some(missing_deg)
        });
        match near {
            Some(missing_deg) => angles[1] = rounded(angles[1] + missing_deg + 1.5 * OPPOSITE_DEG),
            None => break,
        }
    }
    angles
}

fn rotation_of([_, _, _, roll, yaw, pitch]: &LeftPose) -> UnitQuaternion<f64> {
    rotation([*roll, *yaw, *pitch])
}

#[cfg(test)]
mod tests {
    use frames::{Agent, World, deg, math};
    use proptest::prelude::*;

    use super::*;

    /// The matrix of a pose, multiplied out by hand.
    fn matrix([x, y, z, roll, yaw, pitch]: LeftPose) -> [[f64; 4]; 4] {
        let ((sr, cr), (sy, cy), (sp, cp)) =
            (math::sin_cos(deg(roll)), math::sin_cos(deg(yaw)), math::sin_cos(deg(pitch)));
        [
            [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr, x],
            [sy * cp, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr, y],
            [sp, -cp * sr, cp * cr, z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    }

    proptest! {
        #[test]
        fn loaders_make_the_mirrored_transform_of_a_pose(
            x in -2e4..2e4f64, y in -2e4..2e4f64, z in -800.0..800.0f64,
            roll in -3.1..3.1f64, pitch in -1.5..1.5f64, yaw in -3.1..3.1f64,
        ) {
            let pose = Pose::<World, Agent>::from_xyz_rpy([x, y, z], [roll, pitch, yaw]);
            let ours = pose.isometry().to_homogeneous();
            let theirs = matrix([x, -y, z, to_deg(roll), -to_deg(yaw), -to_deg(pitch)]);
            let signs = [1.0, -1.0, 1.0, 1.0];
            let written = matrix(left_pose(&pose));
            for row in 0..4 {
                for column in 0..4 {
                    let mirrored = signs[row] * ours[(row, column)] * signs[column];
                    prop_assert!((theirs[row][column] - mirrored).abs() < 1e-12, "{row} {column}");
                    // Half of the last digit, of an angle three times.
                    prop_assert!((written[row][column] - mirrored).abs() < 0.6e-6, "{row} {column}");
                    prop_assert!((left_matrix(&pose)[(row, column)] - mirrored).abs() < 1e-12);
                }
            }
        }

        #[test]
        fn no_box_looks_against_a_lidar(
            lidar_yaw in -180.0..180.0f64, off in -2e-4..2e-4f64, tilt in -5.0..5.0f64, second in -3e-4..3e-4f64,
        ) {
            let lidars = [
                [0.0, 0.0, 0.0, 0.0, rounded(lidar_yaw), 0.0],
                [9.0, 0.0, 0.0, 0.0, rounded(lidar_yaw + second), 0.0],
                [5.0, 5.0, 0.0, 1.0, 33.0, rounded(tilt)],
            ];
            let angles = [0.0, rounded(lidar_yaw + 180.0 + off), 0.0];
            let turned = turned_away(angles, &lidars);
            prop_assert!((turned[1] - angles[1]).abs() < 1e-3, "{turned:?}");
            for lidar in lidars {
                // Level ones: headings are differences.
                if lidar[3] == 0.0 {
                    let apart = (turned[1] - lidar[4]).rem_euclid(360.0) - 180.0;
                    prop_assert!(apart.abs() > 0.99e-4, "{apart} {turned:?}");
                }
            }
        }
    }

    #[test]
    fn ordinary_boxes_stay_as_they_are() {
        let lidar = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for yaw in [0.0, 90.0, 179.9998, -179.9998] {
            assert_eq!(turned_away([0.0, yaw, 0.0], &[lidar])[1], yaw);
        }
        // 180 - 0.00005 is 0.00005 away; 0.00015 past the opposite it stops.
        assert_eq!(turned_away([0.0, 179.99995, 0.0], &[lidar])[1], 180.00015);
        assert_eq!(turned_away([0.0, -180.0, 0.0], &[lidar])[1], -179.99985);
    }

    #[test]
    fn a_nose_that_points_down_has_negative_pitch() {
        let pose = Pose::<World, Agent>::from_xyz_rpy([1.0, 2.0, 3.0], [0.0, deg(35.0), deg(100.0)]);
        assert_eq!(left_pose(&pose), [1.0, -2.0, 3.0, 0.0, -100.0, -35.0]);
        // Ahead and down: the first column of the matrix.
        assert!(matrix(left_pose(&pose))[2][0] < 0.0);
    }
}
