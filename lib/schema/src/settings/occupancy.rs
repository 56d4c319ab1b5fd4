//! Voxel grids.

use serde::Serialize;

/// A voxel grid around an agent, turning fully with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OccupancySettings {
    /// Write voxel grids.
    pub enabled: bool,
    /// The grid reaches this far ahead, behind, left and right, metres (64).
    pub range_m: f64,
    /// Cell size, metres (0.1).
    pub voxel_m: f64,
    /// Lower face above the grid origin, metres (-1).
    pub lower_m: f64,
    /// Upper face above the grid origin, metres (7).
    pub upper_m: f64,
    /// Height of the grid origin above the agent's origin, metres (0.02).
    pub mount_z_m: f64,
    /// Leave out the carrying agent's own body.
    pub ignore_self: bool,
}

impl Default for OccupancySettings {
    fn default() -> Self {
        Self {
            enabled: true,
            range_m: 64.0,
            voxel_m: 0.1,
            lower_m: -1.0,
            upper_m: 7.0,
            mount_z_m: 0.02,
            ignore_self: false,
        }
    }
}

impl OccupancySettings {
    /// Most cells of a grid: 1 GiB, next to a stage's other data.
    pub const MAX_CELLS: u64 = 1 << 30;
    /// Most cells along one axis, so that positions in cells are exact to a thousandth in `f32`.
    pub const MAX_AXIS: usize = 8192;
    /// Most layers: filling holds a column of cells in registers.
    pub const MAX_LAYERS: usize = 512;

    /// Why no such grid can be made, if none can.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        if !(self.voxel_m.is_finite() && self.voxel_m > 0.0 && self.lower_m.is_finite()) {
            return Some("cell size and lower face must be finite, the size above 0".into());
        }
        let shape = self.shape();
        let [x, y, z] = shape;
        let rule = if shape.contains(&0) {
            "there must be one along every axis".to_owned()
        } else if z > Self::MAX_LAYERS {
            format!("at most {} layers are possible", Self::MAX_LAYERS)
        } else if x > Self::MAX_AXIS || shape.iter().map(|&n| n as u64).product::<u64>() > Self::MAX_CELLS {
            format!("at most {} along an axis and {} in all are possible", Self::MAX_AXIS, Self::MAX_CELLS)
        } else {
            return None;
        };
        Some(format!("{x} x {y} x {z} cells of {} m: {rule}", self.voxel_m))
    }

    /// Cells along x, y, z: `(2 range / voxel, 2 range / voxel, (upper - lower) / voxel)`, rounded.
    #[must_use]
    pub fn shape(&self) -> [usize; 3] {
        let across = (2.0 * self.range_m / self.voxel_m).round() as usize;
        [across, across, ((self.upper_m - self.lower_m) / self.voxel_m).round() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_included() {
        let problem = |range_m, voxel_m, lower_m, upper_m| {
            OccupancySettings { range_m, voxel_m, lower_m, upper_m, ..OccupancySettings::default() }.problem()
        };
        assert_eq!(OccupancySettings::default().problem(), None);
        assert_eq!(problem(16.0, 0.5, -56.0, 200.0), None, "512 layers");
        assert!(problem(16.0, 0.5, -56.5, 200.0).is_some_and(|p| p.contains("64 x 64 x 513")));
        assert_eq!(problem(2048.0, 0.5, 0.0, 8.0), None, "8192 x 8192 x 16 are 2^30 cells");
        assert!(problem(2048.0, 0.5, 0.0, 8.5).is_some(), "one layer more");
        assert!(problem(2048.25, 0.5, 0.0, 1.0).is_some(), "8193 along an axis");
        assert!(problem(1.0, 5.0, -1.0, 7.0).is_some_and(|p| p.contains("0 x 0 x 2")));
        assert!(problem(64.0, 0.1, 7.0, -1.0).is_some(), "upside down");
    }
}
