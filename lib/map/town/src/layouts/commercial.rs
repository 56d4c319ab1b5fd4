//! A commercial town: a boulevard between a dense centre with a market place and large blocks with closes.

use frames::math::{sin, sin_cos};
use random::Stream;
use std::f64::consts::TAU;

use super::graph::{Graph, PointId, empty, first_that_builds};
use crate::layout::{Control, Layout, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Median, Pocket, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the boulevard, other through streets, the centre and closes, km/h.
const BOULEVARD_KMH: f64 = 60.0;
const STREET_KMH: f64 = 50.0;
const CENTRE_KMH: f64 = 30.0;
const PARKING_M: f64 = 2.3;
/// Radius and clothoid of the outer streets' corners, metres.
const CORNER_M: [f64; 2] = [32.0, 8.0];
/// Least distance between two junctions of the boulevard, metres.
const APART_M: f64 = 49.0;
/// Layouts that are tried.
const ATTEMPTS: u64 = 24;

pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    first_that_builds(ATTEMPTS, |attempt| Town::new(parameters, attempt).layout())
}

/// The cross-sections of the town.
struct Shapes {
    boulevard: CrossSection,
    outer: CrossSection,
    centre: CrossSection,
    quiet: CrossSection,
    market: CrossSection,
}

struct Town<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    /// Turn of the whole town, radians; swing of its streets, metres, its period and phase.
    turn_rad: f64,
    swing_m: f64,
    period_m: f64,
    phase: f64,
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    shapes: Shapes,
    graph: Graph,
}

impl<'a> Town<'a> {
    fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.commercial;
        let mut draws = Stream::new(parameters.seed, 0, "town/commercial", attempt);
        let mut lines = |count: u32, scale: f64| {
            let mut at = vec![0.0];
            for _ in 0..count {
                let step = draws.uniform(own.block_m[0], own.block_m[1]) * scale;
                at.push(at.last().copied().unwrap_or(0.0) + step);
            }
            at
        };
        let (x, y_m) = (lines(own.columns - 1, 1.0), lines(own.rows, 0.88));
        let middle = 0.5 * x.last().copied().unwrap_or(0.0);
        let side = |lanes| Side::town(lanes, parameters.lane_width_m).with_sidewalk(parameters.sidewalk_m);
        let parked = side(1).with_parking(PARKING_M);
        let shapes = Shapes {
            boulevard: CrossSection::both_ways(side(2).with_verge(1.5), BOULEVARD_KMH)
                .with_median(Median::raised(3.0)),
            outer: CrossSection::both_ways(side(1), STREET_KMH),
            centre: CrossSection::both_ways(parked, CENTRE_KMH),
            quiet: CrossSection::both_ways(side(1), CENTRE_KMH),
            market: CrossSection {
                left: Side { lanes: 0, ..side(1) },
                ..CrossSection::one_way(parked, 0.5, CENTRE_KMH)
            },
        };
        Self {
            parameters,
            turn_rad: draws.uniform(-0.35, 0.35),
            swing_m: draws.uniform(24.0, 42.0),
            period_m: draws.uniform(550.0, 800.0),
            phase: draws.uniform(0.0, TAU),
            x_m: x.iter().map(|v| v - middle).collect(),
            y_m,
            shapes,
            draws,
            graph: Graph::default(),
        }
    }

    /// From the town's own axes, the boulevard along x, to the world.
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let bent = y + self.swing_m * sin(TAU * x / self.period_m + self.phase);
        let leaning = x + 0.4 * self.swing_m * sin(TAU * y / self.period_m + 2.0 * self.phase);
        let (s, c) = sin_cos(self.turn_rad);
        [leaning * c - bent * s, leaning * s + bent * c]
    }

    fn point(&mut self, x: f64, y: f64, jitter_m: f64) -> PointId {
        let mut off = || self.draws.uniform(-jitter_m, jitter_m);
        let (dx, dy) = (off(), off());
        let at = self.place(x + dx, y + dy);
        self.graph.point(at)
    }

    fn layout(mut self) -> Layout {
        let (columns, rows) = (self.x_m.len(), self.y_m.len());
        let grid: Vec<Vec<PointId>> = (0..columns)
            .map(|i| {
                (0..rows)
                    .map(|j| {
                        // The boulevard and the outer streets are smooth.
                        let inner = i > 0 && i + 1 < columns && j > 0 && j + 1 < rows;
                        self.point(self.x_m[i], self.y_m[j], if inner { 10.0 } else { 0.0 })
                    })
                    .collect()
            })
            .collect();
        let south = self.south_side(&grid);
        self.boulevard(&grid, &south);
        self.centre(&grid);
        self.outer_streets(&grid, &south);
        let waves = (0..2)
            .map(|i| Wave {
                amplitude_m: 0.25 * self.parameters.commercial.relief_m,
                period_m: self.draws.uniform(450.0, 650.0),
                heading_rad: self.draws.uniform(0.0, 1.2) + 1.5 * f64::from(i),
                phase_rad: self.draws.uniform(0.0, TAU),
            })
            .collect();
        let layout = empty(self.parameters, Terrain { waves, ..Terrain::flat() });
        self.graph.into_layout(layout, self.parameters.kerb_radius_m)
    }

    /// Streets on the boulevard's other side, as points on the boulevard and on the street behind the large
    /// blocks: some go on from a street of the centre, some leave the boulevard halfway between two.
    fn south_side(&mut self, grid: &[Vec<PointId>]) -> Vec<[PointId; 2]> {
        let depth_m = -self.parameters.commercial.depth_m;
        let last = grid.len() - 1;
        let mut streets = vec![[grid[0][0], self.point(self.x_m[0], depth_m, 0.0)]];
        let mut from = self.x_m[0];
        for (i, column) in grid.iter().enumerate().take(last).skip(1) {
            let half_m = 0.5 * (self.x_m[i + 1] - self.x_m[i]);
            let halfway = half_m > APART_M && i + 1 < last && self.draws.chance(0.5);
            let x = if halfway { self.x_m[i] + half_m } else { self.x_m[i] };
            if x - from < 115.0 || self.x_m[last] - x < 100.0 {
                continue;
            }
            let top = if halfway { self.point(x, 0.0, 0.0) } else { column[0] };
            let lean = self.draws.uniform(-10.0, 10.0);
            streets.push([top, self.point(x + lean, depth_m, 0.0)]);
            from = x;
        }
        streets.push([grid[last][0], self.point(self.x_m[last], depth_m, 0.0)]);
        streets
    }

    fn boulevard(&mut self, grid: &[Vec<PointId>], south: &[[PointId; 2]]) {
        let line = self.graph.line("Boulevard", self.shapes.boulevard, [200.0, 0.0]);
        self.graph.pockets(line, Pocket::one(22.0, 14.0));
        let mut stops: Vec<PointId> = grid.iter().map(|column| column[0]).collect();
        stops.extend(south.iter().map(|street| street[0]));
        // Along the boulevard; places of two streets once.
        let (s, c) = sin_cos(self.turn_rad);
        let along = |p: &PointId| {
            let [x, y] = self.graph.at_m(*p);
            x * c + y * s
        };
        stops.sort_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        stops.dedup();
        self.graph.lead(line, &stops);
        let last = stops.len() - 1;
        for (i, stop) in stops.iter().enumerate() {
            let through = grid.iter().any(|c| c[0] == *stop) && south.iter().any(|s| s[0] == *stop);
            let kind = match i {
                0 => NodeKind::Crossing(Control::Signals),
                _ if i == last => NodeKind::Roundabout { island_m: 15.0, lanes: 2 },
                _ if through || self.draws.chance(0.3) => NodeKind::Crossing(Control::Signals),
                _ => NodeKind::Crossing(Control::MinorStop),
            };
            self.graph.kind(*stop, kind);
        }
    }

    /// Streets inside the centre; around the market place they are one way.
    fn centre(&mut self, grid: &[Vec<PointId>]) {
        let (columns, rows) = (grid.len(), self.y_m.len());
        // It takes a block that the street round the town does not touch.
        let has_market = rows > 3;
        let market = 1 + self.draws.index(columns - 3).unwrap_or(0);
        let on_market = |a: [usize; 2], b: [usize; 2]| {
            let is_corner = |[i, j]: [usize; 2]| (market..=market + 1).contains(&i) && (1..=2).contains(&j);
            has_market && is_corner(a) && is_corner(b)
        };
        for (i, column) in grid.iter().enumerate().take(columns - 1).skip(1) {
            let line = self.graph.line(format!("Street {i}"), self.shapes.centre, [30.0, 0.0]);
            for j in 0..rows - 1 {
                if !on_market([i, j], [i, j + 1]) && (j == 0 || !self.is_merged()) {
                    self.graph.lead(line, &column[j..=j + 1]);
                }
            }
        }
        for j in 1..rows - 1 {
            let line = self.graph.line(format!("Row {j}"), self.shapes.centre, [30.0, 0.0]);
            for (i, pair) in grid.windows(2).enumerate() {
                let outer = i == 0 || i + 2 == columns;
                if !on_market([i, j], [i + 1, j]) && (outer || !self.is_merged()) {
                    self.graph.lead(line, &[pair[0][j], pair[1][j]]);
                }
            }
        }
        if has_market {
            let (west, east) = (&grid[market], &grid[market + 1]);
            let corners = [west[1], east[1], east[2], west[2], west[1]];
            for (side, pair) in corners.windows(2).enumerate() {
                let line =
                    self.graph.line(format!("Market Place {}", side + 1), self.shapes.market, [20.0, 0.0]);
                self.graph.lead(line, pair);
            }
        }
        for column in &grid[1..columns - 1] {
            for point in &column[1..rows - 1] {
                let control = if self.draws.chance(0.45) { Control::AllStop } else { Control::MinorYield };
                self.graph.kind(*point, NodeKind::Crossing(control));
            }
        }
    }

    fn is_merged(&mut self) -> bool {
        self.draws.chance(self.parameters.commercial.merged_share)
    }

    /// The street round the town, and closes behind the large blocks.
    fn outer_streets(&mut self, grid: &[Vec<PointId>], south: &[[PointId; 2]]) {
        let (last, top) = (grid.len() - 1, self.y_m.len() - 1);
        let ring = self.graph.line("Ring Street", self.shapes.outer, CORNER_M);
        self.graph.lead(ring, &grid[0]);
        let northern: Vec<PointId> = grid.iter().map(|column| column[top]).collect();
        self.graph.lead(ring, &northern);
        self.graph.lead(ring, &grid[last]);
        let park = self.graph.line("Park Road", self.shapes.outer, CORNER_M);
        let southern: Vec<PointId> = south.iter().map(|street| street[1]).collect();
        self.graph.lead(park, &southern);
        for (k, street) in south.iter().enumerate() {
            let line = if k == 0 || k + 1 == south.len() {
                park
            } else {
                self.graph.line(format!("Mall Road {k}"), self.shapes.outer, CORNER_M)
            };
            self.graph.lead(line, street);
        }
        for k in 0..self.parameters.commercial.closes as usize {
            let Some(pair) = southern.get(k..k + 2) else { break };
            let line = self.graph.line(format!("Close {}", k + 1), self.shapes.quiet, [20.0, 0.0]);
            let (share, length_m) = (self.draws.uniform(0.4, 0.6), self.draws.uniform(62.0, 95.0));
            self.graph.close(line, pair[0], pair[1], share, -length_m);
        }
    }
}
