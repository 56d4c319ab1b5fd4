//! Where walkers go: destinations, and the shortest ways there over sidewalks and crossings.
//!
//! The graph's nodes are places on sidewalks: their ends, where crosswalks begin, and stations between, from
//! which those who may cross anywhere go straight over to the other sidewalk. A metre of road costs
//! [`ROAD_COST`] times a metre of sidewalk, but on crosswalks.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, VecDeque};

use nalgebra::Point3;
use random::Stream;

use crate::walking::paths::Paths;

/// What a metre of road costs those who may cross anywhere.
const ROAD_COST: f64 = 10.0;
/// Distance between the stations of a sidewalk, metres.
const STATION_M: f64 = 20.0;
/// Walkers who cross anywhere do so this far before or behind a station at most, metres.
const ASIDE_M: f64 = 8.0;
/// Destinations keep this far from the ends of sidewalks, metres.
const FROM_END_M: f64 = 0.6;
/// Tries for a destination.
const TRIES: usize = 20;

/// What comes at the end of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Turn {
    /// On along another sidewalk, from its last end or its first one.
    Join { way: usize, last: bool },
    /// Over a crosswalk, from one of its ends.
    Crosswalk { crossing: usize, side: usize },
    /// Straight over the road.
    Over,
    /// The destination.
    Arrive,
}

/// A walk along one sidewalk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    pub(crate) way: usize,
    /// Where along it the walk ends, metres.
    pub(crate) to_m: f64,
    pub(crate) then: Turn,
}

/// Legs in their order.
pub(crate) type Route = VecDeque<Leg>;

#[derive(Clone, Copy, Debug)]
struct Edge {
    to: usize,
    cost_m: f64,
    /// None: along the sidewalk.
    turn: Option<Turn>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    way: usize,
    along_m: f64,
    point: Point3<f64>,
}

/// The graph, and the sidewalks that destinations are on.
#[derive(Debug)]
pub(crate) struct Routes {
    nodes: Vec<Node>,
    edges: Vec<Vec<Edge>>,
    /// Nodes of each way, in order along it.
    on_way: Vec<Vec<usize>>,
    /// Which ways hang together, without and with crossing anywhere.
    groups: [Vec<usize>; 2],
    /// Ways with places near an agent, and their areas summed up, m2.
    goals: Vec<(usize, f64)>,
    centres: Vec<Point3<f64>>,
    radius_m: f64,
}

impl Routes {
    /// `radius_m`: destinations are nearer than this to one of the agents' starts.
    pub(crate) fn new(paths: &Paths, agents: &[Point3<f64>], radius_m: f64) -> Self {
        let ways = paths.ways.len();
        let mut routes = Self {
            nodes: Vec::new(),
            edges: Vec::new(),
            on_way: vec![Vec::new(); ways],
            groups: [(0..ways).collect(), (0..ways).collect()],
            goals: Vec::new(),
            centres: agents.to_vec(),
            radius_m,
        };
        let ends: Vec<[usize; 2]> = (0..ways)
            .map(|w| [0.0, paths.ways[w].length_m].map(|along| routes.node(paths, w, along)))
            .collect();
        for (&(way, last), onward) in &paths.joined {
            for &(other, other_last) in onward {
                let (a, b) = (ends[way][usize::from(last)], ends[other][usize::from(other_last)]);
                let cost_m = (routes.nodes[a].point - routes.nodes[b].point).norm();
                let turn = Some(Turn::Join { way: other, last: other_last });
                routes.edges[a].push(Edge { to: b, cost_m, turn });
                routes.unite(way, other, true);
            }
        }
        for (i, crossing) in paths.crossings.iter().enumerate() {
            let doors = crossing.doors.map(|(way, along)| routes.node(paths, way, along));
            let over = (crossing.ends[1] - crossing.ends[0]).norm();
            let to_kerbs = |side: usize| (routes.nodes[doors[side]].point - crossing.ends[side]).norm();
            let cost_m = over + to_kerbs(0) + to_kerbs(1);
            for side in 0..2 {
                let turn = Some(Turn::Crosswalk { crossing: i, side });
                routes.edges[doors[side]].push(Edge { to: doors[1 - side], cost_m, turn });
            }
            routes.unite(crossing.doors[0].0, crossing.doors[1].0, true);
        }
        for way in 0..ways {
            let Some(other) = paths.opposite(way).filter(|&o| paths.opposite(o) == Some(way) && way < o)
            else {
                continue;
            };
            let length = paths.ways[way].length_m;
            let stations = (length / STATION_M).floor() as usize;
            for k in 0..stations {
                let along = (k as f64 + 0.5) * length / stations as f64;
                let Some((from, to)) = paths.across(way, other, along) else { continue };
                let (a, b) = (routes.node(paths, way, along), routes.node(paths, other, to));
                let cost_m = ROAD_COST * (from - routes.nodes[b].point).norm();
                routes.edges[a].push(Edge { to: b, cost_m, turn: Some(Turn::Over) });
                routes.edges[b].push(Edge { to: a, cost_m, turn: Some(Turn::Over) });
                routes.unite(way, other, false);
            }
        }
        routes.link_along();
        for group in &mut routes.groups {
            for way in 0..ways {
                group[way] = root(group, way);
            }
        }
        routes.find_goals(paths);
        routes
    }

    fn node(&mut self, paths: &Paths, way: usize, along_m: f64) -> usize {
        let found = self.on_way[way].iter().find(|&&n| (self.nodes[n].along_m - along_m).abs() < 1e-6);
        if let Some(&node) = found {
            return node;
        }
        self.nodes.push(Node { way, along_m, point: paths.ways[way].place(along_m).point });
        self.edges.push(Vec::new());
        self.on_way[way].push(self.nodes.len() - 1);
        self.nodes.len() - 1
    }

    fn unite(&mut self, a: usize, b: usize, everybody: bool) {
        for group in &mut self.groups[usize::from(!everybody)..] {
            let (a, b) = (root(group, a), root(group, b));
            group[a.max(b)] = a.min(b);
        }
    }

    fn link_along(&mut self) {
        for nodes in &mut self.on_way {
            nodes.sort_by(|&a, &b| self.nodes[a].along_m.total_cmp(&self.nodes[b].along_m));
            for pair in nodes.windows(2) {
                let cost_m = self.nodes[pair[1]].along_m - self.nodes[pair[0]].along_m;
                self.edges[pair[0]].push(Edge { to: pair[1], cost_m, turn: None });
                self.edges[pair[1]].push(Edge { to: pair[0], cost_m, turn: None });
            }
        }
    }

    fn find_goals(&mut self, paths: &Paths) {
        let mut total = 0.0;
        for (w, way) in paths.ways.iter().enumerate() {
            // A sample every two metres: fine enough to tell what is near.
            if way.samples.iter().any(|s| self.is_near(&s.point)) {
                total += way.length_m * way.samples[way.samples.len() / 2].width_m.max(0.1);
                self.goals.push((w, total));
            }
        }
    }

    fn is_near(&self, point: &Point3<f64>) -> bool {
        self.centres.iter().any(|c| (c - point).norm() < self.radius_m)
    }

    /// A route to a new destination: by area, of those near an agent that can be reached; where there is
    /// none, on the same sidewalk. With `forward`, tries to find one that begins this way.
    pub(crate) fn draw(
        &self,
        paths: &Paths,
        from: (usize, f64),
        anywhere: bool,
        forward: Option<bool>,
        stream: &mut Stream,
    ) -> Route {
        let group = &self.groups[usize::from(anywhere)];
        let mut spare = None;
        for _ in 0..TRIES {
            let Some(goal) = self.draw_goal(paths, stream) else { break };
            if group[goal.0] != group[from.0] {
                continue;
            }
            let Some(mut route) = self.find(from, goal, anywhere) else { continue };
            for leg in route.iter_mut().filter(|l| l.then == Turn::Over) {
                let last = paths.ways[leg.way].length_m - FROM_END_M;
                leg.to_m = (leg.to_m + stream.uniform(-ASIDE_M, ASIDE_M)).min(last).max(FROM_END_M);
            }
            let starts = route.front().is_some_and(|leg| forward.is_none_or(|f| (leg.to_m > from.1) == f));
            if starts {
                return route;
            }
            spare.get_or_insert(route);
        }
        spare.unwrap_or_else(|| {
            let length = paths.ways[from.0].length_m;
            let [low, high] = match forward {
                Some(true) => [from.1, length],
                Some(false) => [0.0, from.1],
                None => [0.0, length],
            };
            let to_m = stream.uniform(low, high).min(length - FROM_END_M).max(FROM_END_M.min(0.5 * length));
            VecDeque::from([Leg { way: from.0, to_m, then: Turn::Arrive }])
        })
    }

    fn draw_goal(&self, paths: &Paths, stream: &mut Stream) -> Option<(usize, f64)> {
        let total = self.goals.last()?.1;
        for _ in 0..TRIES {
            let pick = stream.uniform(0.0, total);
            let i = self.goals.partition_point(|g| g.1 <= pick).min(self.goals.len() - 1);
            let way = self.goals[i].0;
            let length = paths.ways[way].length_m;
            let along =
                stream.uniform(0.0, length).min(length - FROM_END_M).max(FROM_END_M.min(0.5 * length));
            if self.is_near(&paths.ways[way].place(along).point) {
                return Some((way, along));
            }
        }
        None
    }

    /// The shortest route (A*: what is left costs no less than the straight line).
    fn find(&self, from: (usize, f64), to: (usize, f64), anywhere: bool) -> Option<Route> {
        let arrive = Leg { way: to.0, to_m: to.1, then: Turn::Arrive };
        if from.0 == to.0 {
            return Some(VecDeque::from([arrive]));
        }
        let mut best: Vec<f64> = vec![f64::INFINITY; self.nodes.len()];
        let mut came: BTreeMap<usize, (usize, Option<Turn>)> = BTreeMap::new();
        let ends: BTreeMap<usize, f64> = self.beside(to).collect();
        let goal = ends.keys().next().map(|&n| self.nodes[n].point)?;
        let slack = ends.iter().map(|(&n, _)| (self.nodes[n].point - goal).norm()).fold(0.0, f64::max);
        let rest = |n: usize| ((self.nodes[n].point - goal).norm() - slack).max(0.0);
        let mut open = BinaryHeap::new();
        for (node, cost) in self.beside(from) {
            best[node] = cost;
            open.push(Reverse((Cost(cost + rest(node)), node)));
        }
        let mut found: Option<(f64, usize)> = None;
        while let Some(Reverse((Cost(at_least), node))) = open.pop() {
            if found.is_some_and(|(cost, _)| cost <= at_least) {
                break;
            }
            let here = best[node];
            if at_least > here + rest(node) + 1e-9 {
                continue;
            }
            if let Some(left) = ends.get(&node)
                && found.is_none_or(|(cost, _)| here + left < cost)
            {
                found = Some((here + left, node));
            }
            for edge in &self.edges[node] {
                let cost = here + edge.cost_m;
                if (anywhere || edge.turn != Some(Turn::Over)) && cost < best[edge.to] {
                    best[edge.to] = cost;
                    came.insert(edge.to, (node, edge.turn));
                    open.push(Reverse((Cost(cost + rest(edge.to)), edge.to)));
                }
            }
        }
        let mut route = VecDeque::from([arrive]);
        let mut node = found?.1;
        while let Some(&(before, turn)) = came.get(&node) {
            if let Some(then) = turn {
                let Node { way, along_m, .. } = self.nodes[before];
                route.push_front(Leg { way, to_m: along_m, then });
            }
            node = before;
        }
        Some(route)
    }

    /// The nodes before and behind a place on its way, with the metres to them.
    fn beside(&self, (way, along_m): (usize, f64)) -> impl Iterator<Item = (usize, f64)> {
        let nodes = &self.on_way[way];
        let after = nodes.partition_point(|&n| self.nodes[n].along_m < along_m);
        let around = [after.checked_sub(1), Some(after)].into_iter().flatten();
        around.filter_map(|i| nodes.get(i)).map(move |&n| (n, (self.nodes[n].along_m - along_m).abs()))
    }
}

/// The representative of a group (union-find).
fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

/// Metres, ordered.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost(f64);

impl Eq for Cost {}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::net::Net;
    use opendrive::Map;

    fn town(name: &str) -> (Paths, Routes) {
        let town = town::generate(&town::named(name).expect("our town")).expect("a town");
        let map = Map::new(town);
        let paths = Paths::new(&map, &Net::new(&map));
        let middle = paths.ways[0].samples[0].point;
        let routes = Routes::new(&paths, &[middle], 300.0);
        (paths, routes)
    }

    /// Cost of the cheapest way to every node by relaxing all edges until nothing changes (Bellman and Ford).
    fn costs(routes: &Routes, from: (usize, f64), anywhere: bool) -> Vec<f64> {
        let mut costs = vec![f64::INFINITY; routes.nodes.len()];
        routes.beside(from).for_each(|(n, c)| costs[n] = c);
        let mut changed = true;
        while changed {
            changed = false;
            for (n, edges) in routes.edges.iter().enumerate() {
                for edge in edges.iter().filter(|e| anywhere || e.turn != Some(Turn::Over)) {
                    if costs[n] + edge.cost_m < costs[edge.to] {
                        costs[edge.to] = costs[n] + edge.cost_m;
                        changed = true;
                    }
                }
            }
        }
        costs
    }

    /// What a route costs, leg by leg; every leg begins where the one before leads.
    fn length(routes: &Routes, from: (usize, f64), route: &Route) -> f64 {
        let (mut way, mut along, mut sum) = (from.0, from.1, 0.0);
        for leg in route {
            assert_eq!(leg.way, way, "{route:?}");
            sum += (leg.to_m - along).abs();
            let near = |n: &&usize| (routes.nodes[**n].along_m - leg.to_m).abs() < 1e-6;
            let Some(&node) = routes.on_way[way].iter().find(near) else {
                assert_eq!(leg.then, Turn::Arrive);
                return sum;
            };
            let Some(edge) = routes.edges[node].iter().find(|e| e.turn == Some(leg.then)) else {
                assert_eq!(leg.then, Turn::Arrive);
                return sum;
            };
            sum += edge.cost_m;
            (way, along) = (routes.nodes[edge.to].way, routes.nodes[edge.to].along_m);
        }
        panic!("{route:?} does not arrive")
    }

    #[test]
    fn routes_are_the_cheapest_there_are() {
        let (paths, routes) = town("convoy/demo");
        let mut stream = Stream::new(7, 0, "test/routes", 0);
        let mut crossed = [0; 2];
        for trial in 0..24 {
            let anywhere = trial % 2 == 1;
            let (Some(from), Some(to)) =
                (routes.draw_goal(&paths, &mut stream), routes.draw_goal(&paths, &mut stream))
            else {
                panic!("no destination")
            };
            let costs = costs(&routes, from, anywhere);
            let mut want = routes.beside(to).map(|(n, c)| costs[n] + c).fold(f64::INFINITY, f64::min);
            if from.0 == to.0 {
                want = want.min((from.1 - to.1).abs());
            }
            match routes.find(from, to, anywhere) {
                Some(route) => {
                    let got = length(&routes, from, &route);
                    assert!((got - want).abs() < 1e-6, "{got} instead of {want}: {route:?}");
                    crossed[usize::from(anywhere)] += route.iter().filter(|l| l.then == Turn::Over).count();
                }
                None => assert_eq!(want, f64::INFINITY),
            }
            let group = &routes.groups[usize::from(anywhere)];
            assert_eq!(want.is_finite(), group[from.0] == group[to.0]);
        }
        assert!(crossed[0] == 0 && crossed[1] > 0, "{crossed:?}");
    }

    #[test]
    fn destinations_are_near_and_the_wished_side_is_found() {
        let (paths, routes) = town("convoy/demo");
        let mut stream = Stream::new(8, 0, "test/routes", 0);
        for trial in 0..200 {
            let from = routes.draw_goal(&paths, &mut stream).expect("a place");
            let wish = [None, Some(false), Some(true)][trial % 3];
            let route = routes.draw(&paths, from, false, wish, &mut stream);
            let last = route.back().expect("a leg");
            assert_eq!(last.then, Turn::Arrive);
            let at = paths.ways[last.way].place(last.to_m).point;
            assert!((at - routes.centres[0]).norm() < 300.0 || last.way == from.0);
        }
    }
}
