//! A hilly old town: winding streets round a hill with a market at its top, lanes between them, alleys that
//! end.

use frames::math::cos;
use frames::wrap_pi;
use random::Stream;
use std::f64::consts::{PI, TAU};

use super::graph::{Graph, PointId, empty, first_that_builds, polar};
use crate::layout::{Control, Layout, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Side};
use crate::terrain::{Hill, Terrain, Wave};

/// Speed limits of the street round the town, streets and lanes, km/h.
const WALL_KMH: f64 = 50.0;
const STREET_KMH: f64 = 30.0;
const LANE_KMH: f64 = 20.0;
const PARKING_M: f64 = 2.0;
/// Narrow lanes and their sidewalks, metres.
const NARROW_M: f64 = 2.8;
const NARROW_SIDEWALK_M: f64 = 1.5;
/// Steepest streets, rise over run.
const GRADE: f64 = 0.12;
/// Greatest angle, radians, and least distance, metres, between two points of a street round the hill.
const STEP_RAD: f64 = 0.42;
const STEP_M: f64 = 38.0;
/// Least distance between the ends of two lanes on a street, and how far a lane slants, metres.
const FOOT_M: f64 = 46.0;
const SLANT_M: [f64; 2] = [34.0, 68.0];
/// Where a lane turns across the slope, as a share of the way between two streets; radius and clothoid,
/// metres.
const BEND_AT: f64 = 0.33;
const BEND_M: [f64; 2] = [16.0, 4.0];
/// Places that are tried for a lane.
const TRIES: usize = 60;
/// Layouts that are tried.
const ATTEMPTS: u64 = 8;

pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    first_that_builds(ATTEMPTS, |attempt| Town::new(parameters, attempt).layout())
}

/// A place on a ring where a lane ends.
#[derive(Clone, Copy)]
struct Foot {
    angle_rad: f64,
    point: PointId,
}

struct Town<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    radius_m: Vec<f64>,
    /// Phases of the two- and threefold swelling of the rings.
    phases: [f64; 2],
    /// Ends of lanes on each ring.
    feet: Vec<Vec<Foot>>,
    graph: Graph,
}

impl<'a> Town<'a> {
    fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.oldtown;
        let mut draws = Stream::new(parameters.seed, 0, "town/oldtown", attempt);
        let mut radius_m = vec![draws.uniform(48.0, 56.0)];
        for _ in 1..own.rings {
            let step = draws.uniform(own.ring_m[0], own.ring_m[1]);
            radius_m.push(radius_m.last().copied().unwrap_or(0.0) + step);
        }
        Self {
            parameters,
            phases: [draws.uniform(0.0, TAU), draws.uniform(0.0, TAU)],
            feet: radius_m.iter().map(|_| Vec::new()).collect(),
            radius_m,
            draws,
            graph: Graph::default(),
        }
    }

    /// A place at an angle; rings (whole numbers) swell together, so they keep their distance.
    fn place(&self, ring: f64, angle_rad: f64) -> [f64; 2] {
        let (low, part) = ((ring.floor() as usize).min(self.radius_m.len() - 2), ring - ring.floor());
        let part = if ring >= (self.radius_m.len() - 1) as f64 { 1.0 } else { part };
        let radius = self.radius_m[low] + (self.radius_m[low + 1] - self.radius_m[low]) * part;
        let swell = cos(2.0 * angle_rad + self.phases[0]) + 0.6 * cos(3.0 * angle_rad + self.phases[1]);
        polar([0.0, 0.0], angle_rad, radius * (1.0 + self.parameters.oldtown.winding * 0.62 * swell))
    }

    fn layout(mut self) -> Layout {
        let own = &self.parameters.oldtown;
        let narrow = Side::town(1, NARROW_M).with_sidewalk(NARROW_SIDEWALK_M);
        let steep = |shape: CrossSection| CrossSection { max_grade: GRADE, ..shape };
        let lane = steep(CrossSection::both_ways(narrow, LANE_KMH));
        let wall = CrossSection::both_ways(
            Side::town(1, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m),
            WALL_KMH,
        );
        self.lanes(lane);
        for ring in 0..self.radius_m.len() {
            let outermost = ring + 1 == self.radius_m.len();
            let shape = if outermost { wall } else { self.street(narrow) };
            let name = match ring {
                0 => "Market".to_owned(),
                _ if outermost => "Wall Street".to_owned(),
                _ => format!("Ring {ring}"),
            };
            self.ring(ring, &name, steep(shape));
        }
        self.alleys(lane);
        let hill = Hill {
            at_m: [self.draws.uniform(-25.0, 25.0), self.draws.uniform(-25.0, 25.0)],
            height_m: own.hill_m,
            radius_m: 0.75 * self.radius_m.last().copied().unwrap_or(200.0),
        };
        let wave = Wave {
            amplitude_m: 0.8,
            period_m: self.draws.uniform(260.0, 380.0),
            heading_rad: self.draws.uniform(0.0, PI),
            phase_rad: self.draws.uniform(0.0, TAU),
        };
        let terrain = Terrain { waves: vec![wave], hills: vec![hill], ..Terrain::flat() };
        let layout = empty(self.parameters, terrain);
        self.graph.into_layout(layout, self.parameters.kerb_radius_m.min(5.0))
    }

    fn street(&mut self, side: Side) -> CrossSection {
        let share = self.parameters.oldtown.parking_share;
        let mut draw = || side.with_parking(if self.draws.chance(share) { PARKING_M } else { 0.0 });
        let (left, right) = (draw(), draw());
        CrossSection { left, ..CrossSection::both_ways(right, STREET_KMH) }
    }

    /// Lanes from ring to ring, one in each sector, clear of the lanes that end there already: hardly one
    /// goes straight up.
    fn lanes(&mut self, shape: CrossSection) {
        let gates = self.parameters.oldtown.gates as usize;
        for ring in 0..self.radius_m.len() - 1 {
            // The market has room for fewer.
            let count = if ring == 0 { 3 } else { gates };
            let sector = TAU / count as f64;
            let turn = self.draws.uniform(0.0, sector);
            for k in 0..count {
                let found = (0..TRIES).find_map(|_| {
                    let angle = turn + sector * (k as f64 + self.draws.uniform(-0.45, 0.45));
                    let side = if self.draws.chance(0.5) { 1.0 } else { -1.0 };
                    let slant_m = side * self.draws.uniform(SLANT_M[0], SLANT_M[1]);
                    let ends = [(ring, angle), (ring + 1, angle + slant_m / self.radius_m[ring + 1])];
                    ends.iter().all(|end| self.is_clear(*end)).then_some(ends)
                });
                let Some(ends) = found else { continue };
                let points = ends.map(|(ring, angle_rad)| {
                    let point = self.graph.point(self.place(ring as f64, angle_rad));
                    self.feet[ring].push(Foot { angle_rad: angle_rad.rem_euclid(TAU), point });
                    point
                });
                let line = self.graph.line(format!("Lane {ring}-{k}"), shape, BEND_M);
                let [below, above] = ends.map(|(_, angle)| angle);
                // It leaves the streets squarely and climbs across the slope in between.
                let turns = [(BEND_AT, 0.08), (1.0 - BEND_AT, 0.92)].map(|(share, way)| {
                    let at = self.place(ring as f64 + share, below + way * (above - below));
                    self.graph.point(at)
                });
                self.graph.lead(line, &[points[0], turns[0], turns[1], points[1]]);
            }
        }
    }

    /// Whether there is room for the end of another lane.
    fn is_clear(&self, (ring, angle_rad): (usize, f64)) -> bool {
        let room = |foot: &Foot| wrap_pi(foot.angle_rad - angle_rad).abs() * self.radius_m[ring] > FOOT_M;
        self.feet[ring].iter().all(room)
    }

    /// A street round the hill through the ends of its lanes.
    fn ring(&mut self, ring: usize, name: &str, shape: CrossSection) {
        let mut feet = self.feet[ring].clone();
        feet.sort_by(|a, b| a.angle_rad.total_cmp(&b.angle_rad));
        let line = self.graph.line(name, shape, [0.8 * self.radius_m[ring], 0.0]);
        let outermost = ring + 1 == self.radius_m.len();
        // A street between market and wall has a gap somewhere: there it turns into the lanes.
        let gap = self.draws.index(feet.len()).filter(|_| ring > 0 && !outermost);
        for k in 0..feet.len() {
            let (from, to) = (feet[k], feet[(k + 1) % feet.len()]);
            let span = (to.angle_rad - from.angle_rad).rem_euclid(TAU);
            let room = (span * self.radius_m[ring] / STEP_M).floor();
            let steps = (span / STEP_RAD).ceil().min(room).max(1.0) as usize;
            let mut stops = vec![from.point];
            for i in 1..steps {
                // Streets inside the walls wander.
                let wander = if ring == 0 || outermost { 0.0 } else { self.draws.uniform(-0.07, 0.07) };
                let at = self.place(ring as f64 + wander, from.angle_rad + span * i as f64 / steps as f64);
                stops.push(self.graph.point(at));
            }
            stops.push(to.point);
            if gap != Some(k) {
                self.graph.lead(line, &stops);
            }
            let control = match ring {
                _ if outermost && k % 2 == 0 => Control::Signals,
                0 => Control::AllStop,
                _ if self.draws.chance(0.3) => Control::MinorStop,
                _ => Control::MinorYield,
            };
            self.graph.kind(from.point, NodeKind::Crossing(control));
            if !outermost {
                self.graph.without_crosswalks(from.point);
            }
        }
    }

    /// Alleys that lead outwards from the wall street and end.
    fn alleys(&mut self, shape: CrossSection) {
        let last = self.radius_m.len() - 1;
        let mut feet = self.feet[last].clone();
        for k in 0..self.parameters.oldtown.alleys {
            let Some(i) = self.draws.index(feet.len()) else { break };
            let foot = feet.swap_remove(i);
            let line = self.graph.line(format!("Alley {}", k + 1), shape, [20.0, 0.0]);
            let [x, y] = self.graph.at_m(foot.point);
            let angle = foot.angle_rad + self.draws.uniform(-0.25, 0.25);
            let end = self.graph.point(polar([x, y], angle, self.draws.uniform(72.0, 100.0)));
            self.graph.lead(line, &[foot.point, end]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_keep_their_distance() {
        let parameters = TownParameters::default();
        for seed in 0..20 {
            let parameters = TownParameters { seed, ..parameters.clone() };
            let town = Town::new(&parameters, 0);
            for i in 0..90 {
                let angle = f64::from(i) * TAU / 90.0;
                for ring in 1..town.radius_m.len() {
                    let [a, b] = [ring - 1, ring].map(|r| town.place(r as f64, angle));
                    let gap = frames::math::hypot(a[0] - b[0], a[1] - b[1]);
                    assert!(gap > 45.0, "seed {seed}: rings {ring} are {gap} m apart at {angle}");
                }
            }
        }
    }
}
