//! Voxel grids.

use serde::Serialize;

/// What a sweep along z does between the cells in which things are met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ZFill {
    /// Nothing.
    #[default]
    None,
    /// From what is met from below to what is next met from the top, where both have one label.
    Scanline,
    /// All cells between the highest and the lowest that were met are labelled by what touches them.
    BoxSweep,
}

impl ZFill {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Scanline, Self::BoxSweep];

    /// Name in configurations.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Scanline => "scanline",
            Self::BoxSweep => "boxsweep",
        }
    }
}

/// Along which directions columns are swept: from the top, the bottom, the front, ...
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)] // The names are their own documentation.
pub struct SweepSettings {
    pub z_top: bool,
    pub z_bottom: bool,
    pub x_front: bool,
    pub x_back: bool,
    pub y_left: bool,
    pub y_right: bool,
    /// What is between, along z.
    pub z_fill: ZFill,
}

impl SweepSettings {
    /// Whether no direction is swept.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        let Self { z_top, z_bottom, x_front, x_back, y_left, y_right, .. } = *self;
        !(z_top || z_bottom || x_front || x_back || y_left || y_right)
    }

    /// Whether what is between can be filled by the sweeps there are.
    #[must_use]
    pub fn can_fill(&self) -> bool {
        match self.z_fill {
            ZFill::None => true,
            ZFill::Scanline => self.z_top && self.z_bottom,
            ZFill::BoxSweep => self.z_top,
        }
    }
}

impl Default for SweepSettings {
    /// From the top and the bottom.
    fn default() -> Self {
        Self {
            z_top: true,
            z_bottom: true,
            x_front: false,
            x_back: false,
            y_left: false,
            y_right: false,
            z_fill: ZFill::None,
        }
    }
}

/// How the insides of closed objects are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FillingRule {
    /// Class by class in chunks, as the published tool does.
    #[default]
    Chunk,
    /// As its paper says: what meets one label first in all six directions takes it.
    Paper,
    /// Whatever is closed is full.
    Solid,
}

impl FillingRule {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Chunk, Self::Paper, Self::Solid];

    /// Name in configurations.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Chunk => "chunk",
            Self::Paper => "paper",
            Self::Solid => "solid",
        }
    }
}

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
    /// Every cell is tested for what touches it; else sweeps find what is met first.
    pub full_sweep: bool,
    /// The sweeps, where not every cell is tested.
    pub sweeps: SweepSettings,
    /// List occupied cells instead of writing whole grids.
    pub sparse: bool,
    /// Write whose each occupied cell is.
    pub ids: bool,
    /// Write how each occupied cell moves.
    pub flow: bool,
    /// How insides are filled.
    pub fill_rule: FillingRule,
    /// Write which cells the agent's lidars saw free, occupied, or not at all. Says nothing of the grid itself: the stage
    /// that makes it does not see this.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub observed: bool,
    /// Grids are made at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
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
            full_sweep: true,
            sweeps: SweepSettings::default(),
            sparse: false,
            ids: false,
            flow: false,
            fill_rule: FillingRule::Chunk,
            observed: false,
            every_n_frames: 1,
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
        } else if x > Self::MAX_AXIS {
            format!("at most {} along an axis are possible", Self::MAX_AXIS)
        } else if !self.sparse && self.cells() > Self::MAX_CELLS {
            format!("at most {} in all are possible, unless they are listed (`sparse`)", Self::MAX_CELLS)
        } else if self.observed && self.cells() > Self::MAX_CELLS {
            format!("at most {} in all are possible with `observed`, which is never listed", Self::MAX_CELLS)
        } else if !self.full_sweep && (self.sparse || self.ids || self.flow) {
            return Some("lists of cells, ids and flow need `full_sweep`".into());
        } else if !self.full_sweep && self.sweeps.is_nothing() {
            return Some("without `full_sweep` there must be a direction to sweep".into());
        } else if !self.full_sweep && !self.sweeps.can_fill() {
            let problem = "fills between what sweeps from the top and from the bottom meet: use both (`boxsweep`: the first)";
            return Some(format!("`z_fill_mode = \"{}\"` {problem}", self.sweeps.z_fill.name()));
        } else {
            return None;
        };
        Some(format!("{x} x {y} x {z} cells of {} m: {rule}", self.voxel_m))
    }

    /// What archives of grids say of themselves: these settings as a JSON object.
    ///
    /// # Errors
    /// It cannot be written as JSON, which is a bug.
    pub fn describe(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// Cells in all.
    #[must_use]
    pub fn cells(&self) -> u64 {
        self.shape().iter().map(|&n| n as u64).product()
    }

    /// Whether insides are filled: not those of lists of cells.
    #[must_use]
    pub fn is_filled(&self) -> bool {
        !self.sparse
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
    fn sweeps_need_directions() {
        let with = |sweeps, ids| {
            OccupancySettings { full_sweep: false, sweeps, ids, ..OccupancySettings::default() }.problem()
        };
        let both = SweepSettings::default();
        assert_eq!(with(both.clone(), false), None);
        assert!(with(both.clone(), true).is_some_and(|p| p.contains("full_sweep")));
        let top = SweepSettings { z_bottom: false, ..both.clone() };
        assert!(with(SweepSettings { z_top: false, ..top.clone() }, false).is_some());
        assert_eq!(with(SweepSettings { z_fill: ZFill::BoxSweep, ..top.clone() }, false), None);
        assert!(with(SweepSettings { z_fill: ZFill::Scanline, ..top }, false).is_some());
        assert_eq!(with(SweepSettings { z_fill: ZFill::Scanline, ..both }, false), None);
    }

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
        let fine = |sparse| OccupancySettings { voxel_m: 0.02, sparse, ..OccupancySettings::default() };
        assert_eq!(fine(true).shape(), [6400, 6400, 400]);
        assert_eq!((fine(true).problem(), fine(false).problem().is_some()), (None, true));
        assert!(
            OccupancySettings { observed: true, ..fine(true) }
                .problem()
                .is_some_and(|p| p.contains("observed"))
        );
        assert!(problem(2048.25, 0.5, 0.0, 1.0).is_some(), "8193 along an axis");
        assert!(problem(1.0, 5.0, -1.0, 7.0).is_some_and(|p| p.contains("0 x 0 x 2")));
        assert!(problem(64.0, 0.1, 7.0, -1.0).is_some(), "upside down");
    }
}
