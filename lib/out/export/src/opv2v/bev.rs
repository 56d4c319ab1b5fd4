//! Pictures from above: 256 x 256 pixels of 0.390625 m around an agent, ahead is up, right is right; any grey
//! but black is yes.
//!
//! A point x ahead and y to the right of the agent lies at row 128 - 2.56 x, column 128 + 2.56 y.

use codecs::Array;
use codecs::images::ImageError;
use frames::{Agent, Pose, World};
use nalgebra::Point3;
use schema::BevClass;
use serde::Deserialize;
use store::Store;

use super::lanes::LaneLines;
use crate::ExportError;

/// Rows and columns.
const SIDE: usize = 256;
/// Pixels of a metre.
const PIXELS_PER_M: f64 = 2.56;
/// How far a picture reaches to each side, metres.
pub(super) const REACH_M: f64 = 0.5 * SIDE as f64 / PIXELS_PER_M;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mask(Vec<u8>);

/// A place in a picture: row and column, of which pixel (0, 0) takes 0 to 1.
pub(super) type Place = [f64; 2];

/// Where a point is in an agent's picture. Height, roll and pitch of the agent do not count.
pub(super) fn place(world_from_agent: &Pose<World, Agent>, point_m: [f64; 3]) -> Place {
    let away = Point3::from(point_m) - world_from_agent.translation();
    let (sin, cos) = frames::math::sin_cos(world_from_agent.yaw());
    let (ahead_m, left_m) = (cos * away.x + sin * away.y, cos * away.y - sin * away.x);
    let middle = 0.5 * SIDE as f64;
    [middle - PIXELS_PER_M * ahead_m, middle - PIXELS_PER_M * left_m]
}

impl Mask {
    /// All black.
    pub(super) fn new() -> Self {
        Self(vec![0; SIDE * SIDE])
    }

    fn set(&mut self, [row, column]: Place) {
        let inside = |v: f64| (0.0..SIDE as f64).contains(&v);
        if inside(row) && inside(column) {
            self.0[row as usize * SIDE + column as usize] = 255;
        }
    }

    /// Fills a convex quadrilateral: pixels whose middles lie in it, and the one that its own middle is in.
    pub(super) fn fill(&mut self, corners: [Place; 4]) {
        let middle = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 4.0);
        self.set(middle);
        let bound = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
            corners.iter().fold(start, |found, c| pick(found, c[axis])).clamp(0.0, SIDE as f64) as usize
        };
        for row in bound(0, f64::INFINITY, f64::min)..bound(0, f64::NEG_INFINITY, f64::max).min(SIDE - 1) + 1
        {
            for column in
                bound(1, f64::INFINITY, f64::min)..bound(1, f64::NEG_INFINITY, f64::max).min(SIDE - 1) + 1
            {
                let pixel = [row as f64 + 0.5, column as f64 + 0.5];
                if is_inside(&corners, pixel) {
                    self.set(pixel);
                }
            }
        }
    }

    /// Draws a line that is a pixel thin.
    pub(super) fn line(&mut self, from: Place, to: Place) {
        let across = [to[0] - from[0], to[1] - from[1]];
        // Maps reach kilometres, not more: a line is a few ten thousand pixels long.
        let steps = across[0].abs().max(across[1].abs()).ceil().min(1e6);
        for step in 0..=steps as u64 {
            let share = if steps > 0.0 { step as f64 / steps } else { 0.0 };
            self.set([from[0] + share * across[0], from[1] + share * across[1]]);
        }
    }

    /// As an 8-bit grey PNG.
    pub(super) fn to_png(&self) -> Result<Vec<u8>, ImageError> {
        crate::picture::grey_png([SIDE as u32; 2], &self.0)
    }
}

/// Whether a point lies on one side of all edges.
fn is_inside(corners: &[Place; 4], [row, column]: Place) -> bool {
    let side = |at: usize| {
        let (a, b) = (corners[at], corners[(at + 1) % 4]);
        (b[0] - a[0]) * (column - a[1]) - (b[1] - a[1]) * (row - a[0])
    };
    let sides = || (0..4).map(side);
    sides().all(|s| s >= 0.0) || sides().all(|s| s <= 0.0)
}

/// Where the roads are in a store's BEV masks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RoadChannel {
    channel: usize,
    cells: usize,
    cell_m: f64,
    pub(super) every_n_frames: u32,
}

/// What `dataset.json` says of BEV masks.
#[derive(Deserialize)]
struct BevConfig {
    classes: Vec<String>,
    cells: usize,
    cell_m: f64,
    #[serde(default = "schema::rate::every_frame")]
    every_n_frames: u32,
}

impl RoadChannel {
    /// What the store says of it; why it cannot serve, else.
    ///
    /// # Errors
    /// The store's configuration cannot be read.
    pub(super) fn read(store: &Store) -> Result<Result<Self, String>, ExportError> {
        let config = crate::source::dataset(store)?;
        let bev = config.pointer("/config/bev").cloned().unwrap_or_default();
        let Ok(bev) = serde_json::from_value::<BevConfig>(bev) else {
            return Ok(Err("dataset.json says nothing of BEV masks".into()));
        };
        let Some(channel) = bev.classes.iter().position(|class| class == BevClass::Road.name()) else {
            return Ok(Err("bev.classes has no road".into()));
        };
        let reach_m = 0.5 * bev.cells as f64 * bev.cell_m;
        if reach_m < REACH_M {
            return Ok(Err(format!("BEV masks reach {reach_m} m, the pictures {REACH_M} m")));
        }
        let BevConfig { cells, cell_m, every_n_frames, .. } = bev;
        Ok(Ok(Self { channel, cells, cell_m, every_n_frames }))
    }

    /// The roads of a mask, as a picture.
    pub(super) fn picture(&self, masks: &Array) -> Result<Mask, String> {
        let (cells, plane) = (self.cells, self.cells * self.cells);
        let road = masks.bytes.get(self.channel * plane..(self.channel + 1) * plane);
        let road = road.filter(|_| masks.shape.ends_with(&[cells, cells]));
        let road = road.ok_or_else(|| format!("BEV masks have the shape {:?}", masks.shape))?;
        let half = 0.5 * cells as f64;
        // Row 0 is ahead and column 0 left in both.
        let cell =
            |pixel: usize| half + (pixel as f64 + 0.5 - 0.5 * SIDE as f64) / PIXELS_PER_M / self.cell_m;
        let mut mask = Mask::new();
        for row in 0..SIDE {
            for column in 0..SIDE {
                if road[cell(row) as usize * cells + cell(column) as usize] != 0 {
                    mask.0[row * SIDE + column] = 255;
                }
            }
        }
        Ok(mask)
    }
}

/// The lane lines around an agent.
pub(super) fn lane_picture(lanes: &LaneLines, world_from_agent: &Pose<World, Agent>) -> Mask {
    let mut mask = Mask::new();
    let agent_from_world = world_from_agent.inverse();
    // Roads over or under this one are none of its lanes; slopes up to this much are the same road.
    let is_level = |point_m: &[f64; 3]| {
        let seen = agent_from_world * Point3::from(*point_m);
        seen.z.abs() < 2.0 + 0.1 * frames::math::hypot(seen.x, seen.y)
    };
    for line in lanes.near(world_from_agent.xyz(), 1.5 * REACH_M) {
        for ends in line.windows(2).filter(|ends| ends.iter().all(is_level)) {
            mask.line(place(world_from_agent, ends[0]), place(world_from_agent, ends[1]));
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use codecs::{DType, Scalar};

    use super::*;

    fn pixels(mask: &Mask) -> Vec<(usize, usize)> {
        (0..SIDE * SIDE).filter(|at| mask.0[*at] != 0).map(|at| (at / SIDE, at % SIDE)).collect()
    }

    /// Faces north at (100, 50): right is east.
    fn north() -> Pose<World, Agent> {
        Pose::from_xyz_rpy([100.0, 50.0, 7.0], [0.0, 0.0, frames::deg(90.0)])
    }

    #[test]
    fn up_is_ahead_and_right_is_right() {
        let near = |point, expected: Place| {
            let found = place(&north(), point);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        };
        near([100.0, 50.0, 0.0], [128.0, 128.0]);
        near([100.0, 60.0, 0.0], [102.4, 128.0]);
        near([110.0, 50.0, 0.0], [128.0, 153.6]);
    }

    #[test]
    fn a_car_has_its_pixels() {
        // 4 m long, 2 m wide, 10 m ahead of an agent that faces east.
        let agent = Pose::from_xyz_rpy([0.0; 3], [0.0; 3]);
        let corners = [[8.0, -1.0], [8.0, 1.0], [12.0, 1.0], [12.0, -1.0]];
        let mut mask = Mask::new();
        mask.fill(corners.map(|[x, y]| place(&agent, [x, y, 0.0])));
        let lit = pixels(&mask);
        // Rows 128 - 30.72 = 97.28 to 107.52, columns 125.44 to 130.56: the middles of 97 to 107 and 125 to
        // 130 are in.
        let rows: Vec<usize> = lit.iter().map(|p| p.0).collect();
        let columns: Vec<usize> = lit.iter().map(|p| p.1).collect();
        assert_eq!((rows.iter().min(), rows.iter().max()), (Some(&97), Some(&107)));
        assert_eq!((columns.iter().min(), columns.iter().max()), (Some(&125), Some(&130)));
        assert_eq!(lit.len(), 11 * 6);
        // Nothing of what is elsewhere, and the middle of what is tiny.
        let mut mask = Mask::new();
        mask.fill([[300.0, 300.0], [300.0, 301.0], [301.0, 301.0], [301.0, 300.0]]);
        mask.fill([[9.1, 9.1], [9.1, 9.2], [9.2, 9.2], [9.2, 9.1]]);
        assert_eq!(pixels(&mask), [(9, 9)]);
    }

    #[test]
    fn lines_are_a_pixel_thin() {
        let mut mask = Mask::new();
        mask.line([10.5, 3.5], [10.5, 8.5]);
        assert_eq!(pixels(&mask), [3, 4, 5, 6, 7, 8].map(|column| (10, column)));
        let mut slope = Mask::new();
        slope.line([0.5, 0.5], [4.5, 8.5]);
        let columns: Vec<usize> = pixels(&slope).iter().map(|p| p.1).collect();
        assert_eq!(columns, (0..9).collect::<Vec<_>>(), "one pixel a column");
    }

    #[test]
    fn roads_are_those_of_the_masks() {
        // Cells of half a metre, 60 m to each side; road ahead of x = 10 m, to the right of y = -20 m.
        let channel = RoadChannel { channel: 1, cells: 240, cell_m: 0.5, every_n_frames: 1 };
        let mut bytes = vec![0; 2 * 240 * 240];
        for (at, cell) in bytes[240 * 240..].iter_mut().enumerate() {
            let (x, y) = (60.0 - 0.5 * ((at / 240) as f64 + 0.5), 60.0 - 0.5 * ((at % 240) as f64 + 0.5));
            *cell = u8::from(x > 10.0 && y < -20.0);
        }
        let masks = Array { dtype: DType::Scalar(Scalar::Bool), shape: vec![2, 240, 240], bytes };
        let lit = pixels(&channel.picture(&masks).expect("fits"));
        // Row 128 - 25.6, column 128 + 51.2.
        assert!(lit.iter().all(|(row, column)| *row < 102 && *column >= 179));
        assert_eq!(lit.len(), 102 * 77);
        let other = Array { shape: vec![1, 240, 240], ..masks };
        assert!(RoadChannel { channel: 0, cells: 100, ..channel }.picture(&other).is_err());
    }
}
