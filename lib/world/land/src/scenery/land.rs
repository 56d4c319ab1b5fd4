//! Which land is still free.

use std::collections::BTreeMap;

use crate::surfaces::{Ground, GroundLevels};
use frames::OrientedRect;

use crate::scenery::site::FOOT_M;

/// Things stand this far from water, metres.
const SHORE_M: f64 = 3.0;
/// Half the thickness of a post where it is thick, however it is turned, metres.
const POST_M: f64 = 0.1;
/// Side of a search cell, metres.
const CELL_M: f64 = 16.0;

/// Points every half metre or less over the whole of a rectangle, edges included.
fn samples(rect: &OrientedRect) -> impl Iterator<Item = [f64; 2]> {
    let rect = *rect;
    let steps = rect.half_m.map(|h| (2.0 * h / 0.5).ceil().clamp(1.0, 400.0) as usize);
    let share = |k: usize, n: usize| 2.0 * k as f64 / n as f64 - 1.0;
    (0..=steps[0])
        .flat_map(move |i| (0..=steps[1]).map(move |j| rect.at(share(i, steps[0]), share(j, steps[1]))))
}

/// The search cells that a rectangle may touch.
pub(crate) fn cells(rect: &OrientedRect) -> impl Iterator<Item = (i32, i32)> + use<> {
    let [ex, ey] = rect.extent_m();
    let of = |v: f64| (v / CELL_M).floor() as i32;
    let [x, y] = rect.centre_m;
    let (x0, x1) = (of(x - ex), of(x + ex));
    let (y0, y1) = (of(y - ey), of(y + ey));
    (x0..=x1).flat_map(move |x| (y0..=y1).map(move |y| (x, y)))
}

/// The land of a region with the objects on it so far.
#[derive(Clone)]
pub(crate) struct Land<'a> {
    ground: &'a GroundLevels,
    /// Whether there are railways.
    tracks: bool,
    taken: Vec<OrientedRect>,
    cells: BTreeMap<(i32, i32), Vec<usize>>,
}

impl<'a> Land<'a> {
    pub(crate) fn new(ground: &'a GroundLevels, tracks: bool) -> Self {
        Self { ground, tracks, taken: Vec::new(), cells: BTreeMap::new() }
    }

    /// The same land with nothing on it.
    pub(crate) fn without_things(&self) -> Self {
        Self::new(self.ground, self.tracks)
    }

    /// Whether nothing stands on a rectangle, posts taken as thick as they are.
    pub(crate) fn clear_of_posts(&self, rect: &OrientedRect) -> bool {
        let near = cells(rect).filter_map(|c| self.cells.get(&c)).flatten();
        !near.into_iter().any(|i| {
            let mut taken = self.taken[*i];
            if taken.half_m == [FOOT_M; 2] {
                taken.half_m = [POST_M; 2];
            }
            taken.meets(rect)
        })
    }

    /// Whether nothing stands on a rectangle.
    pub(crate) fn unused(&self, rect: &OrientedRect) -> bool {
        let near = cells(rect).filter_map(|c| self.cells.get(&c)).flatten();
        !near.into_iter().any(|i| self.taken[*i].meets(rect))
    }

    /// Whether no lane of any kind lies on a rectangle (sampled every half metre).
    pub(crate) fn off_road(&self, rect: &OrientedRect) -> bool {
        samples(rect).all(|[x, y]| !self.ground.cover.any(x, y))
    }

    /// Whether a rectangle keeps off all water (measured from the circle around it).
    pub(crate) fn is_dry(&self, rect: &OrientedRect) -> bool {
        let reach = SHORE_M + (rect.half_m[0] * rect.half_m[0] + rect.half_m[1] * rect.half_m[1]).sqrt();
        let [x, y] = rect.centre_m;
        self.ground.waters.iter().all(|water| water.clearance_m(x, y, reach) >= reach)
    }

    /// Whether no railway runs through a rectangle (sampled every half metre).
    pub(crate) fn off_tracks(&self, rect: &OrientedRect) -> bool {
        !self.tracks
            || samples(rect).all(|[x, y]| !self.ground.cover.at(x, y).any(|(f, _)| f.ground == Ground::Track))
    }

    /// Whether nothing stands on a rectangle, and neither lanes nor water lie there.
    pub(crate) fn free(&self, rect: &OrientedRect) -> bool {
        self.unused(rect) && self.off_road(rect) && self.is_dry(rect)
    }

    pub(crate) fn take(&mut self, rect: OrientedRect) {
        let index = self.taken.len();
        for cell in cells(&rect) {
            self.cells.entry(cell).or_default().push(index);
        }
        self.taken.push(rect);
    }
}
