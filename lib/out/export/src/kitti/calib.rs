//! Calibration files.

use nalgebra::Isometry3;

use super::pair::Pair;

/// Numbers in KITTI's way.
fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|v| format!("{v:.12e}")).collect::<Vec<_>>().join(" ")
}

/// The upper three rows of a transform, row by row.
fn rows(transform: &Isometry3<f64>) -> Vec<f64> {
    let matrix = transform.to_homogeneous();
    (0..3).flat_map(|row| (0..4).map(move |column| (row, column))).map(|at| matrix[at]).collect()
}

/// The projection of the camera: its intrinsics, and no offset, as there is one camera.
fn projection(intrinsics: [[f64; 3]; 3]) -> Vec<f64> {
    intrinsics.iter().flat_map(|row| row.iter().copied().chain([0.0])).collect()
}

/// `calib/NNNNNN.txt` of the object benchmark.
pub(super) fn object(pair: &Pair) -> String {
    text(pair, ["R0_rect:", "Tr_velo_to_cam:", "Tr_imu_to_velo:"])
}

/// `calib/SSSS.txt` of the tracking benchmark.
pub(super) fn tracking(pair: &Pair) -> String {
    text(pair, ["R_rect", "Tr_velo_cam", "Tr_imu_velo"])
}

/// All four cameras of KITTI's car are the one that there is.
fn text(pair: &Pair, [rectify, lidar, imu]: [&str; 3]) -> String {
    let camera = numbers(projection(pair.intrinsics()));
    let mut text: String = (0..4).map(|number| format!("P{number}: {camera}\n")).collect();
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    text += &format!("{rectify} {}\n", numbers(identity));
    text += &format!("{lidar} {}\n", numbers(rows(&pair.optical_from_lidar())));
    // Poses are those of the agent's origin, which takes the place of KITTI's inertial unit.
    text + &format!("{imu} {}\n", numbers(rows(&pair.lidar_from_agent())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_row_by_row() {
        let k = [[700.0, 0.0, 320.0], [0.0, 701.0, 180.0], [0.0, 0.0, 1.0]];
        assert_eq!(projection(k), [700.0, 0.0, 320.0, 0.0, 0.0, 701.0, 180.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(
            rows(&Isometry3::translation(1.0, 2.0, 3.0)),
            [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 3.0]
        );
        assert_eq!(numbers([0.5, -1.0]), "5.000000000000e-1 -1.000000000000e0");
    }
}
