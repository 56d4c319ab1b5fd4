//! Country roads: a sparse network between given sites that keeps clear of what is there already.

use frames::wrap_pi;
use std::collections::BTreeMap;

use super::plane::{Point, Segment, between, cross, distance, heading, near, to_segment};

/// Least angle between two roads at a site, radians.
const ANGLE_RAD: f64 = 1.0;
/// Most roads at a site.
const ARMS: usize = 4;
/// Roads that do not meet keep this far apart, from sites, from other streets and from the motorway, metres.
const APART_M: f64 = 100.0;
const SITE_M: f64 = 150.0;
const STREET_M: f64 = 70.0;
const MOTORWAY_M: f64 = 150.0;
/// Least angle at which a road crosses the motorway, radians; its ends are at least so far from there,
/// metres.
const CROSSING_RAD: f64 = 0.8;
const CROSSING_M: f64 = 260.0;

/// A place that roads may lead to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) at_m: Point,
    /// A road that comes to it from a town or an interchange: where it comes from. Other roads go on ahead.
    pub(super) from_m: Option<Point>,
    /// Sites of the same town, or of the motorway, are joined anyhow.
    pub(super) group: Option<usize>,
}

/// What roads must keep clear of.
#[derive(Clone, Debug, Default)]
pub(super) struct Obstacles {
    /// Streets of towns, ramps, and the shore of the sea.
    pub(super) streets: Vec<Segment>,
    /// A motorway, and the parts of it that roads may cross.
    pub(super) motorway: Vec<Segment>,
    pub(super) open: Vec<Segment>,
}

/// A road between two sites.
pub(super) type Link = [usize; 2];

/// The network.
#[derive(Clone, Debug)]
pub(super) struct Country<'a> {
    sites: &'a [Site],
    obstacles: &'a Obstacles,
    pub(super) links: Vec<Link>,
    /// Neighbours of each site with their distance, metres; those of the same group among them.
    near: Vec<Vec<(usize, f64)>>,
}

impl<'a> Country<'a> {
    /// A greedy spanner (Althoefer and others, 1993): from short to long, each road that would shorten the
    /// way between its ends to `stretch` of it or less, as long as nothing is in its way.
    pub(super) fn new(sites: &'a [Site], obstacles: &'a Obstacles, reach_m: f64, stretch: f64) -> Self {
        let mut country =
            Self { sites, obstacles, links: Vec::new(), near: sites.iter().map(|_| Vec::new()).collect() };
        let mut pairs: Vec<(f64, Link)> = Vec::new();
        for (a, site) in sites.iter().enumerate() {
            for (b, other) in sites.iter().enumerate().skip(a + 1) {
                let d = distance(site.at_m, other.at_m);
                if site.group.is_some() && site.group == other.group {
                    country.near[a].push((b, d));
                    country.near[b].push((a, d));
                } else if d < reach_m {
                    pairs.push((d, [a, b]));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (d, link) in pairs {
            if country.fits(link) && country.way(link, stretch * d).is_none() {
                let [a, b] = link;
                country.links.push(link);
                country.near[a].push((b, d));
                country.near[b].push((a, d));
            }
        }
        country
    }

    /// Roads at a site.
    pub(super) fn arms(&self, site: usize) -> impl Iterator<Item = usize> {
        self.links
            .iter()
            .filter(move |l| l.contains(&site))
            .map(move |[a, b]| if *a == site { *b } else { *a })
    }

    fn fits(&self, [a, b]: Link) -> bool {
        let road = [self.sites[a].at_m, self.sites[b].at_m];
        [[a, b], [b, a]].into_iter().all(|[from, to]| {
            let site = &self.sites[from];
            let out = heading(site.at_m, self.sites[to].at_m);
            let wide = |p: Point| wrap_pi(heading(site.at_m, p) - out).abs() >= ANGLE_RAD;
            let behind = site.from_m.is_none_or(|p| wrap_pi(heading(site.at_m, p) - out).abs() > 1.6);
            behind && self.arms(from).count() < ARMS && self.arms(from).all(|to| wide(self.sites[to].at_m))
        }) && self.is_clear([a, b], road)
    }

    fn is_clear(&self, [a, b]: Link, road: Segment) -> bool {
        let own = |i: usize| i == a || i == b;
        let sites = self.sites.iter().enumerate().all(|(i, site)| {
            own(i)
                || to_segment(site.at_m, road) >= SITE_M
                    && site.from_m.is_none_or(|from| !near(road, [from, site.at_m], APART_M))
        });
        let roads = || {
            self.links.iter().all(|[c, d]| {
                own(*c) || own(*d) || !near(road, [self.sites[*c].at_m, self.sites[*d].at_m], APART_M)
            })
        };
        let streets = || self.obstacles.streets.iter().all(|street| !near(road, *street, STREET_M));
        sites && roads() && streets() && self.passes_motorway(road)
    }

    /// Whether a road keeps clear of the motorway, or crosses it once where it may.
    fn passes_motorway(&self, road: Segment) -> bool {
        let [a, b] = road;
        let crossings = self.obstacles.motorway.iter().filter(|part| cross(road, **part).is_some()).count();
        match crossings {
            0 => self.obstacles.motorway.iter().all(|part| !near(road, *part, MOTORWAY_M)),
            1 => self.obstacles.open.iter().any(|part| {
                cross(road, *part).is_some_and(|(u, _)| {
                    let at = between(a, b, u);
                    let turn = wrap_pi(heading(a, b) - heading(part[0], part[1])).abs();
                    let ends = distance(at, a).min(distance(at, b));
                    turn.min(std::f64::consts::PI - turn) > CROSSING_RAD && ends > CROSSING_M
                })
            }),
            _ => false,
        }
    }

    /// The shortest way between two sites, if it is no longer than a limit: the sites along it, from the
    /// second to the first (Dijkstra, 1959).
    pub(super) fn way(&self, [from, to]: Link, limit_m: f64) -> Option<Vec<usize>> {
        let mut before: BTreeMap<usize, usize> = BTreeMap::new();
        let mut reached: Vec<f64> = vec![f64::INFINITY; self.sites.len()];
        let mut open: Vec<(f64, usize)> = vec![(0.0, from)];
        reached[from] = 0.0;
        while let Some(next) = (0..open.len()).min_by(|a, b| open[*a].0.total_cmp(&open[*b].0)) {
            let (d, site) = open.swap_remove(next);
            if site == to {
                let mut way = vec![to];
                while let Some(previous) = way.last().and_then(|last| before.get(last)) {
                    way.push(*previous);
                }
                return Some(way);
            }
            if d > reached[site] {
                continue;
            }
            for (other, step) in &self.near[site] {
                let sum = d + step;
                if sum < reached[*other] && sum <= limit_m {
                    reached[*other] = sum;
                    before.insert(*other, site);
                    open.push((sum, *other));
                }
            }
        }
        None
    }

    /// The roads that lead somewhere: those that can be reached from a site, without dead ends in the fields
    /// and without loops that end where they began.
    pub(super) fn leading(&self, from: usize) -> Vec<Link> {
        let kept = self.reached(from);
        let mut links: Vec<Link> = self.links.iter().copied().filter(|l| kept[l[0]]).collect();
        loop {
            let arms = |site: usize| links.iter().filter(|l| l.contains(&site)).count();
            let passed = |site: usize| self.sites[site].group.is_none() && arms(site) == 2;
            let other = |[a, b]: Link, site: usize| if a == site { b } else { a };
            // From a junction along a road to where the next one is.
            let walk = |start: usize, first: Link| {
                let (mut road, mut at) = (vec![first], other(first, start));
                while at != start && passed(at) {
                    let last = road[road.len() - 1];
                    let Some(next) = links.iter().find(|l| l.contains(&at) && **l != last) else { break };
                    road.push(*next);
                    at = other(*next, at);
                }
                let dead = self.sites[at].group.is_none() && arms(at) == 1;
                (dead || at == start).then_some(road)
            };
            let ends = links.iter().flat_map(|l| l.map(|site| (site, *l)));
            let Some(idle) = ends.filter(|(site, _)| !passed(*site)).find_map(|(site, l)| walk(site, l))
            else {
                return links;
            };
            links.retain(|l| !idle.contains(l));
        }
    }

    /// Sites that can be reached from one.
    pub(super) fn reached(&self, from: usize) -> Vec<bool> {
        let mut seen = vec![false; self.sites.len()];
        seen[from] = true;
        let mut stack = vec![from];
        while let Some(site) = stack.pop() {
            for (other, _) in &self.near[site] {
                if !seen[*other] {
                    seen[*other] = true;
                    stack.push(*other);
                }
            }
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(x: f64, y: f64) -> Site {
        Site { at_m: [x, y], from_m: None, group: None }
    }

    #[test]
    fn roads_join_all_sites_without_crossing() {
        let sites: Vec<Site> = (0..36)
            .map(|i| free(700.0 * f64::from(i % 6) + 40.0 * f64::from(i % 5), 700.0 * f64::from(i / 6)))
            .collect();
        let none = Obstacles::default();
        let country = Country::new(&sites, &none, 1800.0, 1.9);
        assert!(country.reached(0).iter().all(|seen| *seen));
        let road = |l: &Link| [sites[l[0]].at_m, sites[l[1]].at_m];
        for (i, a) in country.links.iter().enumerate() {
            for b in country.links[i + 1..].iter().filter(|b| !a.iter().any(|s| b.contains(s))) {
                assert!(!near(road(a), road(b), APART_M));
            }
        }
    }

    #[test]
    fn roads_to_nowhere_are_left_out() {
        // A square of sites, a dead end of two roads at its first corner, and a loop at its third.
        let at = |x: f64, y: f64| free(400.0 * x, 400.0 * y);
        let mut sites = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        sites.extend([at(-1.0, 0.0), at(-2.0, 0.0), at(2.0, 1.0), at(1.6, 2.0)]);
        let none = Obstacles::default();
        let mut country = Country::new(&sites, &none, 0.0, 1.0);
        let square = [[0, 1], [1, 2], [2, 3], [0, 3], [0, 2]];
        country.links = [&square[..], &[[0, 4], [4, 5], [2, 6], [6, 7], [2, 7]]].concat();
        for [a, b] in country.links.clone() {
            country.near[a].push((b, 1.0));
            country.near[b].push((a, 1.0));
        }
        assert_eq!(country.leading(0), square);
        // What leads to a town stays.
        let mut with_town = sites.clone();
        with_town[5].group = Some(1);
        let country = Country { sites: &with_town, ..country };
        assert_eq!(country.leading(0), [&square[..], &[[0, 4], [4, 5]]].concat());
    }

    #[test]
    fn motorways_are_crossed_where_they_may_be() {
        let sites = [free(-600.0, 0.0), free(600.0, 0.0)];
        let leg = [[0.0, -2000.0], [0.0, 2000.0]];
        let closed = Obstacles { motorway: vec![leg], ..Obstacles::default() };
        assert!(Country::new(&sites, &closed, 5000.0, 2.0).links.is_empty());
        let open = Obstacles { open: vec![[[0.0, -300.0], [0.0, 300.0]]], ..closed };
        assert_eq!(Country::new(&sites, &open, 5000.0, 2.0).links, [[0, 1]]);
    }
}
