//! Signals: every lane of a signalised junction has one, and no phase lets traffic cross.

use frames::wrap_pi;
use nalgebra::Point3;
use opendrive::{LaneId, LaneType, Map};
use std::collections::{BTreeMap, BTreeSet};

use super::{end_of, label};

pub(super) fn faults(map: &Map) -> Vec<String> {
    let mut faults = Vec::new();
    for signal in map.signals() {
        if signal.lanes.is_empty() && signal.kind != "274" {
            faults.push(format!("signal {} controls nothing", signal.id));
        }
        for lane in &signal.lanes {
            // The controlled traffic drives past the post and sees its face.
            let Some(info) = map.lane(*lane) else { continue };
            let Some(entry) = map.lane_point(*lane, end_of(info, false), 0.0) else { continue };
            let forward = signal.pose.forward();
            let turn = wrap_pi(frames::math::atan2(forward.y, forward.x) - entry.heading_rad).abs();
            let away = (entry.position - signal.on_surface).norm();
            // Posts stand a little before the end of their street, which may bend there.
            if info.junction.is_some() && (turn > 0.02 || away > 25.0) {
                let name = label(map, *lane);
                faults.push(format!("signal {} is {away:.1} m and {turn:.3} rad off {name}", signal.id));
            }
        }
    }
    for junction in 0..map.junctions().len() {
        one(map, junction, &mut faults);
    }
    faults
}

fn one(map: &Map, junction: usize, faults: &mut Vec<String>) {
    let inside: Vec<LaneId> = map
        .lanes()
        .iter()
        .filter(|l| l.junction == Some(junction) && l.lane_type == LaneType::Driving)
        .map(|l| l.id)
        .collect();
    let lights = |lane: &LaneId| -> Vec<usize> {
        map.signals_of_lane(*lane).iter().copied().filter(|s| map.signals()[*s].dynamic).collect()
    };
    if inside.iter().all(|lane| lights(lane).is_empty()) {
        return;
    }
    for lane in inside.iter().filter(|lane| lights(lane).len() != 1) {
        faults.push(format!("{} signals for {}", lights(lane).len(), label(map, *lane)));
    }
    let mut turns: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut green: Vec<BTreeSet<LaneId>> = Vec::new();
    for group in map.signal_groups().iter().filter(|g| g.junction == junction) {
        for controller in &group.controllers {
            let phase = green.len();
            green.push(BTreeSet::new());
            for signal in &controller.signals {
                turns.entry(*signal).or_default().push(phase);
                green[phase].extend(map.signals()[*signal].lanes.iter().copied());
            }
        }
    }
    for lane in &inside {
        for signal in lights(lane) {
            if turns.get(&signal).map_or(0, Vec::len) != 1 {
                faults.push(format!("signal {} of {} is not in one controller", signal, label(map, *lane)));
            }
        }
    }
    for phase in &green {
        let ways: Vec<Way> = phase.iter().filter_map(|lane| Way::new(map, *lane)).collect();
        for (i, a) in ways.iter().enumerate() {
            for b in &ways[i + 1..] {
                if a.crosses(b) && !a.yields_to(b) && !b.yields_to(a) {
                    faults.push(format!("green together: {} and {}", label(map, a.lane), label(map, b.lane)));
                }
            }
        }
    }
}

/// A lane through a junction.
struct Way {
    lane: LaneId,
    points: Vec<Point3<f64>>,
    heading_rad: f64,
    turn_rad: f64,
}

impl Way {
    fn new(map: &Map, lane: LaneId) -> Option<Self> {
        let info = map.lane(lane)?;
        let at = |i: u32| {
            let s = info.s_of_along(info.s_length() * f64::from(i) / 60.0);
            map.lane_point(lane, s, 0.0)
        };
        let poses: Vec<_> = (0..=60).map(at).collect::<Option<_>>()?;
        let turn = poses.windows(2).map(|p| wrap_pi(p[1].heading_rad - p[0].heading_rad)).sum();
        let points = poses.iter().map(|p| p.position).collect();
        Some(Self { lane, points, heading_rad: poses[0].heading_rad, turn_rad: turn })
    }

    /// Whether two ways cut one another: those that begin or end together do not.
    fn crosses(&self, other: &Self) -> bool {
        let near = |a: Option<&Point3<f64>>, b: Option<&Point3<f64>>| match (a, b) {
            (Some(a), Some(b)) => (a - b).norm() < 1.0,
            _ => false,
        };
        if near(self.points.first(), other.points.first()) || near(self.points.last(), other.points.last()) {
            return false;
        }
        self.points.windows(2).any(|a| other.points.windows(2).any(|b| cut(a, b)))
    }

    /// A turn to the left waits for oncoming traffic.
    fn yields_to(&self, other: &Self) -> bool {
        let oncoming = wrap_pi(self.heading_rad - other.heading_rad).abs() > 2.3;
        oncoming && self.turn_rad > 0.5 && other.turn_rad < 0.5
    }
}

fn cut(a: &[Point3<f64>], b: &[Point3<f64>]) -> bool {
    let side = |p: &Point3<f64>, q: &Point3<f64>, r: &Point3<f64>| {
        (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)
    };
    let split =
        |p: &[Point3<f64>], q: &[Point3<f64>]| side(&p[0], &p[1], &q[0]) * side(&p[0], &p[1], &q[1]) < 0.0;
    split(a, b) && split(b, a)
}
