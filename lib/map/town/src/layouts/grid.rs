//! Signalised blocks inside a ring road.

use random::Stream;
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Median, Side};
use crate::terrain::{Terrain, Wave};

/// Width of a parking lane, metres.
const PARKING_M: f64 = 2.3;
/// Speed limits of streets, the avenue and the ring, km/h.
const STREET_KMH: f64 = 40.0;
const AVENUE_KMH: f64 = 60.0;
const RING_KMH: f64 = 50.0;
/// Clothoid at each end of a corner of the ring, metres.
const RING_EASE_M: f64 = 12.0;
/// Period of the relief, metres: long against a block, so that slopes stay gentle.
const RELIEF_PERIOD_M: [f64; 2] = [420.0, 560.0];

/// The nodes and edges of a town.
///
/// Nodes lie where `columns + 2` lines north and `rows + 2` lines east cross; the outermost lines are the
/// ring, whose corners are bends and not nodes.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    let own = &parameters.grid;
    let (columns, rows) = (own.columns as usize, own.rows as usize);
    let mut town = Grid {
        x_m: lines(parameters, "town/columns", columns + 2),
        y_m: lines(parameters, "town/rows", rows + 2),
        nodes: vec![vec![None; rows + 2]; columns + 2],
        layout: Layout::new(&parameters.name, terrain(parameters)),
    };
    town.layout.geo_reference = parameters.geo_reference();
    for row in 0..rows + 2 {
        for column in 0..columns + 2 {
            let inside = (1..=columns).contains(&column) && (1..=rows).contains(&row);
            let corner = (column == 0 || column == columns + 1) && (row == 0 || row == rows + 1);
            let control = if inside { Control::Signals } else { Control::MinorYield };
            if !corner {
                let node = Node::new([town.x_m[column], town.y_m[row]], NodeKind::Crossing(control))
                    .kerbs(parameters.kerb_radius_m)
                    .named(format!("junction {column}-{row}"));
                town.nodes[column][row] = Some(town.layout.node(node));
            }
        }
    }

    let avenue = 1 + Stream::new(parameters.seed, 0, "town/avenue", 0).index(rows).unwrap_or(0);
    for row in 1..=rows {
        let (shape, name) = if row == avenue {
            (avenue_shape(parameters), "Avenue".into())
        } else {
            (street_shape(parameters, "town/parking/rows", row), format!("East {row}"))
        };
        for column in 0..=columns {
            town.edge([column, row], [column + 1, row], shape, &name, None);
        }
    }
    for column in 1..=columns {
        let shape = street_shape(parameters, "town/parking/columns", column);
        for row in 0..=rows {
            town.edge([column, row], [column, row + 1], shape, &format!("North {column}"), None);
        }
    }
    town.ring(parameters, columns, rows);
    town.layout
}

/// Two waves across each other, as high together as the relief.
fn terrain(parameters: &TownParameters) -> Terrain {
    let mut relief = Stream::new(parameters.seed, 0, "town/relief", 0);
    let wave = |heading_rad, period_m, phase_rad| Wave {
        amplitude_m: 0.25 * parameters.grid.relief_m,
        period_m,
        heading_rad,
        phase_rad,
    };
    let phases = [relief.uniform(0.0, TAU), relief.uniform(0.0, TAU)];
    let waves =
        vec![wave(0.0, RELIEF_PERIOD_M[0], phases[0]), wave(FRAC_PI_2, RELIEF_PERIOD_M[1], phases[1])];
    Terrain { waves, ..Terrain::flat() }
}

/// Positions of `count` parallel centre lines, metres, with the middle of the first and the last at 0.
fn lines(parameters: &TownParameters, topic: &str, count: usize) -> Vec<f64> {
    let mut draws = Stream::new(parameters.seed, 0, topic, 0);
    let block = parameters.grid.block_m;
    let mut at = vec![0.0];
    for _ in 1..count {
        let last = at.last().copied().unwrap_or(0.0);
        at.push(last + draws.uniform(block[0], block[1]));
    }
    let middle = 0.5 * at.last().copied().unwrap_or(0.0);
    at.iter().map(|x| x - middle).collect()
}

fn side(parameters: &TownParameters, lanes: u8) -> Side {
    Side::town(lanes, parameters.lane_width_m).with_sidewalk(parameters.sidewalk_m)
}

fn street_shape(parameters: &TownParameters, topic: &str, index: usize) -> CrossSection {
    let mut draws = Stream::new(parameters.seed, 0, topic, index as u64);
    let mut draw = || {
        let parked = draws.chance(parameters.grid.parking_share);
        side(parameters, 1).with_parking(if parked { PARKING_M } else { 0.0 })
    };
    let (left, right) = (draw(), draw());
    CrossSection { left, ..CrossSection::both_ways(right, STREET_KMH) }
}

fn avenue_shape(parameters: &TownParameters) -> CrossSection {
    let median = Median { width_m: parameters.grid.median_m, raised: true, through: false };
    CrossSection::both_ways(side(parameters, 2), AVENUE_KMH).with_median(median)
}

struct Grid {
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    /// By column and row; none in the corners.
    nodes: Vec<Vec<Option<NodeId>>>,
    layout: Layout,
}

impl Grid {
    /// A street from crossing to crossing, or round a corner of the ring.
    fn edge(
        &mut self,
        from: [usize; 2],
        to: [usize; 2],
        shape: CrossSection,
        name: &str,
        corner: Option<([usize; 2], f64)>,
    ) {
        let (Some(a), Some(b)) = (self.nodes[from[0]][from[1]], self.nodes[to[0]][to[1]]) else { return };
        let mut edge = Edge::new(name, a, b, shape);
        if let Some(([column, row], radius_m)) = corner {
            edge = edge.via([self.x_m[column], self.y_m[row]], radius_m, RING_EASE_M);
        }
        self.layout.edge(edge);
    }

    /// The ring, counter-clockwise from its south-west corner.
    fn ring(&mut self, parameters: &TownParameters, columns: usize, rows: usize) {
        let shape = CrossSection::both_ways(side(parameters, 1), RING_KMH);
        let radius = parameters.grid.ring_radius_m;
        let (right, top) = (columns + 1, rows + 1);
        for column in 1..columns {
            self.edge([column, 0], [column + 1, 0], shape, "Ring south", None);
        }
        self.edge([columns, 0], [right, 1], shape, "Ring south-east", Some(([right, 0], radius)));
        for row in 1..rows {
            self.edge([right, row], [right, row + 1], shape, "Ring east", None);
        }
        self.edge([right, rows], [columns, top], shape, "Ring north-east", Some(([right, top], radius)));
        for column in (1..columns).rev() {
            self.edge([column + 1, top], [column, top], shape, "Ring north", None);
        }
        self.edge([1, top], [0, rows], shape, "Ring north-west", Some(([0, top], radius)));
        for row in (1..rows).rev() {
            self.edge([0, row + 1], [0, row], shape, "Ring west", None);
        }
        self.edge([0, 1], [1, 0], shape, "Ring south-west", Some(([0, 0], radius)));
    }
}
