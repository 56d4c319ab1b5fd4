//! What never moves and stands in the way of walkers: poles, trunks, furniture, walls, parked cars, houses.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector2};
use schema::footprint::Footprint;

/// Side of a cell, metres.
const CELL_M: f64 = 4.0;
/// Things are looked for this far around a walker, metres.
const LOOK_M: f64 = 4.0;
/// A pedestrian farther below an obstacle's foot than this is on another level, metres.
const LEVEL_M: f64 = 2.5;

/// An upright box, turned.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fixture {
    centre: Point3<f64>,
    ahead: Vector2<f64>,
    half_m: [f64; 2],
    height_m: f64,
}

impl Fixture {
    fn new(place: &Footprint) -> Self {
        let (sin, cos) = frames::math::sin_cos(place.yaw_rad);
        Self {
            centre: place.xyz_m.into(),
            ahead: Vector2::new(cos, sin),
            half_m: place.half_m,
            height_m: place.height_m,
        }
    }

    /// A vector of the world along and across the box.
    fn local(&self, v: &Vector2<f64>) -> [f64; 2] {
        [v.dot(&self.ahead), v.y * self.ahead.x - v.x * self.ahead.y]
    }

    fn local_point(&self, point: &Point3<f64>) -> [f64; 2] {
        self.local(&(point - self.centre).xy())
    }

    fn is_level(&self, point: &Point3<f64>) -> bool {
        (self.centre.z - LEVEL_M..self.centre.z + self.height_m.max(0.5)).contains(&point.z)
    }

    /// How far a point is outside the box, metres; inside it is less than 0.
    pub(crate) fn gap_m(&self, point: &Point3<f64>) -> f64 {
        let at = self.local_point(point);
        let [a, b] = [0, 1].map(|k| at[k].abs() - self.half_m[k]);
        if a > 0.0 && b > 0.0 { (a * a + b * b).sqrt() } else { a.max(b) }
    }

    /// How far a straight way stays outside the box, metres; where it leads through it, less than 0 or 0.
    pub(crate) fn way_gap_m(&self, from: &Point3<f64>, way: &Vector2<f64>) -> f64 {
        let to = from + way.push(0.0);
        let ends_m = self.gap_m(from).min(self.gap_m(&to));
        if ends_m <= 0.0 || self.entered_s(from, way, 0.0).is_some_and(|share| share <= 1.0) {
            return ends_m.min(0.0);
        }
        let at = self.local_point(from);
        let (start, way) = (Vector2::new(at[0], at[1]), Vector2::from(self.local(way)));
        let [length, width] = self.half_m;
        let corners = [[length, width], [-length, width], [-length, -width], [length, -width]];
        corners.into_iter().map(|c| off_way_m(&Vector2::from(c), &start, &way)).fold(ends_m, f64::min)
    }

    /// The direction in which a point gets away from the box fastest.
    pub(crate) fn away(&self, point: &Point3<f64>) -> Vector2<f64> {
        let at = self.local_point(point);
        let over = [0, 1].map(|k| at[k].abs() - self.half_m[k]);
        let out = if over[0] > 0.0 && over[1] > 0.0 {
            [over[0].copysign(at[0]), over[1].copysign(at[1])]
        } else if over[0] > over[1] {
            [at[0], 0.0]
        } else {
            [0.0, at[1]]
        };
        let world = self.ahead * out[0] + Vector2::new(-self.ahead.y, self.ahead.x) * out[1];
        world.try_normalize(1e-9).unwrap_or(self.ahead)
    }

    /// When a point that moves comes nearer to the box than some distance, seconds (the box's corners taken
    /// square); none if it never does or is as near already.
    pub(crate) fn entered_s(
        &self,
        point: &Point3<f64>,
        velocity_mps: &Vector2<f64>,
        within_m: f64,
    ) -> Option<f64> {
        let (at, v) = (self.local_point(point), self.local(velocity_mps));
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for k in 0..2 {
            let reach = self.half_m[k] + within_m;
            if v[k].abs() < 1e-9 {
                if at[k].abs() >= reach {
                    return None;
                }
            } else {
                let [a, b] = [(-reach - at[k]) / v[k], (reach - at[k]) / v[k]];
                (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
            }
        }
        (first > 0.0 && first < last).then_some(first)
    }
}

/// How far a point is from a straight way, metres.
pub(crate) fn off_way_m(point: &Vector2<f64>, from: &Vector2<f64>, way: &Vector2<f64>) -> f64 {
    let away = point - from;
    let share = (away.dot(way) / way.norm_squared().max(1e-12)).clamp(0.0, 1.0);
    (away - way * share).norm()
}

/// All of them, in a grid.
#[derive(Debug, Default)]
pub(crate) struct Fixtures {
    all: Vec<Fixture>,
    cells: BTreeMap<(i32, i32), Vec<u32>>,
}

fn cell(x_m: f64, y_m: f64) -> (i32, i32) {
    ((x_m / CELL_M).floor() as i32, (y_m / CELL_M).floor() as i32)
}

impl Fixtures {
    /// Adds one, and numbers it.
    pub(crate) fn add(&mut self, place: &Footprint) -> usize {
        let index = self.all.len();
        self.all.push(Fixture::new(place));
        self.list(index, place);
        index
    }

    /// Puts one somewhere else.
    pub(crate) fn replace(&mut self, index: usize, place: &Footprint) {
        if let Some(fixture) = self.all.get_mut(index) {
            *fixture = Fixture::new(place);
            for cell in self.cells.values_mut() {
                cell.retain(|&i| i as usize != index);
            }
            self.list(index, place);
        }
    }

    /// Each is listed wherever somebody may look for it, so that a look goes to one cell.
    fn list(&mut self, index: usize, place: &Footprint) {
        let fixture = &self.all[index];
        let reach = [0, 1].map(|k| {
            let [a, b] = [fixture.ahead.x, fixture.ahead.y].map(f64::abs);
            let half = if k == 0 { [a, b] } else { [b, a] };
            half[0] * place.half_m[0] + half[1] * place.half_m[1] + LOOK_M
        });
        let [x, y, _] = place.xyz_m;
        let (low, high) = (cell(x - reach[0], y - reach[1]), cell(x + reach[0], y + reach[1]));
        for column in low.0..=high.0 {
            for row in low.1..=high.1 {
                self.cells.entry((column, row)).or_default().push(index as u32);
            }
        }
    }

    /// Those around a place on its level.
    pub(crate) fn near(&self, point: Point3<f64>) -> impl Iterator<Item = &Fixture> {
        let here = self.cells.get(&cell(point.x, point.y));
        here.into_iter()
            .flatten()
            .filter_map(|&i| self.all.get(i as usize))
            .filter(move |f| f.is_level(&point))
    }

    /// Whether a disc is clear of all of them.
    pub(crate) fn is_free(&self, point: Point3<f64>, radius_m: f64) -> bool {
        self.near(point).all(|f| f.gap_m(&point) > radius_m)
    }

    /// Whether a disc can go straight from one place to another.
    pub(crate) fn is_way_free(&self, from: Point3<f64>, to: Point3<f64>, radius_m: f64) -> bool {
        let way = to - from;
        let steps = (way.norm() / 0.25).ceil().clamp(1.0, 1000.0);
        (0..=steps as usize).all(|i| self.is_free(from + way * (i as f64 / steps), radius_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench() -> Fixture {
        // 2 m along the northeast, 0.6 m across it.
        Fixture::new(&Footprint {
            xyz_m: [10.0, 5.0, 0.0],
            yaw_rad: std::f64::consts::FRAC_PI_4,
            half_m: [1.0, 0.3],
            height_m: 0.9,
        })
    }

    #[test]
    fn gaps_are_those_to_the_nearest_of_many_points_of_the_box() {
        let bench = bench();
        let (sin, cos) = frames::math::sin_cos(std::f64::consts::FRAC_PI_4);
        for i in 0..20 {
            for j in 0..20 {
                let at = Point3::new(8.0 + 0.2 * f64::from(i), 3.0 + 0.2 * f64::from(j), 0.0);
                let mut nearest = f64::INFINITY;
                for u in -200..=200 {
                    for v in [-60, -45, -30, -15, 0, 15, 30, 45, 60] {
                        let (a, b) = (f64::from(u) / 200.0, f64::from(v) / 200.0);
                        let p = Point3::new(10.0 + a * cos - b * sin, 5.0 + a * sin + b * cos, 0.0);
                        nearest = nearest.min((p - at).norm());
                    }
                }
                let gap = bench.gap_m(&at);
                if gap > 0.0 {
                    assert!((gap - nearest).abs() < 0.01, "{gap} {nearest} at {at}");
                    let out = bench.gap_m(&(at + bench.away(&at).push(0.0) * 0.1));
                    assert!((out - gap - 0.1).abs() < 1e-9);
                } else {
                    assert!(nearest < 0.06);
                }
            }
        }
    }

    #[test]
    fn ways_stay_as_far_outside_as_the_nearest_of_their_points() {
        let bench = bench();
        for i in 0..40 {
            let turn = 0.7 * f64::from(i);
            let (sin, cos) = frames::math::sin_cos(turn);
            let from = Point3::new(10.0 + 1.7 * cos, 5.0 + 1.7 * sin, 0.0);
            let way = Vector2::new(1.3 * frames::math::cos(3.1 * turn), 1.3 * frames::math::sin(3.1 * turn));
            let along = (0..=2000).map(|k| bench.gap_m(&(from + way.push(0.0) * (f64::from(k) / 2000.0))));
            let nearest = along.fold(f64::INFINITY, f64::min);
            let found = bench.way_gap_m(&from, &way);
            let meets = nearest <= 0.0 && found <= 0.0;
            assert!(meets || (found - nearest).abs() < 1e-3, "{found} {nearest} from {from} by {way}");
        }
    }

    #[test]
    fn whoever_walks_at_it_arrives_in_time() {
        let bench = bench();
        let from = Point3::new(10.0, 0.0, 0.0);
        let velocity = Vector2::new(0.0, 1.25);
        let entered = bench.entered_s(&from, &velocity, 0.0).expect("a meeting");
        // Straight from the south onto the long side: 0.3 sqrt(2) before the middle.
        assert!((entered - (5.0 - 0.3 * 2f64.sqrt()) / 1.25).abs() < 1e-9, "{entered}");
        assert_eq!(bench.entered_s(&from, &-velocity, 0.0), None);
        assert_eq!(bench.entered_s(&from, &Vector2::new(2.0, 1.25), 0.3), None);
    }

    #[test]
    fn looks_find_what_is_there_on_their_level() {
        let house = Footprint { xyz_m: [0.0, 0.0, 1.0], yaw_rad: 0.0, half_m: [9.0, 6.0], height_m: 8.0 };
        let pole = Footprint { xyz_m: [30.0, 0.0, 0.0], yaw_rad: 0.0, half_m: [0.1; 2], height_m: 5.0 };
        let mut fixtures = Fixtures::default();
        [house, pole].iter().for_each(|place| {
            fixtures.add(place);
        });
        assert!(!fixtures.is_free(Point3::new(9.3, 0.0, 0.0), 0.35));
        assert!(fixtures.is_free(Point3::new(9.4, 0.0, 0.0), 0.35));
        // On a bridge over the house, and in a tunnel under it.
        assert!(fixtures.is_free(Point3::new(5.0, 0.0, 10.0), 0.35));
        assert!(fixtures.is_free(Point3::new(5.0, 0.0, -4.0), 0.35));
        let ends = [Point3::new(25.0, 0.0, 0.0), Point3::new(35.0, 0.3, 0.0)];
        assert!(!fixtures.is_way_free(ends[0], ends[1], 0.35));
        assert!(fixtures.is_way_free(ends[0], ends[1] + nalgebra::Vector3::y() * 3.0, 0.35));
    }
}
