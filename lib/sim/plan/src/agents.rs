//! Where data-collection vehicles and road-side units are.

use std::f64::consts::PI;

use catalogue::{Catalogue, Model, RSU_MODEL};
use frames::OrientedRect;
use frames::math::{atan2, sin};
use nalgebra::Point3;
use opendrive::Map;
use random::Stream;
use schema::AgentId;
use schema::tables::PlanAgentRow;
use settings::stages::PlanSettings;
use settings::{AgentSettings, GivenRsu, SpawnMode, TrafficSettings};

use crate::PlanError;
use crate::pool::{SpawnPoint, SpawnPool, TakenGround};

/// Colour of an RSU's body (sRGB).
const RSU_COLOR: [u8; 3] = [190, 190, 190];
/// How far an RSU stands from the foot of its signal's pole, towards the junction, metres. The published
/// value is 0.2 m; the housing of a roadside light reaches further, and the lidar at 3.2 m would sit inside
/// it.
const RSU_STEP_M: f64 = 0.6;
/// Files give a pole two signals: RSUs nearer to each other than this would stand in one another, metres.
const RSU_APART_M: f64 = 0.5;
/// Free space between the footprints of two vehicles at the start, metres.
const CLEARANCE_M: f64 = 0.5;
/// Vehicles farther above each other than this are on different decks, metres.
const DECK_M: f64 = 3.0;
/// How far a vehicle is moved along its lane to get clear of another, metres; tried in this order.
const NUDGES_M: [f64; 4] = [2.0, 4.0, 6.0, 8.0];

/// The vehicles of a scene and what RSUs are chosen by.
pub(crate) struct Placement {
    /// Clustered or chained.
    pub(crate) mode: SpawnMode,
    /// Start of each vehicle, in order.
    pub(crate) starts: Vec<SpawnPoint>,
    /// RSUs stand within `reach_m` of one of these.
    pub(crate) pivots: Vec<Point3<f64>>,
    /// See `pivots`, metres.
    pub(crate) reach_m: f64,
    /// Why there are fewer than wished for.
    pub(crate) warnings: Vec<String>,
}

/// Radius of a cluster of `count` vehicles that could stand `spacing_m` apart on its circle, metres. One
/// vehicle gets the spacing itself (the formula would give infinity).
pub(crate) fn cluster_radius_m(spacing_m: f64, count: usize) -> f64 {
    if count < 2 { spacing_m } else { spacing_m / sin(PI / count as f64) }
}

/// Chooses `count` starts, clustered or chained, none overlapping another: those that are given, then others
/// from the pool.
pub(crate) fn place_vehicles(
    map: &Map,
    pool: &SpawnPool,
    settings: &AgentSettings,
    models: &[&Model],
    mode: SpawnMode,
    (count, given, kept): (usize, Vec<SpawnPoint>, &[TakenGround]),
    stream: &mut Stream,
) -> Placement {
    let count = count.max(given.len());
    let wanted = count.min(given.len() + pool.points.len());
    let pivots =
        if mode == SpawnMode::Chained { given.iter().map(|start| start.xyz_m).collect() } else { Vec::new() };
    let given_centre = given.first().copied();
    let mut placement = Placement { mode, starts: given, pivots, reach_m: 0.0, warnings: Vec::new() };
    let points = &pool.points;
    let mut dropped = 0;
    if mode == SpawnMode::Chained {
        placement.reach_m = settings.chained_spawn_distance_m;
        let mut open: Vec<usize> = (0..points.len()).collect();
        while placement.starts.len() < wanted {
            // The first point is free, each other one near a point that is taken.
            let links = &placement.pivots;
            let eligible: Vec<usize> = (0..open.len())
                .filter(|&i| {
                    links.is_empty()
                        || links.iter().any(|l| (l - points[open[i]].xyz_m).norm() <= placement.reach_m)
                })
                .collect();
            let Some(&pick) = stream.choose(&eligible) else { break };
            let candidate = points[open.swap_remove(pick)];
            open.sort_unstable();
            match clear_start(map, candidate, (&placement.starts, kept), models) {
                Some(start) => {
                    placement.starts.push(start);
                    placement.pivots.push(candidate.xyz_m);
                }
                None => dropped += 1,
            }
        }
    } else if let Some(centre) = given_centre.as_ref().or_else(|| stream.choose(points)) {
        let spacing = settings.clustered_spawn_distance_m;
        let radius = cluster_radius_m(spacing, wanted);
        let near: Vec<usize> =
            (0..points.len()).filter(|&i| (points[i].xyz_m - centre.xyz_m).norm() <= radius).collect();
        for i in stream.sample_indices(near.len(), near.len()) {
            if placement.starts.len() == wanted {
                break;
            }
            match clear_start(map, points[near[i]], (&placement.starts, kept), models) {
                Some(start) => placement.starts.push(start),
                None => dropped += 1,
            }
        }
        placement.pivots.push(centre.xyz_m);
        placement.reach_m = cluster_radius_m(spacing, placement.starts.len());
    }
    if placement.starts.len() < count {
        placement.warnings.push(format!(
            "{} of {count} vehicles: the pool has {} points, and no more of them are near enough to the others ({dropped} would overlap)",
            placement.starts.len(),
            points.len()
        ));
    }
    placement
}

/// The candidate, or a place a little along its lane, where the next vehicle touches none of those before it.
fn clear_start(
    map: &Map,
    candidate: SpawnPoint,
    (placed, kept): (&[SpawnPoint], &[TakenGround]),
    models: &[&Model],
) -> Option<SpawnPoint> {
    let size = |i: usize| models[i % models.len()].size_m;
    let own = size(placed.len());
    let clear = |start: &SpawnPoint| {
        placed.iter().enumerate().all(|(i, other)| !overlap(start, own, other, size(i)))
            && kept.iter().all(|(other, size_m)| !overlap(start, own, other, *size_m))
    };
    if clear(&candidate) {
        return Some(candidate);
    }
    let usable = |pos| {
        let onward = map.ahead(pos, own[0]);
        let free = |p: &opendrive::LanePos| map.junction_of(p.lane).is_none();
        (free(&pos) && !onward.is_empty() && onward.iter().all(free))
            .then(|| SpawnPoint::at(map, pos))
            .flatten()
    };
    let moves = NUDGES_M.iter().filter_map(|&d| map.ahead(candidate.pos, d).first().copied());
    moves.filter_map(usable).find(clear)
}

/// Whether two vehicles' footprints come nearer than the clearance: the bounding rectangle of `b` in the
/// frame of `a` against `a` (so a little too careful for vehicles askew).
fn overlap(a: &SpawnPoint, a_size: [f64; 3], b: &SpawnPoint, b_size: [f64; 3]) -> bool {
    let away = b.xyz_m - a.xyz_m;
    if away.z.abs() > DECK_M {
        return false;
    }
    let rect = |start: &SpawnPoint, size: [f64; 3]| {
        OrientedRect::new([start.xyz_m.x, start.xyz_m.y], start.rpy_rad[2], [0.5 * size[0], 0.5 * size[1]])
    };
    let (a, b) = (rect(a, a_size), rect(b, b_size));
    [a.axis, [-a.axis[1], a.axis[0]]]
        .iter()
        .zip(a.half_m)
        .all(|(n, own)| (away.x * n[0] + away.y * n[1]).abs() < own + b.reach_m(*n) + CLEARANCE_M)
}

/// The catalogue entries of the configured vehicle models.
pub(crate) fn vehicle_models(
    settings: &AgentSettings,
    catalogue: &Catalogue,
) -> Result<Vec<&'static Model>, PlanError> {
    let bad = |setting, problem: &str| PlanError::BadSetting { setting, problem: problem.into() };
    if settings.vehicle_models.is_empty() {
        return Err(bad("agents.vehicle_models", "is empty"));
    }
    if settings.vehicle_colors.is_empty() {
        return Err(bad("agents.vehicle_colors", "is empty"));
    }
    let known = |name: &String| {
        catalogue
            .find(name)
            .filter(|m| m.wheelbase_m > 0.0)
            .ok_or_else(|| PlanError::UnknownModel { model: name.clone() })
    };
    settings.vehicle_models.iter().map(known).collect()
}

/// A driver's character: reckless, distracted, speed difference, standstill gap.
fn draw_driver(traffic: &TrafficSettings, stream: &mut Stream) -> (bool, bool, f64, f64) {
    let reckless = stream.chance(traffic.reckless_agent);
    let distracted = stream.chance(traffic.distracted_agent) && !reckless;
    let speed_difference = stream.uniform(-0.4, 0.2);
    let standstill_gap_m = stream.normal(4.2, 1.0).max(0.0);
    let speed_difference = traffic.speed_difference.unwrap_or(speed_difference);
    (reckless, distracted, speed_difference, traffic.standstill_gap_m.unwrap_or(standstill_gap_m))
}

/// Rows of the vehicles that were placed, each with a driver of its own (`stream` by the vehicle's number).
pub(crate) fn vehicle_rows(
    settings: &PlanSettings,
    scene: u32,
    models: &[&Model],
    placement: &Placement,
    stream: impl Fn(u64) -> Stream,
) -> Vec<PlanAgentRow> {
    let row = |(i, start): (usize, &SpawnPoint)| {
        let (reckless, distracted, speed_difference, standstill_gap_m) =
            draw_driver(&settings.traffic, &mut stream(i as u64));
        PlanAgentRow {
            scene,
            agent: AgentId::vehicle(i as u16),
            model: models[i % models.len()].name.into(),
            color: settings.agents.vehicle_colors[i % settings.agents.vehicle_colors.len()].to_vec(),
            xyz_m: start.xyz_m.coords.into(),
            rpy_rad: start.rpy_rad,
            reckless,
            distracted,
            speed_difference,
            standstill_gap_m,
            signal: None,
        }
    };
    placement.starts.iter().enumerate().map(row).collect()
}

/// A pole that an RSU may stand at.
struct Pole {
    xyz_m: Point3<f64>,
    yaw_rad: f64,
    /// None where the user says that one stands there.
    signal: Option<String>,
}

/// Whether RSUs find a place at some junction.
pub(crate) fn has_lights(map: &Map) -> bool {
    let signals = map.junctions().iter().flat_map(|junction| &junction.signals);
    signals.filter_map(|&i| map.signals().get(i)).any(|signal| signal.dynamic)
}

/// RSUs where the user says, then at the traffic lights of signalised junctions near the vehicles; warns when
/// there are fewer than wished for.
pub(crate) fn place_rsus(
    map: &Map,
    given: &[&GivenRsu],
    placement: &mut Placement,
    scene: u32,
    count: usize,
    stream: &mut Stream,
) -> Vec<PlanAgentRow> {
    let mut poles = Vec::new();
    for junction in map.junctions() {
        let near = placement.pivots.iter().any(|p| (p - junction.centre).norm() < placement.reach_m);
        if !near {
            continue;
        }
        for signal in junction.signals.iter().filter_map(|&i| map.signals().get(i)).filter(|s| s.dynamic) {
            let (foot, to) = (signal.on_surface, junction.centre - signal.on_surface);
            let distance = (to.x * to.x + to.y * to.y).sqrt();
            let step = if distance > 0.0 { RSU_STEP_M / distance } else { 0.0 };
            poles.push(Pole {
                xyz_m: Point3::new(foot.x + step * to.x, foot.y + step * to.y, foot.z),
                yaw_rad: atan2(to.y, to.x),
                signal: Some(signal.id.clone()),
            });
        }
    }
    let own = |rsu: &&GivenRsu| Pole { xyz_m: rsu.xyz_m.into(), yaw_rad: rsu.yaw_rad, signal: None };
    let own: Vec<Pole> = given.iter().take(count).map(own).collect();
    let mut chosen: Vec<&Pole> = own.iter().collect();
    for pole in stream.sample_indices(poles.len(), poles.len()).into_iter().map(|i| &poles[i]) {
        let apart = |other: &&Pole| (other.xyz_m - pole.xyz_m).norm() >= RSU_APART_M;
        if chosen.len() < count && chosen.iter().all(apart) {
            chosen.push(pole);
        }
    }
    // Of a map without lights that is said once, not for each scene.
    if chosen.len() < count && (has_lights(map) || !given.is_empty()) {
        placement.warnings.push(format!(
            "{} of {count} RSUs: junctions within {:.0} m of the vehicles' start have no more traffic lights; widen agents.{}_spawn_distance_m or change the seed",
            chosen.len(),
            placement.reach_m,
            placement.mode.name()
        ));
    }
    let row = |(index, pole): (usize, &Pole)| PlanAgentRow {
        scene,
        agent: AgentId::rsu(index as u16),
        model: RSU_MODEL.into(),
        color: RSU_COLOR.to_vec(),
        xyz_m: pole.xyz_m.coords.into(),
        rpy_rad: [0.0, 0.0, pole.yaw_rad],
        reckless: false,
        distracted: false,
        speed_difference: 0.0,
        standstill_gap_m: 0.0,
        signal: pole.signal.clone(),
    };
    chosen.into_iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use frames::math::sin_cos;

    use super::*;

    #[test]
    fn cluster_radii_are_the_published_ones() {
        for (n, r) in [(2, 48.0), (3, 55.4), (4, 67.9), (5, 81.7), (6, 96.0), (7, 110.6), (8, 125.4)] {
            assert!((cluster_radius_m(48.0, n) - r).abs() < 0.05, "{n}");
        }
        assert_eq!(cluster_radius_m(48.0, 1), 48.0);
    }

    #[test]
    fn footprints_side_by_side_and_end_to_end() {
        let at = |x: f64, y: f64, z: f64, yaw: f64| SpawnPoint {
            pos: opendrive::LanePos::default(),
            xyz_m: Point3::new(x, y, z),
            rpy_rad: [0.0, 0.0, yaw],
        };
        let size = [4.0, 2.0, 1.5];
        let here = at(10.0, 5.0, 0.0, 0.7);
        let (sin, cos) = sin_cos(0.7);
        let off = |along: f64, across: f64, yaw: f64| {
            at(10.0 + along * cos - across * sin, 5.0 + along * sin + across * cos, 0.0, yaw)
        };
        assert!(overlap(&here, size, &off(4.4, 0.0, 0.7), size));
        assert!(!overlap(&here, size, &off(4.6, 0.0, 0.7), size));
        assert!(overlap(&here, size, &off(0.0, 2.4, 0.7 + PI), size));
        assert!(!overlap(&here, size, &off(0.0, 2.6, 0.7 + PI), size));
        // Across: half a length and half a width.
        assert!(overlap(&here, size, &off(0.0, 3.4, 0.7 + 0.5 * PI), size));
        assert!(!overlap(&here, size, &off(0.0, 3.6, 0.7 + 0.5 * PI), size));
        assert!(!overlap(&here, size, &at(10.0, 5.0, 6.0, 0.7), size));
    }

    #[test]
    fn drivers_have_the_published_characters() {
        let traffic = TrafficSettings::default();
        let n = 40_000;
        let drivers: Vec<_> =
            (0..n).map(|i| draw_driver(&traffic, &mut Stream::new(27, i, "plan/driver", 0))).collect();
        let share = |holds: fn(&(bool, bool, f64, f64)) -> bool| {
            drivers.iter().filter(|d| holds(d)).count() as f64 / n as f64
        };
        assert!((share(|d| d.0) - 0.01).abs() < 0.002);
        assert!((share(|d| d.1) - 0.0198).abs() < 0.003);
        assert!(drivers.iter().all(|d| !(d.0 && d.1) && (-0.4..0.2).contains(&d.2) && d.3 >= 0.0));
        let mean =
            |value: fn(&(bool, bool, f64, f64)) -> f64| drivers.iter().map(value).sum::<f64>() / n as f64;
        assert!((mean(|d| d.2) + 0.1).abs() < 0.004 && (mean(|d| d.3) - 4.2).abs() < 0.02);
    }
}
