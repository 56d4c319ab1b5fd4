//! How far roads are, coarsely.

use opendrive::Map;

/// Side of a cell, metres.
const CELL_M: f64 = 32.0;
/// Roads are sampled this densely, metres.
const SAMPLE_M: f64 = 16.0;
/// So many of the cells around one hold a road in town: of five by five.
const IN_TOWN: usize = 9;
/// Steps to the next cell along an axis and aslant, as fifths of a cell's side (Borgefors 1986).
const STEPS: [i32; 2] = [5, 7];

/// Distances to roads over a region and around it.
pub(super) struct Roads {
    low: [f64; 2],
    size: [usize; 2],
    /// Whether a road is there.
    has_road: Vec<bool>,
    /// To the next cell with a road, in fifths of a cell.
    fifths: Vec<i32>,
}

impl Roads {
    /// Of a region, from roads in it and so far around it.
    pub(super) fn new(map: &Map, low: [f64; 2], high: [f64; 2], around_m: f64) -> Self {
        let low = low.map(|v| ((v - around_m) / CELL_M).floor() * CELL_M);
        let size = [0, 1].map(|k| ((high[k] + around_m - low[k]) / CELL_M).ceil() as usize + 1);
        let mut has_road = vec![false; size[0] * size[1]];
        for road in 0..map.network().roads.len() as u32 {
            let length = map.road_length(road).unwrap_or(0.0);
            let pieces = (length / SAMPLE_M).ceil().clamp(1.0, 1e5) as usize;
            for i in 0..=pieces {
                let Some(p) = map.road_point(road, length * i as f64 / pieces as f64, 0.0, 0.0) else {
                    continue;
                };
                let [c, r] = [(p.x, 0), (p.y, 1)].map(|(v, k)| ((v - low[k]) / CELL_M).floor());
                if c >= 0.0 && r >= 0.0 && c < size[0] as f64 && r < size[1] as f64 {
                    has_road[r as usize * size[0] + c as usize] = true;
                }
            }
        }
        let far = i32::MAX / 2;
        let fifths = has_road.iter().map(|has_road| if *has_road { 0 } else { far }).collect();
        let mut roads = Self { low, size, has_road, fifths };
        roads.spread();
        roads
    }

    /// Two sweeps over the cells, each of which learns of its neighbours.
    fn spread(&mut self) {
        let [columns, rows] = self.size.map(|n| n as i64);
        let before = [(-1, 0), (-1, -1), (0, -1), (1, -1)];
        for pass in [1, -1] {
            for k in 0..columns * rows {
                let at = if pass > 0 { k } else { columns * rows - 1 - k };
                for (dx, dy) in before {
                    let (c, r) = (at % columns + pass * dx, at / columns + pass * dy);
                    if (0..columns).contains(&c) && (0..rows).contains(&r) {
                        let step = STEPS[usize::from(dx != 0 && dy != 0)];
                        let over = self.fifths[(r * columns + c) as usize] + step;
                        self.fifths[at as usize] = self.fifths[at as usize].min(over);
                    }
                }
            }
        }
    }

    fn cell(&self, x: f64, y: f64) -> [usize; 2] {
        [(x, 0), (y, 1)].map(|(v, k)| {
            let c = ((v - self.low[k]) / CELL_M).floor().clamp(0.0, (self.size[k] - 1) as f64);
            c as usize
        })
    }

    /// Distance to the next road, metres, between cells' middles.
    pub(super) fn away_m(&self, x: f64, y: f64) -> f64 {
        let axis = |v: f64, k: usize| {
            let at = ((v - self.low[k]) / CELL_M - 0.5).clamp(0.0, (self.size[k] - 1) as f64);
            let first = at.floor() as usize;
            (first, (first + 1).min(self.size[k] - 1), at - first as f64)
        };
        let ((c0, c1, u), (r0, r1, v)) = (axis(x, 0), axis(y, 1));
        let at =
            |c: usize, r: usize| f64::from(self.fifths[r * self.size[0] + c]) * CELL_M / f64::from(STEPS[0]);
        let row = |r: usize| at(c0, r) + u * (at(c1, r) - at(c0, r));
        row(r0) + v * (row(r1) - row(r0))
    }

    /// Whether a place has streets all around.
    pub(super) fn is_town(&self, x: f64, y: f64) -> bool {
        let [c, r] = self.cell(x, y);
        let [columns, rows] = [(c, 0), (r, 1)].map(|(v, k)| v.saturating_sub(2)..(v + 3).min(self.size[k]));
        let with_roads = rows.flat_map(|row| columns.clone().map(move |column| row * self.size[0] + column));
        with_roads.filter(|cell| self.has_road[*cell]).count() >= IN_TOWN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_roads() {
        let lane = || testkit::both_ways(&[(opendrive::LaneType::Driving, 3.5)]);
        let map = testkit::map(vec![testkit::road("1", [0.0, 0.0], 0.0, 600.0, lane())]);
        let roads = Roads::new(&map, [-500.0, -500.0], [1100.0, 700.0], 200.0);
        for (x, y) in [(300.0f64, 0.0f64), (300.0, 400.0), (-300.0, 0.0), (900.0, 300.0), (100.0, -350.0)] {
            let off = x - x.clamp(0.0, 600.0);
            let exact = (off * off + y * y).sqrt();
            // Half a cell, and what steps of 45 degrees are longer by.
            assert!(
                (roads.away_m(x, y) - exact).abs() < 24.0 + 0.08 * exact,
                "{x} {y}: {}",
                roads.away_m(x, y)
            );
        }
        assert!(!roads.is_town(300.0, 0.0));
    }
}
