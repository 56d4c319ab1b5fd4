//! How walkers keep out of one another's way and off the objects there: each looks at those around and picks
//! a velocity; whatever it picks, nobody takes a step into somebody or something.
//!
//! Walkers are discs about their boxes. A velocity costs what it is slower than wished and off the wished
//! line, and, for the first one met on it within [`LOOK_S`], the more the sooner. Right is a little cheaper
//! than left, so that two who meet head on go to different sides.

use nalgebra::{Point3, Vector2};
use schema::FRAME_PERIOD_S;

use crate::grid::Grid;
use crate::walking::fixtures::{Fixture, Fixtures};

/// Side of a cell, and how far around a walker looks, metres.
const CELL_M: f64 = 5.0;
/// Walkers who would meet later than this do not mind, seconds.
const LOOK_S: f64 = 3.0;
/// Space left between walkers where there is a choice, metres.
const SPARE_M: f64 = 0.12;
/// Space left beside things where there is a choice, metres.
const BESIDE_M: f64 = 0.05;
/// Fastest change of velocity, m/s2; those who run turn as tightly as those who walk, so they may push off
/// harder by this for each m/s.
const PUSH_MPS2: f64 = 4.0;
const PUSH_PER_S: f64 = 3.0;
/// Fastest step aside, m/s.
const ASIDE_MPS: f64 = 0.8;
/// Steps aside are this soft at the edges of the free width, seconds.
const EDGE_S: f64 = 0.35;
/// Walkers on other levels do not meet, metres.
const LEVEL_M: f64 = 2.5;

/// A walker as the others see it.
#[derive(Clone, Copy, Debug)]
struct Disc {
    point: Point3<f64>,
    velocity_mps: Vector2<f64>,
    radius_m: f64,
}

/// What a walker wishes for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DesiredVelocity {
    /// Unit vector of its way.
    pub(crate) ahead: Vector2<f64>,
    pub(crate) speed_mps: f64,
    /// How far left of where it is it would like to walk, metres.
    pub(crate) aside_m: f64,
    /// Room to the right (not positive, if it is inside) and to the left (not negative), metres.
    pub(crate) room_m: [f64; 2],
}

/// All walkers, in a grid.
#[derive(Debug)]
pub(crate) struct Crowd {
    discs: Vec<Disc>,
    grid: Grid,
}

impl Default for Crowd {
    fn default() -> Self {
        Self { discs: Vec::new(), grid: Grid::new(CELL_M) }
    }
}

fn flat(from: &Point3<f64>, to: &Point3<f64>) -> Vector2<f64> {
    (to - from).xy()
}

/// The radius of the circle about a walker's box, metres.
pub(crate) fn radius_m(size_m: [f64; 3]) -> f64 {
    0.5 * (size_m[0] * size_m[0] + size_m[1] * size_m[1]).sqrt()
}

impl Crowd {
    /// Adds a walker and returns its number.
    pub(crate) fn add(&mut self, point: Point3<f64>, velocity_mps: Vector2<f64>, radius_m: f64) -> usize {
        self.grid.insert(point.x, point.y, self.discs.len());
        self.discs.push(Disc { point, velocity_mps, radius_m });
        self.discs.len() - 1
    }

    /// A walker has moved; cells stay, as nobody gets far within a step.
    pub(crate) fn moved(&mut self, me: usize, point: Point3<f64>, velocity_mps: Vector2<f64>) {
        if let Some(disc) = self.discs.get_mut(me) {
            (disc.point, disc.velocity_mps) = (point, velocity_mps);
        }
    }

    /// Those near a place on its level.
    fn near(&self, point: Point3<f64>) -> impl Iterator<Item = (usize, &Disc)> {
        let around = self.grid.around(point.x, point.y);
        around.filter_map(|j| Some((j, self.discs.get(j)?))).filter(move |(_, d)| {
            (d.point.z - point.z).abs() < LEVEL_M && flat(&point, &d.point).norm() < CELL_M
        })
    }

    /// Whether a walker of a radius can stand at a place.
    pub(crate) fn is_free(&self, point: Point3<f64>, radius_m: f64, fixtures: &Fixtures) -> bool {
        self.near(point).all(|(_, d)| flat(&point, &d.point).norm() > radius_m + d.radius_m + SPARE_M)
            && fixtures.is_free(point, radius_m + BESIDE_M)
    }

    /// Whether nobody is nearer to a place than this, counted from the circles about them.
    pub(crate) fn keeps_off(&self, point: Point3<f64>, gap_m: f64) -> bool {
        self.near(point).all(|(_, d)| flat(&point, &d.point).norm() > d.radius_m + gap_m)
    }

    /// The velocity of walker `me` in the next step: towards the cheapest one, as fast as velocities change.
    pub(crate) fn velocity(&self, me: usize, wish: &DesiredVelocity, fixtures: &Fixtures) -> Vector2<f64> {
        let Some(own) = self.discs.get(me) else { return Vector2::zeros() };
        let others: Vec<&Disc> = self.near(own.point).filter(|(j, _)| *j != me).map(|(_, d)| d).collect();
        let things: Vec<&Fixture> = fixtures.near(own.point).collect();
        let left = Vector2::new(-wish.ahead.y, wish.ahead.x);
        let [low, high] = [
            (wish.room_m[0] / EDGE_S).clamp(-ASIDE_MPS, ASIDE_MPS),
            (wish.room_m[1] / EDGE_S).clamp(-ASIDE_MPS, ASIDE_MPS),
        ];
        let line = wish.aside_m.clamp(-0.5 * ASIDE_MPS, 0.5 * ASIDE_MPS).clamp(low, high.max(low));
        let mut best = (f64::INFINITY, Vector2::zeros());
        for share in [1.0, 0.75, 0.5, 0.25, 0.0] {
            for aside in [0.0, -0.4, 0.4, -0.8, 0.8] {
                let (forward, sideways) = (share * wish.speed_mps, (line + aside).clamp(low, high.max(low)));
                let candidate = wish.ahead * forward + left * sideways;
                let off = sideways - line;
                let cost = 2.0 * (1.0 - share) + if off > 0.0 { 0.6 } else { 0.5 } * off.abs();
                if cost < best.0 {
                    let people = others.iter().map(|o| meeting(own, &candidate, o)).fold(0.0, f64::max);
                    let cost =
                        cost + things.iter().map(|f| hitting(own, &candidate, f)).fold(people, f64::max);
                    if cost < best.0 {
                        best = (cost, candidate);
                    }
                }
            }
        }
        let change = best.1 - own.velocity_mps;
        let most = PUSH_MPS2.max(PUSH_PER_S * own.velocity_mps.norm()) * FRAME_PERIOD_S;
        own.velocity_mps + change * (most / change.norm().max(most))
    }

    /// The part of a step that walker `me` can take without coming into somebody or something: all of it,
    /// what of it leads past the one in the way, or nothing.
    pub(crate) fn step(&self, me: usize, step: Vector2<f64>, fixtures: &Fixtures) -> Vector2<f64> {
        let Some(own) = self.discs.get(me) else { return Vector2::zeros() };
        // The direction of the first person or obstacle that blocks a step.
        let blocker = |step: &Vector2<f64>| {
            let person = self.near(own.point).find(|(j, d)| {
                let away = flat(&own.point, &d.point);
                let after = away - step;
                // Two that touch already may part.
                *j != me && after.norm() < own.radius_m + d.radius_m && after.norm() < away.norm() + 1e-9
            });
            let person = person.map(|(_, d)| flat(&own.point, &d.point));
            person.or_else(|| {
                let after = own.point + step.push(0.0);
                let near = |f: &&Fixture| {
                    let gap = f.gap_m(&after);
                    gap < own.radius_m && gap < f.gap_m(&own.point) + 1e-9
                };
                fixtures.near(own.point).find(near).map(|f| -f.away(&own.point))
            })
        };
        let Some(away) = blocker(&step) else { return step };
        let Some(towards) = away.try_normalize(1e-6) else { return Vector2::zeros() };
        let past = step - towards * (step.dot(&towards) + 1e-4);
        if blocker(&past).is_none() { past } else { Vector2::zeros() }
    }
}

/// What it costs a walker of some velocity to walk against a thing.
fn hitting(own: &Disc, velocity_mps: &Vector2<f64>, thing: &Fixture) -> f64 {
    let reach = own.radius_m + BESIDE_M;
    if thing.gap_m(&own.point) <= reach {
        let towards = -velocity_mps.dot(&thing.away(&own.point));
        return if towards > 1e-6 { 8.0 * (towards / velocity_mps.norm()).min(1.0) } else { 0.0 };
    }
    let cost = |time_s: f64| (0.8 * (LOOK_S / time_s.max(0.05) - 1.0)).clamp(0.0, 8.0);
    thing.entered_s(&own.point, velocity_mps, reach).map_or(0.0, cost)
}

/// What it costs a walker of some velocity to meet another one.
fn meeting(own: &Disc, velocity_mps: &Vector2<f64>, other: &Disc) -> f64 {
    let away = flat(&own.point, &other.point);
    let closing = velocity_mps - other.velocity_mps;
    let (reach, approach) = (own.radius_m + other.radius_m + SPARE_M, away.dot(&closing));
    if approach <= 0.0 {
        return 0.0;
    }
    let clear = away.norm_squared() - reach * reach;
    if clear <= 0.0 {
        return 8.0 * (approach / away.norm().max(1e-6)).min(1.0);
    }
    // First time at which the distance is the reach: |away - closing t| = reach.
    let square = closing.norm_squared();
    let root = approach * approach - square * clear;
    if root < 0.0 {
        return 0.0;
    }
    let time_s = (approach - root.sqrt()) / square;
    (0.8 * (LOOK_S / time_s.max(0.05) - 1.0)).clamp(0.0, 8.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::footprint::Footprint;

    const AHEAD: DesiredVelocity =
        DesiredVelocity { ahead: Vector2::new(1.0, 0.0), speed_mps: 1.2, aside_m: 0.0, room_m: [-1.0, 1.0] };

    #[test]
    fn two_who_meet_go_to_their_right() {
        let mut crowd = Crowd::default();
        let me = crowd.add(Point3::origin(), Vector2::new(1.2, 0.0), 0.35);
        crowd.add(Point3::new(3.0, 0.0, 0.0), Vector2::new(-1.2, 0.0), 0.35);
        let velocity = crowd.velocity(me, &AHEAD, &Fixtures::default());
        assert!(velocity.y < -0.05 && velocity.x > 0.9, "{velocity}");
        // On a deck above there is nobody to go around.
        let above = crowd.add(Point3::new(0.0, 0.0, 5.0), Vector2::new(1.2, 0.0), 0.35);
        assert_eq!(crowd.velocity(above, &AHEAD, &Fixtures::default()), Vector2::new(1.2, 0.0));
    }

    #[test]
    fn nobody_steps_into_anybody_and_those_who_touch_may_part() {
        let (mut crowd, empty) = (Crowd::default(), Fixtures::default());
        let me = crowd.add(Point3::origin(), Vector2::zeros(), 0.35);
        crowd.add(Point3::new(0.72, 0.0, 0.0), Vector2::zeros(), 0.35);
        assert_eq!(crowd.step(me, Vector2::new(0.01, 0.0), &empty), Vector2::new(0.01, 0.0));
        let past = crowd.step(me, Vector2::new(0.1, 0.05), &empty);
        assert!(past.x <= 0.0 && past.y == 0.05, "{past}");
        crowd.add(Point3::new(0.0, 0.6, 0.0), Vector2::zeros(), 0.35);
        assert_eq!(crowd.step(me, Vector2::new(0.1, 0.05), &empty), Vector2::zeros());
        assert_eq!(crowd.step(me, Vector2::new(0.0, -0.05), &empty), Vector2::new(0.0, -0.05));
    }

    #[test]
    fn a_pole_is_walked_around_and_never_into() {
        let pole = Footprint { xyz_m: [4.0, 0.05, 0.0], yaw_rad: 0.4, half_m: [0.15; 2], height_m: 5.0 };
        let mut fixtures = Fixtures::default();
        fixtures.add(&pole);
        let (mut at, mut velocity) = (Point3::origin(), Vector2::new(1.2, 0.0));
        let mut nearest = f64::INFINITY;
        for _ in 0..160 {
            let mut crowd = Crowd::default();
            let me = crowd.add(at, velocity, 0.35);
            let wish = DesiredVelocity { aside_m: -at.y, room_m: [-1.0 - at.y, 1.0 - at.y], ..AHEAD };
            let moved = crowd.step(me, crowd.velocity(me, &wish, &fixtures) * FRAME_PERIOD_S, &fixtures);
            (at.x, at.y) = (at.x + moved.x, at.y + moved.y);
            velocity = moved / FRAME_PERIOD_S;
            nearest = nearest.min((at.xy() - Point3::new(4.0, 0.05, 0.0).xy()).norm());
        }
        // The pole's box reaches 0.15 to 0.21 from its middle.
        assert!(nearest > 0.5 && nearest < 0.8, "{nearest}");
        assert!(at.x > 8.5 && at.y.abs() < 0.1, "{at}");
    }
}
