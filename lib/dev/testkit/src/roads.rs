//! Small road networks.

use std::f64::consts::PI;

use frames::math::sin_cos;
use opendrive::{
    Connection, ContactPoint, Controller, Cubic, Geometry, Junction, JunctionController, Lane, LaneLink,
    LaneSection, LaneType, LaneValidity, Map, Network, Road, RoadLink, RoadType, Signal, Speed, SpeedUnit,
};

/// A lane of constant width, metres.
#[must_use]
pub fn lane(id: i16, lane_type: LaneType, width_m: f64) -> Lane {
    Lane { id, lane_type, widths: vec![Cubic::constant(width_m)], ..Lane::default() }
}

/// A section with the same lanes on both sides, from the middle outward: type and width in metres.
#[must_use]
pub fn both_ways(lanes: &[(LaneType, f64)]) -> LaneSection {
    LaneSection { left: side(1, lanes), ..one_way(lanes) }
}

/// A section with lanes on the right alone, from the middle outward: type and width in metres.
#[must_use]
pub fn one_way(lanes: &[(LaneType, f64)]) -> LaneSection {
    LaneSection { right: side(-1, lanes), ..LaneSection::default() }
}

fn side(sign: i16, lanes: &[(LaneType, f64)]) -> Vec<Lane> {
    (1..).zip(lanes).map(|(i, (lane_type, width_m))| lane(sign * i, *lane_type, *width_m)).collect()
}

/// A straight road of one section at height 0: where its reference line starts and leads to, metres and
/// radians.
#[must_use]
pub fn road(id: &str, start_m: [f64; 2], hdg_rad: f64, length_m: f64, section: LaneSection) -> Road {
    Road {
        id: id.to_owned(),
        length_m,
        plan_view: vec![Geometry {
            x_m: start_m[0],
            y_m: start_m[1],
            hdg_rad,
            length_m,
            ..Geometry::default()
        }],
        sections: vec![section],
        ..Road::default()
    }
}

/// A [`road`] of type `town`, with its limit of 50 km/h.
#[must_use]
pub fn town_street(id: &str, start_m: [f64; 2], hdg_rad: f64, length_m: f64, section: LaneSection) -> Road {
    let limit = Speed { max: 50.0, unit: SpeedUnit::KilometresPerHour };
    let types = vec![RoadType { s: 0.0, kind: "town".to_owned(), speed: Some(limit), ..RoadType::default() }];
    Road { types, ..road(id, start_m, hdg_rad, length_m, section) }
}

/// The road "1" to the east from the origin, with the same lanes on both sides, as a [`town_street`].
#[must_use]
pub fn straight_road(length_m: f64, lanes: &[(LaneType, f64)]) -> Road {
    town_street("1", [0.0; 2], 0.0, length_m, both_ways(lanes))
}

/// A street to the east from the origin: a driving lane of 3.5 m and a sidewalk of 3 m each way.
#[must_use]
pub fn straight(length_m: f64) -> Map {
    map(vec![straight_road(length_m, &[(LaneType::Driving, 3.5), (LaneType::Sidewalk, 3.0)])])
}

/// A link to an end of another road.
#[must_use]
pub fn road_link(id: &str, contact: ContactPoint) -> Option<RoadLink> {
    Some(RoadLink::Road { id: id.to_owned(), contact })
}

/// A map of roads without junctions.
#[must_use]
pub fn map(roads: Vec<Road>) -> Map {
    Map::new(Network { roads, ..Network::default() })
}

/// A map from the text of an OpenDRIVE file.
///
/// # Panics
/// The text is no OpenDRIVE file.
#[must_use]
#[track_caller]
pub fn map_from_text(text: &str) -> Map {
    Map::new(Network::parse(text).unwrap_or_else(|e| panic!("{e}")))
}

/// The map of [`crossing_network`].
#[must_use]
pub fn crossing(signals: bool) -> Map {
    Map::new(crossing_network(signals))
}

/// Four arms of 200 m, "0" to "3" from the east counter-clockwise, a driving lane each way; straight ways
/// "10" to "13" through the middle of 20 m. With signals: a light "s0" to "s3" for each arm, and two
/// controllers that take turns.
#[must_use]
pub fn crossing_network(signals: bool) -> Network {
    let arms = [0.0, 0.5, 1.0, 1.5].map(|half_turns| half_turns * PI);
    let mut network = Network::default();
    for (i, &angle) in arms.iter().enumerate() {
        let (sin, cos) = sin_cos(angle);
        let section = both_ways(&[(LaneType::Driving, 3.5)]);
        let mut arm = town_street(&i.to_string(), [10.0 * cos, 10.0 * sin], angle, 200.0, section);
        arm.predecessor = Some(RoadLink::Junction { id: "j".to_owned() });
        network.roads.push(arm);
    }
    let mut junction = Junction { id: "j".to_owned(), ..Junction::default() };
    for (i, &angle) in arms.iter().enumerate() {
        let (sin, cos) = sin_cos(angle);
        let mut section = one_way(&[(LaneType::Driving, 3.5)]);
        (section.right[0].predecessors, section.right[0].successors) = (vec![1], vec![-1]);
        let id = (10 + i).to_string();
        let mut way = town_street(&id, [10.0 * cos, 10.0 * sin], angle + PI, 20.0, section);
        way.junction = Some("j".to_owned());
        way.predecessor = road_link(&i.to_string(), ContactPoint::Start);
        way.successor = road_link(&((i + 2) % 4).to_string(), ContactPoint::Start);
        if signals {
            way.signals.push(Signal {
                id: format!("s{i}"),
                dynamic: true,
                t: -5.0,
                validity: vec![LaneValidity { from: -1, to: -1 }],
                ..Signal::default()
            });
        }
        junction.connections.push(Connection {
            id: i.to_string(),
            incoming_road: i.to_string(),
            connecting_road: id,
            contact: ContactPoint::Start,
            lane_links: vec![LaneLink { from: 1, to: -1, ..LaneLink::default() }],
            ..Connection::default()
        });
        network.roads.push(way);
    }
    if signals {
        for (id, members) in [("a", ["s0", "s2"]), ("b", ["s1", "s3"])] {
            let signals = members.map(String::from).to_vec();
            network.controllers.push(Controller { id: id.to_owned(), signals, ..Controller::default() });
            junction
                .controllers
                .push(JunctionController { id: id.to_owned(), ..JunctionController::default() });
        }
    }
    network.junctions.push(junction);
    network
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_built_reads_back_without_a_warning() {
        let networks = [crossing_network(false), crossing_network(true), straight(80.0).network().clone()];
        for mut network in networks {
            network.header.revision = (1, 7);
            let again = map_from_text(&opendrive::write(&network));
            assert_eq!(again.network().warnings, []);
            assert_eq!(*again.network(), network);
        }
    }

    #[test]
    fn ways_of_the_crossing_join_opposite_arms() {
        let map = crossing(true);
        let road = |id: &str| map.network().roads.iter().position(|r| r.id == id).expect("a road") as u32;
        for i in 0..4 {
            let way = map.lanes().iter().find(|l| l.id.road == road(&format!("1{i}"))).expect("its lane");
            let (from, to) = (map.predecessors(way.id), map.successors(way.id));
            assert_eq!((from.len(), to.len()), (1, 1));
            assert_eq!([from[0].road, to[0].road], [road(&i.to_string()), road(&((i + 2) % 4).to_string())]);
        }
        assert_eq!(map.signals().iter().filter(|s| s.lanes.len() == 1).count(), 4);
    }
}
