//! The land of a region: its waters, its motorway with interchanges, where its towns stand, and where country
//! roads may meet.

use frames::math::{cos, sin, sin_cos};
use random::Stream;
use std::f64::consts::{PI, TAU};

use super::carriageways::{Crossroad, Size, Stop, diamond, motorway, seam};
use super::country::{Obstacles, Site};
use super::graph::empty;
use super::patch::{Gate, Patch, Spot, extent, gates, plant, segments};
use super::plane::{Point, Segment, between, cross, distance, heading, to_segment};
use crate::layout::{Control, Layout, NodeId, NodeKind, Water};
use crate::parameters::TownParameters;
use crate::path::{Pose2, Via};
use crate::section::{CrossSection, Side};
use crate::terrain::{Channel, Terrain, Wave};

/// Legs of the motorway, and the least and largest distance of its corners from the middle, as a share of the
/// size.
const LEGS: usize = 8;
const CORNER_SHARE: [f64; 2] = [0.29, 0.365];
/// Radius and clothoids of its corners, metres.
const CORNER_M: [f64; 2] = [480.0, 110.0];
/// From a corner to where its bend has ended for certain, metres.
const BENT_M: f64 = 370.0;
const DIAMOND: Size = Size { seam_m: 240.0, terminal_m: 140.0 };
/// From an interchange's middle to the ends of its acceleration lanes, metres.
const DROP_M: f64 = 520.0;
/// Roads leave towns and interchanges straight for so long, metres.
const APPROACH_M: f64 = 225.0;
/// Roads at most that lead away from a town.
const GATES: usize = 5;
/// Least distances of a town's streets from the motorway, from other towns, from the river and from the
/// shore, metres.
const TOWN_GAP_M: [f64; 3] = [380.0, 600.0, 220.0];
const SHORE_GAP_M: f64 = 70.0;
/// Junctions of country roads are so far from water, those of the road along the shore so far from it,
/// metres.
const DRY_M: f64 = 190.0;
const SHORE_ROAD_M: f64 = 150.0;
/// Roads cross the motorway so far from its bridges over the river, metres.
const BRIDGE_GAP_M: f64 = 160.0;
/// Parts of the river's and the shore's line.
const PARTS: u32 = 80;
/// Waters go on beyond the region to so many times its size; a river ends so far out in the sea, metres.
const BEYOND: f64 = 1.12;
const MOUTH_M: f64 = 20.0;
/// Period of the ground's waves, metres: long, so that towns of any style can stand on it.
const WAVE_M: [f64; 2] = [3800.0, 6500.0];
/// Height of the coast over the sea, the same of the river's banks, and the depth of its bed, metres.
const BANK_M: f64 = 4.5;
const BED_M: f64 = 7.5;

/// A region as it grows.
pub(super) struct Region<'a> {
    pub(super) parameters: &'a TownParameters,
    pub(super) draws: Stream,
    /// Corners of the motorway.
    corners: Vec<Point>,
    /// The coast, from west to east, and the river, from north to south.
    coast: Vec<Point>,
    river: Vec<Point>,
    patches: Vec<Patch>,
    pub(super) sites: Vec<Site>,
    /// Where the roads that come to sites from towns and interchanges begin, and whether in a town.
    pub(super) stubs: Vec<(usize, NodeId, bool)>,
    pub(super) obstacles: Obstacles,
    pub(super) layout: Layout,
}

impl<'a> Region<'a> {
    pub(super) fn new(parameters: &'a TownParameters, attempt: u64) -> Self {
        let own = &parameters.region;
        let mut draws = Stream::new(parameters.seed, 0, "town/region", attempt);
        let half = 0.5 * own.size_m;
        // The sea takes its part of the square; the rest is the region.
        let north = if own.coast { 0.06 * own.size_m } else { 0.0 };
        let phase = draws.uniform(0.0, TAU);
        let corners = (0..LEGS)
            .map(|k| {
                let angle = phase + TAU * (k as f64 + draws.uniform(-0.12, 0.12)) / LEGS as f64;
                let r = own.size_m * draws.uniform(CORNER_SHARE[0], CORNER_SHARE[1]);
                let (s, c) = sin_cos(angle);
                let flat = if own.coast { 0.86 } else { 1.0 };
                [r * c, north + flat * r * s]
            })
            .collect();
        let waves = (0..3)
            .map(|i| Wave {
                amplitude_m: own.relief_m / 6.0,
                period_m: draws.uniform(WAVE_M[0], WAVE_M[1]),
                heading_rad: 1.05 * f64::from(i) + draws.uniform(0.0, 0.9),
                phase_rad: draws.uniform(0.0, TAU),
            })
            .collect();
        let mut line = |phase: f64, swing: f64| -> Vec<f64> {
            let (a, b) = (draws.uniform(0.5, 1.0) * swing, draws.uniform(0.2, 0.45) * swing);
            (0..=PARTS)
                .map(|i| {
                    let u = TAU * f64::from(i) / f64::from(PARTS);
                    a * sin(1.3 * u + phase) + b * sin(3.1 * u + 2.0 * phase)
                })
                .collect()
        };
        let along = |i: usize| half * (2.0 * i as f64 / f64::from(PARTS) - 1.0);
        let coast = if own.coast { line(1.0 + phase, 0.035 * own.size_m) } else { Vec::new() };
        let coast: Vec<Point> =
            coast.iter().enumerate().map(|(i, d)| [along(i), d - 0.36 * own.size_m]).collect();
        let river = if own.river { line(2.0 * phase, 0.06 * own.size_m) } else { Vec::new() };
        let east = 0.05 * own.size_m * cos(phase);
        let river = river.iter().enumerate().map(|(i, d)| [east + d, -BEYOND * along(i)]).collect();
        Self {
            parameters,
            draws,
            corners,
            coast,
            river,
            patches: Vec::new(),
            sites: Vec::new(),
            stubs: Vec::new(),
            obstacles: Obstacles::default(),
            layout: empty(parameters, Terrain { waves, ..Terrain::flat() }),
        }
    }

    /// The region with its towns and all that is settled before its roads.
    pub(super) fn settled(mut self, towns: &[Layout]) -> Self {
        self.waters();
        self.motorway();
        for town in towns {
            self.town(town);
        }
        self.shore();
        self.farmland();
        self
    }

    /// Groups of sites that belong to towns.
    pub(super) fn groups(&self) -> impl Iterator<Item = usize> {
        1..=self.patches.len()
    }

    fn waters(&mut self) {
        let half = 0.5 * self.parameters.region.size_m;
        if !self.river.is_empty() {
            // It ends where the sea begins.
            if let Some(out) = self.river.iter().position(|p| self.sea_gap_m(*p) < -MOUTH_M) {
                let [a, b] = [self.river[out.saturating_sub(1)], self.river[out]];
                let [land, sea] = [a, b].map(|p| self.sea_gap_m(p) + MOUTH_M);
                self.river.truncate(out);
                self.river.push(between(a, b, land / (land - sea).max(1e-9)));
            }
            let line_m = self.river.clone();
            let (width_m, slope_m) = (36.0, 16.0);
            let half_m = 0.5 * width_m + 0.35 * slope_m;
            self.layout.waters.push(Water::along("River", &line_m, half_m, -BANK_M));
            self.layout.terrain.channels.push(Channel { line_m, width_m, slope_m, depth_m: BED_M });
        }
        if !self.coast.is_empty() {
            let [[_, west], [_, east]] = [self.coast[0], self.coast[self.coast.len() - 1]];
            let out = BEYOND * half;
            let mut ring_m = vec![[-out, -out], [-out, west]];
            ring_m.extend(self.coast.iter().copied().chain([[out, east], [out, -out]]));
            self.layout.waters.push(Water { name: "Sea water".into(), ring_m, z_m: -BANK_M });
            self.obstacles.streets.extend(self.coast.windows(2).map(|s| [s[0], s[1]]));
        }
    }

    /// Distance from the middle of the river, or from the shore, metres; negative out at sea.
    pub(super) fn water_gap_m(&self, p: Point) -> f64 {
        self.river_gap_m(p).min(self.sea_gap_m(p))
    }

    fn river_gap_m(&self, p: Point) -> f64 {
        to_line(p, &self.river)
    }

    fn sea_gap_m(&self, p: Point) -> f64 {
        let shore = |s: &[Point]| between(s[0], s[1], (p[0] - s[0][0]) / (s[1][0] - s[0][0]).max(1e-9))[1];
        let over = self.coast.windows(2).find(|s| p[0] <= s[1][0]).map_or(1.0, |s| p[1] - shore(s));
        to_line(p, &self.coast) * over.signum()
    }

    fn leg(&self, k: usize) -> Segment {
        [self.corners[k % LEGS], self.corners[(k + 1) % LEGS]]
    }

    /// The motorway and its interchanges, one on every leg that has room for it.
    fn motorway(&mut self) {
        let own = &self.parameters.region;
        let street = CrossSection::both_ways(Side::town(1, own.road_m), 50.0);
        let kind = if own.roundabouts {
            NodeKind::Roundabout { island_m: 16.0, lanes: 1 }
        } else {
            NodeKind::Crossing(Control::Signals)
        };
        let crossroad = Crossroad { kind, ramp_kmh: 60.0, ..Crossroad::signals(street) };
        let mut stops: Vec<Stop> = Vec::new();
        for k in 0..LEGS {
            let leg = self.leg(k);
            let (length, hdg) = (distance(leg[0], leg[1]), heading(leg[0], leg[1]));
            let (from, to) = (BENT_M / length, 1.0 - BENT_M / length);
            self.obstacles.motorway.push(leg);
            let middle = between(leg[0], leg[1], 0.5);
            let room = 0.5 * length - BENT_M > DROP_M + 60.0 && self.water_gap_m(middle) > 700.0;
            if room {
                let at = |d: f64| between(leg[0], leg[1], 0.5 + d / length);
                let share = |d: f64| 0.5 + d / length;
                let pose = Pose2 { x_m: middle[0], y_m: middle[1], heading_rad: hdg };
                let name = format!("Interchange {}", k + 1);
                let first = self.layout.edges.len();
                let made = diamond(&mut self.layout, &name, pose, DIAMOND, &crossroad);
                for edge in &self.layout.edges[first..] {
                    self.obstacles.streets.extend(segments(&self.layout, edge));
                }
                let drops =
                    [-DROP_M, DROP_M].map(|d| seam(&mut self.layout, at(d), format!("{name} lane drop")));
                stops.extend([
                    Stop::Drop(drops[0]),
                    Stop::Behind(made.behind),
                    Stop::Ahead(made.ahead),
                    Stop::Drop(drops[1]),
                ]);
                for (node, side) in made.terminals.into_iter().zip([-1.0, 1.0]) {
                    let gate = Gate { node, heading_rad: hdg + side * 0.5 * PI };
                    self.approach(gate, 0, false);
                }
                for part in [[from, share(-DROP_M - 80.0)], [share(DROP_M + 80.0), to]] {
                    if part[0] < part[1] {
                        self.open(part.map(|u| between(leg[0], leg[1], u)));
                    }
                }
            } else {
                self.open([from, to].map(|u| between(leg[0], leg[1], u)));
            }
            let via = Via { at_m: leg[1], radius_m: CORNER_M[0], ease_m: CORNER_M[1] };
            stops.push(Stop::Corner(via));
        }
        // It begins and ends at its first interchange.
        if let Some(first) = stops.iter().position(|s| matches!(s, Stop::Drop(_))) {
            stops.rotate_left(first);
            stops.push(stops[0]);
        }
        let side = Side::open(own.motorway_lanes as u8, if own.roundabouts { 3.5 } else { 3.75 }, 2.5);
        let shape = CrossSection::motorway(side, 4.0, own.motorway_kmh);
        motorway(&mut self.layout, "Motorway", shape, &stops);
    }

    /// Lets roads cross a part of the motorway, but not where the river is.
    fn open(&mut self, part: Segment) {
        let gap = BRIDGE_GAP_M / distance(part[0], part[1]).max(1e-9);
        let bridges = self.river.windows(2).filter_map(|s| cross(part, [s[0], s[1]]));
        let mut bridges: Vec<f64> = bridges.map(|(u, _)| u).chain([f64::INFINITY]).collect();
        bridges.sort_by(f64::total_cmp);
        let mut from = 0.0;
        for bridge in bridges {
            let to = (bridge - gap).min(1.0);
            if from < to {
                self.obstacles.open.push([from, to].map(|u| between(part[0], part[1], u)));
            }
            from = bridge + gap;
        }
    }

    /// A road that leads straight away from a junction to a site.
    fn approach(&mut self, gate: Gate, group: usize, town: bool) {
        let from = self.layout.nodes[gate.node].at_m;
        let (s, c) = sin_cos(gate.heading_rad);
        let at_m = [from[0] + APPROACH_M * c, from[1] + APPROACH_M * s];
        if self.water_gap_m(at_m) < DRY_M {
            return;
        }
        self.stubs.push((self.sites.len(), gate.node, town));
        self.sites.push(Site { at_m, from_m: Some(from), group: Some(group) });
    }

    /// Finds room for a town and puts it there: the second one by the sea, the others near an interchange if
    /// there is any.
    fn town(&mut self, town: &Layout) {
        let (_, radius) = extent(town);
        let reach = 0.5 * self.parameters.region.size_m - radius - 180.0;
        let mut best: Option<(f64, Point)> = None;
        let mut found = 0;
        for _ in 0..4000 {
            let at = [self.draws.uniform(-reach, reach), self.draws.uniform(-reach, reach)];
            let motorway = self.obstacles.motorway.iter().map(|leg| to_segment(at, *leg));
            let towns = self.patches.iter().map(|p| distance(p.centre_m, at) - p.radius_m);
            let fits = motorway.fold(f64::INFINITY, f64::min) > radius + TOWN_GAP_M[0]
                && towns.fold(f64::INFINITY, f64::min) > radius + TOWN_GAP_M[1]
                && self.river_gap_m(at) > radius + TOWN_GAP_M[2]
                && self.sea_gap_m(at) > radius + SHORE_GAP_M;
            if fits {
                let site = self.sites.iter().filter(|s| s.group == Some(0));
                let mut off = site.map(|s| distance(s.at_m, at)).fold(f64::INFINITY, f64::min);
                if self.patches.len() == 1 && !self.coast.is_empty() {
                    off = self.sea_gap_m(at);
                }
                if best.is_none_or(|(nearest, _)| off < nearest) {
                    best = Some((off, at));
                }
                found += 1;
                if found > 10 {
                    break;
                }
            }
        }
        let Some((_, at_m)) = best else { return };
        let turn_rad = self.draws.uniform(-PI, PI);
        let patch = plant(&mut self.layout, town.clone(), Spot { at_m, turn_rad });
        for edge in &self.layout.edges[patch.edges.clone()] {
            self.obstacles.streets.extend(segments(&self.layout, edge));
        }
        let group = self.patches.len() + 1;
        for gate in gates(&self.layout, &patch, GATES) {
            self.approach(gate, group, true);
        }
        self.patches.push(patch);
    }

    /// Sites along the shore, for a road by the sea.
    fn shore(&mut self) {
        let half = 0.5 * self.parameters.region.size_m - 130.0;
        let step = self.parameters.region.farms_m;
        let mut walked = f64::INFINITY;
        for part in self.coast.clone().windows(2) {
            let [dx, dy] = [part[1][0] - part[0][0], part[1][1] - part[0][1]];
            let length = distance(part[0], part[1]);
            walked += length;
            let at = [part[0][0] - dy / length * SHORE_ROAD_M, part[0][1] + dx / length * SHORE_ROAD_M];
            if walked > step && at[0].abs() < half && self.is_free(at, SHORE_ROAD_M - 20.0) {
                self.sites.push(Site { at_m: at, from_m: None, group: None });
                walked = 0.0;
            }
        }
    }

    /// Whether there is room for one more site, so far from water.
    fn is_free(&self, at: Point, dry_m: f64) -> bool {
        let step = self.parameters.region.farms_m;
        self.patches.iter().all(|p| distance(p.centre_m, at) > p.radius_m + 260.0)
            && self.obstacles.motorway.iter().all(|leg| to_segment(at, *leg) > 360.0)
            && self.sites.iter().all(|site| distance(site.at_m, at) > 0.45 * step)
            && self.water_gap_m(at) > dry_m
    }

    /// Sites all over the land that is left.
    fn farmland(&mut self) {
        let own = &self.parameters.region;
        let half = 0.5 * own.size_m - 130.0;
        let step = own.farms_m;
        let count = (2.0 * half / step) as usize;
        let turn = self.draws.uniform(-0.3, 0.3);
        let (s, c) = sin_cos(turn);
        let reach = (count as i32 * 3) / 4 + 1;
        for i in -reach..=reach {
            for j in -reach..=reach {
                let mut off = || self.draws.uniform(-0.2, 0.2);
                // Where roads wind, neighbouring rows of junctions are staggered.
                let stagger = 0.5 * own.winding * f64::from(j.rem_euclid(2));
                let (x, y) = (step * (f64::from(i) + stagger + off()), step * (f64::from(j) + off()));
                let at = [x * c - y * s, x * s + y * c];
                let inside = at[0].abs() < half && at[1].abs() < half;
                if inside && self.is_free(at, DRY_M) {
                    self.sites.push(Site { at_m: at, from_m: None, group: None });
                }
            }
        }
    }
}

/// Distance from the nearest part of a line, metres.
fn to_line(p: Point, line: &[Point]) -> f64 {
    line.windows(2).map(|s| to_segment(p, [s[0], s[1]])).fold(f64::INFINITY, f64::min)
}
