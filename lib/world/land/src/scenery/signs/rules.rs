//! Which signs a side of a road has, besides those of the map.

use std::f64::consts::PI;

use frames::math::atan2;
use frames::wrap_pi;
use nalgebra::{Point3, Vector3};
use random::Stream;

use super::codes::Meaning;
use super::given::GivenSign;
use super::plates::{BEND, WARNING};
use crate::scenery::draw::draw;
use crate::scenery::frontage::Frontage;
use crate::scenery::site::Site;

/// Roads with a higher limit have no signs about parking, m/s.
const TOWN_MPS: f64 = 21.0;
/// Roads with this limit are motorways, if they have no sidewalk, m/s.
const MOTORWAY_MPS: f64 = 24.0;
/// The turn of a bend that is warned of, over so much road, and how far before it, radians and metres.
const BEND_RAD: f64 = 0.6;
const BEND_OVER_M: f64 = 40.0;
const BEFORE_BEND_M: f64 = 50.0;
/// A sign stands so far before what painting or a crosswalk says, metres.
const BEFORE_M: f64 = 1.0;
/// Crosswalks whose traffic has a light within this distance have no signs, metres.
const LIT_M: f64 = 30.0;
/// Frontages farther from the middle of a crosswalk are not crossed by it, metres.
const CROSSED_M: f64 = 16.0;

/// What is painted is looked for this far around an area, metres.
const PAINT_M: f64 = 60.0;
/// A sign of the map within this distance holds for a word on the road, metres.
const SIGNED_M: f64 = 20.0;
/// Numbers of wishes: of those drawn from 0, of those that the map asks for from here.
const CROSSWALK: u64 = 1 << 32;
const STOP: u64 = 2 << 32;

/// Where beside the road a sign stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoadsidePosition {
    /// At the kerb, or beside the pavement.
    Side,
    /// On the median.
    Median,
}

/// A sign that a side of a road would have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SignRequest {
    /// Its number among the signs of the frontage; it does not depend on the tile that is made.
    pub(super) slot: u64,
    /// Distance from the start of the frontage, metres.
    pub(super) along_m: f64,
    pub(super) place: RoadsidePosition,
    pub(super) meaning: Meaning,
    /// Whether those see it who drive on this side; else those who come against them.
    pub(super) to_traffic: bool,
}

/// A side of a road as its traffic sees it.
struct Side<'a> {
    front: &'a Frontage,
    length_m: f64,
    town: bool,
    motorway: bool,
    wishes: Vec<SignRequest>,
}

impl Side<'_> {
    /// Distance from the start of the frontage of what traffic reaches after some metres.
    fn along(&self, after_m: f64) -> f64 {
        if self.front.traffic.direction > 0.0 { after_m } else { self.length_m - after_m }
    }

    fn wish(&mut self, after_m: f64, meaning: Meaning) {
        self.push(after_m, RoadsidePosition::Side, meaning, true);
    }

    fn push(&mut self, after_m: f64, place: RoadsidePosition, meaning: Meaning, to_traffic: bool) {
        let (slot, along_m) = (self.wishes.len() as u64, self.along(after_m));
        self.wishes.push(SignRequest { slot, along_m, place, meaning, to_traffic });
    }

    /// On both sides of a carriageway of its own.
    fn wish_twice(&mut self, after_m: f64, meaning: Meaning) {
        self.wish(after_m, meaning);
        if self.front.traffic.lanes > 1 {
            self.push(after_m, RoadsidePosition::Median, meaning, true);
        }
    }

    /// Signs drawn from some kinds by their shares, from a place on, each so far after the one before.
    fn row(&mut self, random: &mut Stream, first_m: [f64; 2], steps_m: [f64; 2], kinds: &[(Meaning, f64)]) {
        let shares: Vec<f64> = kinds.iter().map(|(_, share)| *share).collect();
        let mut after_m = random.uniform(first_m[0], first_m[1]);
        while after_m < self.length_m - 12.0 {
            let (meaning, _) = kinds[draw(random, &shares)];
            self.wish(after_m, meaning);
            after_m += random.uniform(steps_m[0], steps_m[1]);
        }
    }
}

/// All signs that a side would have, the same for every tile that asks. None where no vehicles drive.
pub(super) fn wishes(site: &Site<'_>, front: &Frontage, paint: &Painted) -> Vec<SignRequest> {
    let length_m = front.length_m();
    let Some(middle) = front.at(0.5 * length_m).filter(|_| front.traffic.lanes > 0 && !front.track) else {
        return Vec::new();
    };
    let town = middle.walk_m > 0.9;
    let motorway = !town && front.speed_mps > MOTORWAY_MPS;
    let mut side = Side { front, length_m, town, motorway, wishes: Vec::new() };
    let stream = |topic| Stream::new(site.rules.seed, 0, topic, front.entity);
    limits(&mut side, &mut stream("world/signs/limits"));
    if town && front.speed_mps < TOWN_MPS {
        streets(&mut side, &mut stream("world/signs/streets"));
    } else if !town {
        country(&mut side, &mut stream("world/signs/country"));
    }
    painted(&mut side, paint);
    side.wishes
}

/// Limits a while after junctions and again on long roads.
fn limits(side: &mut Side<'_>, random: &mut Stream) {
    let Some(number) = number_of(side.front.speed_mps) else { return };
    let mut after_m = random.uniform(20.0, 32.0);
    // In the blocks of a town not every street repeats it.
    let again = random.chance(if side.town { 0.2 } else { 0.6 });
    let step_m = if side.town { 220.0 } else { 300.0 };
    if !again {
        after_m += step_m;
    }
    while after_m < side.length_m - 15.0 {
        side.wish_twice(after_m, Meaning::limit(Some(number)));
        after_m += step_m + random.uniform(0.0, 60.0);
    }
}

/// The number on a sign for a speed: whole fives of km/h, or of miles an hour.
fn number_of(speed_mps: f64) -> Option<f64> {
    let fives = |speed: f64| (speed / 5.0).round() * 5.0;
    let is_five = |speed: &f64| *speed > 9.0 && (speed - fives(*speed)).abs() < 0.05;
    [3.6 * speed_mps, speed_mps / 0.44704].into_iter().find(is_five).map(fives)
}

fn streets(side: &mut Side<'_>, random: &mut Stream) {
    let say = Meaning::of;
    let parked = [
        (say("parking_time_limit"), 0.4),
        (say("parking"), 0.3),
        (say("reserved_parking"), 0.2),
        (say("no_standing"), 0.1),
    ];
    let empty = [
        (say("no_parking"), 0.5),
        (say("no_standing"), 0.2),
        (say("tow_away_zone"), 0.1),
        (say("no_parking_towing_enforced"), 0.1),
        (say("bus_stop_no_parking"), 0.1),
    ];
    let kinds: &[(Meaning, f64)] = if side.front.traffic.parks { &parked } else { &empty };
    side.row(random, [14.0, 150.0], [80.0, 150.0], kinds);
    let others = [
        (say("school_zone"), 0.25),
        (say("frequent_pedestrian_cyclist"), 0.2),
        (say("photo_enforced"), 0.15),
        (say("clean_up_after_pet"), 0.15),
        (say("no_bicycles"), 0.1),
        (say("cross_only_at_crosswalk"), 0.15),
    ];
    side.row(random, [30.0, 900.0], [500.0, 900.0], &others);
    if random.chance(0.4) && side.length_m > 40.0 {
        side.wish(side.length_m - 3.0, say("street_name"));
    }
    if side.front.traffic.one_way_street && side.length_m > 30.0 {
        side.wish(6.0, say("one_way"));
        side.push(side.length_m - 4.0, RoadsidePosition::Side, say("do_not_enter"), false);
    }
}

fn country(side: &mut Side<'_>, random: &mut Stream) {
    let say = Meaning::of;
    if side.motorway {
        let kinds = [
            (say("interchange"), 0.45),
            (say("highway"), 0.3),
            (say("no_pedestrians"), 0.15),
            (say("passenger_cars_only"), 0.1),
        ];
        side.row(random, [40.0, 200.0], [180.0, 300.0], &kinds);
        return;
    }
    let unknown = Meaning { sign_type: "", plate: WARNING, value: None };
    let kinds = [
        (say("animal_crossing"), 0.3),
        (unknown, 0.25),
        (say("uneven_road"), 0.15),
        (say("frequent_pedestrian_cyclist"), 0.15),
        (say("bump_ahead"), 0.15),
    ];
    side.row(random, [40.0, 180.0], [150.0, 280.0], &kinds);
    let bend = Meaning { sign_type: "", plate: BEND, value: None };
    let heading = |side: &Side<'_>, after_m: f64| {
        side.front.at(side.along(after_m)).map(|spot| atan2(spot.away.y, spot.away.x))
    };
    let mut after_m = BEFORE_BEND_M + 5.0;
    while after_m + BEND_OVER_M < side.length_m {
        let turn = heading(side, after_m).zip(heading(side, after_m + BEND_OVER_M));
        if turn.is_some_and(|(a, b)| wrap_pi(b - a).abs() > BEND_RAD) {
            side.wish(after_m - BEFORE_BEND_M, bend);
            after_m += 160.0;
        }
        after_m += 10.0;
    }
}

/// What is painted near an area that signs belong to.
pub(super) struct Painted {
    /// Crosswalks without lights: number, middle and corners.
    crosswalks: Vec<(usize, Point3<f64>, Vec<Point3<f64>>)>,
    /// Words on the road before which traffic stops, where the map has no sign: number, place and the
    /// frontage of their lane.
    stops: Vec<(usize, Point3<f64>, u64)>,
}

impl Painted {
    pub(super) fn near(site: &Site<'_>, given: &[GivenSign]) -> Self {
        let near = |p: &Point3<f64>| site.near(p.x, p.y, PAINT_M);
        let crosswalks = site.map.crosswalks().iter().enumerate().filter_map(|(i, crosswalk)| {
            let ring = &crosswalk.polygon;
            let sum = ring.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords);
            let middle = Point3::from(sum / ring.len().max(1) as f64);
            let lit = || {
                let mut lights = site.map.signals().iter().filter(|signal| signal.dynamic);
                lights.any(|light| apart(&light.on_surface, &middle) < LIT_M)
            };
            (near(&middle) && !lit()).then(|| (i, middle, ring.clone()))
        });
        let stops = site.map.objects().iter().enumerate().filter_map(|(i, object)| {
            let place = Point3::from(object.pose.xyz());
            if !object.name.eq_ignore_ascii_case("Stencil_STOP") || !near(&place) {
                return None;
            }
            let held = given.iter().filter(|sign| matches!(sign.sign_type, "stop" | "yield"));
            let signed = held.into_iter().any(|sign| apart(&sign.foot, &place) < SIGNED_M);
            let hit = site.map.nearest_driving_lane(place).filter(|hit| hit.is_inside() && !signed)?;
            Some((i, place, 2 * u64::from(hit.lane.road) + u64::from(hit.lane.lane > 0)))
        });
        Self { crosswalks: crosswalks.collect(), stops: stops.collect() }
    }
}

fn apart(a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    (a - b).xy().norm()
}

/// Signs before crosswalks, and where the word stop is on the road.
fn painted(side: &mut Side<'_>, painted: &Painted) {
    let direction = side.front.traffic.direction;
    let mut wish = |slot, along_m, word| {
        let meaning = Meaning::of(word);
        side.wishes.push(SignRequest {
            slot,
            along_m,
            place: RoadsidePosition::Side,
            meaning,
            to_traffic: true,
        });
    };
    for (i, middle, ring) in &painted.crosswalks {
        let Some([along_m, far_m]) = side.front.nearest(middle.x, middle.y) else { continue };
        let level = side.front.at(along_m).is_some_and(|spot| (spot.point.z - middle.z).abs() < 2.0);
        let inner = along_m > 0.5 && along_m < side.length_m - 0.5;
        if far_m > CROSSED_M || !level || !inner {
            continue;
        }
        // Half of what it takes up along the road.
        let ends = ring.iter().filter_map(|p| side.front.nearest(p.x, p.y));
        let half_m = ends.map(|[along, _]| (along - along_m).abs()).fold(0.0, f64::max);
        wish(CROSSWALK | *i as u64, along_m - (half_m + BEFORE_M) * direction, "pedestrian_crossing");
    }
    for (i, place, _) in painted.stops.iter().filter(|(.., front)| *front == side.front.entity) {
        let Some([along_m, _]) = side.front.nearest(place.x, place.y) else { continue };
        wish(STOP | *i as u64, along_m + 2.0 * direction, "stop");
    }
}

impl crate::scenery::frontage::Spot {
    /// Yaw of what looks at the traffic of the side.
    pub(crate) fn facing_traffic_rad(&self, front: &Frontage) -> f64 {
        // Forward along the road is a quarter to the left of away on the right side, to the right on the left
        // one.
        let quarter = if front.entity.is_multiple_of(2) { 0.5 * PI } else { -0.5 * PI };
        let along = atan2(self.away.y, self.away.x) + quarter;
        wrap_pi(if front.traffic.direction > 0.0 { along + PI } else { along })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_country() {
        for (speed_mps, number) in
            [(50.0 / 3.6, 50.0), (30.0 * 0.44704, 30.0), (55.0 * 0.44704, 55.0), (25.0, 90.0)]
        {
            assert_eq!(number_of(speed_mps), Some(number), "{speed_mps}");
        }
        assert_eq!([0.0, 1.0, 12.0].map(number_of), [None; 3]);
    }
}
