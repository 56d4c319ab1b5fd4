//! The country roads of a region: which lead where, what they are like, and what is where they meet.

use frames::wrap_pi;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use super::country::{Country, Link};
use super::graph::{Graph, LineId, PointId};
use super::patch::points;
use super::plane::{Point, Segment, between, cross, distance, heading, near};
use super::region_land::Region;
use crate::layout::{Anchor, Control, Layout, NodeId, NodeKind};
use crate::section::{CrossSection, Pocket, Side};

/// Roads between sites are at most so many times as long as the distance of farms, and shorten ways to so
/// much.
const REACH: f64 = 2.3;
const STRETCH: f64 = 1.65;
/// Distance between the bends of a country road, and the largest way that they lead aside, metres.
const BEND_EVERY_M: f64 = 290.0;
const ASIDE_M: f64 = 42.0;
/// From a town's junction to where its street becomes a country road; the same for a hamlet, metres.
const TOWN_END_M: f64 = 95.0;
const HAMLET_M: f64 = 145.0;
/// Least angle between two roads in a hamlet, where sidewalks need room, and at a roundabout, radians.
const HAMLET_RAD: f64 = 1.25;
const ROUND_RAD: f64 = 1.4;
/// Two roads this much off a straight line are one, radians.
const STRAIGHT_RAD: f64 = 0.6;
/// Height of a road over the motorway, metres; it keeps it for so far to both sides.
const OVER_M: f64 = 7.8;
const DECK_M: f64 = 24.0;
/// Where it leaves the ground, metres from there.
const RISE_M: f64 = 210.0;
/// Probability that a road has a farm; least and largest length of its track, and what it keeps free of other
/// roads and of water, metres.
const FARM_SHARE: f64 = 0.45;
const TRACK_M: [f64; 2] = [80.0, 190.0];
const TRACK_FREE_M: f64 = 100.0;
/// Parts of roads that are shorter have no farms, metres.
const FARM_ROAD_M: f64 = 250.0;
/// Radius of the kerbs where country roads meet, metres.
const KERB_M: f64 = 10.0;

/// What a road is like; main roads last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    Lane,
    Minor,
    Main,
}

/// A road between two places: sites, or beyond them the ends of stubs.
#[derive(Clone, Copy, Debug)]
struct Way {
    ends: Link,
    class: Class,
    /// A road that comes from a town or an interchange.
    stub: Option<(NodeId, bool)>,
    /// The first of those that continue one another.
    line: usize,
}

/// Lays the country roads and finishes the layout; nothing if they don't reach every town.
pub(super) fn roads(mut region: Region<'_>) -> Option<Layout> {
    let sites = region.sites.clone();
    let obstacles = region.obstacles.clone();
    let reach = REACH * region.parameters.region.farms_m;
    let country = Country::new(&sites, &obstacles, reach, STRETCH);
    let links = country.leading(0);
    let led = |group: usize| links.iter().flatten().any(|s| sites[*s].group == Some(group));
    if !region.groups().all(led) {
        return None;
    }
    let mut places: Vec<Point> = sites.iter().map(|s| s.at_m).collect();
    let mut ways: Vec<Way> = Vec::new();
    let main = main_roads(&region, &country);
    for link in &links {
        let ends = link.map(|s| links.iter().filter(|l| l.contains(&s)).count());
        let class = if main.contains(link) {
            Class::Main
        } else if ends.contains(&1) || region.draws.chance(0.3) {
            Class::Lane
        } else {
            Class::Minor
        };
        ways.push(Way { ends: *link, class, stub: None, line: ways.len() });
    }
    for (site, node, town) in &region.stubs {
        if links.iter().any(|l| l.contains(site)) {
            places.push(region.layout.nodes[*node].at_m);
            let ends = [places.len() - 1, *site];
            ways.push(Way { ends, class: Class::Main, stub: Some((*node, *town)), line: ways.len() });
        }
    }
    join(&mut ways, &places);
    let first = region.layout.edges.len();
    let mut layout = Builder::new(&mut region, &places, &ways).build();
    // Where roads cross the motorway they lead over it.
    for index in first..layout.edges.len() {
        let line = points(&layout, &layout.edges[index]);
        for part in line.windows(2) {
            for leg in &obstacles.motorway {
                let Some((u, _)) = cross([part[0], part[1]], *leg) else { continue };
                let length = distance(part[0], part[1]);
                let heights = [(-RISE_M, 0.0), (-DECK_M, OVER_M), (DECK_M, OVER_M), (RISE_M, 0.0)];
                let anchors = heights.map(|(d, lift_m)| {
                    let at_m = between(part[0], part[1], u + d / length);
                    Anchor { at_m, lift_m }
                });
                layout.edges[index].anchors.extend(anchors);
            }
        }
    }
    Some(layout)
}

/// Roads on the shortest ways between towns, and between each of them and the motorway.
fn main_roads(region: &Region<'_>, country: &Country<'_>) -> Vec<Link> {
    let mut main: Vec<Link> = Vec::new();
    let group = |g: usize| (0..region.sites.len()).filter(move |s| region.sites[*s].group == Some(g));
    let count = region.sites.iter().filter_map(|s| s.group).max().unwrap_or(0);
    for a in 1..=count {
        let Some(from) = group(a).next() else { continue };
        let off = |s: &usize| distance(region.sites[*s].at_m, region.sites[from].at_m);
        let mut goals: Vec<usize> = (1..=count).filter(|b| *b != a).filter_map(|b| group(b).next()).collect();
        goals.sort_by(|p, q| off(p).total_cmp(&off(q)));
        goals.truncate(2);
        goals.extend(group(0).min_by(|p, q| off(p).total_cmp(&off(q))));
        for to in goals {
            let way = country.way([from, to], f64::INFINITY).unwrap_or_default();
            for pair in way.windows(2) {
                let link = [pair[0].min(pair[1]), pair[0].max(pair[1])];
                if country.links.contains(&link) && !main.contains(&link) {
                    main.push(link);
                }
            }
        }
    }
    main
}

/// Joins roads that continue one another: always where no third one is, and elsewhere those of one class that
/// face each other.
fn join(ways: &mut [Way], places: &[Point]) {
    let at = |ways: &[Way], place: usize| -> Vec<usize> {
        (0..ways.len()).filter(|w| ways[*w].ends.contains(&place)).collect()
    };
    let merge = |ways: &mut [Way], a: usize, b: usize| {
        let (a, b) = (ways[a].line, ways[b].line);
        let class = ways.iter().filter(|w| w.line == a || w.line == b).map(|w| w.class).max();
        for way in ways.iter_mut().filter(|w| w.line == a || w.line == b) {
            (way.line, way.class) = (a.min(b), class.unwrap_or(Class::Minor));
        }
    };
    for place in 0..places.len() {
        if let [a, b] = at(ways, place)[..] {
            merge(ways, a, b);
        }
    }
    for place in 0..places.len() {
        let here = at(ways, place);
        if here.len() < 3 {
            continue;
        }
        let out = |w: usize| {
            let other = ways[w].ends.iter().copied().find(|e| *e != place).unwrap_or(place);
            heading(places[place], places[other])
        };
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, a) in here.iter().enumerate() {
            for b in &here[i + 1..] {
                let off = wrap_pi(out(*a) - out(*b) - PI).abs();
                if off < STRAIGHT_RAD && ways[*a].class == ways[*b].class {
                    pairs.push((off, *a, *b));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut used: Vec<usize> = Vec::new();
        for (_, a, b) in pairs {
            if !used.contains(&a) && !used.contains(&b) {
                used.extend([a, b]);
                merge(ways, a, b);
            }
        }
    }
}

/// Least angle between two roads at a place, radians.
fn narrowest_rad(places: &[Point], ways: &[Way], place: usize) -> f64 {
    let here = ways.iter().filter(|w| w.ends.contains(&place));
    let other = |w: &Way| if w.ends[0] == place { w.ends[1] } else { w.ends[0] };
    let mut out: Vec<f64> = here.map(|w| heading(places[place], places[other(w)])).collect();
    out.sort_by(f64::total_cmp);
    let gaps = (0..out.len()).map(|i| (out[(i + 1) % out.len()] - out[i]).rem_euclid(TAU));
    gaps.fold(TAU, f64::min)
}

/// Turns roads into streets of a graph.
struct Builder<'r, 'a> {
    region: &'r mut Region<'a>,
    places: &'r [Point],
    ways: &'r [Way],
    graph: Graph,
    points: Vec<PointId>,
    /// Streets of each line: in the country, and in hamlets and towns.
    lines: BTreeMap<(usize, bool), LineId>,
    hamlets: Vec<bool>,
    farms: Vec<Segment>,
}

impl<'r, 'a> Builder<'r, 'a> {
    fn new(region: &'r mut Region<'a>, places: &'r [Point], ways: &'r [Way]) -> Self {
        let mut graph = Graph::default();
        let used = |place: usize| ways.iter().filter(|w| w.ends.contains(&place)).count();
        let points = places.iter().map(|p| graph.point(*p)).collect();
        let hamlets = (0..places.len())
            .map(|place| {
                let free = region.sites.get(place).is_some_and(|s| s.from_m.is_none());
                free && used(place) > 2
                    && narrowest_rad(places, ways, place) > HAMLET_RAD
                    && region.draws.chance(region.parameters.region.hamlet_share)
            })
            .collect();
        Self { region, places, ways, graph, points, lines: BTreeMap::new(), hamlets, farms: Vec::new() }
    }

    fn build(mut self) -> Layout {
        for way in self.ways {
            match way.stub {
                Some((_, town)) => self.stub(way, town),
                None => self.road(way),
            }
        }
        for place in 0..self.region.sites.len() {
            self.junction(place);
        }
        let empty = Layout::new("", crate::terrain::Terrain::flat());
        let layout = std::mem::replace(&mut self.region.layout, empty);
        self.graph.into_layout(layout, KERB_M)
    }

    fn line(&mut self, way: &Way, village: bool) -> LineId {
        if let Some(line) = self.lines.get(&(way.line, village)) {
            return *line;
        }
        let own = &self.region.parameters.region;
        let (width_m, kmh, bend_m) = match way.class {
            Class::Main => (own.road_m, own.road_kmh, [320.0, 40.0]),
            Class::Minor => (own.road_m - 0.3, (own.road_kmh - 20.0).max(50.0), [200.0, 25.0]),
            Class::Lane => ((own.road_m - 0.6).max(2.6), 50.0, [110.0, 10.0]),
        };
        let name = format!("{:?} Road {}", way.class, way.line);
        let shape = if village {
            let side = Side::town(1, width_m).with_sidewalk(self.region.parameters.sidewalk_m.min(2.2));
            CrossSection::both_ways(side, 50.0)
        } else {
            let shoulder_m = if way.class == Class::Main { 1.0 } else { 0.5 };
            CrossSection { max_grade: 0.1, ..CrossSection::rural(Side::open(1, width_m, shoulder_m), kmh) }
        };
        let line = self.graph.line(name, shape, bend_m);
        if way.class == Class::Main {
            self.graph.pockets(line, Pocket::one(32.0, 24.0));
        }
        self.lines.insert((way.line, village), line);
        line
    }

    /// From a town or an interchange to its site.
    fn stub(&mut self, way: &Way, town: bool) {
        let [from, to] = way.ends.map(|e| self.points[e]);
        let country = self.line(way, false);
        if !town {
            self.graph.lead(country, &[from, to]);
            return;
        }
        let street = self.line(way, true);
        let [a, b] = way.ends.map(|e| self.places[e]);
        let end = self.graph.point(between(a, b, TOWN_END_M / distance(a, b)));
        self.graph.kind(end, NodeKind::Seam { length_m: 24.0 });
        self.graph.lead(street, &[from, end]);
        self.graph.lead(country, &[end, to]);
    }

    fn road(&mut self, way: &Way) {
        let [a, b] = way.ends.map(|e| self.places[e]);
        let length = distance(a, b);
        let motorway = &self.region.obstacles.motorway;
        let over = motorway.iter().any(|leg| cross([a, b], *leg).is_some());
        let winding = if over { 0.0 } else { self.region.parameters.region.winding };
        let count = (length / BEND_EVERY_M).floor().max(1.0) as usize;
        let normal = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
        let country = self.line(way, false);
        let mut stops = vec![self.points[way.ends[0]]];
        let mut middle: Vec<Point> = (1..count)
            .map(|i| {
                let on = between(a, b, i as f64 / count as f64);
                let d = winding * ASIDE_M * self.region.draws.uniform(-1.0, 1.0);
                [on[0] + d * normal[0], on[1] + d * normal[1]]
            })
            .collect();
        let hamlets = way.ends.map(|e| self.hamlets[e] && length > 2.6 * HAMLET_M);
        if hamlets.contains(&true) && middle.is_empty() {
            middle.push(between(a, b, 0.5));
        }
        let inner: Vec<PointId> = middle.iter().map(|p| self.graph.point(*p)).collect();
        let mut heads = [None; 2];
        for (k, (start, next)) in
            [(a, middle.first().copied()), (b, middle.last().copied())].into_iter().enumerate()
        {
            let Some(next) = next.filter(|next| hamlets[k] && distance(start, *next) > HAMLET_M + 20.0)
            else {
                continue;
            };
            let end = self.graph.point(between(start, next, HAMLET_M / distance(start, next)));
            self.graph.kind(end, NodeKind::Seam { length_m: 24.0 });
            heads[k] = Some(end);
        }
        let last = self.points[way.ends[1]];
        if let Some(head) = heads[0] {
            self.hamlet(way, stops[0], head);
            stops[0] = head;
        }
        stops.extend(inner);
        stops.push(heads[1].unwrap_or(last));
        self.graph.lead(country, &stops);
        if let Some(head) = heads[1] {
            self.hamlet(way, last, head);
        }
        if !over && self.region.draws.chance(FARM_SHARE) {
            self.farm(way, &stops);
        }
    }

    /// A farm beside a road, at the end of a track.
    fn farm(&mut self, way: &Way, stops: &[PointId]) {
        let draws = &mut self.region.draws;
        let Some(i) = draws.index(stops.len() - 1) else { return };
        let share = draws.uniform(0.4, 0.6);
        let left_m = draws.uniform(TRACK_M[0], TRACK_M[1]) * if draws.chance(0.5) { 1.0 } else { -1.0 };
        let [from, to] = [stops[i], stops[i + 1]];
        let [a, b] = [from, to].map(|p| self.graph.at_m(p));
        let road_m = distance(a, b);
        let at = between(a, b, share);
        let aside = left_m / road_m;
        let track = [at, [at[0] - aside * (b[1] - a[1]), at[1] + aside * (b[0] - a[0])]];
        let region = &*self.region;
        let clear = |other: Segment| !near(track, other, TRACK_FREE_M);
        let roads = self.ways.iter().filter(|w| w.ends != way.ends).map(|w| w.ends.map(|e| self.places[e]));
        let others = roads.chain(region.obstacles.motorway.iter().chain(&region.obstacles.streets).copied());
        let dry = track.iter().all(|p| region.water_gap_m(*p) > TRACK_FREE_M);
        let inside = track[1].iter().all(|v| v.abs() < 0.5 * region.parameters.region.size_m - 60.0);
        let free = others.chain(self.farms.iter().copied()).all(clear);
        if road_m < FARM_ROAD_M || !dry || !inside || !free {
            return;
        }
        let side = Side::open(1, (region.parameters.region.road_m - 0.6).max(2.6), 0.3);
        let shape = CrossSection { banked: false, ..CrossSection::rural(side, 30.0) };
        let line = self.graph.line(format!("Farm track {}", self.farms.len() + 1), shape, [25.0, 0.0]);
        self.graph.close(line, from, to, share, left_m);
        self.farms.push(track);
    }

    /// A street of a hamlet, with a close now and then.
    fn hamlet(&mut self, way: &Way, from: PointId, to: PointId) {
        let street = self.line(way, true);
        self.graph.lead(street, &[from, to]);
        let draws = &mut self.region.draws;
        if draws.chance(0.6) {
            // All to the left, so that no two of them meet.
            let (share, length) = (draws.uniform(0.48, 0.56), draws.uniform(46.0, 62.0));
            let close = CrossSection::both_ways(Side::town(1, 2.9).with_sidewalk(1.6), 30.0);
            let close = self.graph.line("Close", close, [20.0, 0.0]);
            self.graph.close(close, from, to, share, length);
        }
    }

    /// What is where roads meet.
    fn junction(&mut self, place: usize) {
        let here: Vec<&Way> = self.ways.iter().filter(|w| w.ends.contains(&place)).collect();
        if here.len() < 3 {
            return;
        }
        let main = here.iter().filter(|w| w.class == Class::Main).count();
        let narrowest = narrowest_rad(self.places, self.ways, place);
        let rounds = self.region.parameters.region.roundabouts && narrowest > ROUND_RAD;
        let stop = self.region.draws.chance(0.5);
        let kind = match (main, here.len()) {
            (3.., _) if rounds => NodeKind::Roundabout { island_m: 18.0, lanes: 1 },
            (3.., _) => NodeKind::Crossing(Control::Signals),
            (_, _) if rounds && self.hamlets[place] => NodeKind::Roundabout { island_m: 16.0, lanes: 1 },
            (0, 4..) if stop => NodeKind::Crossing(Control::AllStop),
            (_, 4..) => NodeKind::Crossing(Control::MinorStop),
            _ if stop => NodeKind::Crossing(Control::MinorStop),
            _ => NodeKind::Crossing(Control::MinorYield),
        };
        self.graph.kind(self.points[place], kind);
    }
}
