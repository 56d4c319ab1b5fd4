//! Country roads: narrow lanes between scattered crossroads, farms at the end of tracks, a single-track
//! railway.

use random::Stream;
use std::f64::consts::TAU;

use super::graph::{Graph, PointId, empty, first_that_builds};
use crate::layout::{Control, Layout, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the main road, lanes and farm tracks, km/h.
const ROAD_KMH: f64 = 80.0;
const LANE_KMH: f64 = 60.0;
const FARM_KMH: f64 = 30.0;
/// Shoulders of the main road, lanes and farm tracks, metres.
const SHOULDERS_M: [f64; 3] = [1.0, 0.5, 0.3];
/// Radius and clothoids of bends of roads, and of the railway, metres.
const BEND_M: [f64; 2] = [90.0, 25.0];
const RAIL_BEND_M: [f64; 2] = [400.0, 60.0];
/// The railway goes on so far beyond the roads, metres.
const RAIL_BEYOND_M: f64 = 140.0;
/// Layouts that are tried.
const ATTEMPTS: u64 = 16;

pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    first_that_builds(ATTEMPTS, |attempt| Land::new(parameters, attempt).layout())
}

struct Land<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    /// Crossroads by column and row.
    at: Vec<Vec<PointId>>,
    /// The row that the main road follows, and the row north of which the railway runs.
    main: usize,
    railway: usize,
    graph: Graph,
    /// Roads that farms may lie at.
    lanes: Vec<[PointId; 2]>,
}

impl<'a> Land<'a> {
    fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.rural;
        let mut draws = Stream::new(parameters.seed, 0, "town/rural", attempt);
        let mut lines = |count: u32| {
            let mut at = vec![0.0];
            for _ in 1..count {
                let step = draws.uniform(own.spacing_m[0], own.spacing_m[1]);
                at.push(at.last().copied().unwrap_or(0.0) + step);
            }
            let middle = 0.5 * at.last().copied().unwrap_or(0.0);
            at.iter().map(|v| v - middle).collect::<Vec<f64>>()
        };
        let (x, y) = (lines(own.columns), lines(own.rows));
        let mut graph = Graph::default();
        let off = own.disorder_m;
        let at = x
            .iter()
            .map(|x| {
                let mut place = |y: &f64| [x + draws.uniform(-off, off), y + draws.uniform(-off, off)];
                y.iter().map(|y| graph.point(place(y))).collect()
            })
            .collect();
        let rows = own.rows as usize;
        let main = 1 + draws.index(rows - 2).unwrap_or(0);
        let railway = draws.index(rows - 1).unwrap_or(0);
        Self { parameters, draws, at, main, railway, graph, lanes: Vec::new() }
    }

    fn layout(mut self) -> Layout {
        let own = &self.parameters.rural;
        let open = |lane_m: f64, k: usize| Side::open(1, lane_m, SHOULDERS_M[k]);
        let road = CrossSection::rural(open(own.lane_m + 0.5, 0), ROAD_KMH);
        let lane = CrossSection::rural(open(own.lane_m, 1), LANE_KMH);
        let farm = CrossSection { banked: false, ..CrossSection::rural(open(own.lane_m, 2), FARM_KMH) };

        self.along(road, lane);
        let crossings = self.across(lane);
        if own.railway && crossings.len() > 1 {
            self.rails(&crossings);
        }
        for column in self.at.clone() {
            for (j, point) in column.into_iter().enumerate() {
                let control = match self.draws.index(3) {
                    _ if j == self.main => Control::MinorStop,
                    Some(0) => Control::AllStop,
                    Some(1) => Control::MinorStop,
                    _ => Control::MinorYield,
                };
                self.graph.kind(point, NodeKind::Crossing(control));
            }
        }
        for k in 0..own.farms {
            let Some(i) = self.draws.index(self.lanes.len()) else { break };
            let [from, to] = self.lanes.swap_remove(i);
            let track = self.graph.line(format!("Farm track {}", k + 1), farm, [25.0, 0.0]);
            let side = if self.draws.chance(0.5) { 1.0 } else { -1.0 };
            let length_m = side * self.draws.uniform(70.0, 95.0);
            let share = self.draws.uniform(0.35, 0.65);
            self.graph.close(track, from, to, share, length_m);
        }
        let waves = [0.5, 0.3, 0.2]
            .into_iter()
            .map(|share| Wave {
                amplitude_m: 0.5 * share * own.relief_m,
                period_m: self.draws.uniform(420.0, 760.0) * (0.6 + share),
                heading_rad: self.draws.uniform(0.0, TAU),
                phase_rad: self.draws.uniform(0.0, TAU),
            })
            .collect();
        let layout = empty(self.parameters, Terrain { waves, ..Terrain::flat() });
        self.graph.into_layout(layout, self.parameters.kerb_radius_m)
    }

    /// Roads from west to east: the outer ones and the main road whole, the others with gaps.
    fn along(&mut self, road: CrossSection, lane: CrossSection) {
        let (columns, rows) = (self.at.len(), self.at[0].len());
        for j in 0..rows {
            let main = j == self.main;
            let (name, shape) =
                if main { ("Main Road".to_owned(), road) } else { (format!("Lane {j}"), lane) };
            let line = self.graph.line(name, shape, BEND_M);
            for i in 0..columns - 1 {
                let whole = main || j == 0 || j + 1 == rows;
                if whole || !self.draws.chance(self.parameters.rural.missing_share) {
                    let ends = [self.at[i][j], self.at[i + 1][j]];
                    self.graph.lead(line, &ends);
                    self.wander(ends);
                }
            }
        }
    }

    /// Gives the road between two crossroads a bend, and remembers its halves for farms.
    fn wander(&mut self, [from, to]: [PointId; 2]) {
        let (a, b) = (self.graph.at_m(from), self.graph.at_m(to));
        let off = 0.6 * self.parameters.rural.disorder_m;
        let share = self.draws.uniform(0.42, 0.58);
        let aside = self.draws.uniform(-off, off);
        let length = frames::math::hypot(b[0] - a[0], b[1] - a[1]).max(1.0);
        let (dx, dy) = ((b[0] - a[0]) / length, (b[1] - a[1]) / length);
        if let Some(bend) = self.graph.split(from, to, share) {
            let [x, y] = self.graph.at_m(bend);
            self.graph.move_to(bend, [x - dy * aside, y + dx * aside]);
            self.lanes.push(if self.draws.chance(0.5) { [from, bend] } else { [bend, to] });
        }
    }

    /// Roads from south to north. Those that the railway crosses do it halfway, where they are straight; the
    /// crossings from west to east.
    fn across(&mut self, lane: CrossSection) -> Vec<PointId> {
        let (columns, rows) = (self.at.len(), self.at[0].len());
        let mut crossings = Vec::new();
        for i in 0..columns {
            let line = self.graph.line(format!("Hill Road {i}"), lane, BEND_M);
            for j in 0..rows - 1 {
                let ends = [self.at[i][j], self.at[i][j + 1]];
                let outer = i == 0 || i + 1 == columns;
                let by_rail = self.parameters.rural.railway && j == self.railway;
                if !outer && self.draws.chance(self.parameters.rural.missing_share) {
                    continue;
                }
                self.graph.lead(line, &ends);
                if !by_rail {
                    self.wander(ends);
                } else if let Some(point) = self.graph.split(ends[0], ends[1], 0.5) {
                    crossings.push(point);
                }
            }
        }
        crossings
    }

    fn rails(&mut self, crossings: &[PointId]) {
        let (Some(first), Some(last)) = (crossings.first(), crossings.last()) else { return };
        let ([x0, y0], [x1, y1]) = (self.graph.at_m(*first), self.graph.at_m(*last));
        let slope = (y1 - y0) / (x1 - x0).max(1.0);
        let west = self.graph.point([x0 - RAIL_BEYOND_M, y0 - 0.5 * slope * RAIL_BEYOND_M]);
        let east = self.graph.point([x1 + RAIL_BEYOND_M, y1 + 0.5 * slope * RAIL_BEYOND_M]);
        let line = self.graph.line("Railway", CrossSection::railway(false), RAIL_BEND_M);
        let stops: Vec<PointId> = [west].into_iter().chain(crossings.iter().copied()).chain([east]).collect();
        self.graph.lead(line, &stops);
    }
}
