//! A city: an avenue and a boulevard with turn lanes, a roundabout, an underpass, side streets at odd angles,
//! a ring.

use random::Stream;
use std::f64::consts::TAU;

use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Ending, Median, Pocket, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the boulevard, the avenue, streets and the ring, km/h.
const BOULEVARD_KMH: f64 = 60.0;
const AVENUE_KMH: f64 = 50.0;
const STREET_KMH: f64 = 40.0;
const RING_KMH: f64 = 60.0;
const PARKING_M: f64 = 2.2;
const BIKE_M: f64 = 1.8;
/// Medians of the boulevard and the avenue, metres.
const MEDIANS_M: [f64; 2] = [5.0, 3.0];
/// Radius and clothoid of the ring's corners, metres.
const RING_BEND_M: [f64; 2] = [60.0, 20.0];
/// How deep the underpass lies, metres.
const UNDERPASS_M: f64 = -6.4;
/// A street comes up from the underpass over at least so many metres before the next crossing's middle.
const UNDERPASS_REACH_M: f64 = 130.0;

/// The city: a grid whose crossings are moved about; its outermost lines are a ring with rounded corners.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    let mut city = City::new(parameters);
    city.place_nodes();
    city.streets();
    city.ring();
    city.layout
}

struct City<'a> {
    parameters: &'a TownParameters,
    columns: usize,
    rows: usize,
    /// The boulevard's column, the avenue's row, the columns of the roundabout (on the avenue) and of the
    /// underpass.
    boulevard: usize,
    avenue: usize,
    roundabout: usize,
    underpass: usize,
    at_m: Vec<Vec<[f64; 2]>>,
    nodes: Vec<Vec<Option<NodeId>>>,
    layout: Layout,
}

impl<'a> City<'a> {
    fn new(parameters: &'a TownParameters) -> Self {
        let own = &parameters.city;
        let (columns, rows) = (own.columns as usize, own.rows as usize);
        let mut draws = Stream::new(parameters.seed, 0, "town/city", 0);
        let mut lines = |count: usize| -> Vec<f64> {
            let mut at = vec![0.0];
            for _ in 1..count {
                at.push(at.last().copied().unwrap_or(0.0) + draws.uniform(own.block_m[0], own.block_m[1]));
            }
            let middle = 0.5 * at.last().copied().unwrap_or(0.0);
            at.iter().map(|v| v - middle).collect()
        };
        let (x, mut y) = (lines(columns), lines(rows));
        let boulevard = 2 + draws.index(columns - 5).unwrap_or(0);
        let avenue = 2 + draws.index(rows - 4).unwrap_or(0);
        // The street below the avenue needs room to come up again, wherever its crossings are moved to.
        for j in [avenue, avenue + 1] {
            let lacking = UNDERPASS_REACH_M + 2.0 * own.disorder_m - (y[j] - y[j - 1]);
            y[j..].iter_mut().for_each(|y| *y += lacking.max(0.0));
        }
        let at_m = (0..columns)
            .map(|i| {
                let edge_x = i == 0 || i + 1 == columns;
                (0..rows)
                    .map(|j| {
                        let edge_y = j == 0 || j + 1 == rows;
                        // The ring stays straight; its crossings move along it.
                        let mut off = |fixed: bool| {
                            let d = draws.uniform(-own.disorder_m, own.disorder_m);
                            if fixed { 0.0 } else { d }
                        };
                        [x[i] + off(edge_x), y[j] + off(edge_y)]
                    })
                    .collect()
            })
            .collect();
        let waves = (0..3)
            .map(|i| Wave {
                amplitude_m: own.relief_m / 6.0,
                period_m: draws.uniform(480.0, 800.0),
                heading_rad: draws.uniform(0.0, TAU) + f64::from(i),
                phase_rad: draws.uniform(0.0, TAU),
            })
            .collect();
        let mut layout = Layout::new(&parameters.name, Terrain { waves, ..Terrain::flat() });
        layout.geo_reference = parameters.geo_reference();
        Self {
            parameters,
            columns,
            rows,
            boulevard,
            avenue,
            roundabout: columns - 2,
            underpass: if boulevard > 2 { boulevard - 1 } else { boulevard + 1 },
            at_m,
            nodes: vec![vec![None; rows]; columns],
            layout,
        }
    }

    fn kind(&self, i: usize, j: usize) -> Option<NodeKind> {
        let ring = [i == 0 || i + 1 == self.columns, j == 0 || j + 1 == self.rows];
        let main = i == self.boulevard || j == self.avenue;
        match ring {
            [true, true] => None,
            _ if (i, j) == (self.underpass, self.avenue) => None,
            [false, false] if (i, j) == (self.roundabout, self.avenue) => {
                Some(NodeKind::Roundabout { island_m: self.parameters.city.island_m, lanes: 2 })
            }
            [false, false] if main => Some(NodeKind::Crossing(Control::Signals)),
            [false, false] if (i + 2 * j).is_multiple_of(3) => Some(NodeKind::Crossing(Control::AllStop)),
            [false, false] if (i + 2 * j) % 3 == 1 => Some(NodeKind::Crossing(Control::MinorStop)),
            _ if main => Some(NodeKind::Crossing(Control::Signals)),
            _ => Some(NodeKind::Crossing(Control::MinorYield)),
        }
    }

    fn place_nodes(&mut self) {
        for i in 0..self.columns {
            for j in 0..self.rows {
                if let Some(kind) = self.kind(i, j) {
                    let node = Node::new(self.at_m[i][j], kind)
                        .kerbs(self.parameters.kerb_radius_m)
                        .named(format!("junction {i}-{j}"));
                    self.nodes[i][j] = Some(self.layout.node(node));
                }
            }
        }
    }

    fn side(&self, lanes: u8) -> Side {
        Side::town(lanes, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m)
    }

    fn street_shape(&self, topic: &str, index: usize) -> CrossSection {
        let mut draws = Stream::new(self.parameters.seed, 0, topic, index as u64);
        let mut draw = || {
            let parked = draws.chance(self.parameters.city.parking_share);
            self.side(1).with_parking(if parked { PARKING_M } else { 0.0 })
        };
        let (left, right) = (draw(), draw());
        CrossSection { left, ..CrossSection::both_ways(right, STREET_KMH) }
    }

    /// Pockets of a street where it meets a crossing of the main streets.
    fn ending(&self, i: usize, j: usize, main: bool, lanes: [u8; 2]) -> Ending {
        let signals = self.kind(i, j) == Some(NodeKind::Crossing(Control::Signals));
        let inner = i > 0 && j > 0 && i + 1 < self.columns && j + 1 < self.rows;
        if !signals || !inner || !main {
            return Ending::default();
        }
        let pocket = |lanes: u8| (lanes > 0).then_some(Pocket { lanes, length_m: 38.0, taper_m: 20.0 });
        Ending { left: pocket(lanes[0]), right: pocket(lanes[1]), ..Ending::default() }
    }

    fn streets(&mut self) {
        let boulevard = CrossSection::both_ways(self.side(3).with_verge(1.5), BOULEVARD_KMH)
            .with_median(Median::raised(MEDIANS_M[0]));
        let avenue = CrossSection::both_ways(self.side(2).with_bike(BIKE_M), AVENUE_KMH)
            .with_median(Median::raised(MEDIANS_M[1]));
        for j in 1..self.rows - 1 {
            let main = j == self.avenue;
            let (shape, name) = if main {
                (avenue, "Avenue".to_owned())
            } else {
                (self.street_shape("town/city/rows", j), format!("East {j}"))
            };
            self.chain((0..self.columns).map(|i| [i, j]).collect(), shape, &name, main, [1, 0]);
        }
        for i in 1..self.columns - 1 {
            let main = i == self.boulevard;
            let (shape, name) = if main {
                (boulevard, "Boulevard".to_owned())
            } else {
                (self.street_shape("town/city/columns", i), format!("North {i}"))
            };
            self.chain((0..self.rows).map(|j| [i, j]).collect(), shape, &name, main, [1, 1]);
        }
    }

    /// Edges from node to node along a line of the grid.
    fn chain(
        &mut self,
        line: Vec<[usize; 2]>,
        shape: CrossSection,
        name: &str,
        main: bool,
        pockets: [u8; 2],
    ) {
        let mut from: Option<[usize; 2]> = None;
        let mut between: Vec<[f64; 2]> = Vec::new();
        for [i, j] in line {
            let Some(node) = self.nodes[i][j] else {
                between.push(self.at_m[i][j]);
                continue;
            };
            if let Some([a, b]) = from
                && let Some(start) = self.nodes[a][b]
            {
                let mut edge = Edge::new(name, start, node, shape)
                    .start(self.ending(a, b, main, pockets))
                    .end(self.ending(i, j, main, pockets));
                for at in between.drain(..) {
                    // At the underpass the avenue goes straight over the street, which dives under it.
                    edge = edge.via(at, 400.0, 0.0);
                    if !main {
                        edge = edge.lifted(at, UNDERPASS_M);
                    }
                }
                self.layout.edge(edge);
            }
            between.clear();
            from = Some([i, j]);
        }
    }

    fn ring(&mut self) {
        let shape = CrossSection::both_ways(self.side(1), RING_KMH);
        let (right, top) = (self.columns - 1, self.rows - 1);
        let mut around: Vec<[usize; 2]> = Vec::new();
        around.extend((0..right).map(|i| [i, 0]));
        around.extend((0..top).map(|j| [right, j]));
        around.extend((1..=right).rev().map(|i| [i, top]));
        around.extend((1..=top).rev().map(|j| [0, j]));
        // From the first crossing after a corner all the way round.
        around.rotate_left(1);
        around.push(around[0]);
        let mut from: Option<NodeId> = None;
        let mut corner: Option<[f64; 2]> = None;
        for [i, j] in around {
            let Some(node) = self.nodes[i][j] else {
                corner = Some(self.at_m[i][j]);
                continue;
            };
            if let Some(start) = from {
                let mut edge = Edge::new("Ring", start, node, shape);
                if let Some(at) = corner {
                    edge = edge.via(at, RING_BEND_M[0], RING_BEND_M[1]);
                }
                self.layout.edge(edge);
            }
            (from, corner) = (Some(node), None);
        }
    }
}
