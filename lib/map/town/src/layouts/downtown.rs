//! A down-town: a tree-lined boulevard between two districts, avenues with bike lanes, one-way streets, a
//! drive along the shore.

use frames::math::{atan2, sin, sin_cos, tan};
use random::Stream;
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Ending, Median, Pocket, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the boulevard, avenues, streets and the drive, km/h.
const BOULEVARD_KMH: f64 = 60.0;
const AVENUE_KMH: f64 = 50.0;
const STREET_KMH: f64 = 40.0;
const DRIVE_KMH: f64 = 50.0;
/// Lanes of each direction of the boulevard, an avenue, the drive; and of a one-way street.
const LANES: [u8; 3] = [3, 2, 2];
const ONE_WAY_LANES: u8 = 3;
/// Medians of the boulevard, an avenue, the drive, metres.
const MEDIANS_M: [f64; 3] = [9.0, 5.0, 4.0];
const BIKE_M: f64 = 2.0;
const PARKING_M: f64 = 2.3;
/// Grass with trees along the boulevard, metres.
const VERGE_M: f64 = 2.0;
/// Streets beside a boulevard or avenue are this much further away, metres.
const MAIN_MORE_M: f64 = 25.0;
/// Pockets: full length and taper, metres.
const MAIN_POCKET_M: [f64; 2] = [42.0, 20.0];
const STREET_POCKET_M: [f64; 2] = [24.0, 15.0];
/// Radius and clothoid of the drive's corners, metres.
const CORNER_M: [f64; 2] = [55.0, 18.0];
/// Period and largest sideways displacement of the columns' slow bends, metres.
const SWAY_M: [f64; 2] = [900.0, 11.0];
/// Most blocks that are joined to parks.
const PARKS: usize = 3;

/// The down-town: columns and rows; the outermost ones are the drive, whose corners are bends and not nodes.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    let mut town = Downtown::new(parameters);
    town.place_nodes();
    let streets = town.streets();
    town.build(&streets);
    town.drive();
    town.layout
}

/// What kind of street a line of the grid is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Boulevard,
    Avenue,
    /// Two ways.
    Street,
    /// One way: along the line, or against it.
    OneWay {
        along: bool,
    },
    Drive,
}

impl Class {
    fn is_main(self) -> bool {
        matches!(self, Self::Boulevard | Self::Avenue)
    }
}

/// A column and a row.
type Cell = [usize; 2];

/// A stretch of street between two neighbouring crossings, in the direction in which its line counts.
struct Stretch {
    from: Cell,
    to: Cell,
    class: Class,
    /// Which line it belongs to, counted from its side of the town.
    line: usize,
}

impl Stretch {
    /// Whether traffic may drive from one of its ends to the other.
    fn leads(&self, from: Cell, to: Cell) -> bool {
        match self.class {
            Class::OneWay { along: true } => (self.from, self.to) == (from, to),
            Class::OneWay { along: false } => (self.to, self.from) == (from, to),
            _ => (self.from, self.to) == (from, to) || (self.to, self.from) == (from, to),
        }
    }
}

struct Downtown<'a> {
    parameters: &'a TownParameters,
    columns: Vec<Class>,
    rows: Vec<Class>,
    /// Places of the crossings, by column and row.
    at_m: Vec<Vec<[f64; 2]>>,
    nodes: Vec<Vec<Option<NodeId>>>,
    layout: Layout,
    turn_rad: f64,
}

impl<'a> Downtown<'a> {
    fn new(parameters: &'a TownParameters) -> Self {
        let own = &parameters.downtown;
        let seed = parameters.seed;
        let mut draws = Stream::new(seed, 0, "town/downtown", 0);
        let (columns, rows) = (own.columns as usize, own.rows as usize);
        let boulevard = 3 + draws.index(columns - 6).unwrap_or(0);
        let avenues = [2, rows - 3];
        let columns: Vec<Class> =
            classes(&mut draws, columns, own.one_way_share, |i| (i == boulevard).then_some(Class::Boulevard));
        let rows: Vec<Class> =
            classes(&mut draws, rows, own.one_way_share, |j| avenues.contains(&j).then_some(Class::Avenue));
        let waves = (0..3)
            .map(|i| Wave {
                amplitude_m: own.relief_m / 6.0,
                period_m: draws.uniform(520.0, 900.0),
                heading_rad: draws.uniform(0.0, TAU) + f64::from(i),
                phase_rad: draws.uniform(0.0, TAU),
            })
            .collect();
        let mut layout = Layout::new(&parameters.name, Terrain { waves, ..Terrain::flat() });
        layout.geo_reference = parameters.geo_reference();
        let turn_rad = draws.uniform(-0.5, 0.5);
        let mut town = Self {
            parameters,
            nodes: vec![vec![None; rows.len()]; columns.len()],
            at_m: Vec::new(),
            columns,
            rows,
            layout,
            turn_rad,
        };
        town.at_m = town.places(&mut draws, boulevard);
        town
    }

    /// Where the lines of the grid cross. The rows leave the boulevard at angles of their own on either side;
    /// the columns sway slowly; the southernmost row is the shore, an arc. At the end the whole is turned.
    fn places(&self, draws: &mut Stream, boulevard: usize) -> Vec<Vec<[f64; 2]>> {
        let own = &self.parameters.downtown;
        let mut lines = |classes: &[Class]| -> Vec<f64> {
            let mut at = vec![0.0];
            for pair in classes.windows(2) {
                let more = if pair.iter().any(|c| c.is_main()) { MAIN_MORE_M } else { 0.0 };
                let last = at.last().copied().unwrap_or(0.0);
                at.push(last + draws.uniform(own.block_m[0], own.block_m[1]) + more);
            }
            at
        };
        let (x, y) = (lines(&self.columns), lines(&self.rows));
        let most = frames::deg(own.skew_deg);
        let skews = [draws.uniform(-most, -0.4 * most), draws.uniform(0.4 * most, most)];
        let phase = draws.uniform(0.0, TAU);
        let (width, height) = (x[x.len() - 1], y[y.len() - 1]);
        let (s, c) = sin_cos(self.turn_rad);
        let place = |i: usize, j: usize| {
            let across = x[i] - x[boulevard];
            // Along the shore nothing is skewed: an arc through both corners, by its parabola.
            let share = j as f64 / (y.len() - 1) as f64;
            let skew = tan(skews[usize::from(across > 0.0)]) * across * share;
            let bulge = (1.0 - share) * (1.0 - share) * (1.0 - share);
            let u = 2.0 * x[i] / width - 1.0;
            let north = y[j] + skew - bulge * own.shore_m * (1.0 - u * u);
            let east = x[i] + SWAY_M[1] * sin(TAU * y[j] / SWAY_M[0] + phase);
            let (dx, dy) = (east - 0.5 * width, north - 0.5 * height);
            [c * dx - s * dy, s * dx + c * dy]
        };
        (0..x.len()).map(|i| (0..y.len()).map(|j| place(i, j)).collect()).collect()
    }

    fn is_border(&self, [i, j]: Cell) -> [bool; 2] {
        [i == 0 || i + 1 == self.columns.len(), j == 0 || j + 1 == self.rows.len()]
    }

    fn place_nodes(&mut self) {
        for i in 0..self.columns.len() {
            for j in 0..self.rows.len() {
                let border = self.is_border([i, j]);
                if border == [true; 2] {
                    continue;
                }
                let classes = [self.columns[i], self.rows[j]];
                let quiet = classes == [Class::Street; 2] && border == [false; 2];
                let control = if quiet { Control::AllStop } else { Control::Signals };
                let node = Node::new(self.at_m[i][j], NodeKind::Crossing(control))
                    .kerbs(self.parameters.kerb_radius_m)
                    .named(format!("{} and {}", name(classes[1], false, j), name(classes[0], true, i)));
                self.nodes[i][j] = Some(self.layout.node(node));
            }
        }
    }

    /// The stretches inside the drive; a few between quiet streets are left out for parks.
    fn streets(&self) -> Vec<Stretch> {
        let mut all = Vec::new();
        let (columns, rows) = (self.columns.len(), self.rows.len());
        for j in 1..rows - 1 {
            for i in 0..columns - 1 {
                all.push(Stretch { from: [i, j], to: [i + 1, j], class: self.rows[j], line: j });
            }
        }
        for i in 1..columns - 1 {
            for j in 0..rows - 1 {
                all.push(Stretch { from: [i, j], to: [i, j + 1], class: self.columns[i], line: i });
            }
        }
        let mut draws = Stream::new(self.parameters.seed, 0, "town/downtown/parks", 0);
        let mut taken: Vec<Cell> = Vec::new();
        for _ in 0..4 * PARKS {
            let Some(at) = draws.index(all.len()) else { break };
            let stretch = &all[at];
            let ends = [stretch.from, stretch.to];
            let inside = ends.iter().all(|end| self.is_border(*end) == [false; 2]);
            // Neighbouring parks would leave streets that end at one another's parks.
            let near = |a: &Cell, b: &Cell| a[0].abs_diff(b[0]) <= 1 && a[1].abs_diff(b[1]) <= 1;
            let free = ends.iter().all(|end| !taken.iter().any(|other| near(end, other)));
            if stretch.class == Class::Street && inside && free {
                taken.extend(ends);
                all.remove(at);
            }
            if taken.len() == 2 * PARKS {
                break;
            }
        }
        all
    }

    fn build(&mut self, streets: &[Stretch]) {
        for stretch in streets {
            let ([a, b], [c, d]) = (stretch.from, stretch.to);
            let (Some(from), Some(to)) = (self.nodes[a][b], self.nodes[c][d]) else { continue };
            let column = a == c;
            let name = name(stretch.class, column, stretch.line);
            let shape = self.shape(stretch.class, column, stretch.line);
            let start = self.ending(streets, stretch, stretch.to, stretch.from);
            let end = self.ending(streets, stretch, stretch.from, stretch.to);
            self.layout.edge(match stretch.class {
                Class::OneWay { along: false } => Edge::new(name, to, from, shape).start(end).end(start),
                _ => Edge::new(name, from, to, shape).start(start).end(end),
            });
        }
    }

    fn side(&self, lanes: u8) -> Side {
        Side::town(lanes, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m)
    }

    fn shape(&self, class: Class, column: bool, line: usize) -> CrossSection {
        let mut draws = Stream::new(
            self.parameters.seed,
            0,
            "town/downtown/parking",
            2 * line as u64 + u64::from(column),
        );
        let mut parked = |side: Side| {
            let chance = draws.chance(self.parameters.downtown.parking_share);
            side.with_parking(if chance { PARKING_M } else { 0.0 })
        };
        match class {
            Class::Boulevard => CrossSection::both_ways(
                self.side(LANES[0]).with_bike(BIKE_M).with_verge(VERGE_M),
                BOULEVARD_KMH,
            )
            .with_median(Median::raised(MEDIANS_M[0])),
            Class::Avenue => CrossSection::both_ways(self.side(LANES[1]).with_bike(BIKE_M), AVENUE_KMH)
                .with_median(Median::raised(MEDIANS_M[1])),
            Class::Drive => CrossSection::both_ways(self.side(LANES[2]).with_bike(BIKE_M), DRIVE_KMH)
                .with_median(Median::raised(MEDIANS_M[2])),
            Class::Street => {
                let (left, right) = (parked(self.side(1)), parked(self.side(1)));
                CrossSection { left, ..CrossSection::both_ways(right, STREET_KMH) }
            }
            Class::OneWay { .. } => CrossSection::one_way(parked(self.side(ONE_WAY_LANES)), 0.5, STREET_KMH),
        }
    }

    /// Pockets of the traffic that comes from one crossing to the next.
    fn ending(&self, streets: &[Stretch], own: &Stretch, from: Cell, at: Cell) -> Ending {
        let border = self.is_border(at);
        let turned = |quarters: usize| -> Option<Cell> {
            let (mut dx, mut dy) = (at[0] as i64 - from[0] as i64, at[1] as i64 - from[1] as i64);
            for _ in 0..quarters {
                (dx, dy) = (-dy, dx);
            }
            Some([at[0].checked_add_signed(dx as isize)?, at[1].checked_add_signed(dy as isize)?])
        };
        let open =
            |quarters: usize| turned(quarters).is_some_and(|to| streets.iter().any(|s| s.leads(at, to)));
        let across = if own.from[0] == own.to[0] { self.rows[at[1]] } else { self.columns[at[0]] };
        let signals = border != [false; 2] || own.class != Class::Street || across != Class::Street;
        if border != [false; 2] || !own.leads(from, at) || !signals || !open(0) {
            return Ending::default();
        }
        let pocket = |lanes: u8, [length_m, taper_m]: [f64; 2]| Some(Pocket { lanes, length_m, taper_m });
        let mut ending = Ending::default();
        let both = own.class.is_main() && across.is_main();
        match own.class {
            Class::Boulevard | Class::Avenue => {
                if open(1) {
                    ending.left = pocket(if both { 2 } else { 1 }, MAIN_POCKET_M);
                }
                if open(3) && both {
                    ending.right = pocket(1, MAIN_POCKET_M);
                }
            }
            // A street gets room for its turns where it meets a main one.
            Class::Street if across.is_main() && open(1) => ending.left = pocket(1, STREET_POCKET_M),
            _ => {}
        }
        ending
    }

    /// The drive, counter-clockwise; between the crossings of the shore it follows the arc.
    fn drive(&mut self) {
        let shape = self.shape(Class::Drive, false, 0);
        let (right, top) = (self.columns.len() - 1, self.rows.len() - 1);
        let mut around: Vec<Cell> = Vec::new();
        around.extend((0..right).map(|i| [i, 0]));
        around.extend((0..top).map(|j| [right, j]));
        around.extend((1..=right).rev().map(|i| [i, top]));
        around.extend((1..=top).rev().map(|j| [0, j]));
        let count = around.len();
        let at = |k: usize| {
            let [i, j] = around[k % count];
            self.at_m[i][j]
        };
        // The direction in which the drive passes a crossing: along the chord of its neighbours.
        let along = |k: usize| {
            let (before, after) = (at(k + count - 1), at(k + 1));
            atan2(after[1] - before[1], after[0] - before[0])
        };
        let mut edges = Vec::new();
        for k in 0..count {
            let [i, j] = around[k];
            let Some(from) = self.nodes[i][j] else { continue };
            let beside = |k: usize| {
                let [i, j] = around[k % count];
                self.nodes[i][j]
            };
            let side = match (j, i) {
                (0, _) => "Shore Drive",
                (_, i) if i == right => "East Drive",
                (j, _) if j == top => "North Drive",
                _ => "West Drive",
            };
            // A straight line where both neighbours belong to the same side; else the corner is rounded.
            let edge = match (beside(k + 1), beside(k + 2)) {
                (Some(to), _) => Edge::new(side, from, to, shape).headings(
                    self.heading(along(k), beside(k + count - 1).is_some(), at(k), at(k + 1)),
                    self.heading(along(k + 1), beside(k + 2).is_some(), at(k), at(k + 1)) + 2.0 * FRAC_PI_2,
                ),
                (None, Some(to)) => Edge::new(side, from, to, shape).via(at(k + 1), CORNER_M[0], CORNER_M[1]),
                _ => continue,
            };
            edges.push(edge);
        }
        for edge in edges {
            self.layout.edge(edge);
        }
    }

    /// The heading of the drive at a crossing: along its neighbours' chord, or straight on towards a corner.
    fn heading(&self, along_rad: f64, curved: bool, from: [f64; 2], to: [f64; 2]) -> f64 {
        if curved { along_rad } else { atan2(to[1] - from[1], to[0] - from[0]) }
    }
}

/// The classes of a family of lines: the drive outside, mains where they are named, one-way streets in turns.
fn classes(
    draws: &mut Stream,
    count: usize,
    one_way_share: f64,
    main: impl Fn(usize) -> Option<Class>,
) -> Vec<Class> {
    let mut along = draws.chance(0.5);
    (0..count)
        .map(|i| {
            let one_way = draws.chance(one_way_share);
            if i == 0 || i + 1 == count {
                return Class::Drive;
            }
            if let Some(main) = main(i) {
                return main;
            }
            if one_way {
                along = !along;
                Class::OneWay { along }
            } else {
                Class::Street
            }
        })
        .collect()
}

/// Name of a line.
fn name(class: Class, column: bool, line: usize) -> String {
    match class {
        Class::Boulevard => "Grand Boulevard".into(),
        Class::Avenue => format!("Avenue {line}"),
        Class::Drive => "Drive".into(),
        Class::Street | Class::OneWay { .. } if column => format!("North Street {line}"),
        Class::Street | Class::OneWay { .. } => format!("East Street {line}"),
    }
}
