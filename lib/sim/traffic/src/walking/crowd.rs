//! How walkers keep out of one another's way and off the objects there: each looks at those around and picks
//! a velocity; whatever it picks, its way until it could stand is clear of everything, and of the ways on
//! which the others could stand. So braking straight on is always safe, and nobody has to stop at once.
//!
//! Walkers are discs about their boxes. A velocity costs what it is slower than wished and off the wished
//! line, and, for the first one met on it within [`LOOK_S`], the more the sooner. Right is a little cheaper
//! than left, so that two who meet head on go to different sides.

use nalgebra::{Point3, Vector2};

use crate::grid::Grid;
use crate::walking::fixtures::{Fixture, Fixtures, off_way_m};
use crate::walking::gait::{braked, braking_way, pushed, stopping_way};

/// Side of a cell, and how far around a walker looks, metres.
const CELL_M: f64 = 5.0;
/// Walkers who would meet later than this do not mind, seconds.
const LOOK_S: f64 = 3.0;
/// Space left between walkers where there is a choice, metres.
const SPARE_M: f64 = 0.12;
/// Space left beside things where there is a choice, metres.
const BESIDE_M: f64 = 0.05;
/// Fastest step aside, m/s.
const ASIDE_MPS: f64 = 0.8;
/// Steps aside are this soft at the edges of the free width, seconds.
const EDGE_S: f64 = 0.35;
/// Who slides past something parts from it as fast as this, m/s.
const PARTS_MPS: f64 = 0.002;
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

    /// The cheapest velocity for walker `me`.
    pub(crate) fn choice(&self, me: usize, wish: &DesiredVelocity, fixtures: &Fixtures) -> Vector2<f64> {
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
        best.1
    }

    /// The velocity that walker `me` can have in the next step who pushes off towards one: that, or what of
    /// it leads past the one in the way, or it brakes. `blocked` tells what else is in the way.
    pub(crate) fn passable(
        &self,
        me: usize,
        velocity_mps: Vector2<f64>,
        fixtures: &Fixtures,
        blocked: &dyn Fn(&Vector2<f64>) -> bool,
    ) -> Vector2<f64> {
        let Some(own) = self.discs.get(me) else { return Vector2::zeros() };
        let free = |v: &Vector2<f64>| self.blocker(me, v, fixtures).is_none() && !blocked(v);
        let Some(away) = self.blocker(me, &velocity_mps, fixtures) else {
            return if blocked(&velocity_mps) { braked(own.velocity_mps) } else { velocity_mps };
        };
        let past = away.try_normalize(1e-6).map(|towards| {
            let past = velocity_mps - towards * (velocity_mps.dot(&towards) + PARTS_MPS);
            pushed(own.velocity_mps, past)
        });
        past.filter(free).unwrap_or_else(|| braked(own.velocity_mps))
    }

    /// Whether walker `me` can have a velocity in the next step.
    pub(crate) fn is_passable(&self, me: usize, velocity_mps: &Vector2<f64>, fixtures: &Fixtures) -> bool {
        self.blocker(me, velocity_mps, fixtures).is_none()
    }

    /// The way to the first person or obstacle that walker `me` could come into before it stands.
    fn blocker(&self, me: usize, velocity_mps: &Vector2<f64>, fixtures: &Fixtures) -> Option<Vector2<f64>> {
        let own = self.discs.get(me)?;
        let way = stopping_way(velocity_mps);
        let person = self.near(own.point).filter(|(j, _)| *j != me).find_map(|(_, other)| {
            let (away, reach_m) = (flat(&own.point, &other.point), own.radius_m + other.radius_m);
            let theirs = braking_way(&other.velocity_mps);
            if away.norm() >= reach_m + way.norm() + theirs.norm() {
                return None;
            }
            // Two that touch already may part.
            let blocks = if away.norm() < reach_m {
                (away - way).norm() < away.norm() + 1e-9
            } else {
                ways_apart_m(&way, &away, &theirs) < reach_m
            };
            blocks.then_some(away)
        });
        person.or_else(|| {
            let near = |f: &&Fixture| {
                let gap_m = f.gap_m(&own.point);
                if gap_m < own.radius_m {
                    f.gap_m(&(own.point + way.push(0.0))) < gap_m + 1e-9
                } else {
                    gap_m < own.radius_m + way.norm() && f.way_gap_m(&own.point, &way) < own.radius_m
                }
            };
            fixtures.near(own.point).find(near).map(|f| -f.away(&own.point))
        })
    }
}

/// Smallest distance between two straight ways, one of which begins here and the other one `away` from here,
/// metres.
fn ways_apart_m(own: &Vector2<f64>, away: &Vector2<f64>, theirs: &Vector2<f64>) -> f64 {
    let here = Vector2::zeros();
    let side = |from: &Vector2<f64>, way: &Vector2<f64>, point: &Vector2<f64>| way.perp(&(point - from));
    let (own_end, their_end) = (*own, away + theirs);
    let cut = |from: &Vector2<f64>, way: &Vector2<f64>, [a, b]: [&Vector2<f64>; 2]| {
        side(from, way, a) * side(from, way, b) < 0.0
    };
    if cut(&here, own, [away, &their_end]) && cut(away, theirs, [&here, &own_end]) {
        return 0.0;
    }
    let theirs_m = off_way_m(away, &here, own).min(off_way_m(&their_end, &here, own));
    theirs_m.min(off_way_m(&here, away, theirs)).min(off_way_m(&own_end, away, theirs))
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
    use schema::FRAME_PERIOD_S;
    use schema::footprint::Footprint;

    const AHEAD: DesiredVelocity =
        DesiredVelocity { ahead: Vector2::new(1.0, 0.0), speed_mps: 1.2, aside_m: 0.0, room_m: [-1.0, 1.0] };

    const OPEN: &dyn Fn(&Vector2<f64>) -> bool = &|_| false;

    #[test]
    fn two_who_meet_go_to_their_right() {
        let mut crowd = Crowd::default();
        let me = crowd.add(Point3::origin(), Vector2::new(1.2, 0.0), 0.35);
        crowd.add(Point3::new(3.0, 0.0, 0.0), Vector2::new(-1.2, 0.0), 0.35);
        let velocity = crowd.choice(me, &AHEAD, &Fixtures::default());
        assert!(velocity.y < -0.05 && velocity.x > 0.9, "{velocity}");
        // On a deck above there is nobody to go around.
        let above = crowd.add(Point3::new(0.0, 0.0, 5.0), Vector2::new(1.2, 0.0), 0.35);
        assert_eq!(crowd.choice(above, &AHEAD, &Fixtures::default()), Vector2::new(1.2, 0.0));
    }

    #[test]
    fn nobody_steps_into_anybody_and_those_who_touch_may_part() {
        let (mut crowd, empty) = (Crowd::default(), Fixtures::default());
        let me = crowd.add(Point3::origin(), Vector2::zeros(), 0.35);
        crowd.add(Point3::new(0.72, 0.0, 0.0), Vector2::zeros(), 0.35);
        let slow = Vector2::new(0.1, 0.0);
        assert_eq!(crowd.passable(me, slow, &empty, OPEN), slow);
        let past = crowd.passable(me, Vector2::new(0.4, 0.05), &empty, OPEN);
        assert!(past.x <= 0.0 && (past.y - 0.05).abs() < 1e-12, "{past}");
        assert_eq!(crowd.passable(me, slow, &empty, &|_| true), Vector2::zeros());
        crowd.add(Point3::new(0.0, 0.6, 0.0), Vector2::zeros(), 0.35);
        assert_eq!(crowd.passable(me, Vector2::new(0.4, 0.1), &empty, OPEN), Vector2::zeros());
        let back = Vector2::new(0.0, -0.1);
        assert_eq!(crowd.passable(me, back, &empty, OPEN), back);
    }

    #[test]
    fn two_who_run_at_each_other_stop_before_they_touch() {
        let mut places = [(Point3::origin(), 3.0), (Point3::new(12.0, 0.1, 0.0), -3.0)];
        for _ in 0..200 {
            let mut crowd = Crowd::default();
            for (point, speed_mps) in places {
                crowd.add(point, Vector2::new(speed_mps, 0.0), 0.35);
            }
            for (me, (point, speed_mps)) in places.iter_mut().enumerate() {
                let wished = Vector2::new(if me == 0 { 3.0 } else { -3.0 }, 0.0);
                let own = Vector2::new(*speed_mps, 0.0);
                // Neither of them would step aside.
                let pushed = pushed(own, wished);
                let free = crowd.is_passable(me, &pushed, &Fixtures::default());
                let next = if free { pushed } else { braked(own) };
                assert!((next.x - *speed_mps).abs() < 3.0 * FRAME_PERIOD_S);
                (*speed_mps, point.x) = (next.x, point.x + next.x * FRAME_PERIOD_S);
                crowd.moved(me, *point, next);
            }
            assert!((places[1].0 - places[0].0).norm() >= 0.7, "{places:?}");
        }
        assert!((places[1].0 - places[0].0).norm() < 0.9, "{places:?}");
    }

    #[test]
    fn ways_are_as_far_apart_as_the_nearest_of_their_points() {
        for i in 0..60 {
            let way = |turn: f64, length: f64| {
                let (sin, cos) = frames::math::sin_cos(turn);
                Vector2::new(length * cos, length * sin)
            };
            let k = f64::from(i);
            let (own, away, theirs) = (way(0.3 * k, 1.5), way(1.1 * k, 1.2), way(2.3 * k, 0.9));
            let mut nearest = f64::INFINITY;
            for a in 0..=200 {
                for b in 0..=200 {
                    let [a, b] = [a, b].map(|part| f64::from(part) / 200.0);
                    nearest = nearest.min((away + theirs * b - own * a).norm());
                }
            }
            let found = ways_apart_m(&own, &away, &theirs);
            assert!((found - nearest).abs() < 0.01, "{found} {nearest}: {own} {away} {theirs}");
        }
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
            let choice = crowd.choice(me, &wish, &fixtures);
            let next = crowd.passable(me, pushed(velocity, choice), &fixtures, OPEN);
            assert!((next - velocity).norm() < 3.0 * FRAME_PERIOD_S);
            velocity = next;
            (at.x, at.y) = (at.x + velocity.x * FRAME_PERIOD_S, at.y + velocity.y * FRAME_PERIOD_S);
            nearest = nearest.min((at.xy() - Point3::new(4.0, 0.05, 0.0).xy()).norm());
        }
        // The pole's box reaches 0.15 to 0.21 from its middle.
        assert!(nearest > 0.5 && nearest < 0.8, "{nearest}");
        assert!(at.x > 8.0 && at.y.abs() < 0.1, "{at}");
    }
}
