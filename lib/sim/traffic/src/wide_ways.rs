//! Ways wide enough for what a vehicle tows: it cuts corners, the more the longer it is. A lane is such a way
//! if the towed one stays within it, but for a margin; and on what reaches over the lane's edge there is
//! another lane. Most towns have streets that lead to tight turns alone: of each lane it is told for how long
//! one can drive on from it.

use std::sync::Arc;

use catalogue::trains::Train;
use frames::math::sin_cos;
use nalgebra::{Point3, Vector3};

use crate::road::centreline::CentrelinePoint;
use crate::road::net::{Lane, Net};
use crate::vehicle::motion::{after_rod, half_base_m};

/// How far it may reach over the edge of its lane, on a road and in a junction, where nobody drives beside,
/// metres.
const ROAD_MARGIN_M: f64 = 0.0;
const JUNCTION_MARGIN_M: f64 = 1.2;
/// Room to the edge of the road, metres.
const EDGE_M: f64 = 0.10;
/// Lanes whose radius is nowhere smaller than this are wide enough for whatever is as wide as a lane, metres.
const STRAIGHT_M: f64 = 150.0;
/// Lanes narrower than the vehicle and this are no way, metres.
const BESIDE_M: f64 = 0.3;
/// Ways are driven in steps of this, metres.
const STEP_M: f64 = 0.75;
/// Ways before a lane are looked at so far back, metres, and at most so many of them.
const BEFORE_M: f64 = 30.0;
const MOST_BEFORE: usize = 6;

/// For each lane of a map the least time that a train can drive from its beginning until only narrow ways
/// lead on, seconds: at the limits, on the longest way; 0 on what is narrow itself, and without end on a
/// ring, or where the road itself ends. Lanes farther than `reach_m` from all of some places are not looked
/// at, and count as wide.
pub(crate) fn wide_ways(net: &Net, train: &Train, places: &[Point3<f64>], reach_m: f64) -> Arc<[f64]> {
    let near = |lane: usize| {
        let way = &net.lanes[lane].centre;
        [way.start(), way.end()].iter().any(|end| places.iter().any(|p| (p - end).norm() < reach_m))
    };
    let near: Vec<bool> = (0..net.lanes.len()).map(near).collect();
    let bent = |lane: usize| net.lanes[lane].radius_m < STRAIGHT_M;
    let mut wide: Vec<bool> = (0..net.lanes.len())
        .map(|lane| !near[lane] || has_width(net, train, lane) && (!bent(lane) || fits(net, train, &[lane])))
        .collect();
    // Behind a bend, and from bend to bend.
    let alone = wide.clone();
    for lane in (0..net.lanes.len()).filter(|&lane| near[lane] && alone[lane]) {
        let ways = ways_to(net, &alone, lane);
        let winding = ways.into_iter().filter(|way| way.len() > 1 && way.iter().any(|&l| bent(l)));
        wide[lane] = winding.into_iter().all(|way| fits(net, train, &way));
    }
    lead_on_s(net, wide).into()
}

/// Whether a lane is wider than what drives on it, all along.
fn has_width(net: &Net, train: &Train, lane: usize) -> bool {
    let least_m = train.lead.size_m[1].max(train.towed.size_m[1]) + BESIDE_M;
    net.lanes[lane].centre.samples.iter().all(|sample| sample.width_m >= least_m)
}

/// How long one can drive on over wide lanes, seconds.
fn lead_on_s(net: &Net, mut wide: Vec<bool>) -> Vec<f64> {
    let mut rooms_s: Vec<f64> = wide.iter().map(|wide| if *wide { f64::INFINITY } else { 0.0 }).collect();
    // Those that lead to narrow ones alone, from their ends on backwards: when one is taken out, all that
    // follow it are.
    let mut open: Vec<usize> = (0..wide.len()).collect();
    while let Some(lane) = open.pop() {
        let Lane { next, previous, centre, limit_mps, .. } = &net.lanes[lane];
        if wide[lane] && !next.is_empty() && next.iter().all(|&on| !wide[on]) {
            wide[lane] = false;
            let on_s = next.iter().map(|&on| rooms_s[on]).fold(0.0, f64::max);
            rooms_s[lane] = centre.length_m / limit_mps + on_s;
            open.extend(previous.iter().filter(|&&before| wide[before]));
        }
    }
    rooms_s
}

/// Ways over wide lanes that end with a lane, as long as a train and what it remembers of bends behind it.
fn ways_to(net: &Net, wide: &[bool], lane: usize) -> Vec<Vec<usize>> {
    let mut found = Vec::new();
    let mut open = vec![(vec![lane], 0.0)];
    while let Some((way, long_m)) = open.pop() {
        let before = net.lanes[way[0]].previous.iter().filter(|&&l| wide[l] && !way.contains(&l));
        let mut is_last = true;
        for &first in before.filter(|_| long_m < BEFORE_M) {
            is_last = false;
            let longer = std::iter::once(first).chain(way.iter().copied()).collect();
            open.push((longer, long_m + net.lanes[first].centre.length_m));
        }
        if is_last {
            found.push(way);
        }
        if found.len() >= MOST_BEFORE {
            break;
        }
    }
    found
}

/// Whether a train that comes along a way stays where it may be from when it enters the last lane of it on,
/// going straight on behind that.
fn fits(net: &Net, train: &Train, way: &[usize]) -> bool {
    let length = |lane: usize| net.lanes[lane].centre.length_m;
    let Some(&last) = way.last() else { return true };
    let before_m: f64 = way[..way.len() - 1].iter().map(|&l| length(l)).sum();
    let place = |along_m: f64| -> (usize, CentrelinePoint) {
        let (mut lane, mut left_m) = (way[0], along_m);
        for &next in &way[1..] {
            if left_m < length(lane) {
                break;
            }
            left_m -= length(lane);
            lane = next;
        }
        (lane, net.lanes[lane].centre.place_beyond(left_m))
    };
    let mut gone = TrainWay::new(train, place(0.0).1);
    let end_m = before_m + length(last) + train.rear_m();
    // Where the lead's middle is, and the place beside the axle of what is towed.
    let (mut at_m, mut beside_m) = (0.0, -(train.hitch_m + train.rod_m));
    while at_m < end_m {
        at_m += STEP_M;
        gone.advance(place(at_m).1.point);
        let axle = gone.axle();
        for _ in 0..4 {
            beside_m += place(beside_m).1.local(&axle)[0];
        }
        if at_m < before_m {
            continue;
        }
        let (lane, beside) = place(beside_m);
        // A way that bends sharply has no place beside.
        let [ahead_m, left_m] = beside.local(&axle);
        let half_m = 0.5 * train.towed.size_m[1];
        let over_m = left_m.abs() + half_m - 0.5 * beside.width_m;
        let margin_m = if net.lanes[lane].junction.is_some() { JUNCTION_MARGIN_M } else { ROAD_MARGIN_M };
        if ahead_m.abs() > STEP_M || over_m > margin_m {
            return false;
        }
        let off_road =
            over_m > -EDGE_M && gone.side(left_m, half_m + EDGE_M).any(|p| net.lanes_at(&p, 0.0).is_empty());
        if off_road {
            return false;
        }
    }
    true
}

/// A train on its way: the kinematics of [`crate::vehicle::motion::Motion`] and
/// [`crate::vehicle::towed::Towed`], in the plane.
struct TrainWay<'a> {
    train: &'a Train,
    at: Point3<f64>,
    yaw_rad: f64,
    hitch: Point3<f64>,
    towed_yaw_rad: f64,
}

impl<'a> TrainWay<'a> {
    /// In line at a place.
    fn new(train: &'a Train, at: CentrelinePoint) -> Self {
        let yaw_rad = at.heading_rad;
        let mut way = Self { train, at: at.point, yaw_rad, hitch: at.point, towed_yaw_rad: yaw_rad };
        way.hitch = way.hitch_now();
        way
    }

    fn hitch_now(&self) -> Point3<f64> {
        let (sin, cos) = sin_cos(self.yaw_rad);
        self.at - Vector3::new(cos, sin, 0.0) * self.train.hitch_m
    }

    fn advance(&mut self, to: Point3<f64>) {
        self.yaw_rad = after_rod(self.yaw_rad, &(to - self.at), half_base_m(self.train.lead));
        self.at = to;
        let hitch = self.hitch_now();
        self.towed_yaw_rad = after_rod(self.towed_yaw_rad, &(hitch - self.hitch), self.train.rod_m);
        self.hitch = hitch;
    }

    /// A point of what is towed, so far behind the hitch and to the left.
    fn behind(&self, back_m: f64, left_m: f64) -> Point3<f64> {
        let (sin, cos) = sin_cos(self.towed_yaw_rad);
        self.hitch - Vector3::new(cos, sin, 0.0) * back_m + Vector3::new(-sin, cos, 0.0) * left_m
    }

    fn axle(&self) -> Point3<f64> {
        self.behind(self.train.rod_m, 0.0)
    }

    /// Points of its side that is towards an offset, around its axle, and of the other one at its rear end.
    fn side(&self, left_m: f64, aside_m: f64) -> impl Iterator<Item = Point3<f64>> {
        let rear_m = self.train.coupling_m + 0.5 * self.train.towed.size_m[0];
        let [inner, outer] = [aside_m.copysign(left_m), -aside_m.copysign(left_m)];
        let rod_m = self.train.rod_m;
        [(0.6 * rod_m, inner), (0.8 * rod_m, inner), (rod_m, inner), (rear_m, inner), (rear_m, outer)]
            .map(|(back_m, left_m)| self.behind(back_m, left_m))
            .into_iter()
    }
}

/// Where a train stands in line along the way that it came, its lead at a place on a lane and the lanes
/// before that in order from the nearest one on: the yaw of what it tows.
pub(crate) fn towed_yaw_rad(
    net: &Net,
    train: &Train,
    (lane, along_m): (usize, f64),
    behind: &[usize],
) -> f64 {
    let place = |on_m: f64| {
        let (mut at, mut on_m) = (lane, along_m + on_m);
        for &before in behind {
            if on_m >= 0.0 {
                break;
            }
            at = before;
            on_m += net.lanes[before].centre.length_m;
        }
        net.lanes[at].centre.place_beyond(on_m)
    };
    // What it has forgotten after so many lengths of its rod is less than a thousandth.
    let from_m = -(7.0 * train.rod_m + train.rear_m());
    let mut way = TrainWay::new(train, place(from_m));
    let steps = (-from_m / STEP_M).ceil();
    for k in 1..=steps as u32 {
        way.advance(place(from_m * (1.0 - f64::from(k) / steps)).point);
    }
    way.towed_yaw_rad
}

#[cfg(test)]
mod tests {
    use super::*;
    use catalogue::trains;
    use opendrive::{Curve, Geometry, LaneSection, LaneType, Map, Network};
    use testkit::{lane, straight};

    /// Straight on for 60 m, round a bend to the left whose lane's middle has a radius, on for 60 m.
    fn bend(radius_m: f64, turn_rad: f64) -> Net {
        let section = LaneSection { right: vec![lane(-1, LaneType::Driving, 3.5)], ..LaneSection::default() };
        // The reference runs along the lane's left edge.
        let inner_m = radius_m - 1.75;
        let mut road = testkit::town_street("1", [0.0; 2], 0.0, 120.0 + turn_rad * inner_m, section);
        road.plan_view[0].length_m = 60.0;
        let (sin, cos) = sin_cos(turn_rad);
        let arc_m = turn_rad * inner_m;
        road.plan_view.push(Geometry {
            s: 60.0,
            x_m: 60.0,
            length_m: arc_m,
            curve: Curve::Arc { curvature: 1.0 / inner_m },
            ..Geometry::default()
        });
        road.plan_view.push(Geometry {
            s: 60.0 + arc_m,
            x_m: 60.0 + inner_m * sin,
            y_m: inner_m * (1.0 - cos),
            hdg_rad: turn_rad,
            length_m: 60.0,
            ..Geometry::default()
        });
        Net::new(&Map::new(Network { roads: vec![road], ..Network::default() }))
    }

    fn is_wide(net: &Net, towed: &str) -> bool {
        let train = trains::of_towed(towed).expect("a train");
        wide_ways(net, train, &[Point3::origin()], 1000.0).iter().all(|room_s| *room_s > 0.0)
    }

    #[test]
    fn long_bends_are_wide_where_pythagoras_says_so() {
        // On a road the offset may be 3.5 / 2 - 2.55 / 2 - 0.1 m before the edge of the road: beyond it there
        // is grass.
        let most_m = 0.5 * 3.5 - 0.5 * 2.55 - EDGE_M;
        for towed in ["trailer.box", "bus.articulated_rear"] {
            let train = trains::of_towed(towed).expect("a train");
            let cuts_m = |radius_m: f64| radius_m - train.axle_radius_m(radius_m);
            let mut radius_m = 15.0;
            while cuts_m(radius_m) > most_m {
                radius_m += 0.5;
            }
            assert!(is_wide(&bend(1.15 * radius_m, 2.0), towed), "{towed}: {radius_m}");
            assert!(!is_wide(&bend(0.85 * radius_m, 2.0), towed), "{towed}: {radius_m}");
        }
    }

    #[test]
    fn what_leads_to_narrow_ways_alone_is_none() {
        let map = straight(100.0);
        let mut net = Net::new(&map);
        let on = net.lanes.len();
        // The first lane goes on as a second one, which is too narrow.
        let mut narrow = net.lanes[0].clone();
        narrow.centre.samples.iter_mut().for_each(|s| s.width_m = 2.6);
        narrow.next = Vec::new();
        narrow.previous = vec![0];
        net.lanes[0].next = vec![on];
        net.lanes.push(narrow);
        let train = trains::of_towed("trailer.box").expect("a train");
        let wide = wide_ways(&net, train, &[Point3::origin()], 1000.0);
        // 100 m at 50 km/h.
        assert_eq!(wide[on], 0.0);
        assert!((wide[0] - 7.2).abs() < 0.01, "{}", wide[0]);
        net.lanes[0].next = Vec::new();
        assert_eq!(wide_ways(&net, train, &[Point3::origin()], 1000.0)[0], f64::INFINITY);
    }

    #[test]
    fn trains_begin_as_they_would_have_come() {
        let net = bend(40.0, 2.0);
        let train = trains::of_towed("trailer.box").expect("a train");
        // After 1.5 rad the towed one is nearly as on a circle for good: the angle at the axle is asin(L /
        // R_h).
        let at = 60.0 + 1.6 * 40.0;
        let lane = (0..net.lanes.len()).find(|&l| net.lanes[l].centre.length_m > 150.0).expect("one lane");
        let heading = net.lanes[lane].centre.place(at).heading_rad;
        let towed = towed_yaw_rad(&net, train, (lane, at), &[]);
        let rear = (40.0f64 * 40.0 - 1.85 * 1.85).sqrt();
        let hitch = (rear * rear + 0.4 * 0.4).sqrt();
        let (asin, atan) = (frames::math::asin, frames::math::atan);
        // The lead heads inside its followed point's way by asin(h / R); the hitch is ahead of its axle.
        let wanted = heading - asin(1.85 / 40.0) + atan(0.4 / rear) - asin(train.rod_m / hitch);
        assert!(frames::wrap_pi(towed - wanted).abs() < 0.003, "{towed} instead of {wanted}");
    }
}
