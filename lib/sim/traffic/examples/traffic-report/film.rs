//! A scene's log as tracks: what an onlooker with a watch and a tape measure sees.

use std::collections::BTreeMap;

use catalogue::{Special, models, trains};
use frames::math::sin_cos;
use nalgebra::Point3;
use opendrive::{LaneHit, LanePos, Map};
use schema::{ActorKind, ActorRole, Attribute};
use traffic::SimulationLog;

use crate::common::yaw;

/// Time between two states, seconds.
pub(crate) const DT: f64 = schema::FRAME_PERIOD_S;
/// Steps between two of the sampled states (0.5 s).
pub(crate) const SAMPLE: usize = 10;
/// Lanes whose direction differs by more than this are not the vehicle's own, radians.
const ASKEW_RAD: f64 = 0.7;
/// Ends of lanes farther from each other than this do not meet, metres.
const APART_M: f64 = 0.1;
/// Ways ahead are followed this far beyond the end of a track, metres: over a junction and what may block the
/// way out of it. From the second length on, points are coarser.
const BEYOND_M: f64 = 100.0;
const FINE_M: f64 = 24.0;
const COARSE_M: f64 = 2.0;
/// The default of `traffic.active_distance_m`.
const ACTIVE_M: f64 = 1600.0;
/// Distance between the points of a way ahead, metres.
pub(crate) const POINT_M: f64 = 0.5;

/// A body at a moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snap {
    pub(crate) at: Point3<f64>,
    pub(crate) yaw_rad: f64,
    /// Of its middle; negative backwards.
    pub(crate) speed_mps: f64,
    /// Lamps that burn, as in the log.
    pub(crate) lamps: u32,
}

impl Snap {
    /// Metres ahead of and to the left of this body's middle.
    pub(crate) fn local(&self, point: &Point3<f64>) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.yaw_rad);
        let (dx, dy) = (point.x - self.at.x, point.y - self.at.y);
        [dx * cos + dy * sin, dy * cos - dx * sin]
    }

    /// Whether a point is over a body of a size, widened by a margin.
    pub(crate) fn covers(&self, size_m: [f64; 2], point: &Point3<f64>, margin_m: f64) -> bool {
        let [ahead, left] = self.local(point);
        ahead.abs() < 0.5 * size_m[0] + margin_m
            && left.abs() < 0.5 * size_m[1] + margin_m
            && (self.at.z - point.z).abs() < 3.0
    }
}

/// Something or somebody that stands in a hazard.
#[derive(Debug)]
pub(crate) struct Obstacle {
    pub(crate) id: u16,
    pub(crate) size_m: [f64; 2],
    pub(crate) snap: Snap,
}

/// A vehicle or a walker over the whole scene.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) id: u16,
    pub(crate) size_m: [f64; 2],
    pub(crate) wheelbase_m: f64,
    pub(crate) two_wheeled: bool,
    /// Neither reckless nor distracted.
    pub(crate) ordinary: bool,
    /// The one that tows it, if one does: nobody drives it.
    pub(crate) towed_by: Option<u16>,
    /// On a bench.
    pub(crate) sits: bool,
    /// A wheelchair or a pram.
    pub(crate) rolls: bool,
    /// Collects data: those far from all of these sleep.
    pub(crate) is_agent: bool,
    /// First state at which it touches another vehicle or a walker, if it ever does.
    pub(crate) touched: Option<usize>,
    pub(crate) track: Vec<Snap>,
    /// Points of its way, [`POINT_M`] apart, beyond the end of the track too (all branches).
    way: Vec<(f64, Point3<f64>)>,
    /// Way gone at each state, metres.
    gone_m: Vec<f64>,
}

impl Body {
    /// Points on the way that its front is still going to pass, with their distance from the front.
    pub(crate) fn ahead(&self, i: usize, reach_m: f64) -> impl Iterator<Item = (f64, &Point3<f64>)> {
        let front = self.gone_m[i] + 0.5 * self.size_m[0];
        let first = self.way.partition_point(|(along, _)| *along <= front);
        self.way[first..]
            .iter()
            .map(move |(along, p)| (along - front, p))
            .take_while(move |(to, _)| *to < reach_m)
    }

    /// Whether a point is over its footprint, widened by a margin.
    pub(crate) fn covers(&self, i: usize, point: &Point3<f64>, margin_m: f64) -> bool {
        self.track[i].covers(self.size_m, point, margin_m)
    }

    /// Whether it is coupled with another one.
    pub(crate) fn is_coupled(&self, other: &Self) -> bool {
        self.towed_by == Some(other.id) || other.towed_by == Some(self.id)
    }

    /// Whether it has touched something before.
    pub(crate) fn is_wrecked(&self, i: usize) -> bool {
        self.touched.is_some_and(|t| t <= i)
    }
}

/// A traffic light or sign with the places where it holds traffic.
#[derive(Debug)]
pub(crate) struct Hold {
    pub(crate) lines: Vec<(LanePos, Snap)>,
    /// State of the light at each moment (its first letter); none for a sign.
    pub(crate) light: Option<Vec<u8>>,
}

impl Hold {
    /// Whether a driver who stands before it does so rightly.
    pub(crate) fn stops(&self, i: usize) -> bool {
        self.light.as_ref().is_none_or(|states| matches!(states[i], b'R' | b'Y'))
    }
}

/// A scene, watched.
#[derive(Debug)]
pub(crate) struct Film<'a> {
    pub(crate) map: &'a Map,
    pub(crate) vehicles: Vec<Body>,
    pub(crate) walkers: Vec<Body>,
    /// The objects on the road in accidents and road works.
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) holds: Vec<Hold>,
    /// Ends of lanes that the map links to beginnings which lie elsewhere, with how far apart, metres.
    pub(crate) leaps: Vec<(Point3<f64>, f64)>,
    /// States of each track.
    pub(crate) states: usize,
}

impl<'a> Film<'a> {
    pub(crate) fn new(map: &'a Map, log: &SimulationLog) -> Self {
        let mut tracks: BTreeMap<u16, Vec<Snap>> = BTreeMap::new();
        for state in &log.states {
            let yaw_rad = yaw(state.quaternion);
            let (sin, cos) = sin_cos(yaw_rad);
            let [vx, vy, _] = state.velocity_mps.map(f64::from);
            let speed_mps = (vx * vx + vy * vy).sqrt().copysign(vx * cos + vy * sin);
            let snap = Snap { at: state.xyz_m.into(), yaw_rad, speed_mps, lamps: state.lights };
            tracks.entry(state.id).or_default().push(snap);
        }
        let bodies = |kind: ActorKind| -> Vec<Body> {
            let actors = log.actors.iter().filter(|a| a.kind == kind && a.role != ActorRole::Hazard);
            actors
                .filter_map(|actor| {
                    let model = models::find(&actor.model).or_else(|| trains::find(&actor.model))?;
                    let track = tracks.get(&actor.id)?.clone();
                    let (way, gone_m) =
                        if kind == ActorKind::Vehicle { way(map, &track) } else { Default::default() };
                    let unruly = [Attribute::Reckless, Attribute::Distracted]
                        .iter()
                        .any(|a| actor.attributes.is_true(a));
                    Some(Body {
                        id: actor.id,
                        size_m: [actor.length_m, actor.width_m],
                        wheelbase_m: model.wheelbase_m,
                        two_wheeled: actor.width_m < 1.2,
                        towed_by: actor.parent.and_then(|id| u16::try_from(id).ok()),
                        is_agent: kind == ActorKind::Vehicle && actor.role != ActorRole::Background,
                        ordinary: !unruly,
                        rolls: matches!(model.special, Special::Wheelchair | Special::Pram),
                        sits: actor.attributes.is_true(&Attribute::SitsOnBench),
                        touched: None,
                        track,
                        way,
                        gone_m,
                    })
                })
                .collect()
        };
        let (vehicles, walkers) = (bodies(ActorKind::Vehicle), bodies(ActorKind::Walker));
        let states = vehicles.first().or(walkers.first()).map_or(0, |b| b.track.len());
        let holds = holds(map, log, states);
        let standing = log.actors.iter().filter(|a| a.role == ActorRole::Hazard && a.kind != ActorKind::Sign);
        let obstacle = |a: &schema::tables::ActorRow| Obstacle {
            id: a.id,
            size_m: [a.length_m, a.width_m],
            snap: Snap { at: a.xyz_m.into(), yaw_rad: yaw(a.quaternion), speed_mps: 0.0, lamps: 0 },
        };
        let obstacles = standing.map(obstacle).collect();
        Self { map, vehicles, walkers, obstacles, holds, leaps: leaps(map), states }
    }

    /// Whether a vehicle is so far from all agents that it sleeps.
    pub(crate) fn is_asleep(&self, body: &Body, i: usize) -> bool {
        let near = |a: &Body| (a.track[i].at - body.track[i].at).xy().norm() < ACTIVE_M;
        !self.vehicles.iter().filter(|v| v.is_agent).any(near)
    }

    /// Every sampled state.
    pub(crate) fn samples(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.states).step_by(SAMPLE)
    }

    /// The driving lane that a vehicle is on: of those that run its way the one whose middle it is nearest
    /// to.
    pub(crate) fn lane(&self, snap: &Snap) -> Option<LaneHit> {
        lane(self.map, snap)
    }

    /// Number of the junction at a place for a vehicle that goes its way.
    pub(crate) fn junction(&self, snap: &Snap) -> Option<usize> {
        self.map.lane(self.lane(snap)?.lane)?.junction
    }

    /// Lines that hold a vehicle: metres from its front (negative when passed), and what holds it there.
    pub(crate) fn lines_ahead(&self, body: &Body, i: usize, reach_m: f64) -> Vec<(f64, &Hold)> {
        let snap = &body.track[i];
        let front = 0.5 * body.size_m[0];
        let mut found = Vec::new();
        for hold in &self.holds {
            for (_, line) in &hold.lines {
                if (line.at - snap.at).norm() > reach_m + 10.0 {
                    continue;
                }
                let [ahead, left] = snap.local(&line.at);
                let along = frames::wrap_pi(line.yaw_rad - snap.yaw_rad).abs() < ASKEW_RAD;
                // Farther ahead the lane may bend a little.
                let off_it = left.abs() > 1.7 + 0.06 * ahead.max(0.0);
                if along && !off_it && ahead - front < reach_m {
                    found.push((ahead - front, hold));
                }
            }
        }
        found
    }
}

fn lane(map: &Map, snap: &Snap) -> Option<LaneHit> {
    let near = map.lanes_within(snap.at, 3.5, |l| l.lane_type.is_drivable());
    let runs_along = |hit: &&LaneHit| {
        let point = map.lane_point(hit.lane, hit.s, 0.0);
        point.is_some_and(|p| frames::wrap_pi(p.heading_rad - snap.yaw_rad).abs() < ASKEW_RAD)
    };
    near.iter().find(runs_along).copied()
}

/// The way of a track, on along the lanes from its last place.
fn way(map: &Map, track: &[Snap]) -> (Vec<(f64, Point3<f64>)>, Vec<f64>) {
    let (mut way, mut gone_m, mut gone) = (Vec::new(), Vec::with_capacity(track.len()), 0.0);
    for (i, snap) in track.iter().enumerate() {
        gone += if i == 0 { 0.0 } else { (snap.at - track[i - 1].at).norm() };
        gone_m.push(gone);
        if way.last().is_none_or(|(along, _)| gone - along >= POINT_M) {
            way.push((gone, snap.at));
        }
    }
    let last = track.last().and_then(|snap| Some((lane(map, snap)?, map)));
    if let Some((hit, map)) = last
        && let Some(info) = map.lane(hit.lane)
    {
        let mut ends = vec![LanePos { lane: hit.lane, along_m: info.along_of_s(hit.s) }];
        let mut on = 0.0;
        while on < BEYOND_M {
            let step = if on < FINE_M { POINT_M } else { COARSE_M };
            on += step;
            ends = ends.into_iter().flat_map(|end| map.ahead(end, step)).collect();
            // Ways that lead into one lane go on as one.
            ends.sort_by_key(|end| end.lane);
            ends.dedup_by_key(|end| end.lane);
            way.extend(ends.iter().filter_map(|end| Some((gone + on, map.point_at(*end)?.position))));
        }
    }
    (way, gone_m)
}

/// Where the map leads from the end of one lane to the beginning of one that lies apart: vehicles go over
/// before.
fn leaps(map: &Map) -> Vec<(Point3<f64>, f64)> {
    let at = |lane, along_m| map.point_at(LanePos { lane, along_m }).map(|p| p.position);
    let mut found = Vec::new();
    for lane in map.lanes().iter().filter(|l| l.lane_type.is_drivable()) {
        let Some(end) = at(lane.id, lane.s_length()) else { continue };
        let starts = map.successors(lane.id).iter().filter_map(|&next| at(next, 0.0));
        found.extend(starts.map(|s| (end, (s - end).norm())).filter(|(_, apart_m)| *apart_m > APART_M));
    }
    found
}

/// Lights, and stop and yield signs, with where they hold traffic. A signal may have several heads, each with
/// rows of its own.
fn holds(map: &Map, log: &SimulationLog, count: usize) -> Vec<Hold> {
    let mut states: BTreeMap<&str, Vec<u8>> = BTreeMap::new();
    for row in &log.signals {
        let shown = states.entry(&row.opendrive_id).or_insert_with(|| vec![b'?'; count]);
        // The first state is that of frame -1.
        if let Some(shown) = usize::try_from(row.frame + 1).ok().and_then(|i| shown.get_mut(i)) {
            *shown = row.state.name().as_bytes()[0];
        }
    }
    let lines = |signal: usize| -> Vec<(LanePos, Snap)> {
        let places = map.stop_points(signal).into_iter();
        let snap = |pos: LanePos| {
            let p = map.point_at(pos)?;
            Some((pos, Snap { at: p.position, yaw_rad: p.heading_rad, speed_mps: 0.0, lamps: 0 }))
        };
        places.filter_map(snap).collect()
    };
    let mut found = Vec::new();
    for (i, signal) in map.signals().iter().enumerate() {
        if signal.dynamic {
            found.extend(
                states.get(signal.id.as_str()).map(|s| Hold { lines: lines(i), light: Some(s.clone()) }),
            );
        } else if signal.is_stop_sign() || signal.kind == "205" {
            found.push(Hold { lines: lines(i), light: None });
        }
    }
    found
}
