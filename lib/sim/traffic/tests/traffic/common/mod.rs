//! Small networks, plans and checks for the tests.
#![allow(dead_code, unused_imports, reason = "each test binary uses its part")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use frames::math::sin_cos;
use frames::{Object, Pose, World};
use opendrive::{
    Connection, ContactPoint, Controller, Cubic, Curve, Geometry, Junction, JunctionController, Lane,
    LaneLink, LaneSection, LaneType, LaneValidity, Map, MarkType, Network, Road, RoadLink, RoadMark, Signal,
    Speed, SpeedUnit,
};
use schema::tables::{ActorRow, PlanAgentRow, PlanHazardRow, PlanSceneRow, StateRow, Weather};
use schema::{ActorKind, ActorRole, AgentId, Attributes, HazardKind, SignalState};
use settings::stages::SimulationSettings;
use settings::{TrafficSettings, WalkerSettings};
use testkit::lane;
pub(crate) use testkit::straight;
use traffic::{SceneInput, SimulationLog, simulate};

pub(crate) fn settings() -> SimulationSettings {
    SimulationSettings {
        traffic: TrafficSettings {
            reckless_background: 0.0,
            distracted_background: 0.0,
            ..TrafficSettings::default()
        },
        walkers: WalkerSettings { in_groups: 0.0, waiting: 0.0, ..WalkerSettings::default() },
        ..SimulationSettings::default()
    }
}

pub(crate) fn scene(duration_s: f64) -> PlanSceneRow {
    PlanSceneRow {
        scene: 1,
        split: "train".into(),
        map: "test".into(),
        map_hash: String::new(),
        seed: 28,
        duration_s,
        frames: (duration_s * 20.0).round() as u32,
        warmup_s: 2.0,
        spawn_mode: "chained".into(),
        dynamic_weather: true,
        initial_weather: Weather::default(),
        final_weather: Weather { sun_altitude_deg: -20.0, ..Weather::default() },
        spawn_radius_m: 500.0,
        spawn_separation_m: 24.0,
        background_vehicles: Some(0),
        walkers: 0,
        walker_cross_factor: 0.5,
        ..PlanSceneRow::default()
    }
}

pub(crate) fn agent(index: usize, xyz_m: [f64; 3], yaw_rad: f64) -> PlanAgentRow {
    PlanAgentRow {
        scene: 1,
        agent: AgentId::vehicle(index as u16),
        model: "car.sedan".into(),
        color: vec![0, 0, 0],
        xyz_m,
        rpy_rad: [0.0, 0.0, yaw_rad],
        reckless: false,
        distracted: false,
        speed_difference: 0.0,
        standstill_gap_m: 4.0,
        signal: None,
    }
}

fn town_road(id: &str, x_m: f64, y_m: f64, hdg_rad: f64, length_m: f64, section: LaneSection) -> Road {
    testkit::town_street(id, [x_m, y_m], hdg_rad, length_m, section)
}

/// A road 300 m to the east of two lanes, of which the file says that the right one goes on as the left one
/// after 100 m.
pub(crate) fn ending_lane() -> Map {
    let mut ending = [lane(-1, LaneType::Driving, 3.5), lane(-2, LaneType::Driving, 3.5)];
    ending.iter_mut().for_each(|l| l.successors = vec![-1]);
    let mut left = lane(-1, LaneType::Driving, 3.5);
    left.predecessors = vec![-1];
    let first = LaneSection { right: ending.to_vec(), ..LaneSection::default() };
    let second = LaneSection { s: 100.0, right: vec![left], ..LaneSection::default() };
    let mut road = town_road("1", 0.0, 0.0, 0.0, 300.0, first);
    road.sections.push(second);
    Map::new(Network { roads: vec![road], ..Network::default() })
}

/// A road 800 m to the east of two lanes with a marking between them; the right one may end.
pub(crate) fn two_lanes(between: MarkType, right_ends_m: Option<f64>) -> Map {
    let mut left = lane(-1, LaneType::Driving, 3.5);
    left.marks = vec![RoadMark { mark_type: between, ..RoadMark::default() }];
    let right = lane(-2, LaneType::Driving, 3.5);
    let mut road = town_road("1", 0.0, 0.0, 0.0, 800.0, LaneSection::default());
    match right_ends_m {
        None => road.sections = vec![LaneSection { right: vec![left, right], ..LaneSection::default() }],
        Some(s) => {
            let mut on = left.clone();
            (left.successors, on.predecessors) = (vec![-1], vec![-1]);
            road.sections = vec![
                LaneSection { right: vec![left, right], ..LaneSection::default() },
                LaneSection { s, right: vec![on], ..LaneSection::default() },
            ];
        }
    }
    Map::new(Network { roads: vec![road], ..Network::default() })
}

/// Two lanes with broken marks between them, 150 m to the east; there the next road begins, at an angle, and
/// bends: as much as files have of both.
pub(crate) fn bent_seam() -> Map {
    let lanes = |on: &str| {
        let mut pair = [lane(-1, LaneType::Driving, 3.5), lane(-2, LaneType::Driving, 3.5)];
        pair[0].marks = vec![RoadMark { mark_type: MarkType::Broken, ..RoadMark::default() }];
        for l in &mut pair {
            (if on == "1" { &mut l.successors } else { &mut l.predecessors }).push(l.id);
        }
        LaneSection { right: pair.to_vec(), ..LaneSection::default() }
    };
    let mut first = town_road("1", 0.0, 0.0, 0.0, 150.0, lanes("1"));
    first.successor = Some(RoadLink::Road { id: "2".into(), contact: ContactPoint::Start });
    let mut second = town_road("2", 150.0, 0.0, 0.03, 250.0, lanes("2"));
    second.plan_view[0].curve = Curve::Arc { curvature: 1.0 / 60.0 };
    second.predecessor = Some(RoadLink::Road { id: "1".into(), contact: ContactPoint::End });
    Map::new(Network { roads: vec![first, second], ..Network::default() })
}

/// A road of one lane and a sidewalk: 20 m to the east, then 270 degrees to the left on a circle, the lane's
/// middle at a radius.
pub(crate) fn circle(radius_m: f64) -> Map {
    let right = vec![lane(-1, LaneType::Driving, 3.5), lane(-2, LaneType::Sidewalk, 3.0)];
    let section = LaneSection { right, ..LaneSection::default() };
    let arc_m = 1.5 * std::f64::consts::PI * (radius_m - 1.75);
    let mut road = town_road("1", 0.0, 0.0, 0.0, 20.0 + arc_m, section);
    road.plan_view[0].length_m = 20.0;
    road.plan_view.push(Geometry {
        s: 20.0,
        x_m: 20.0,
        length_m: arc_m,
        curve: Curve::Arc { curvature: 1.0 / (radius_m - 1.75) },
        ..Geometry::default()
    });
    Map::new(Network { roads: vec![road], ..Network::default() })
}

/// A road of one lane each way: 100 m to the east, a quarter turn to the right (the inner lane's middle at a
/// radius), 100 m to the south.
pub(crate) fn right_bend(radius_m: f64) -> Map {
    let lanes = |sign: i16| vec![lane(sign, LaneType::Driving, 3.5)];
    let section = LaneSection { left: lanes(1), right: lanes(-1), ..LaneSection::default() };
    let (radius_m, quarter) = (radius_m + 1.75, std::f64::consts::FRAC_PI_2);
    let arc_m = quarter * radius_m;
    let mut road = town_road("1", 0.0, 0.0, 0.0, 200.0 + arc_m, section);
    road.plan_view[0].length_m = 100.0;
    road.plan_view.push(Geometry {
        s: 100.0,
        x_m: 100.0,
        length_m: arc_m,
        curve: Curve::Arc { curvature: -1.0 / radius_m },
        ..Geometry::default()
    });
    road.plan_view.push(Geometry {
        s: 100.0 + arc_m,
        x_m: 100.0 + radius_m,
        y_m: -radius_m,
        hdg_rad: -quarter,
        length_m: 100.0,
        ..Geometry::default()
    });
    Map::new(Network { roads: vec![road], ..Network::default() })
}

/// A straight road of one lane, 200 m over a crest: its height is `20 - 0.002 (s - 100)^2`.
pub(crate) fn crest(heading_rad: f64) -> Map {
    let section = LaneSection { right: vec![lane(-1, LaneType::Driving, 3.5)], ..LaneSection::default() };
    let mut road = town_road("1", 0.0, 0.0, heading_rad, 200.0, section);
    road.elevation = vec![Cubic { s: 0.0, a: 0.0, b: 0.4, c: -0.002, d: 0.0 }];
    Map::new(Network { roads: vec![road], ..Network::default() })
}

/// Four arms of 200 m; straight ways through the middle. With signals: two controllers in turn.
pub(crate) fn crossing(signals: bool) -> Map {
    let arms = [0.0, 0.5, 1.0, 1.5].map(|half_turns| half_turns * std::f64::consts::PI);
    let mut network = Network::default();
    for (i, &angle) in arms.iter().enumerate() {
        let (sin, cos) = sin_cos(angle);
        let driving = |id: i16| vec![lane(id, LaneType::Driving, 3.5)];
        let section = LaneSection { left: driving(1), right: driving(-1), ..LaneSection::default() };
        let mut road = town_road(&i.to_string(), 10.0 * cos, 10.0 * sin, angle, 200.0, section);
        road.predecessor = Some(RoadLink::Junction { id: "j".into() });
        network.roads.push(road);
    }
    let mut junction = Junction { id: "j".into(), ..Junction::default() };
    for (i, &angle) in arms.iter().enumerate() {
        let (sin, cos) = sin_cos(angle);
        let mut through = lane(-1, LaneType::Driving, 3.5);
        (through.predecessors, through.successors) = (vec![1], vec![-1]);
        let section = LaneSection { right: vec![through], ..LaneSection::default() };
        let heading = angle + std::f64::consts::PI;
        let id = (10 + i).to_string();
        let mut road = town_road(&id, 10.0 * cos, 10.0 * sin, heading, 20.0, section);
        road.junction = Some("j".into());
        road.predecessor = Some(RoadLink::Road { id: i.to_string(), contact: ContactPoint::Start });
        road.successor = Some(RoadLink::Road { id: ((i + 2) % 4).to_string(), contact: ContactPoint::Start });
        if signals {
            road.signals.push(Signal {
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
        network.roads.push(road);
    }
    if signals {
        for (id, members) in [("a", ["s0", "s2"]), ("b", ["s1", "s3"])] {
            let signals = members.map(String::from).to_vec();
            network.controllers.push(Controller { id: id.into(), signals, ..Controller::default() });
            junction.controllers.push(JunctionController { id: id.into(), ..JunctionController::default() });
        }
    }
    network.junctions.push(junction);
    Map::new(network)
}

/// Half of the splitter islands between the lanes of a roundabout's arms, metres.
const SPLITTER_HALF_M: f64 = 1.5;
/// Half the angle of the ring that a roundabout's arm takes, radians.
const ARM_HALF_RAD: f64 = 0.6;

/// From the middle of a [`roundabout`] to where its arms begin, metres, and the radius on which their lanes
/// bend to the ring's.
///
/// A lane at y = e comes in towards -x and meets the tangent of the ring of radius r at angle a at
/// x = (r - e sin a) / cos a; from there it is u = (r sin a - e) / cos a along the tangent to the ring.
pub(crate) fn roundabout_entry_m(radius_m: f64) -> [f64; 2] {
    let (sin, cos) = sin_cos(ARM_HALF_RAD);
    let e = SPLITTER_HALF_M + 1.75;
    let leg = (radius_m * sin - e) / cos;
    let (half_sin, half_cos) = sin_cos(0.5 * (std::f64::consts::FRAC_PI_2 - ARM_HALF_RAD));
    [(radius_m - e * sin) / cos + leg, leg * half_cos / half_sin]
}

/// A ring of one lane, its middle at a radius, and four arms of one lane each way; vehicles that enter have a
/// yield sign. As real maps have it, each arm is a junction and the ring between two arms is a road.
pub(crate) fn roundabout(radius_m: f64, arms_m: f64) -> Map {
    use std::f64::consts::FRAC_PI_2;
    let [from_m, bend_m] = roundabout_entry_m(radius_m);
    // References run along the left edges of their lanes.
    let (ring_m, bend_m) = (radius_m - 1.75, bend_m + 1.75);
    let driving = |id: i16, from: i16, to: i16| {
        let (predecessors, successors) = (vec![from], vec![to]);
        Lane { predecessors, successors, ..lane(id, LaneType::Driving, 3.5) }
    };
    let one_way =
        |from: i16, to: i16| LaneSection { right: vec![driving(-1, from, to)], ..LaneSection::default() };
    let arc =
        |id: String, [x_m, y_m, hdg_rad]: [f64; 3], length_m: f64, curvature: f64, section: LaneSection| {
            let mut road = town_road(&id, x_m, y_m, hdg_rad, length_m, section);
            road.plan_view[0].curve = Curve::Arc { curvature };
            road.types[0].speed = Some(Speed { max: 30.0, unit: SpeedUnit::KilometresPerHour });
            road
        };
    let on_ring = |angle: f64| {
        let (sin, cos) = sin_cos(angle);
        [ring_m * cos, ring_m * sin, angle + FRAC_PI_2]
    };
    let at = |id: String, contact: ContactPoint| Some(RoadLink::Road { id, contact });
    let (start, end) = (ContactPoint::Start, ContactPoint::End);
    let mut network = Network::default();
    for i in 0..4 {
        let angle = i as f64 * FRAC_PI_2;
        let (sin, cos) = sin_cos(angle);
        let place = |x: f64, y: f64| [x * cos - y * sin, x * sin + y * cos];
        let (name, before) = (|kind: &str| format!("{kind}{i}"), (i + 3) % 4);
        let side = |sign: i16| {
            vec![lane(sign, LaneType::None, SPLITTER_HALF_M), lane(2 * sign, LaneType::Driving, 3.5)]
        };
        let section = LaneSection { left: side(1), right: side(-1), ..LaneSection::default() };
        let [x_m, y_m] = place(from_m, 0.0);
        let mut arm = town_road(&name("arm"), x_m, y_m, angle, arms_m, section);
        arm.predecessor = Some(RoadLink::Junction { id: name("j") });
        let gap = FRAC_PI_2 - 2.0 * ARM_HALF_RAD;
        let curvature = 1.0 / ring_m;
        let mut piece =
            arc(name("ring"), on_ring(angle + ARM_HALF_RAD), gap * ring_m, curvature, one_way(-1, -1));
        piece.predecessor = Some(RoadLink::Junction { id: name("j") });
        piece.successor = Some(RoadLink::Junction { id: format!("j{}", (i + 1) % 4) });
        let turn_m = (FRAC_PI_2 - ARM_HALF_RAD) * bend_m;
        let [x_m, y_m] = place(from_m, SPLITTER_HALF_M);
        let inwards = [x_m, y_m, angle + 2.0 * FRAC_PI_2];
        let mut enter = arc(name("enter"), inwards, turn_m, -1.0 / bend_m, one_way(2, -1));
        (enter.predecessor, enter.successor) = (at(name("arm"), start), at(name("ring"), start));
        let validity = vec![LaneValidity { from: -1, to: -1 }];
        let sign = Signal { id: name("yield"), kind: "205".into(), t: -5.0, validity, ..Signal::default() };
        enter.signals.push(sign);
        let mut leave =
            arc(name("leave"), on_ring(angle - ARM_HALF_RAD), turn_m, -1.0 / bend_m, one_way(-1, -2));
        (leave.predecessor, leave.successor) = (at(format!("ring{before}"), end), at(name("arm"), start));
        let through_m = 2.0 * ARM_HALF_RAD * ring_m;
        let mut through =
            arc(name("through"), on_ring(angle - ARM_HALF_RAD), through_m, curvature, one_way(-1, -1));
        (through.predecessor, through.successor) =
            (at(format!("ring{before}"), end), at(name("ring"), start));
        let mut junction = Junction { id: name("j"), ..Junction::default() };
        for (road, from) in [(&mut enter, 2), (&mut leave, -1), (&mut through, -1)] {
            road.junction = Some(name("j"));
            let incoming = if from == 2 { name("arm") } else { format!("ring{before}") };
            junction.connections.push(Connection {
                id: road.id.clone(),
                incoming_road: incoming,
                connecting_road: road.id.clone(),
                contact: start,
                lane_links: vec![LaneLink { from, to: -1, ..LaneLink::default() }],
                ..Connection::default()
            });
        }
        network.roads.extend([arm, piece, enter, leave, through]);
        network.junctions.push(junction);
    }
    Map::new(network)
}

/// Queues on all arms of a [`roundabout`], `count` vehicles each, so far from one another; drivers differ as
/// planned ones do.
pub(crate) fn queues_at_roundabout(
    radius_m: f64,
    count: usize,
    apart_m: f64,
    seed: u64,
) -> Vec<PlanAgentRow> {
    let from_m = roundabout_entry_m(radius_m)[0] + 8.0;
    let places = (0..4).flat_map(|arm| (0..count).map(move |k| (arm, from_m + apart_m * k as f64)));
    let row = |(i, (arm, x)): (usize, (i32, f64))| {
        let angle = f64::from(arm) * std::f64::consts::FRAC_PI_2;
        let (sin, cos) = sin_cos(angle);
        let y = SPLITTER_HALF_M + 1.75;
        let at = [x * cos - y * sin, x * sin + y * cos, 0.0];
        let row = agent(i, at, frames::wrap_pi(angle + std::f64::consts::PI));
        as_planned(row, seed, i)
    };
    places.enumerate().map(row).collect()
}

/// A driver as the plan draws them: 0.8 to 1.4 of the limit, gaps of about 4.2 m.
pub(crate) fn as_planned(agent: PlanAgentRow, seed: u64, index: usize) -> PlanAgentRow {
    let mut draw = random::Stream::new(seed, 0, "traffic-report/driver", index as u64);
    let speed_difference = draw.uniform(-0.4, 0.2);
    PlanAgentRow { speed_difference, standstill_gap_m: draw.normal(4.2, 1.0).max(0.0), ..agent }
}

/// A traffic light of the scenery for every dynamic signal, ids from 1.
pub(crate) fn lights(map: &Map) -> Vec<ActorRow> {
    let dynamic = map.signals().iter().filter(|s| s.dynamic);
    dynamic
        .enumerate()
        .map(|(i, signal)| ActorRow {
            id: i as u16 + 1,
            kind: ActorKind::TrafficLight,
            model: "light".into(),
            role: ActorRole::Scenery,
            semantic_tags: vec![7],
            length_m: 0.3,
            width_m: 0.3,
            height_m: 4.0,
            color: vec![0, 0, 0],
            fixed: true,
            xyz_m: signal.on_surface.into(),
            quaternion: signal.pose.wxyz(),
            variant: 0,
            parent: None,
            opendrive_id: Some(signal.id.clone()),
            attributes: Attributes::new(),
        })
        .collect()
}

pub(crate) fn run(
    map: &Map,
    scene: &PlanSceneRow,
    agents: &[PlanAgentRow],
    settings: &SimulationSettings,
) -> SimulationLog {
    run_with(map, scene, agents, &[], settings)
}

/// A scene with accidents and road works.
pub(crate) fn run_with(
    map: &Map,
    scene: &PlanSceneRow,
    agents: &[PlanAgentRow],
    hazards: &[PlanHazardRow],
    settings: &SimulationSettings,
) -> SimulationLog {
    run_beside(map, scene, agents, hazards, settings, lights(map))
}

/// A parked vehicle of a size.
pub(crate) fn parked(xyz_m: [f64; 3], yaw_rad: f64, [length_m, width_m, height_m]: [f64; 3]) -> ActorRow {
    ActorRow {
        id: 1,
        kind: ActorKind::Parked,
        model: "car.sedan".into(),
        role: ActorRole::Scenery,
        semantic_tags: vec![14],
        length_m,
        width_m,
        height_m,
        fixed: true,
        xyz_m,
        quaternion: Pose::<World, Object>::from_xyz_rpy([0.0; 3], [0.0, 0.0, yaw_rad]).wxyz(),
        ..ActorRow::default()
    }
}

/// A scene with the objects beside the road.
pub(crate) fn run_beside(
    map: &Map,
    scene: &PlanSceneRow,
    agents: &[PlanAgentRow],
    hazards: &[PlanHazardRow],
    settings: &SimulationSettings,
    mut fixed: Vec<ActorRow>,
) -> SimulationLog {
    for (id, actor) in (1..).zip(&mut fixed) {
        actor.id = id;
    }
    let first_id = fixed.len() as u16 + 1;
    let input = SceneInput {
        catalogue: catalogue::Catalogue::built_in(),
        map,
        scene,
        agents,
        hazards,
        weather: &[],
        routes: &[],
        trajectories: &[],
        settings,
        fixed: &fixed,
        first_id,
    };
    simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log")
}

/// A hazard on a lane of a road, between two places of it.
pub(crate) fn hazard(kind: HazardKind, road: &str, lane: i32, [back_m, front_m]: [f64; 2]) -> PlanHazardRow {
    PlanHazardRow {
        scene: 1,
        kind,
        back_road: road.into(),
        back_lane: lane,
        back_s_m: back_m,
        front_road: road.into(),
        front_lane: lane,
        front_s_m: front_m,
        ..PlanHazardRow::default()
    }
}

/// Agents on spawn points of a map: every `stride`-th driving lane outside junctions that is long enough.
pub(crate) fn agents_on(map: &Map, count: usize, stride: usize) -> Vec<PlanAgentRow> {
    let lanes = map
        .lanes()
        .iter()
        .filter(|l| l.lane_type.is_drivable() && l.junction.is_none() && l.s_length() > 30.0);
    let rows = lanes.step_by(stride).take(count).enumerate().map(|(i, l)| {
        let at = map.lane_point(l.id, 0.5 * (l.s_start + l.s_end), 0.0).expect("a lane");
        agent(i, at.position.into(), at.heading_rad)
    });
    rows.collect()
}

/// States of each object, in frame order.
pub(crate) fn tracks(log: &SimulationLog) -> BTreeMap<u16, Vec<&StateRow>> {
    let mut tracks: BTreeMap<u16, Vec<&StateRow>> = BTreeMap::new();
    for state in &log.states {
        tracks.entry(state.id).or_default().push(state);
    }
    tracks
}

pub(crate) fn yaw(q: [f64; 4]) -> f64 {
    let [w, x, y, z] = q;
    frames::math::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// Whether two footprints overlap (separating axes in the plane), decks apart.
pub(crate) fn touch(a: &StateRow, a_size: [f64; 2], b: &StateRow, b_size: [f64; 2]) -> bool {
    if (a.xyz_m[2] - b.xyz_m[2]).abs() > 3.0 {
        return false;
    }
    let (ya, yb) = (yaw(a.quaternion), yaw(b.quaternion));
    let away = [b.xyz_m[0] - a.xyz_m[0], b.xyz_m[1] - a.xyz_m[1]];
    [ya, ya + std::f64::consts::FRAC_PI_2, yb, yb + std::f64::consts::FRAC_PI_2].iter().all(|&axis| {
        let reach = |yaw: f64, size: [f64; 2]| {
            let (sin, cos) = sin_cos(yaw - axis);
            0.5 * (size[0] * cos.abs() + size[1] * sin.abs())
        };
        let (sin, cos) = sin_cos(axis);
        (away[0] * cos + away[1] * sin).abs() < reach(ya, a_size) + reach(yb, b_size)
    })
}

/// Pairs of a kind of actors that overlap in any frame; what is towed lies over its own lead.
pub(crate) fn collisions(log: &SimulationLog, with_walkers: bool) -> Vec<(i32, u16, u16)> {
    let size: BTreeMap<u16, ([f64; 2], bool)> =
        log.actors.iter().map(|a| (a.id, ([a.length_m, a.width_m], a.kind == ActorKind::Walker))).collect();
    let parents: BTreeMap<u16, i32> = log.actors.iter().filter_map(|a| Some((a.id, a.parent?))).collect();
    let coupled = |lead: u16, towed: u16| parents.get(&towed) == Some(&i32::from(lead));
    let mut found = Vec::new();
    for frame in log.states.chunk_by(|a, b| a.frame == b.frame) {
        for (i, a) in frame.iter().enumerate() {
            for b in &frame[i + 1..] {
                let (sa, sb) = (size[&a.id], size[&b.id]);
                let wanted = if with_walkers { !sa.1 && sb.1 } else { !sa.1 && !sb.1 };
                let near = (a.xyz_m[0] - b.xyz_m[0]).abs() < 14.0 && (a.xyz_m[1] - b.xyz_m[1]).abs() < 14.0;
                let apart = coupled(a.id, b.id) || coupled(b.id, a.id);
                if wanted && near && !apart && touch(a, sa.0, b, sb.0) {
                    found.push((a.frame, a.id, b.id));
                }
            }
        }
    }
    found
}

/// Vehicles whose front passed a stop line while the light behind it was red: (frame, id).
pub(crate) fn red_runs(map: &Map, log: &SimulationLog, lights: &[ActorRow]) -> Vec<(i32, u16)> {
    let mut runs = Vec::new();
    let tracks = tracks(log);
    for (index, signal) in map.signals().iter().enumerate().filter(|(_, s)| s.dynamic) {
        let Some(light) = lights.iter().find(|l| l.opendrive_id.as_ref() == Some(&signal.id)) else {
            continue;
        };
        let states: Vec<SignalState> =
            log.signals.iter().filter(|r| r.id == light.id).map(|r| r.state).collect();
        for stop in map.stop_points(index) {
            let Some(line) = map.point_at(stop) else { continue };
            let (sin, cos) = frames::math::sin_cos(line.heading_rad);
            for actor in log.actors.iter().filter(|a| a.kind == ActorKind::Vehicle) {
                let past = |i: usize| {
                    let s = tracks[&actor.id][i];
                    let (dx, dy) = (s.xyz_m[0] - line.position.x, s.xyz_m[1] - line.position.y);
                    let (ahead, aside) = (dx * cos + dy * sin, dy * cos - dx * sin);
                    let along = frames::wrap_pi(yaw(s.quaternion) - line.heading_rad).abs() < 0.5;
                    (
                        ahead + 0.5 * actor.length_m,
                        aside.abs() < 1.0 && along && (s.xyz_m[2] - line.position.z).abs() < 2.0,
                    )
                };
                for (i, state) in states.iter().enumerate().skip(1) {
                    let ((before, on), (after, _)) = (past(i - 1), past(i));
                    // All ways from this line that the light controls: a red one among several is enough to
                    // stop.
                    if on && before <= 0.0 && after > 0.0 && *state == SignalState::Red {
                        runs.push((i as i32 - 1, actor.id));
                    }
                }
            }
        }
    }
    runs
}
