//! A layout: a grid of streets inside a ring road.

use frames::math::sin;
use random::Stream;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::TownParameters;
use crate::assemble::{Edge, Layout, Node};
use crate::control::Control;
use crate::section::{CrossSection, Side};

/// Width of the gutter between the carriageway and the kerb, metres.
const GUTTER_M: f64 = 0.5;
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

/// Headings, radians.
const EAST: f64 = 0.0;
const NORTH: f64 = FRAC_PI_2;
const WEST: f64 = PI;
const SOUTH: f64 = -FRAC_PI_2;

/// The nodes and edges of a town.
///
/// Nodes lie where `columns + 2` lines north and `rows + 2` lines east cross; the outermost lines are the ring, whose
/// corners are bends and not nodes.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    let (columns, rows) = (parameters.columns as usize, parameters.rows as usize);
    let x = lines(parameters, "town/columns", columns + 2);
    let y = lines(parameters, "town/rows", rows + 2);
    let mut relief = Stream::new(parameters.seed, 0, "town/relief", 0);
    let phase = [relief.uniform(0.0, TAU), relief.uniform(0.0, TAU)];
    let height = |x: f64, y: f64| {
        let wave = |at: f64, axis: usize| sin(TAU * at / RELIEF_PERIOD_M[axis] + phase[axis]);
        0.5 * parameters.relief_m * wave(x, 0) * wave(y, 1)
    };

    let mut town = Grid { columns, rows, nodes: Vec::new(), edges: Vec::new() };
    for (row, y_m) in y.iter().enumerate() {
        for (column, x_m) in x.iter().enumerate() {
            if town.is_corner(column, row) {
                continue;
            }
            let inside = (1..=columns).contains(&column) && (1..=rows).contains(&row);
            town.nodes.push(Node {
                x_m: *x_m,
                y_m: *y_m,
                z_m: height(*x_m, *y_m),
                control: if inside { Control::Signals } else { Control::Priority },
                name: format!("junction {column}-{row}"),
            });
        }
    }

    let avenue = 1 + Stream::new(parameters.seed, 0, "town/avenue", 0).index(rows).unwrap_or(0);
    for row in 1..=rows {
        let shape = if row == avenue {
            avenue_shape(parameters)
        } else {
            street_shape(parameters, "town/parking/rows", row)
        };
        let name = if row == avenue { "Avenue".into() } else { format!("East {row}") };
        for column in 0..=columns {
            town.edge([column, row], [column + 1, row], [EAST, WEST], shape, &name);
        }
    }
    for column in 1..=columns {
        let shape = street_shape(parameters, "town/parking/columns", column);
        for row in 0..=rows {
            town.edge([column, row], [column, row + 1], [NORTH, SOUTH], shape, &format!("North {column}"));
        }
    }
    town.ring(parameters);
    Layout {
        name: parameters.name.clone(),
        nodes: town.nodes,
        edges: town.edges,
        kerb_radius_m: parameters.kerb_radius_m,
        geo_reference: format!(
            "+proj=tmerc +lat_0={} +lon_0={} +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +vunits=m +no_defs",
            parameters.latitude_deg, parameters.longitude_deg
        ),
    }
}

/// Positions of `count` parallel centre lines, metres, with the middle of the first and the last at 0.
fn lines(parameters: &TownParameters, topic: &str, count: usize) -> Vec<f64> {
    let mut draws = Stream::new(parameters.seed, 0, topic, 0);
    let mut at = vec![0.0];
    for _ in 1..count {
        let last = at.last().copied().unwrap_or(0.0);
        at.push(last + draws.uniform(parameters.block_m[0], parameters.block_m[1]));
    }
    let middle = 0.5 * at.last().copied().unwrap_or(0.0);
    at.iter().map(|x| x - middle).collect()
}

fn side(parameters: &TownParameters, lanes: u8, parking_m: Option<f64>) -> Side {
    Side {
        lanes,
        lane_m: parameters.lane_width_m,
        gutter_m: GUTTER_M,
        parking_m,
        sidewalk_m: parameters.sidewalk_m,
    }
}

fn plain(parameters: &TownParameters, lanes: u8, median_m: f64, speed_limit_kmh: f64) -> CrossSection {
    let side = side(parameters, lanes, None);
    CrossSection { left: side, right: side, median_m, speed_limit_kmh }
}

fn street_shape(parameters: &TownParameters, topic: &str, index: usize) -> CrossSection {
    let mut draws = Stream::new(parameters.seed, 0, topic, index as u64);
    let mut draw = || side(parameters, 1, draws.chance(parameters.parking_share).then_some(PARKING_M));
    CrossSection { left: draw(), right: draw(), median_m: 0.0, speed_limit_kmh: STREET_KMH }
}

fn avenue_shape(parameters: &TownParameters) -> CrossSection {
    plain(parameters, 2, parameters.median_m, AVENUE_KMH)
}

struct Grid {
    columns: usize,
    rows: usize,
    nodes: Vec<Node>,
    edges: Vec<Edge>,
}

impl Grid {
    fn is_corner(&self, column: usize, row: usize) -> bool {
        (column == 0 || column == self.columns + 1) && (row == 0 || row == self.rows + 1)
    }

    /// Index of the node at a crossing that is not a corner: row by row, with the corners left out.
    fn node(&self, [column, row]: [usize; 2]) -> usize {
        let width = self.columns + 2;
        let corners_before = if row == 0 {
            1
        } else if row <= self.rows {
            2
        } else {
            3
        };
        row * width + column - corners_before
    }

    fn edge(
        &mut self,
        from: [usize; 2],
        to: [usize; 2],
        headings: [f64; 2],
        shape: CrossSection,
        name: &str,
    ) {
        self.bent_edge(from, to, headings, shape, [f64::INFINITY, 0.0], name);
    }

    fn bent_edge(
        &mut self,
        from: [usize; 2],
        to: [usize; 2],
        headings: [f64; 2],
        shape: CrossSection,
        bend_m: [f64; 2],
        name: &str,
    ) {
        let from = (self.node(from), headings[0]);
        let to = (self.node(to), headings[1]);
        self.edges.push(Edge { from, to, shape, bend_m, name: name.to_owned() });
    }

    /// The ring, counter-clockwise from its south-west corner.
    fn ring(&mut self, parameters: &TownParameters) {
        let shape = plain(parameters, 1, 0.0, RING_KMH);
        let bend = [parameters.ring_radius_m, RING_EASE_M];
        let (right, top) = (self.columns + 1, self.rows + 1);
        for column in 1..self.columns {
            self.edge([column, 0], [column + 1, 0], [EAST, WEST], shape, "Ring south");
        }
        self.bent_edge([self.columns, 0], [right, 1], [EAST, SOUTH], shape, bend, "Ring south-east");
        for row in 1..self.rows {
            self.edge([right, row], [right, row + 1], [NORTH, SOUTH], shape, "Ring east");
        }
        self.bent_edge(
            [right, self.rows],
            [self.columns, top],
            [NORTH, EAST],
            shape,
            bend,
            "Ring north-east",
        );
        for column in (1..self.columns).rev() {
            self.edge([column + 1, top], [column, top], [WEST, EAST], shape, "Ring north");
        }
        self.bent_edge([1, top], [0, self.rows], [WEST, NORTH], shape, bend, "Ring north-west");
        for row in (1..self.rows).rev() {
            self.edge([0, row + 1], [0, row], [SOUTH, NORTH], shape, "Ring west");
        }
        self.bent_edge([0, 1], [1, 0], [SOUTH, WEST], shape, bend, "Ring south-west");
    }
}
