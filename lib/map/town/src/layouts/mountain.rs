//! A mountain town: a motorway in a figure of eight, deck over deck, with the town in one of its loops and a
//! mountain in the other; a country road joins them over the mountain's pass.

use frames::math::{cos, hypot, sin, sin_cos};
use random::Stream;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::carriageways::{Crossroad, Diamond, Size, Stop, diamond, motorway, seam};
use super::graph::{Graph, empty, first_that_builds};
use super::slope_town::{Slope, slope_town};
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::parameters::TownParameters;
use crate::path::{Pose2, Via};
use crate::section::{CrossSection, Side};
use crate::terrain::{Hill, Pad, Terrain, Wave};

/// Speed limits of the motorway, the country road and the road over the pass, km/h.
const MOTORWAY_KMH: f64 = 100.0;
const COUNTRY_KMH: f64 = 70.0;
const PASS_KMH: f64 = 50.0;
/// Where the loops' straight legs begin, as a share of half the length.
const KNEE: f64 = 0.42;
/// Radius and clothoids of the outer corners, and of the knees, metres.
const CORNER_M: [f64; 2] = [200.0, 60.0];
const KNEE_M: [f64; 2] = [400.0, 80.0];
const DIAMOND: Size = Size { seam_m: 205.0, terminal_m: 115.0 };
/// Height of the upper strand over the lower one, and of strands over the country road, metres.
const DECK_M: f64 = 9.0;
const STRAND_M: f64 = 8.2;
/// Way on which a strand comes down again, metres.
const DESCENT_M: f64 = 260.0;
/// Where the country road meets the strands, from their crossing, metres.
const UNDER_M: f64 = 215.0;
/// Mean grade of the road over the pass.
const CLIMB: f64 = 0.062;
/// Half the angle that it takes up on either face, radians.
const FACE_RAD: f64 = 0.56;
/// Its steepest places.
const PASS_GRADE: f64 = 0.115;
/// Radius of its hairpins, and distance between the legs that they join, metres.
const HAIRPIN_M: [f64; 2] = [22.0, 50.0];
/// Its tightest bend, metres: where the last hairpin leaves too little room before the pass, another layout
/// is tried.
const PASS_BEND_M: f64 = 12.0;
/// Its distance from the summit where it begins to climb, and at the pass, metres.
const FOOT_M: f64 = 320.0;
const TOP_M: f64 = 64.0;
const PASS_OUT_M: f64 = 56.0;
/// Height and radius of the hill with the tunnel, metres.
const TUNNEL_HILL_M: [f64; 2] = [46.0, 62.0];
/// Layouts that are tried.
const ATTEMPTS: u64 = 12;

pub(crate) fn layout(parameters: &TownParameters) -> Layout {
    first_that_builds(ATTEMPTS, |attempt| Town::new(parameters, attempt).layout())
}

/// A corner of a road on the mountain.
#[derive(Clone, Copy)]
struct Bend {
    /// Seen from the summit.
    bearing_rad: f64,
    /// Distance from the summit, metres.
    out_m: f64,
    radius_m: f64,
}

/// From the figure's own axes (its length along x) to the world.
#[derive(Clone, Copy)]
struct Frame {
    turn_rad: f64,
    mirrored: bool,
}

impl Frame {
    fn at(self, x: f64, y: f64) -> [f64; 2] {
        let (s, c) = sin_cos(self.turn_rad);
        let y = if self.mirrored { -y } else { y };
        [x * c - y * s, x * s + y * c]
    }

    fn pose(self, x: f64, y: f64, heading_rad: f64) -> Pose2 {
        let [x_m, y_m] = self.at(x, y);
        let heading = if self.mirrored { -heading_rad } else { heading_rad };
        Pose2 { x_m, y_m, heading_rad: frames::wrap_pi(heading + self.turn_rad) }
    }
}

struct Town<'a> {
    parameters: &'a TownParameters,
    draws: Stream,
    frame: Frame,
    /// Half the figure's length and width, and where its legs begin, metres.
    half_m: [f64; 2],
    knee_m: f64,
    /// Summit, and the standard deviation of its bell, metres.
    summit_m: [f64; 2],
    spread_m: f64,
    layout: Layout,
}

impl<'a> Town<'a> {
    fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.mountain;
        let mut draws = Stream::new(parameters.seed, 0, "town/mountain", attempt);
        let half_m = [0.5 * own.length_m, 0.5 * own.width_m];
        let frame = Frame { turn_rad: draws.uniform(-0.6, 0.6), mirrored: draws.chance(0.5) };
        Self {
            parameters,
            frame,
            half_m,
            knee_m: half_m[0] * (KNEE + draws.uniform(-0.02, 0.02)),
            summit_m: [-0.57 * half_m[0], draws.uniform(-25.0, 25.0)],
            spread_m: 3.2 * own.peak_m.max(45.0),
            draws,
            layout: empty(parameters, Terrain::flat()),
        }
    }

    fn layout(mut self) -> Layout {
        self.layout.terrain = self.terrain();
        let [town, mountain] = self.motorway();
        let gate = self.country(mountain.terminals[0]);
        self.outskirts([&town, &mountain]);
        self.town(town.terminals[0], gate)
    }

    fn terrain(&mut self) -> Terrain {
        let frame = self.frame;
        let [a, b] = self.half_m;
        let own = &self.parameters.mountain;
        let mut hills = vec![
            Hill {
                at_m: frame.at(self.summit_m[0], self.summit_m[1]),
                height_m: own.peak_m,
                radius_m: self.spread_m,
            },
            Hill { at_m: frame.at(-0.61 * a, -b), height_m: TUNNEL_HILL_M[0], radius_m: TUNNEL_HILL_M[1] },
        ];
        // Mountains round about, beyond the motorway.
        for (x, y) in
            [(0.45 * a, b + 420.0), (0.9 * a, -b - 450.0), (-0.3 * a, b + 480.0), (0.05 * a, -b - 380.0)]
        {
            let at_m = frame.at(x + self.draws.uniform(-80.0, 80.0), y);
            let height_m = self.draws.uniform(18.0, 32.0);
            hills.push(Hill { at_m, height_m, radius_m: self.draws.uniform(260.0, 320.0) });
        }
        let waves = (0..2)
            .map(|i| Wave {
                amplitude_m: self.draws.uniform(2.0, 3.5),
                period_m: self.draws.uniform(560.0, 800.0),
                heading_rad: 1.4 * f64::from(i) + self.draws.uniform(0.0, 1.0),
                phase_rad: self.draws.uniform(0.0, TAU),
            })
            .collect();
        // The ground is level where the strands cross and at the interchanges.
        let pads = [(0.0, 110.0, 420.0), (a, 240.0, 600.0), (-a, 150.0, 400.0)];
        let pads =
            pads.map(|(x, radius_m, blend_m)| Pad { at_m: frame.at(x, 0.0), radius_m, blend_m }).to_vec();
        Terrain { waves, hills, pads, ..Terrain::flat() }
    }

    /// The figure of eight; gives the interchanges at the town and at the mountain.
    fn motorway(&mut self) -> [Diamond; 2] {
        let frame = self.frame;
        let [a, b] = self.half_m;
        let lane = Side::open(self.parameters.mountain.lanes as u8, 3.6, 2.5);
        let shape = CrossSection { max_grade: 0.065, ..CrossSection::motorway(lane, 4.0, MOTORWAY_KMH) };
        let street =
            CrossSection::both_ways(Side::town(1, self.parameters.lane_width_m).with_sidewalk(2.0), 50.0);
        let crossroad = Crossroad::signals(street);
        let names = ["Town", "Mountain"];
        let interchanges = [a, -a].map(|x| {
            let name = names[usize::from(x < 0.0)];
            diamond(&mut self.layout, name, frame.pose(x, 0.0, -FRAC_PI_2), DIAMOND, &crossroad)
        });
        let corner = |x: f64, y: f64, [radius_m, ease_m]: [f64; 2]| {
            Stop::Corner(Via { at_m: frame.at(x, y), radius_m, ease_m })
        };
        let drops = [(0.62 * a, b), (0.62 * a, -b), (-0.62 * a, b), (-a + CORNER_M[0] + 70.0, -b)]
            .map(|(x, y)| seam(&mut self.layout, frame.at(x, y), "lane drop"));
        let k = self.knee_m;
        // A place on the strand that rises towards the town's upper knee; negative before the crossing.
        let leg = hypot(k, b);
        let upper = |d: f64| frame.at(d * k / leg, d * b / leg);
        let lower = |d: f64| frame.at(-d * k / leg, d * b / leg);
        let [town, mountain] = interchanges;
        let stops = [
            Stop::Drop(drops[0]),
            corner(a, b, CORNER_M),
            Stop::Behind(town.behind),
            Stop::Ahead(town.ahead),
            corner(a, -b, CORNER_M),
            Stop::Drop(drops[1]),
            corner(k, -b, KNEE_M),
            Stop::Lift(lower(-50.0), 0.0),
            Stop::Lift(lower(50.0), 0.0),
            Stop::Lift(lower(UNDER_M), 0.0),
            corner(-k, b, KNEE_M),
            Stop::Drop(drops[2]),
            corner(-a, b, CORNER_M),
            Stop::Behind(mountain.behind),
            Stop::Ahead(mountain.ahead),
            corner(-a, -b, CORNER_M),
            Stop::Drop(drops[3]),
            Stop::Even(frame.at(-0.61 * a - 165.0, -b), frame.at(-0.61 * a + 165.0, -b)),
            corner(-k, -b, KNEE_M),
            Stop::Lift(upper(-50.0 - DESCENT_M), 0.0),
            Stop::Lift(upper(-50.0), DECK_M),
            Stop::Lift(upper(50.0), DECK_M),
            Stop::Lift(upper(UNDER_M - 15.0), STRAND_M),
            Stop::Lift(upper(UNDER_M + 15.0), STRAND_M),
            Stop::Lift(upper(UNDER_M + 15.0 + DESCENT_M), 0.0),
            corner(k, b, KNEE_M),
            Stop::Drop(drops[0]),
        ];
        motorway(&mut self.layout, "Motorway", shape, &stops);
        // The terminals inside the loops first.
        interchanges.map(|diamond| {
            let off = |n: NodeId| {
                let [x, y] = self.layout.nodes[n].at_m;
                hypot(x, y)
            };
            let [p, q] = diamond.terminals;
            Diamond { terminals: if off(p) < off(q) { [p, q] } else { [q, p] }, ..diamond }
        })
    }

    /// The country road from the town's gate under one strand and over the other to the mountain, over its
    /// pass and down to the interchange behind it. Gives the gate.
    fn country(&mut self, terminal: NodeId) -> NodeId {
        let frame = self.frame;
        let [_, b] = self.half_m;
        let leg = hypot(self.knee_m, b);
        let (px, py) = (UNDER_M * self.knee_m / leg, UNDER_M * b / leg);
        let road = CrossSection::rural(Side::open(1, 3.25, 0.75), COUNTRY_KMH);
        let gate = self.layout.node(
            Node::new(frame.at(self.knee_m - 205.0, 0.5 * py - 20.0), NodeKind::Seam { length_m: 24.0 })
                .named("gate"),
        );
        let fork = self.layout.node(
            Node::new(frame.at(0.0, py + 55.0), NodeKind::Crossing(Control::MinorYield)).named("valley fork"),
        );
        self.layout.edge(
            Edge::new("Valley Road", gate, fork, road).via(frame.at(px + 70.0, py - 38.0), 120.0, 20.0).via(
                frame.at(px - 70.0, py + 38.0),
                160.0,
                20.0,
            ),
        );
        let close = self.layout.node(Node::new(
            frame.at(self.draws.uniform(-60.0, 60.0), py + self.draws.uniform(250.0, 330.0)),
            NodeKind::DeadEnd { radius_m: 9.5 },
        ));
        self.layout.edge(
            Edge::new("Quarry Lane", fork, close, CrossSection { limit_kmh: PASS_KMH, ..road }).via(
                frame.at(self.draws.uniform(-25.0, 25.0), py + 130.0),
                60.0,
                10.0,
            ),
        );
        let narrow = CrossSection { limit_kmh: PASS_KMH, banked: false, max_grade: PASS_GRADE, ..road };
        let (east, west) = (self.climb(0.1, FACE_RAD, 0.15), self.climb(PI + 0.1, FACE_RAD, -0.1));
        // The road rounds the summit on the side where there is more room; a lane leads from there to the
        // top.
        let [e, w] = [&east, &west].map(|face| face.last().map_or(0.0, |bend| bend.bearing_rad));
        let between = frames::wrap_pi(w - e);
        let side = e + 0.5 * between;
        let pass = Node::new(self.on_mountain(side, PASS_OUT_M), NodeKind::Crossing(Control::MinorYield));
        let pass = self.layout.node(pass.named("pass"));
        let mut edge = Edge::new("Pass Road", fork, pass, narrow)
            .min_radius(PASS_BEND_M)
            .via(frame.at(-px + 75.0, py + 32.0), 160.0, 20.0)
            .via(frame.at(-px - 120.0, py - 20.0), 160.0, 20.0)
            .lifted(frame.at(-px + 12.0, py), STRAND_M)
            .lifted(frame.at(-px - 12.0, py), STRAND_M)
            .lifted(frame.at(-px - 190.0, py - 55.0), 0.0);
        for bend in &east {
            edge = edge.via(self.on_mountain(bend.bearing_rad, bend.out_m), bend.radius_m, 0.0);
        }
        self.layout.edge(edge);
        let mut edge = Edge::new("Pass Road", pass, terminal, narrow).min_radius(PASS_BEND_M);
        for bend in west.iter().rev() {
            edge = edge.via(self.on_mountain(bend.bearing_rad, bend.out_m), bend.radius_m, 0.0);
        }
        self.layout.edge(edge);
        let hut = Node::new(self.on_mountain(side + PI, 24.0), NodeKind::DeadEnd { radius_m: 10.0 });
        let hut = self.layout.node(hut.lifted(-0.8));
        self.layout.edge(Edge::new("Hut", pass, hut, narrow));
        gate
    }

    /// A place at a bearing and a distance from the summit.
    fn on_mountain(&self, bearing_rad: f64, radius_m: f64) -> [f64; 2] {
        let [x, y] = self.summit_m;
        self.frame.at(x + radius_m * cos(bearing_rad), y + radius_m * sin(bearing_rad))
    }

    /// Corners of a road that climbs one face of the mountain to and fro, from its foot to the pass, each
    /// with its radius. The face looks to `bearing_rad` and reaches `half_rad` to both sides; the road sets
    /// out clockwise at `start_rad` from its middle.
    ///
    /// The road gains height evenly along its legs, as the ground falls away from the summit.
    fn climb(&self, bearing_rad: f64, half_rad: f64, start_rad: f64) -> Vec<Bend> {
        const STEP_M: f64 = 4.0;
        let ground = |bearing: f64, r: f64| {
            let [x, y] = self.on_mountain(bearing, r);
            self.layout.terrain.bank(x, y)
        };
        let fall = |bearing: f64, r: f64| {
            ((ground(bearing, r - STEP_M) - ground(bearing, r + STEP_M)) / (2.0 * STEP_M)).max(0.02)
        };
        let mut corners = Vec::new();
        let (mut r, mut angle, mut way) = (FOOT_M, start_rad, -1.0);
        let mut since_m = f64::INFINITY;
        while r > TOP_M {
            if since_m >= 44.0 {
                corners.push(Bend { bearing_rad: bearing_rad + angle, out_m: r, radius_m: 90.0 });
                since_m = 0.0;
            }
            let inwards = (CLIMB / fall(bearing_rad + angle, r)).min(0.8);
            r -= STEP_M * inwards;
            angle += way * STEP_M * (1.0 - inwards * inwards).sqrt() / r;
            since_m += STEP_M;
            if way * angle > half_rad && r > TOP_M + HAIRPIN_M[1] {
                let hairpin = Bend { bearing_rad: bearing_rad + angle, out_m: r, radius_m: HAIRPIN_M[0] };
                if since_m < 30.0 {
                    corners.pop();
                }
                r -= HAIRPIN_M[1];
                corners.extend([hairpin, Bend { out_m: r, ..hairpin }]);
                (way, since_m) = (-way, -14.0);
            }
        }
        corners
    }

    /// Small places outside of the figure, behind the interchanges.
    fn outskirts(&mut self, interchanges: [&Diamond; 2]) {
        let frame = self.frame;
        let street =
            CrossSection::both_ways(Side::town(1, self.parameters.lane_width_m).with_sidewalk(2.0), 50.0);
        let [a, _] = self.half_m;
        for (diamond, way) in interchanges.into_iter().zip([1.0, -1.0]) {
            let x = way * (a + self.draws.uniform(240.0, 280.0));
            let at = |dx: f64, dy: f64| frame.at(x + way * dx, dy);
            let middle = self
                .layout
                .node(Node::new(at(0.0, 0.0), NodeKind::Crossing(Control::AllStop)).named("outskirts"));
            self.layout.edge(Edge::new("Access", diamond.terminals[1], middle, street));
            let reach = [-1.0, 1.0].map(|s| s * self.draws.uniform(95.0, 140.0));
            let ends = reach.map(|y| at(self.draws.uniform(0.0, 30.0), y));
            for end in ends {
                let node = self.layout.node(Node::new(end, NodeKind::DeadEnd { radius_m: 10.0 }));
                self.layout.edge(Edge::new("Yard", middle, node, street));
            }
        }
    }

    /// The town in its loop, between the interchange and the gate to the country road.
    fn town(mut self, terminal: NodeId, gate: NodeId) -> Layout {
        let frame = self.frame;
        let [a, b] = self.half_m;
        let mut graph = Graph::default();
        let slope = Slope {
            rows: self.parameters.mountain.rows as usize,
            // The wedge between the strands opens towards the town.
            west_m: Box::new({
                let k = self.knee_m;
                move |y: f64| ((y.abs() + 75.0) * k / b + 70.0).max(k - 140.0)
            }),
            east_m: a - 215.0,
            half_width_m: b - 95.0,
            ends: [gate, terminal].map(|n| self.layout.nodes[n].at_m),
            parking_share: self.parameters.mountain.parking_share,
        };
        slope_town(&mut graph, &mut self.draws, self.parameters, &slope, &|x, y| frame.at(x, y));
        graph.into_layout(self.layout, self.parameters.kerb_radius_m)
    }
}
