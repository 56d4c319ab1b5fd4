//! The squares that the static world of a map is made and kept in.

use std::fmt;

/// Side of a tile, metres.
pub const TILE_M: f64 = 256.0;
/// What belongs to a tile reaches at most this far beyond it, metres: wide roads, houses, crowns of trees.
pub const TILE_OVERHANG_M: f64 = 64.0;

/// A tile, by its place in the grid whose corner is the world's origin. Tiles are ordered by column, then
/// row.
///
/// ```
/// use schema::tile::TileIndex;
///
/// let tile = TileIndex::at(300.0, -1.0);
/// assert_eq!((tile, tile.low_m()), (TileIndex { x: 1, y: -1 }, [256.0, -256.0]));
/// // 44 m west of the place begins the next tile.
/// assert_eq!(tile.distance_m(256.0 - 44.0, -1.0), 44.0);
/// assert_eq!(TileIndex::near(300.0, -100.0, 45.0), [TileIndex { x: 0, y: -1 }, tile]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileIndex {
    /// Column, from west to east.
    pub x: i32,
    /// Row, from south to north.
    pub y: i32,
}

impl TileIndex {
    /// The tile that a place of the plan lies in, metres.
    #[must_use]
    pub fn at(x_m: f64, y_m: f64) -> Self {
        Self { x: (x_m / TILE_M).floor() as i32, y: (y_m / TILE_M).floor() as i32 }
    }

    /// Its south-western corner, metres.
    #[must_use]
    pub fn low_m(self) -> [f64; 2] {
        [self.x, self.y].map(|i| f64::from(i) * TILE_M)
    }

    /// How far a place of the plan is from the tile, metres; 0 within it.
    #[must_use]
    pub fn distance_m(self, x_m: f64, y_m: f64) -> f64 {
        let low = self.low_m();
        let off = |v: f64, low: f64| (low - v).max(v - low - TILE_M).max(0.0);
        let [dx, dy] = [off(x_m, low[0]), off(y_m, low[1])];
        (dx * dx + dy * dy).sqrt()
    }

    /// The tiles that are not farther than this from a place, in their order.
    #[must_use]
    pub fn near(x_m: f64, y_m: f64, reach_m: f64) -> Vec<Self> {
        // A tile that ends just there is near, too.
        let low = [x_m, y_m].map(|v| ((v - reach_m) / TILE_M).ceil() as i32 - 1);
        let (low, high) = (Self { x: low[0], y: low[1] }, Self::at(x_m + reach_m, y_m + reach_m));
        let all = (low.x..=high.x).flat_map(|x| (low.y..=high.y).map(move |y| Self { x, y }));
        all.filter(|tile| tile.distance_m(x_m, y_m) <= reach_m).collect()
    }
}

/// As in the names of folders.
impl fmt::Display for TileIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}_{}", self.x, self.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_near_a_place_are_those_that_a_disc_touches() {
        for (x, y, reach) in [(10.0, 20.0, 300.0), (-256.0, 511.9, 100.0), (128.0, 128.0, 128.0)] {
            let near = TileIndex::near(x, y, reach);
            assert!(near.is_sorted() && !near.is_empty());
            for tile in (-5..5).flat_map(|x| (-5..5).map(move |y| TileIndex { x, y })) {
                // The nearest of a fine grid of points of the tile.
                let low = tile.low_m();
                let points = (0..=64).flat_map(|i| (0..=64).map(move |j| [i, j].map(|k| f64::from(k) * 4.0)));
                let far = points.map(|[u, v]| {
                    let (dx, dy) = (low[0] + u - x, low[1] + v - y);
                    (dx * dx + dy * dy).sqrt()
                });
                let nearest = far.fold(f64::INFINITY, f64::min);
                let distance = tile.distance_m(x, y);
                assert!((distance - 1e-9..distance + 3.0).contains(&nearest), "{distance} {nearest}");
                assert_eq!(near.contains(&tile), tile.distance_m(x, y) <= reach, "{tile}");
            }
        }
    }
}
