//! Voxel grids.

use crate::key::{choice, settings};
use crate::reader::Section;

choice! {
    /// What a sweep along z does between the cells in which things are met.
    pub enum ZFill {
        /// Nothing.
        #[default]
        None = "none",
        /// From what is met from below to what is next met from the top, where both have one label.
        Scanline = "scanline",
        /// All cells between the highest and the lowest that were met are labelled by what touches them.
        BoxSweep = "boxsweep",
    }
}

settings! {
    /// Along which directions columns are swept: from the top, the bottom, the front, ...
    #[derive(Eq)]
    pub struct SweepSettings {
        /// Without `full_sweep`: sweep columns from the top.
        z_top: bool = true, named("use_z_top"), yaml_in("voxel_detector_properties", "use_z_top");
        /// Without `full_sweep`: sweep columns from the bottom.
        z_bottom: bool = true, named("use_z_bottom"), yaml_in("voxel_detector_properties", "use_z_bottom");
        /// Without `full_sweep`: sweep columns from the front.
        x_front: bool = false, named("use_x_front"), yaml_in("voxel_detector_properties", "use_x_front");
        /// Without `full_sweep`: sweep columns from the back.
        x_back: bool = false, named("use_x_back"), yaml_in("voxel_detector_properties", "use_x_back");
        /// Without `full_sweep`: sweep columns from the left.
        y_left: bool = false, named("use_y_left"), yaml_in("voxel_detector_properties", "use_y_left");
        /// Without `full_sweep`: sweep columns from the right.
        y_right: bool = false, named("use_y_right"), yaml_in("voxel_detector_properties", "use_y_right");
        /// Between what sweeps from top and bottom meet: nothing; `scanline` one label where both have it;
        /// `boxsweep` what touches each cell.
        z_fill: ZFill = ZFill::None, named("z_fill_mode"), choice(), yaml_in("voxel_detector_properties", "z_fill_mode");
    }
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

choice! {
    /// How the insides of closed objects are filled.
    pub enum FillingRule {
        /// Class by class in chunks, as the published tool does.
        #[default]
        Chunk = "chunk",
        /// As its paper says: what meets one label first in all six directions takes it.
        Paper = "paper",
        /// Whatever is closed is full.
        Solid = "solid",
    }
}

settings! {
    /// A voxel grid around an agent, turning fully with it.
    pub struct OccupancySettings {
        /// Write voxel grids.
        enabled: bool = true, yaml("use_voxel_detector");
        /// Reach ahead, behind, left and right, m.
        range_m: f64 = 64.0, within(1.0..=500.0), yaml("voxel_detector_range");
        /// Cell size, m.
        voxel_m: f64 = 0.1, within(0.02..=5.0), yaml("voxel_size");
        /// Lower face above the grid's origin, m.
        lower_m: f64 = -1.0, within(-100.0..=100.0), yaml("voxel_detector_lower_limit");
        /// Upper face above the grid's origin, m.
        upper_m: f64 = 7.0, within(-100.0..=100.0), yaml("voxel_detector_upper_limit");
        /// Grid origin above the agent's origin, m.
        mount_z_m: f64 = 0.02, within(-10.0..=100.0);
        /// Leave out the carrying agent's own body.
        ignore_self: bool = false, yaml_in("voxel_detector_properties", "ignore_self");
        /// Test every cell for what touches it; else sweeps along the grid's axes find what is met first.
        full_sweep: bool = true, yaml_in("voxel_detector_properties", "full_sweep");
        /// The sweeps, where not every cell is tested.
        sweeps: SweepSettings = SweepSettings::default(), flat();
        /// List occupied cells (`occupancy_cells/`) instead of writing whole grids; they are not filled then.
        sparse: bool = false;
        /// Write whose each occupied cell is (`occupancy_ids/`).
        ids: bool = false;
        /// Write the velocity of each occupied cell (`occupancy_flow/`).
        flow: bool = false;
        /// How insides are filled: `chunk` by class in chunks, as SimBEV2X does; `paper` where all six
        /// directions meet one label first; `solid` whatever is closed.
        fill_rule: FillingRule = FillingRule::Chunk, choice();
        /// Write which cells the agent's lidars saw free, occupied or not at all (`occupancy_observed/`); one
        /// of them must sweep at every frame that has a grid.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        observed: bool = false;
        /// Grids are made at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
    rule possible;
}

fn possible(s: &Section<'_>, grid: &OccupancySettings) {
    if grid.lower_m >= grid.upper_m {
        s.fault_at_any(&["lower_m", "upper_m"], format!("`{}` is not below upper_m", s.path_of("lower_m")));
    } else if let Some(problem) = grid.problem() {
        let keys = ["voxel_m", "range_m", "upper_m", "lower_m"];
        s.fault_at_any(&keys, format!("`{}`: {problem}", s.path()));
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
