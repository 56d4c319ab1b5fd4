//! How open land near streets is used: as a meadow, a wood, a field and so on, by place and seed.

use std::collections::BTreeSet;

use random::Stream;

use crate::noise::{entity, smooth};
use crate::scenery::draw::draw;
use crate::scenery::frontage::Frontage;
use crate::scenery::site::{Site, reach_m};

/// What grows on a piece of land.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Mown grass: nothing stands out of the ground.
    Lawn,
    Meadow,
    Shrubs,
    Wood,
    Orchard,
    Maize,
    Wheat,
    Vines,
}

impl Use {
    /// Whether nothing else is put there.
    pub(crate) fn is_tilled(self) -> bool {
        matches!(self, Self::Maize | Self::Wheat | Self::Vines | Self::Orchard)
    }
}

/// Fields, and their shares.
const FIELDS: [(Use, f64); 5] =
    [(Use::Maize, 0.24), (Use::Wheat, 0.30), (Use::Meadow, 0.22), (Use::Orchard, 0.12), (Use::Vines, 0.12)];
/// Side of a field, metres.
const FIELD_M: f64 = 96.0;
/// Side of a piece of land of one use at the least, metres.
pub(crate) const PLOT_M: f64 = 8.0;
/// Land is in use up to this far from the edge of a street, metres, and in town up to this far from one with
/// sidewalks: that much and a cell.
const NEAR_M: f64 = 40.0;
const TOWN_M: f64 = 32.0;
/// Side of a cell that is near a street or not, and how densely streets are looked at, metres.
const CELL_M: f64 = 16.0;
const STEP_M: f64 = 8.0;

/// The use of all land of a region.
pub(crate) struct Uses {
    seed: u64,
    near: BTreeSet<(i32, i32)>,
    town: BTreeSet<(i32, i32)>,
}

fn cell(v: f64) -> i32 {
    (v / CELL_M).floor() as i32
}

impl Uses {
    pub(crate) fn new(site: &Site<'_>, fronts: &[Frontage]) -> Self {
        let (mut near, mut town) = (BTreeSet::new(), BTreeSet::new());
        // Trees ask for places this far outside of the area, and patches for the land beside them.
        let region = site.ground.area.grown(reach_m::TREES + 3.0 * PLOT_M + NEAR_M + CELL_M);
        for front in fronts {
            let steps = (front.length_m() / STEP_M).ceil() as usize;
            let spots = (0..=steps).filter_map(|k| front.at((k as f64 * STEP_M).min(front.length_m())));
            for spot in spots.filter(|spot| region.contains(spot.point.x, spot.point.y)) {
                let (x, y) = (spot.point.x, spot.point.y);
                let around = |reach_m: f64, cells: &mut BTreeSet<(i32, i32)>| {
                    for i in cell(x - reach_m)..=cell(x + reach_m) {
                        cells.extend((cell(y - reach_m)..=cell(y + reach_m)).map(|j| (i, j)));
                    }
                };
                around(NEAR_M, &mut near);
                if spot.walk_m > 0.0 {
                    around(TOWN_M, &mut town);
                }
            }
        }
        Self { seed: site.rules.seed, near, town }
    }

    /// A number that tells pieces of land apart, below 2^63.
    pub(crate) fn entity(i: i32, j: i32) -> u64 {
        entity(i, j) & (u64::MAX >> 1)
    }

    /// A stream of a cell of a grid.
    pub(crate) fn stream(&self, topic: &str, i: i32, j: i32) -> Stream {
        Stream::new(self.seed, 0, topic, entity(i, j))
    }

    /// Noise between 0 and 1 that changes smoothly over some metres.
    fn noise(&self, topic: &str, [x, y]: [f64; 2], scale_m: f64) -> f64 {
        smooth([x / scale_m, y / scale_m], |i, j| self.stream(topic, i, j).unit())
    }

    /// The use of the land at a place; none where no street is near.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<Use> {
        let place = (cell(x), cell(y));
        if !self.near.contains(&place) {
            return None;
        }
        if self.town.contains(&place) {
            let noise = self.noise("world/uses/town", [x, y], 44.0);
            let [i, j] = [x, y].map(|v| (v / PLOT_M).floor() as i32);
            return Some(match noise {
                low if low < 0.40 => Use::Meadow,
                high if high > 0.68 => Use::Wood,
                _ if self.stream("world/uses/shrubs", i, j).chance(0.45) => Use::Shrubs,
                _ => Use::Lawn,
            });
        }
        let noise = self.noise("world/uses/country", [x, y], 84.0);
        Some(match noise {
            low if low < 0.38 => Use::Wood,
            middle if middle < 0.45 => Use::Shrubs,
            middle if middle < 0.52 => Use::Meadow,
            high if high > 0.74 => Use::Lawn,
            _ => self.field(x, y),
        })
    }

    /// What grows on the field around a place.
    fn field(&self, x: f64, y: f64) -> Use {
        let [i, j] = [x, y].map(|v| (v / FIELD_M).floor() as i32);
        let mut random = self.stream("world/uses/field", i, j);
        FIELDS[draw(&mut random, &FIELDS.map(|(_, share)| share))].0
    }

    /// Tells fields and meadows beside one another apart.
    pub(crate) fn colour(&self, x: f64, y: f64) -> u32 {
        let [i, j] = [x, y].map(|v| (v / FIELD_M).floor() as i32);
        self.stream("world/uses/colour", i, j).next_u32()
    }

    /// Which way the rows of the field around a place run, radians from east.
    pub(crate) fn rows_rad(&self, x: f64, y: f64) -> f64 {
        let [i, j] = [x, y].map(|v| (v / FIELD_M).floor() as i32);
        let turned = self.stream("world/uses/rows", i, j).chance(0.5);
        if turned { std::f64::consts::FRAC_PI_2 } else { 0.0 }
    }
}
