//! What cameras see beyond the world that is laid out around agents: hills, woods, fields, villages, a
//! skyline where more of the town is.
//!
//! It is for pictures alone: rays, boxes, masks and voxels know nothing of it. It follows from the map and
//! the season, and so is the same for all scenes, agents and frames on it. It is coarse: it begins hundreds
//! of metres off.

mod plot;
mod roads;
mod shape;
mod things;

use glam::Vec3;
use opendrive::Map;
use random::Stream;
use schema::geometry::TriMesh;

use crate::noise::{entity, smooth};
use crate::surfaces::{Field, waters};
use plot::{PLOT_M, SQUARE_M, Use};
use roads::Roads;
use shape::Shape;

/// Side of a piece; they lie on whole multiples of it in the world, metres.
pub const PIECE_M: f64 = 128.0;
/// The land of the horizon is so much lower than that around agents, which hides its edge, metres.
const SUNK_M: f64 = 1.2;
/// Hills begin this far from roads and are whole at the second distance, metres; and their height there.
const HILLS_FROM_M: [f64; 2] = [260.0, 900.0];
const HILLS_M: f64 = 70.0;
/// Hills are about so long, and woods, metres.
const HILL_M: f64 = 520.0;
const WOOD_M: f64 = 300.0;
/// Share of the land that is wood, about.
const WOODED: f64 = 0.45;
/// Share of plots that are a village.
const VILLAGES: f64 = 0.04;
/// Nearer to a road there is no wood, metres.
const OPEN_M: f64 = 56.0;

/// A piece of the horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct HorizonPiece {
    /// Where its frame's origin is in the world: the middle of its ground. Metres.
    pub origin_m: [f64; 3],
    /// Its triangles.
    pub mesh: TriMesh,
}

/// The pieces that are between two distances from any of some places in the world, metres; row by row.
/// `is_winter` leaves fields brown and woods bare.
#[must_use]
pub fn horizon(
    map: &Map,
    (seed, is_winter): (u64, bool),
    places: &[[f64; 2]],
    [from_m, to_m]: [f64; 2],
) -> Vec<HorizonPiece> {
    let cells = cells(places, [from_m, to_m]);
    let (Some(first), Some(last)) = (corner(&cells, i64::min), corner(&cells, i64::max)) else {
        return Vec::new();
    };
    let [low, high] = [first.map(|v| v as f64 * PIECE_M), last.map(|v| (v + 1) as f64 * PIECE_M)];
    let land = Land {
        field: Field::new(map, &waters(map)),
        roads: Roads::new(map, low, high, HILLS_FROM_M[1]),
        seed,
        is_winter,
    };
    cells.into_iter().map(|cell| land.piece(cell)).collect()
}

/// The least or greatest column and row.
fn corner(cells: &[[i64; 2]], of: fn(i64, i64) -> i64) -> Option<[i64; 2]> {
    cells.iter().copied().reduce(|a, b| [of(a[0], b[0]), of(a[1], b[1])])
}

/// Columns and rows of pieces whose middles are so far from any of some places.
fn cells(places: &[[f64; 2]], [from_m, to_m]: [f64; 2]) -> Vec<[i64; 2]> {
    let near = |place: &[f64; 2]| {
        let [[c0, r0], [c1, r1]] = [-to_m, to_m].map(|by| place.map(|v| ((v + by) / PIECE_M).floor() as i64));
        let all = (r0..=r1).flat_map(move |row| (c0..=c1).map(move |column| [row, column]));
        let place = *place;
        all.filter(move |[row, column]| {
            let off = [(place[0], column), (place[1], row)].map(|(v, c)| (*c as f64 + 0.5) * PIECE_M - v);
            (from_m..=to_m).contains(&(off[0] * off[0] + off[1] * off[1]).sqrt())
        })
    };
    let all: std::collections::BTreeSet<[i64; 2]> = places.iter().flat_map(near).collect();
    all.into_iter().map(|[row, column]| [column, row]).collect()
}

/// The land far off.
struct Land {
    field: Field,
    roads: Roads,
    seed: u64,
    is_winter: bool,
}

impl Land {
    /// Height of the ground.
    fn height_m(&self, x: f64, y: f64) -> f64 {
        let [from, to] = HILLS_FROM_M;
        let away = ((self.roads.away_m(x, y) - from) / (to - from)).clamp(0.0, 1.0);
        let rise = away * away * (3.0 - 2.0 * away);
        let hills = 0.7 * self.noise(0, x / HILL_M, y / HILL_M)
            + 0.3 * self.noise(1, 2.7 * x / HILL_M, 2.7 * y / HILL_M);
        self.field.height(x, y) - SUNK_M + HILLS_M * rise * hills
    }

    /// Smooth noise, 0 to 1, about one hill a unit.
    fn noise(&self, which: u64, x: f64, y: f64) -> f64 {
        let stream = Stream::new(self.seed, which, "land/horizon/noise", 0);
        smooth([x, y], |i, j| f64::from(stream.at(entity(i, j))[0]) / f64::from(u32::MAX))
    }

    /// What a plot is used for, by its middle.
    fn used_for(&self, x: f64, y: f64, draw: &mut Stream) -> Use {
        let is_village = draw.chance(VILLAGES);
        if self.roads.is_town(x, y) {
            return Use::Town;
        }
        if self.roads.away_m(x, y) < OPEN_M {
            return Use::Meadow;
        }
        match self.noise(2, x / WOOD_M, y / WOOD_M) {
            wooded if wooded > 1.0 - WOODED => Use::Wood,
            _ if is_village => Use::Village,
            _ => Use::Field,
        }
    }

    fn piece(&self, [column, row]: [i64; 2]) -> HorizonPiece {
        let [west, south] = [column, row].map(|c| c as f64 * PIECE_M);
        let middle = [west + 0.5 * PIECE_M, south + 0.5 * PIECE_M];
        let origin_m = [middle[0], middle[1], self.height_m(middle[0], middle[1])];
        let mut shape = Shape::default();
        for plot in 0..4 {
            let [x, y] = [west + f64::from(plot % 2) * PLOT_M, south + f64::from(plot / 2) * PLOT_M];
            let [i, j] = [x, y].map(|v| (v / PLOT_M).round() as i32);
            let mut draw = Stream::new(self.seed, 0, "land/horizon", entity(i, j));
            let used_for = self.used_for(x + 0.5 * PLOT_M, y + 0.5 * PLOT_M, &mut draw);
            let local = |x: f64, y: f64| {
                let z = self.height_m(x, y);
                Vec3::new((x - origin_m[0]) as f32, (y - origin_m[1]) as f32, (z - origin_m[2]) as f32)
            };
            things::add_ground(&mut shape, used_for, self.is_winter, &mut draw, |i, j| {
                local(x + i * SQUARE_M, y + j * SQUARE_M)
            });
            things::add(&mut shape, used_for, self.is_winter, &mut draw, |i, j| {
                let (x, y) = (x + i, y + j);
                (local(x, y), self.roads.away_m(x, y))
            });
        }
        HorizonPiece { origin_m, mesh: shape.finish() }
    }
}

#[cfg(test)]
mod tests;
