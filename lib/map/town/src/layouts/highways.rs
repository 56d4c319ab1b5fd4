//! Highways: a motorway ring with diamonds and a trumpet, and inside it a divided highway where turns to the
//! left are made through its wide median (Michigan lefts), between suburbs.

use random::Stream;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::motorway::{Diamond, DiamondPlan, Frame, Motorway, diamond, exit_lane};
use super::trumpet::{self, Trumpet, trumpet};
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::section::{CrossSection, Ending, Median, Pocket, Side};
use crate::terrain::{Terrain, Wave};

/// Speed limits of the motorway, the highway, crossroads, collectors and lanes, km/h.
const MOTORWAY_KMH: f64 = 100.0;
const HIGHWAY_KMH: f64 = 70.0;
const CROSSROAD_KMH: f64 = 60.0;
const COLLECTOR_KMH: f64 = 50.0;
const LANE_KMH: f64 = 40.0;
/// Driving lanes of each direction of the motorway, the highway and crossroads.
const MOTORWAY_LANES: u8 = 3;
const HIGHWAY_LANES: u8 = 3;
const CROSSROAD_LANES: u8 = 2;
const CROSSROAD_MEDIAN_M: f64 = 3.0;
/// Half the length of the ring from south to north, metres.
const HALF_NORTH_M: f64 = 1020.0;
/// Radius and clothoid of the ring's corners, metres.
const CORNER_M: [f64; 2] = [450.0, 120.0];
/// From the highway's first and last crossroad to the ring's west and east side, metres.
const WEST_M: f64 = 760.0;
const EAST_M: f64 = 720.0;
/// From a crossroad to the crossovers on either side, metres.
const CROSSOVER_M: f64 = 175.0;
/// From the ring to where the highway's form changes, west and east, metres.
const CHANGE_M: [f64; 2] = [400.0, 310.0];
const CHANGE_LENGTH_M: [f64; 2] = [110.0, 70.0];
/// From a diamond's street to its seams, from the motorway's axis to the ends of its ramps, and the
/// motorway's height.
const REACH_M: f64 = 290.0;
const RAMP_END_M: f64 = 62.0;
const DECK_M: f64 = 7.4;
/// Where lanes end between two interchanges: share of the way to the corner, and the motorway's height,
/// metres.
const DROP_SHARE: f64 = 0.65;
const DROP_M: f64 = 2.4;
/// Full length and taper of pockets before crossovers, for turns to the right, and on smaller roads, metres.
const CROSSOVER_POCKET_M: [f64; 2] = [60.0, 30.0];
const RIGHT_POCKET_M: [f64; 2] = [45.0, 25.0];
const LEFT_POCKET_M: [f64; 2] = [30.0, 18.0];
/// From the highway to the collectors north and south of it, metres.
const COLLECTOR_M: [f64; 2] = [330.0, 390.0];
/// Radius and clothoid where a crossroad turns into a collector, and of the lanes' corners, metres.
const TURN_M: [f64; 2] = [60.0, 20.0];
const LANE_TURN_M: [f64; 2] = [40.0, 12.0];
/// How far lanes lead from their collector: outwards (a crescent), inwards (a close), metres.
const CRESCENT_M: [f64; 2] = [170.0, 240.0];
const CLOSE_M: [f64; 2] = [130.0, 190.0];
const CIRCLE_M: f64 = 10.0;

/// The highways.
pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    Highways::new(parameters).build()
}

struct Highways<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    frame: Frame,
    /// Where the crossroads meet the southern collector, the highway and the northern collector; in the
    /// frame.
    at_m: Vec<[[f64; 2]; 3]>,
    /// West and east side of the ring.
    sides_m: [f64; 2],
    /// The crossroad that leads to the ring in the north and in the south.
    through: usize,
    layout: Layout,
}

impl<'a> Highways<'a> {
    fn new(parameters: &'a TownParameters) -> Self {
        let own = &parameters.highways;
        let mut draws = Stream::new(parameters.seed, 0, "town/highways", 0);
        let count = own.crossroads as usize;
        let mut x = vec![0.0];
        for _ in 1..count {
            x.push(x.last().copied().unwrap_or(0.0) + draws.uniform(own.spacing_m[0], own.spacing_m[1]));
        }
        let last = x.last().copied().unwrap_or(0.0);
        let middle = 0.5 * (last + EAST_M - WEST_M);
        let wander = own.wander_m;
        let at_m = x
            .iter()
            .map(|x| {
                let mut off = || draws.uniform(-wander, wander);
                let x = x - middle;
                let y = off();
                let south = [x + off(), y - 0.5 * (COLLECTOR_M[0] + COLLECTOR_M[1]) + 0.5 * off()];
                let north = [x + off(), y + 0.5 * (COLLECTOR_M[0] + COLLECTOR_M[1]) + 0.5 * off()];
                [south, [x, y], north]
            })
            .collect();
        let through = 1 + draws.index(count - 2).unwrap_or(0);
        let waves = (0..3)
            .map(|i| Wave {
                amplitude_m: own.relief_m / 6.0,
                period_m: draws.uniform(900.0, 1700.0),
                heading_rad: draws.uniform(0.0, TAU) + f64::from(i),
                phase_rad: draws.uniform(0.0, TAU),
            })
            .collect();
        let mut layout = Layout::new(&parameters.name, Terrain { waves, ..Terrain::flat() });
        layout.geo_reference = parameters.geo_reference();
        let heading_rad = draws.uniform(-0.5, 0.5);
        Self {
            parameters,
            draws,
            frame: Frame { origin_m: [0.0, 0.0], heading_rad },
            at_m,
            sides_m: [-middle - WEST_M, last - middle + EAST_M],
            through,
            layout,
        }
    }

    fn build(mut self) -> Layout {
        let (diamonds, trumpet) = self.ring();
        let crossings = self.highway(diamonds[1], trumpet);
        self.crossroads(&crossings, diamonds);
        self.layout
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.frame.at(x, y)
    }

    /// The motorway, counter-clockwise. Returns the diamonds in the south, east and north, and the trumpet in
    /// the west.
    fn ring(&mut self) -> ([Diamond; 3], Trumpet) {
        let road = Motorway { name: "Ring Motorway", limit_kmh: MOTORWAY_KMH, lanes: MOTORWAY_LANES };
        let [west, east] = self.sides_m;
        let (frame, half) = (self.frame, HALF_NORTH_M);
        let [south_x, _, north_x] = self.at_m[self.through].map(|p| p[0]);
        let plan = |name, frame| DiamondPlan {
            name,
            frame,
            reach_m: REACH_M,
            beside_m: RAMP_END_M,
            lift_m: DECK_M,
            kind: NodeKind::Crossing(Control::Signals),
            kerb_radius_m: self.parameters.kerb_radius_m,
        };
        let last_y = self.at_m.last().map_or(0.0, |p| p[1][1]);
        let first_y = self.at_m.first().map_or(0.0, |p| p[1][1]);
        let places = [
            ("Exit South", frame.then(south_x, -half, 0.0)),
            ("Exit East", frame.then(east, last_y, FRAC_PI_2)),
            ("Exit North", frame.then(north_x, half, PI)),
        ];
        let [south, right, north] =
            places.map(|(name, at)| diamond(&mut self.layout, &road, &plan(name, at)));
        // The road to the trumpet comes from its right.
        let left = trumpet(&mut self.layout, &road, "Western Spur", frame.then(west, first_y, FRAC_PI_2));

        // Between two interchanges the lanes of the entries end, those of either direction at the same place.
        let seam = |layout: &mut Layout, x: f64, y: f64| road.seam(layout, frame.at(x, y), DROP_M);
        let between = |a: f64, b: f64| a + DROP_SHARE * (b - a);
        let reach = CORNER_M[0] + 0.5 * CORNER_M[1];
        let drops = [
            seam(&mut self.layout, between(south_x + REACH_M, east - reach), -half),
            seam(&mut self.layout, between(north_x + REACH_M, east - reach), half),
            seam(&mut self.layout, between(north_x - REACH_M, west + reach), half),
            seam(&mut self.layout, between(south_x - REACH_M, west + reach), -half),
        ];
        let exit = exit_lane();
        let none = Ending::default();
        // In the corners the motorway lies on the ground.
        let corner = |edge: Edge, x: f64, y: f64| {
            edge.via(frame.at(x, y), CORNER_M[0], CORNER_M[1]).lifted(frame.at(x, y), 0.0)
        };
        let mut add = |edge: Edge, start: Ending, end: Ending| self.layout.edge(edge.start(start).end(end));
        for diamond in [south, right, north] {
            add(road.edge(diamond.seams[0], diamond.seams[1], [0, 0]), none, none);
        }
        add(road.edge(south.seams[1], drops[0], [0, 1]), exit, none);
        add(corner(road.edge(drops[0], right.seams[0], [1, 0]), east, -half), none, exit);
        add(corner(road.edge(right.seams[1], drops[1], [0, 1]), east, half), exit, none);
        add(road.edge(drops[1], north.seams[0], [1, 0]), none, exit);
        add(road.edge(north.seams[1], drops[2], [0, 1]), exit, none);
        add(corner(road.edge(drops[2], left.seams[2], [1, 0]), west, half), none, none);
        add(corner(road.edge(left.seams[0], drops[3], [0, 1]), west, -half), exit, none);
        add(road.edge(drops[3], south.seams[0], [1, 0]), none, exit);
        left.carriageways(&mut self.layout, &road);
        ([south, right, north], left)
    }

    fn side(&self, lanes: u8) -> Side {
        Side::town(lanes, self.parameters.lane_width_m).with_sidewalk(self.parameters.sidewalk_m)
    }

    fn highway_shape(&self) -> CrossSection {
        let side = self.side(HIGHWAY_LANES).with_verge(1.5);
        CrossSection::both_ways(side, HIGHWAY_KMH)
            .with_median(Median::raised(self.parameters.highways.median_m))
    }

    fn crossroad_shape(&self) -> CrossSection {
        CrossSection::both_ways(self.side(CROSSROAD_LANES), CROSSROAD_KMH)
            .with_median(Median::raised(CROSSROAD_MEDIAN_M))
    }

    /// The divided highway from the trumpet to the ring's east side. Returns its crossings.
    fn highway(&mut self, east: Diamond, trumpet: Trumpet) -> Vec<NodeId> {
        let shape = self.highway_shape();
        let places: Vec<[f64; 2]> = self.at_m.iter().map(|p| p[1]).collect();
        let (first_y, last_y) = (places[0][1], places[places.len() - 1][1]);
        let mut change = |x: f64, y: f64, length_m: f64| {
            let node =
                Node::new(self.frame.at(x, y), NodeKind::Seam { length_m }).named("Grand River Avenue");
            self.layout.node(node)
        };
        let start = change(self.sides_m[0] + CHANGE_M[0], first_y, CHANGE_LENGTH_M[0]);
        let finish = change(self.sides_m[1] - CHANGE_M[1], last_y, CHANGE_LENGTH_M[1]);
        self.layout.edge(Edge::new("Western Spur", start, trumpet.road, trumpet::road_shape(trumpet::LANES)));

        let pocket = |[length_m, taper_m]: [f64; 2]| Some(Pocket::one(length_m, taper_m));
        // The traffic that has just passed a crossing may turn back; that from the other side may not.
        let back = Ending { left: pocket(CROSSOVER_POCKET_M), ..Ending::default() };
        let right = Ending { right: pocket(RIGHT_POCKET_M), ..Ending::default() };
        let mut crossings = Vec::new();
        let mut before = start;
        let name = "Grand River Avenue";
        for (i, at) in places.iter().enumerate() {
            let toward = |other: Option<&[f64; 2]>, ahead: f64| {
                let [x, y] = other.copied().unwrap_or([at[0] + ahead, at[1]]);
                let (dx, dy) = (x - at[0], y - at[1]);
                let share = CROSSOVER_M / (dx * dx + dy * dy).sqrt();
                [at[0] + share * dx, at[1] + share * dy]
            };
            let ends =
                [toward(i.checked_sub(1).and_then(|k| places.get(k)), -1.0), toward(places.get(i + 1), 1.0)];
            let node = Node::new(self.at(*at), NodeKind::Crossing(Control::Signals))
                .kerbs(self.parameters.kerb_radius_m)
                .without_lefts()
                .named(format!("Grand River Avenue and Crossroad {}", i + 1));
            let crossing = self.layout.node(node);
            let turns = ends.map(|end| {
                let node = Node::new(self.frame.at(end[0], end[1]), NodeKind::Crossover);
                self.layout.node(node.named(format!("crossover {}", i + 1)))
            });
            self.layout.edge(Edge::new(name, before, turns[0], shape));
            self.layout.edge(Edge::new(name, turns[0], crossing, shape).start(back).end(right));
            self.layout.edge(Edge::new(name, crossing, turns[1], shape).start(right).end(back));
            before = turns[1];
            crossings.push(crossing);
        }
        self.layout.edge(Edge::new(name, before, finish, shape));
        let left = Ending { left: pocket(LEFT_POCKET_M), ..Ending::default() };
        let road = self.crossroad_shape();
        // Seen along the ring, the highway comes from the left.
        self.layout.edge(Edge::new(name, finish, east.ends[1], road));
        self.layout.edge(Edge::new(name, east.ends[1], east.ends[0], road).start(left));
        crossings
    }

    /// The crossroads, the collectors on either side of the highway, and the lanes of the suburbs.
    fn crossroads(&mut self, crossings: &[NodeId], diamonds: [Diamond; 3]) {
        let shape = self.crossroad_shape();
        let collector = CrossSection::both_ways(self.side(1), COLLECTOR_KMH);
        let right =
            Ending { right: Some(Pocket::one(RIGHT_POCKET_M[0], RIGHT_POCKET_M[1])), ..Ending::default() };
        let left =
            Ending { left: Some(Pocket::one(LEFT_POCKET_M[0], LEFT_POCKET_M[1])), ..Ending::default() };
        let none = Ending::default();
        let last = crossings.len() - 1;
        for (half, north) in [(0, false), (2, true)] {
            let places: Vec<[f64; 2]> = self.at_m.iter().map(|p| self.at(p[half])).collect();
            let mut row: Vec<(NodeId, Vec<[f64; 2]>)> = Vec::new();
            for (i, crossing) in crossings.iter().enumerate() {
                if i == 0 || i == last {
                    // The outermost crossroads turn into the collector.
                    row.push((*crossing, vec![places[i]]));
                    continue;
                }
                let through = i == self.through;
                let control = if through { Control::Signals } else { Control::AllStop };
                let node = Node::new(places[i], NodeKind::Crossing(control))
                    .kerbs(self.parameters.kerb_radius_m)
                    .named(format!("collector and Crossroad {}", i + 1));
                let node = self.layout.node(node);
                let name = format!("Crossroad {}", i + 1);
                let end = if through { left } else { none };
                self.layout.edge(Edge::new(&name, *crossing, node, shape).start(right).end(end));
                if through {
                    let diamond = if north { diamonds[2] } else { diamonds[0] };
                    // The ring's left is inside.
                    let [outer, inner] = diamond.ends;
                    self.layout.edge(Edge::new(&name, node, inner, shape).start(left));
                    self.layout.edge(Edge::new(&name, inner, outer, shape).start(left));
                }
                row.push((node, Vec::new()));
            }
            let name = if north { "North Collector" } else { "South Collector" };
            for (k, pair) in row.windows(2).enumerate() {
                let ((from, a), (to, b)) = (&pair[0], &pair[1]);
                let (p, q) = (places[k], places[k + 1]);
                self.suburb(name, collector, [*from, *to], [a, b], [p, q], north);
            }
        }
    }

    /// A collector between two crossroads, with a crescent on its outer and a close on its inner side.
    fn suburb(
        &mut self,
        name: &str,
        shape: CrossSection,
        ends: [NodeId; 2],
        corners: [&[[f64; 2]]; 2],
        [p, q]: [[f64; 2]; 2],
        north: bool,
    ) {
        let along = |share: f64| [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])];
        let out = if north { 1.0 } else { -1.0 };
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        let length = (dx * dx + dy * dy).sqrt();
        let aside = |[x, y]: [f64; 2], by: f64| [x - out * by * dy / length, y + out * by * dx / length];
        let lane = CrossSection::both_ways(self.side(1), LANE_KMH);
        let shares =
            [self.draws.uniform(0.22, 0.3), self.draws.uniform(0.45, 0.55), self.draws.uniform(0.7, 0.78)];
        let mut junction = |at_m: [f64; 2]| {
            let node = Node::new(at_m, NodeKind::Crossing(Control::MinorStop))
                .kerbs(self.parameters.kerb_radius_m)
                .named(name);
            self.layout.node(node)
        };
        let nodes = shares.map(|share| junction(along(share)));
        // The collector.
        let mut from = ends[0];
        let mut vias: Vec<[f64; 2]> = corners[0].to_vec();
        for to in nodes.into_iter().chain([ends[1]]) {
            if to == ends[1] {
                vias.extend_from_slice(corners[1]);
            }
            let edge = Edge::new(name, from, to, shape);
            let bend = |edge: Edge, at: [f64; 2]| edge.via(at, TURN_M[0], TURN_M[1]);
            self.layout.edge(vias.drain(..).fold(edge, bend));
            from = to;
        }
        // A crescent outside, bent by chance.
        let depths = [0, 1].map(|_| self.draws.uniform(CRESCENT_M[0], CRESCENT_M[1]));
        let lean = [self.draws.uniform(-0.05, 0.05), self.draws.uniform(-0.05, 0.05)];
        let top =
            [aside(along(shares[0] + lean[0]), depths[0]), aside(along(shares[2] + lean[1]), depths[1])];
        let middle = [0.5 * (top[0][0] + top[1][0]), 0.5 * (top[0][1] + top[1][1])];
        let crown = self.layout.node(
            Node::new(middle, NodeKind::Crossing(Control::MinorYield))
                .kerbs(self.parameters.kerb_radius_m)
                .named(format!("{name} crescent")),
        );
        let turn = |edge: Edge, at: [f64; 2]| edge.via(at, LANE_TURN_M[0], LANE_TURN_M[1]);
        let crescent = format!("{name} crescent");
        self.layout.edge(turn(Edge::new(&crescent, nodes[0], crown, lane), top[0]));
        self.layout.edge(turn(Edge::new(&crescent, crown, nodes[2], lane), top[1]));
        // A close inside, and one that leads on from the crescent's crown.
        for (start, at, depth) in [
            (nodes[1], along(shares[1]), -self.draws.uniform(CLOSE_M[0], CLOSE_M[1])),
            (crown, middle, self.draws.uniform(0.5 * CLOSE_M[0], 0.6 * CLOSE_M[1])),
        ] {
            let close = Node::new(aside(at, depth), NodeKind::DeadEnd { radius_m: CIRCLE_M });
            let end = self.layout.node(close.named(format!("{name} close")));
            self.layout.edge(Edge::new(format!("{name} close"), start, end, lane));
        }
    }
}
