//! Which land is still free.

use std::collections::BTreeMap;

use surfaces::{Ground, GroundLevels};

/// Things stand this far from water, metres.
const SHORE_M: f64 = 3.0;
/// Side of a search cell, metres.
const CELL_M: f64 = 16.0;

/// A rectangle in the plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rect {
    pub(crate) centre: [f64; 2],
    /// Direction of its first side, of length 1.
    pub(crate) axis: [f64; 2],
    pub(crate) half: [f64; 2],
}

impl Rect {
    /// A square around a point.
    pub(crate) fn around(x: f64, y: f64, half: f64) -> Self {
        Self { centre: [x, y], axis: [1.0, 0.0], half: [half; 2] }
    }

    pub(crate) fn grown(&self, by_m: f64) -> Self {
        Self { half: self.half.map(|h| h + by_m), ..*self }
    }

    /// The point at shares -1 to 1 of the half sides.
    pub(crate) fn at(&self, u: f64, v: f64) -> [f64; 2] {
        let (a, b) = (u * self.half[0], v * self.half[1]);
        [
            self.centre[0] + a * self.axis[0] - b * self.axis[1],
            self.centre[1] + a * self.axis[1] + b * self.axis[0],
        ]
    }

    /// Half extents of the upright box around it.
    fn extent(&self) -> [f64; 2] {
        let [c, s] = self.axis.map(f64::abs);
        [c * self.half[0] + s * self.half[1], s * self.half[0] + c * self.half[1]]
    }

    /// Whether two rectangles meet (separating axes).
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let apart = [other.centre[0] - self.centre[0], other.centre[1] - self.centre[1]];
        let axes = [self.axis, [-self.axis[1], self.axis[0]], other.axis, [-other.axis[1], other.axis[0]]];
        axes.iter().all(|n| {
            let reach = |r: &Self| {
                let along = (n[0] * r.axis[0] + n[1] * r.axis[1]).abs();
                let across = (n[1] * r.axis[0] - n[0] * r.axis[1]).abs();
                along * r.half[0] + across * r.half[1]
            };
            (n[0] * apart[0] + n[1] * apart[1]).abs() <= reach(self) + reach(other)
        })
    }

    /// Points every half metre or less over the whole of it, edges included.
    fn samples(&self) -> impl Iterator<Item = [f64; 2]> {
        let steps = self.half.map(|h| (2.0 * h / 0.5).ceil().clamp(1.0, 400.0) as usize);
        let share = |k: usize, n: usize| 2.0 * k as f64 / n as f64 - 1.0;
        (0..=steps[0])
            .flat_map(move |i| (0..=steps[1]).map(move |j| self.at(share(i, steps[0]), share(j, steps[1]))))
    }

    fn cells(&self) -> impl Iterator<Item = (i32, i32)> {
        let [ex, ey] = self.extent();
        let of = |v: f64| (v / CELL_M).floor() as i32;
        let (x0, x1) = (of(self.centre[0] - ex), of(self.centre[0] + ex));
        let (y0, y1) = (of(self.centre[1] - ey), of(self.centre[1] + ey));
        (x0..=x1).flat_map(move |x| (y0..=y1).map(move |y| (x, y)))
    }
}

/// The land of a region with what stands on it so far.
pub(crate) struct Land<'a> {
    ground: &'a GroundLevels,
    /// Whether there are railways.
    tracks: bool,
    taken: Vec<Rect>,
    cells: BTreeMap<(i32, i32), Vec<usize>>,
}

impl<'a> Land<'a> {
    pub(crate) fn new(ground: &'a GroundLevels, tracks: bool) -> Self {
        Self { ground, tracks, taken: Vec::new(), cells: BTreeMap::new() }
    }

    /// Whether nothing stands on a rectangle.
    pub(crate) fn unused(&self, rect: &Rect) -> bool {
        let near = rect.cells().filter_map(|c| self.cells.get(&c)).flatten();
        !near.into_iter().any(|i| self.taken[*i].meets(rect))
    }

    /// Whether no lane of any kind lies on a rectangle (sampled every half metre).
    pub(crate) fn off_road(&self, rect: &Rect) -> bool {
        rect.samples().all(|[x, y]| !self.ground.cover.any(x, y))
    }

    /// Whether a rectangle keeps off all water (measured from the circle around it).
    pub(crate) fn is_dry(&self, rect: &Rect) -> bool {
        let reach = SHORE_M + (rect.half[0] * rect.half[0] + rect.half[1] * rect.half[1]).sqrt();
        let [x, y] = rect.centre;
        self.ground.waters.iter().all(|water| water.clearance_m(x, y, reach) >= reach)
    }

    /// Whether no railway runs through a rectangle (sampled every half metre).
    pub(crate) fn off_tracks(&self, rect: &Rect) -> bool {
        !self.tracks
            || rect
                .samples()
                .all(|[x, y]| !self.ground.cover.at(x, y).any(|(f, _)| f.ground == Ground::Track))
    }

    /// Whether nothing stands on a rectangle, and neither lanes nor water lie there.
    pub(crate) fn free(&self, rect: &Rect) -> bool {
        self.unused(rect) && self.off_road(rect) && self.is_dry(rect)
    }

    pub(crate) fn take(&mut self, rect: Rect) {
        let index = self.taken.len();
        for cell in rect.cells() {
            self.cells.entry(cell).or_default().push(index);
        }
        self.taken.push(rect);
    }
}
