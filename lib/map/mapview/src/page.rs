//! Where the world lies on the sheet.

use nalgebra::Point3;
use opendrive::Map;

/// From this many metres a pixel on, roads are drawn as lines instead of lane by lane.
pub const COARSE_FROM_M_PER_PX: f64 = 2.0;
/// Ground shown around the roads, metres and as a share of the extent.
const MARGIN_M: f64 = 15.0;
const MARGIN_SHARE: f64 = 0.03;
/// White edge of the sheet, pixels.
pub(crate) const EDGE_PX: f64 = 14.0;
/// Least and largest size of the map on the sheet, pixels.
const SIZE_RANGE_PX: [f64; 2] = [120.0, 12_000.0];

/// What to draw, and how large.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Longer side of the map on the sheet, pixels (120 to 12,000).
    pub size_px: f64,
    /// The part of the world to show; none shows everything.
    pub window: Option<Window>,
    /// Name on the sheet; none takes the network's own.
    pub title: Option<String>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self { size_px: 1600.0, window: None, title: None }
    }
}

/// A square of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its middle, metres east and north.
    pub centre_m: [f64; 2],
    /// Half its side, metres.
    pub radius_m: f64,
}

/// The sheet.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    west_m: f64,
    north_m: f64,
    pub(crate) m_per_px: f64,
    /// Top left corner of the map on the sheet.
    pub(crate) origin_px: [f64; 2],
    /// Size of the map on the sheet.
    pub(crate) map_px: [f64; 2],
}

impl Page {
    pub(crate) fn new(map: &Map, options: &ViewOptions) -> Self {
        let [west, south, east, north] = match options.window {
            Some(Window { centre_m: [x, y], radius_m }) => {
                let r = radius_m.max(1.0);
                [x - r, y - r, x + r, y + r]
            }
            None => extent(map),
        };
        let (width_m, height_m) = (east - west, north - south);
        let m_per_px = width_m.max(height_m) / options.size_px.clamp(SIZE_RANGE_PX[0], SIZE_RANGE_PX[1]);
        // A narrow map still needs room for its legend.
        let pixels = |m: f64| (m / m_per_px).round().max(0.35 * width_m.max(height_m) / m_per_px);
        let map_px = [pixels(width_m), pixels(height_m)];
        Self {
            west_m: 0.5 * (west + east) - 0.5 * map_px[0] * m_per_px,
            north_m: 0.5 * (south + north) + 0.5 * map_px[1] * m_per_px,
            m_per_px,
            origin_px: [EDGE_PX; 2],
            map_px,
        }
    }

    pub(crate) fn is_coarse(&self) -> bool {
        self.m_per_px > COARSE_FROM_M_PER_PX
    }

    /// How far a drawn line may be off the true one, metres.
    pub(crate) fn tolerance_m(&self) -> f64 {
        (0.12 * self.m_per_px).clamp(0.01, 5.0)
    }

    /// Metres as pixels.
    pub(crate) fn px(&self, metres: f64) -> f64 {
        metres / self.m_per_px
    }

    /// Metres as pixels, at least `least`.
    pub(crate) fn px_min(&self, metres: f64, least: f64) -> f64 {
        self.px(metres).max(least)
    }

    pub(crate) fn at(&self, p: &Point3<f64>) -> [f64; 2] {
        [
            self.origin_px[0] + (p.x - self.west_m) / self.m_per_px,
            self.origin_px[1] + (self.north_m - p.y) / self.m_per_px,
        ]
    }

    pub(crate) fn chain<'p>(&self, points: impl IntoIterator<Item = &'p Point3<f64>>) -> Vec<[f64; 2]> {
        points.into_iter().map(|p| self.at(p)).collect()
    }

    /// Whether anything within `margin_px` of the box around some points is on the map.
    pub(crate) fn shows<'p>(
        &self,
        points: impl IntoIterator<Item = &'p Point3<f64>>,
        margin_px: f64,
    ) -> bool {
        let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for p in points {
            let at = self.at(p);
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        (0..2).all(|axis| {
            high[axis] >= self.origin_px[axis] - margin_px
                && low[axis] <= self.origin_px[axis] + self.map_px[axis] + margin_px
        })
    }
}

/// West, south, east, north of all lanes with their margin, metres.
fn extent(map: &Map) -> [f64; 4] {
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for lane in map.lanes() {
        for point in &map.lane_polyline(lane.id, 1.0).centre {
            for (axis, value) in [point.x, point.y].into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
    }
    if low.iter().chain(&high).any(|v| !v.is_finite()) {
        return [-100.0, -100.0, 100.0, 100.0];
    }
    let margin = MARGIN_M + MARGIN_SHARE * (high[0] - low[0]).max(high[1] - low[1]);
    [low[0] - margin, low[1] - margin, high[0] + margin, high[1] + margin]
}
