//! A small town on both banks of a river: quays and a main street along it, lanes across, a few bridges.

use frames::math::sin;
use random::Stream;
use std::f64::consts::TAU;

use super::graph::{Graph, LineId, PointId, empty, first_that_builds};
use crate::layout::{Control, Layout, NodeKind, Water};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Side};
use crate::terrain::{Channel, Hill, Terrain, Wave};

/// Speed limits of the main street, bridges and quays, lanes, the bypass, km/h.
const MAIN_KMH: f64 = 50.0;
const QUAY_KMH: f64 = 40.0;
const LANE_KMH: f64 = 30.0;
const PARKING_M: f64 = 2.2;
const BIKE_M: f64 = 1.6;
/// Width of each slope beside the river, depth of its bed, height of its water over the bed, metres.
const SLOPE_M: f64 = 9.0;
const DEPTH_M: f64 = 6.5;
const WATER_M: f64 = 2.2;
/// From the top of the bank to the middle of the quay, metres.
const QUAY_M: f64 = 19.0;
/// The river goes on so far beyond the town, metres.
const BEYOND_M: f64 = 160.0;
/// Layouts that are tried.
const ATTEMPTS: u64 = 24;

pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    first_that_builds(ATTEMPTS, |attempt| Town::new(parameters, attempt).layout())
}

struct Town<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    /// Half the period and the phase of the river's swing.
    period_m: f64,
    phase: f64,
    /// Where lanes across leave the river's line, metres along it.
    along_m: Vec<f64>,
    /// Whether each has a bridge.
    bridged: Vec<bool>,
    /// Distances of the streets along the river from its middle, metres; south ones are negative. Ascending.
    across_m: Vec<f64>,
    graph: Graph,
}

impl<'a> Town<'a> {
    fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.river;
        let mut draws = Stream::new(parameters.seed, 0, "town/river", attempt);
        let quay_m = 0.5 * own.river_m + SLOPE_M + QUAY_M;
        let mut rows = |count: u32| {
            let mut at = vec![quay_m];
            for _ in 0..count {
                at.push(at.last().copied().unwrap_or(0.0) + draws.uniform(72.0, 96.0));
            }
            at
        };
        let (north, south) = (rows(own.north_rows), rows(own.south_rows));
        let across_m = south.iter().rev().map(|v| -v).chain(north).collect();

        let lanes = (own.length_m / 100.0).round().max(4.0) as usize;
        let step = own.length_m / lanes as f64;
        let along_m: Vec<f64> = (0..=lanes)
            .map(|i| (i as f64 - 0.5 * lanes as f64) * step)
            .map(|x| x + draws.uniform(-0.14, 0.14) * step)
            .collect();
        // Bridges stand apart; the outermost lanes have two of them.
        let mut bridged = vec![false; lanes + 1];
        for i in 0..own.bridges as usize {
            bridged[i * lanes / (own.bridges as usize - 1).max(1)] = true;
        }
        Self {
            parameters,
            period_m: draws.uniform(0.85, 1.25) * own.length_m,
            phase: draws.uniform(0.0, TAU),
            along_m,
            bridged,
            across_m,
            draws,
            graph: Graph::default(),
        }
    }

    /// The river's middle at a distance along the town.
    fn river(&self, along_m: f64) -> [f64; 2] {
        let swing = self.parameters.river.swing_m * sin(TAU * along_m / self.period_m + self.phase);
        [along_m, swing]
    }

    /// A place beside the river: streets follow its swing, less so the farther they are.
    fn place(&self, along_m: f64, across_m: f64) -> [f64; 2] {
        let ([x, y], [x0, y0], [x1, y1]) =
            (self.river(along_m), self.river(along_m - 5.0), self.river(along_m + 5.0));
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = (dx * dx + dy * dy).sqrt();
        let follow = 1.0 / (1.0 + (across_m / 260.0) * (across_m / 260.0));
        let normal = [-dy / length * follow, dx / length];
        [x + normal[0] * across_m, y * follow + normal[1] * across_m]
    }

    fn layout(mut self) -> Layout {
        let side =
            |lanes| Side::town(lanes, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m);
        let (plain, parked) = (side(1), side(1).with_parking(PARKING_M));
        let main = CrossSection::both_ways(parked, MAIN_KMH);
        let bridge = CrossSection::both_ways(plain, MAIN_KMH);
        let quay = CrossSection::both_ways(plain.with_bike(BIKE_M), QUAY_KMH);
        let lane = CrossSection::both_ways(plain, LANE_KMH);
        let half_parked = CrossSection { left: parked, ..lane };

        let points = self.points();
        let south = self.parameters.river.south_rows as usize + 1;
        let last = self.across_m.len() - 1;
        // Along the river: the quays, the main street behind the north one, and the outer streets.
        for j in 0..=last {
            let (name, shape) = match j {
                _ if j + 1 == south => ("South Quay".to_owned(), quay),
                _ if j == south => ("North Quay".to_owned(), quay),
                _ if j == south + 1 => ("Main Street".to_owned(), main),
                _ => (format!("Row {j}"), half_parked),
            };
            let line = self.graph.line(name, shape, [60.0, 0.0]);
            let row: Vec<PointId> = points.iter().map(|column| column[j]).collect();
            self.graph.lead(line, &row);
        }
        // Across it.
        for (i, column) in points.iter().enumerate() {
            let outer = i == 0 || i + 1 == points.len();
            let name = if self.bridged[i] { format!("Bridge Street {i}") } else { format!("Lane {i}") };
            let shape = if self.bridged[i] { bridge } else { lane };
            let line = self.graph.line(name, shape, [24.0, 8.0]);
            for j in 0..last {
                let over_river = j + 1 == south;
                // Some lanes end at the street before the last one: blocks are not all alike.
                let left_out =
                    !self.bridged[i] && !outer && (j == 0 || j + 1 == last) && self.draws.chance(0.3);
                if over_river && self.bridged[i] {
                    // A street of its own: bridges are straight from quay to quay.
                    let over = self.graph.line(format!("Bridge {i}"), shape, [24.0, 8.0]);
                    self.graph.lead(over, &column[j..=j + 1]);
                } else if !over_river && !left_out {
                    self.graph.lead(line, &column[j..=j + 1]);
                }
            }
            self.control(i, column, south);
        }
        self.closes(&points, lane);
        let (terrain, water) = self.terrain();
        let mut layout = empty(self.parameters, terrain);
        layout.waters.push(water);
        self.graph.into_layout(layout, self.parameters.kerb_radius_m)
    }

    fn points(&mut self) -> Vec<Vec<PointId>> {
        let mut points = Vec::new();
        for i in 0..self.along_m.len() {
            let mut column = Vec::new();
            for j in 0..self.across_m.len() {
                // Lanes lean; the banks of a bridge lie opposite each other.
                let lean = (self.across_m[j] / 100.0) * self.draws.uniform(-6.0, 6.0);
                let at = self.place(self.along_m[i] + lean, self.across_m[j]);
                column.push(self.graph.point(at));
            }
            points.push(column);
        }
        points
    }

    fn control(&mut self, i: usize, column: &[PointId], south: usize) {
        let inner = i > 0 && i + 1 < self.along_m.len();
        if !inner {
            return;
        }
        let main = column.get(south + 1).copied();
        if self.bridged[i] {
            self.graph.kind(column[south], NodeKind::Crossing(Control::Signals));
            self.graph.kind(column[south - 1], NodeKind::Crossing(Control::Signals));
            if let Some(point) = main {
                self.graph.kind(point, NodeKind::Crossing(Control::Signals));
            }
        } else if let Some(point) = main
            && self.draws.chance(0.4)
        {
            self.graph.kind(point, NodeKind::Crossing(Control::AllStop));
        }
    }

    /// Closes that lead away from the town.
    fn closes(&mut self, points: &[Vec<PointId>], lane: CrossSection) {
        let last = self.across_m.len() - 1;
        for (j, away) in [(0, -1.0), (last, 1.0)] {
            let Some(i) = self.draws.index(points.len() - 1) else { continue };
            let length = self.draws.uniform(48.0, 75.0);
            let close: LineId =
                self.graph.line(if j == 0 { "Meadow Close" } else { "Mill Close" }, lane, [20.0, 0.0]);
            self.graph.close(
                close,
                points[i][j],
                points[i + 1][j],
                self.draws.uniform(0.42, 0.58),
                away * length,
            );
        }
    }

    fn terrain(&mut self) -> (Terrain, Water) {
        let own = &self.parameters.river;
        let reach = 0.5 * own.length_m + BEYOND_M;
        let count = (2.0 * reach / 20.0).ceil() as usize;
        let line_m: Vec<[f64; 2]> =
            (0..=count).map(|i| self.river(-reach + 2.0 * reach * i as f64 / count as f64)).collect();
        let wave = Wave {
            amplitude_m: 0.12 * own.relief_m,
            period_m: self.draws.uniform(380.0, 520.0),
            heading_rad: self.draws.uniform(-0.5, 0.5),
            phase_rad: self.draws.uniform(0.0, TAU),
        };
        // The town rises to the north.
        let top_m = self.across_m.last().copied().unwrap_or(0.0);
        let hill = Hill {
            at_m: [self.draws.uniform(-100.0, 100.0), top_m + 160.0],
            height_m: 0.9 * own.relief_m,
            radius_m: 0.6 * top_m + 60.0,
        };
        let channel =
            Channel { line_m: line_m.clone(), width_m: own.river_m, slope_m: SLOPE_M, depth_m: DEPTH_M };
        let terrain =
            Terrain { waves: vec![wave], hills: vec![hill], channels: vec![channel], ..Terrain::flat() };
        let bed_m = line_m.iter().map(|[x, y]| terrain.ground(*x, *y)).fold(f64::INFINITY, f64::min);
        // The water reaches a little up the slopes.
        let half_m = 0.5 * own.river_m + 0.35 * SLOPE_M;
        (terrain, Water::along("River", &line_m, half_m, bed_m + WATER_M))
    }
}
