//! A grid city with an elevated motorway: it crosses the city on a viaduct and leads round its northern half.

use random::Stream;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};

use super::blocks::{Blocks, Cell};
use super::motorway::{Diamond, DiamondPlan, Frame, Motorway, diamond, exit_lane};
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Ending, Median, Pocket, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the motorway, avenues and streets, km/h.
const MOTORWAY_KMH: f64 = 80.0;
const AVENUE_KMH: f64 = 50.0;
const STREET_KMH: f64 = 40.0;
const PARKING_M: f64 = 2.2;
const BIKE_M: f64 = 1.8;
const MEDIAN_M: f64 = 3.0;
/// From the motorway's axis to the streets beside it, and to the ends of its ramps, metres.
const CORRIDOR_M: f64 = 118.0;
const RAMP_END_M: f64 = 44.0;
/// From an interchange's street to where its ramps leave the motorway, metres.
const REACH_M: f64 = 235.0;
/// Columns between the two interchanges in the city.
const APART: usize = 6;
/// Radius and clothoid of the motorway's corners, metres.
const CORNER_M: [f64; 2] = [230.0, 70.0];
/// From the city's border to where the motorway's corners begin, metres.
const CLEAR_M: f64 = 45.0;
/// From the northernmost street to the motorway beyond it, metres.
const NORTH_M: f64 = 190.0;
/// Radius and clothoid of streets that turn a corner, metres.
const BEND_M: [f64; 2] = [28.0, 8.0];
/// Pockets of avenues: full length and taper, metres; the same under the viaduct.
const POCKET_M: [f64; 2] = [35.0, 18.0];
const SHORT_POCKET_M: [f64; 2] = [24.0, 12.0];

/// The city.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    City::new(parameters).build()
}

struct City<'a> {
    parameters: &'a TownParameters,
    /// The viaduct runs along its x axis, from the middle of the city.
    frame: Frame,
    x_m: Vec<f64>,
    /// Rows; the first `rows_south` of them lie south of the viaduct.
    y_m: Vec<f64>,
    south: usize,
    /// Columns with an interchange on the viaduct, and the one with the interchange in the north.
    crossings: [usize; 2],
    northern: usize,
    /// Rows that are avenues.
    avenue_rows: [usize; 2],
    layout: Layout,
}

impl<'a> City<'a> {
    fn new(parameters: &'a TownParameters) -> Self {
        let own = &parameters.viaduct;
        let mut draws = Stream::new(parameters.seed, 0, "town/viaduct", 0);
        let columns = own.columns as usize;
        let (south, north) = (own.rows_south as usize, own.rows_north as usize);
        let heading_rad = draws.uniform(-0.6, 0.6);
        let mut steps = |count: usize| -> Vec<f64> {
            let mut at = vec![0.0];
            for _ in 1..count {
                at.push(at.last().copied().unwrap_or(0.0) + draws.uniform(own.block_m[0], own.block_m[1]));
            }
            at
        };
        let x = steps(columns);
        let below = steps(south);
        let above = steps(north);
        let middle = 0.5 * x[columns - 1];
        let mut y_m: Vec<f64> = below.iter().rev().map(|d| -CORRIDOR_M - d).collect();
        y_m.extend(above.iter().map(|d| CORRIDOR_M + d));
        let first = 2 + draws.index(columns - APART - 4).unwrap_or(0);
        let northern = first + 2 + draws.index(APART - 3).unwrap_or(0);
        let avenue_rows = [south - 1, south + 1 + draws.index(north - 2).unwrap_or(0)];
        let waves = (0..3)
            .map(|i| Wave {
                amplitude_m: own.relief_m / 6.0,
                period_m: draws.uniform(700.0, 1200.0),
                heading_rad: draws.uniform(0.0, TAU) + f64::from(i),
                phase_rad: draws.uniform(0.0, TAU),
            })
            .collect();
        let mut layout = Layout::new(&parameters.name, Terrain { waves, ..Terrain::flat() });
        layout.geo_reference = parameters.geo_reference();
        Self {
            parameters,
            frame: Frame { origin_m: [0.0, 0.0], heading_rad },
            x_m: x.iter().map(|x| x - middle).collect(),
            y_m,
            south,
            crossings: [first, first + APART],
            northern,
            avenue_rows,
            layout,
        }
    }

    fn build(mut self) -> Layout {
        let (diamonds, north) = self.motorway();
        self.streets(diamonds, north);
        self.layout
    }

    /// The motorway: along the viaduct with two interchanges, round the corners of the city's northern half,
    /// and along its north with a third one. Returns the interchanges.
    fn motorway(&mut self) -> ([Diamond; 2], Diamond) {
        let own = &self.parameters.viaduct;
        let (deck, frame) = (own.deck_m, self.frame);
        let road = Motorway { name: "City Motorway", limit_kmh: MOTORWAY_KMH, lanes: own.motorway_lanes };
        let kind = NodeKind::Crossing(Control::Signals);
        let plan = |name, frame| DiamondPlan {
            name,
            frame,
            reach_m: REACH_M,
            beside_m: RAMP_END_M,
            lift_m: deck,
            kind,
            kerb_radius_m: self.parameters.kerb_radius_m,
        };
        let [west, east] = [(0, "Interchange West"), (1, "Interchange East")].map(|(k, name)| {
            let frame = frame.then(self.x_m[self.crossings[k]], 0.0, 0.0);
            diamond(&mut self.layout, &road, &plan(name, frame))
        });
        let last = |list: &[f64]| list.last().copied().unwrap_or(0.0);
        let top = last(&self.y_m) + NORTH_M;
        let north_at = frame.then(self.x_m[self.northern], top, PI);
        let north = diamond(&mut self.layout, &road, &plan("Interchange North", north_at));
        // The corners keep clear of the city and of the interchanges' ends.
        let reach = CORNER_M[0] + CORNER_M[1];
        let beyond = |edge: f64, lanes: f64| (edge + CLEAR_M).max(lanes + 90.0) + reach;
        let sides = [
            -beyond(-self.x_m[0], REACH_M - self.x_m[self.crossings[0]]),
            beyond(last(&self.x_m), REACH_M + self.x_m[self.crossings[1]]),
        ];
        let [left, right] = sides.map(|x| road.seam(&mut self.layout, frame.at(x, 0.5 * top), 0.0));

        let exit = exit_lane();
        let none = Ending::default();
        let bend = |edge: Edge, x: f64, y: f64| edge.via(frame.at(x, y), CORNER_M[0], CORNER_M[1]);
        // The deck stays up until it has left the city.
        let up = |edge: Edge, x: f64| edge.lifted(frame.at(x, 0.0), deck);
        let [x0, x1] = [self.x_m[0] - CLEAR_M, last(&self.x_m) + CLEAR_M];
        let mut add = |edge: Edge, start: Ending, end: Ending| self.layout.edge(edge.start(start).end(end));
        add(road.edge(west.seams[0], west.seams[1], [0, 0]), none, none);
        // Between the interchanges the entries' lanes go on to the exits.
        add(road.edge(west.seams[1], east.seams[0], [1, 1]), none, none);
        add(road.edge(east.seams[0], east.seams[1], [0, 0]), none, none);
        let edge = road.edge(east.seams[1], right, [0, 1]);
        let edge = if sides[1] - reach > x1 + 30.0 || x1 > self.x_m[self.crossings[1]] + REACH_M + 60.0 {
            up(edge, x1)
        } else {
            edge
        };
        add(bend(edge, sides[1], 0.0), exit, none);
        add(bend(road.edge(right, north.seams[0], [1, 0]), sides[1], top), none, exit);
        add(road.edge(north.seams[0], north.seams[1], [0, 0]), none, none);
        add(bend(road.edge(north.seams[1], left, [0, 1]), sides[0], top), exit, none);
        let edge = bend(road.edge(left, west.seams[0], [1, 0]), sides[0], 0.0);
        let edge = if x0 < self.x_m[self.crossings[0]] - REACH_M - 60.0 { up(edge, x0) } else { edge };
        add(edge, none, exit);
        ([west, east], north)
    }

    /// Whether a column passes under the viaduct: not beside an interchange, where ramps come down.
    fn passes(&self, column: usize) -> bool {
        self.crossings.iter().all(|c| column.abs_diff(*c) != 1)
    }

    fn streets(&mut self, diamonds: [Diamond; 2], north: Diamond) {
        let (columns, rows) = (self.x_m.len(), self.y_m.len());
        let mut blocks = Blocks::new(Stream::new(self.parameters.seed, 0, "town/viaduct/gaps", 0));
        for i in 0..columns {
            for j in 0..rows {
                blocks.place([i, j], self.frame.at(self.x_m[i], self.y_m[j]));
            }
        }
        for j in 0..rows {
            for i in 0..columns - 1 {
                blocks.link([i, j], [i + 1, j]);
            }
        }
        for i in 0..columns {
            for j in 0..rows - 1 {
                let under = j + 1 == self.south;
                if !under || (self.passes(i) && !self.crossings.contains(&i)) {
                    blocks.link([i, j], [i, j + 1]);
                }
            }
        }
        let mut kept: BTreeSet<Cell> = BTreeSet::new();
        for i in self.crossings {
            kept.extend([[i, self.south - 1], [i, self.south]]);
        }
        kept.insert([self.northern, rows - 1]);
        let own = &self.parameters.viaduct;
        let quiet = |a: Cell, b: Cell| self.class(a, b) == Class::Street;
        blocks.leave_out(own.gaps, |a, b| quiet(a, b) && !kept.contains(&a) && !kept.contains(&b));

        let mut nodes: BTreeMap<Cell, NodeId> = BTreeMap::new();
        for (cell, at_m) in blocks.crossings(&kept) {
            let node = Node::new(at_m, NodeKind::Crossing(self.control(cell)))
                .kerbs(self.parameters.kerb_radius_m)
                .named(format!("crossing {}-{}", cell[0], cell[1]));
            nodes.insert(cell, self.layout.node(node));
        }
        for chain in blocks.chains(&nodes) {
            let (Some([a, b]), Some([y, z])) = (chain.first_pair(), chain.last_pair()) else { continue };
            let class = self.class(a, b);
            let line = if a[1] == b[1] { a[1] } else { columns + a[0] };
            let (Some(from), Some(to)) = (nodes.get(&a), nodes.get(&z)) else { continue };
            let mut edge = Edge::new(self.name(a, b), *from, *to, self.shape(class, line))
                .start(self.ending(class, b, a))
                .end(self.ending(class, y, z));
            for at_m in &chain.corners_m {
                edge = edge.via(*at_m, BEND_M[0], BEND_M[1]);
            }
            self.layout.edge(edge);
        }
        for (k, diamond) in diamonds.iter().enumerate() {
            let i = self.crossings[k];
            let at = |j: usize| nodes.get(&[i, j]).copied();
            let name = format!("Avenue {i}");
            self.under(&name, at(self.south - 1), diamond.ends, at(self.south));
        }
        let last = nodes.get(&[self.northern, rows - 1]).copied();
        // Seen along the motorway in the north, the city lies to its left.
        self.under("North Avenue", last, [north.ends[1], north.ends[0]], None);
    }

    /// The avenue that passes under the motorway between the ends of an interchange's ramps.
    fn under(&mut self, name: &str, south: Option<NodeId>, ends: [NodeId; 2], north: Option<NodeId>) {
        let shape = self.shape(Class::Avenue, 0);
        let pocket = |[length_m, taper_m]: [f64; 2]| Ending {
            left: Some(Pocket::one(length_m, taper_m)),
            ..Ending::default()
        };
        let none = Ending::default();
        let mut add = |from: NodeId, to: NodeId, start: Ending, end: Ending| {
            self.layout.edge(Edge::new(name, from, to, shape).start(start).end(end));
        };
        if let Some(south) = south {
            add(south, ends[0], none, none);
        }
        // Where the street ends behind the motorway, nothing turns left into a ramp at its last end.
        let both = [pocket(SHORT_POCKET_M), pocket(SHORT_POCKET_M)];
        add(ends[0], ends[1], both[0], if north.is_some() { both[1] } else { none });
        if let Some(north) = north {
            add(ends[1], north, none, none);
        }
    }

    fn class(&self, a: Cell, b: Cell) -> Class {
        let row = a[1] == b[1];
        let avenue = if row { self.avenue_rows.contains(&a[1]) } else { self.crossings.contains(&a[0]) };
        if avenue { Class::Avenue } else { Class::Street }
    }

    fn name(&self, a: Cell, b: Cell) -> String {
        match (self.class(a, b), a[1] == b[1]) {
            (Class::Avenue, true) => format!("East Avenue {}", a[1]),
            (Class::Avenue, false) => format!("Avenue {}", a[0]),
            (Class::Street, true) => format!("East Street {}", a[1]),
            (Class::Street, false) => format!("North Street {}", a[0]),
        }
    }

    fn control(&self, [i, j]: Cell) -> Control {
        let avenues = [self.crossings.contains(&i) || i == self.northern, self.avenue_rows.contains(&j)];
        let beside = j + 1 == self.south || j == self.south;
        match (avenues, beside, (i + j) % 3) {
            ([false, false], false, 0) => Control::AllStop,
            ([false, false], false, 1) => Control::MinorStop,
            _ => Control::Signals,
        }
    }

    fn shape(&self, class: Class, line: usize) -> CrossSection {
        let side = |lanes: u8| {
            Side::town(lanes, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m)
        };
        let mut draws = Stream::new(self.parameters.seed, 0, "town/viaduct/parking", line as u64);
        let mut parked = |side: Side| {
            let parks = draws.chance(self.parameters.viaduct.parking_share);
            side.with_parking(if parks { PARKING_M } else { 0.0 })
        };
        match class {
            Class::Avenue => CrossSection::both_ways(side(2).with_bike(BIKE_M), AVENUE_KMH)
                .with_median(Median::raised(MEDIAN_M)),
            Class::Street => {
                let (left, right) = (parked(side(1)), parked(side(1)));
                CrossSection { left, ..CrossSection::both_ways(right, STREET_KMH) }
            }
        }
    }

    /// Pockets of an avenue for the traffic that comes from one crossing to the next: where avenues cross.
    fn ending(&self, class: Class, from: Cell, at: Cell) -> Ending {
        let row = from[1] == at[1];
        let across = if row { self.crossings.contains(&at[0]) } else { self.avenue_rows.contains(&at[1]) };
        let inner = at[0] > 0 && at[0] + 1 < self.x_m.len() && at[1] > 0 && at[1] + 1 < self.y_m.len();
        let [length_m, taper_m] = POCKET_M;
        let left = (class == Class::Avenue && across && inner).then_some(Pocket::one(length_m, taper_m));
        Ending { left, ..Ending::default() }
    }
}

/// What kind of street it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Avenue,
    Street,
}
