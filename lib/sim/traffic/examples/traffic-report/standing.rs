//! Why vehicles stand, and for how long.

use std::collections::BTreeMap;

use super::film::{Body, DT, Film, SAMPLE};

/// Slower than this is standing, m/s.
const STANDING_MPS: f64 = 0.1;
/// Nobody judges drivers before they have set off, seconds.
const START_S: f64 = 3.0;
/// A leader's rear is this near, metres: the largest standing gap drawn, and as much again behind a wreck.
const LEADER_M: f64 = 9.0;
const WRECK_M: f64 = 16.0;
/// A vehicle that stands straight ahead of the bumper, wherever the way leads later, is within this distance,
/// metres, and not askew by more, radians.
const STRAIGHT_M: f64 = 7.0;
const ASKEW_RAD: f64 = 1.0;
/// A vehicle that is let in is at most this far ahead, bumper to middle, and this far aside, metres.
const LET_IN_M: [f64; 2] = [14.0, 5.0];
/// Room between two who meet, metres; the ground that a vehicle needs is looked at over this way, metres.
const MEET_M: f64 = 0.35;
const NEEDED_M: f64 = 25.0;
/// A line is this near, metres: farther off where long vehicles swing out beside it.
const LINE_M: f64 = 11.0;
/// Walkers on the road within this way ahead, and this far beside it, metres.
const WALKER_M: [f64; 2] = [16.0, 6.0];
/// A junction begins within this distance, metres.
const JUNCTION_M: f64 = 10.0;
/// Room to wait between two junctions beyond the own length, metres, and how far junctions are looked for.
const BETWEEN_M: f64 = 10.0;
const JUNCTIONS_M: f64 = 80.0;
/// Vehicles that come to a junction are given way if they are this near: metres at least, and seconds
/// (critical gaps of the Highway Capacity Manual are 6.2 to 7.1 s).
const RIVAL_M: f64 = 25.0;
const RIVAL_S: f64 = 7.0;
/// Vehicles that use a junction are this near at most, metres.
const ACROSS_M: f64 = 60.0;
/// The first vehicle at a line before a junction is this near to it, metres.
const AT_LINE_M: f64 = 14.0;
/// The exit of a junction is looked at over this length, metres.
const EXIT_M: f64 = 60.0;
/// Vehicles that set off need no reason any more, states (1.5 s).
const SETTING_OFF: usize = 30;

/// Why a vehicle stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Reason {
    /// A vehicle ahead; its index.
    Leader(usize),
    Walker,
    Light,
    /// A stop or yield sign, or others in an unsignalised junction.
    Priority,
    /// Others who are about to come over the ground that it needs, as in tight bends.
    Meeting,
    /// One beside it that indicates and is let in.
    LetIn,
    /// A vehicle that stands behind the junction; its index.
    Exit(usize),
    /// It has crashed, or one who has lies ahead.
    Wreck,
    /// It is about to move.
    SettingOff,
    /// An accident or road works lie ahead.
    Hazard,
    /// The road ends.
    DeadEnd,
    /// It is too far from all agents to be simulated.
    Asleep,
    None,
}

impl Reason {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Leader(_) => "leader",
            Self::Walker => "walker",
            Self::Light => "light",
            Self::Priority => "sign or junction",
            Self::Meeting => "others come through",
            Self::LetIn => "lets one in",
            Self::Exit(_) => "blocked exit",
            Self::Wreck => "wreck",
            Self::SettingOff => "setting off",
            Self::Hazard => "hazard",
            Self::DeadEnd => "dead end",
            Self::Asleep => "asleep",
            Self::None => "none",
        }
    }
}

/// A stretch of standing without moving: seconds, state at its end, vehicle.
pub(crate) type Longest = Option<(f64, usize, u16)>;

#[derive(Debug, Default)]
pub(crate) struct Standing {
    /// Sampled states of standing ordinary vehicles by reason.
    pub(crate) reasons: BTreeMap<&'static str, usize>,
    /// Those without a reason: (state, vehicle).
    pub(crate) faults: Vec<(usize, u16)>,
    /// Longest standing for whatever reason.
    pub(crate) longest: Longest,
    /// Longest standing of which the cause, at the head of the queue, is neither a light nor a walker nor a
    /// wreck nor a hazard.
    pub(crate) gridlock: Longest,
}

pub(crate) fn measure(film: &Film<'_>) -> Standing {
    let mut standing = Standing::default();
    let mut since: Vec<[usize; 2]> = vec![[0; 2]; film.vehicles.len()];
    for i in film.samples() {
        let reasons: Vec<Option<Reason>> = (0..film.vehicles.len())
            .map(|n| {
                (film.vehicles[n].towed_by.is_none() && stands(&film.vehicles[n], i))
                    .then(|| reason(film, n, i))
            })
            .collect();
        for (n, body) in film.vehicles.iter().enumerate() {
            let Some(reason) = reasons[n].filter(|_| body.ordinary && !body.is_wrecked(i)) else {
                since[n] = [i; 2];
                continue;
            };
            if (i as f64) * DT >= START_S {
                *standing.reasons.entry(reason.name()).or_default() += 1;
                if reason == Reason::None {
                    standing.faults.push((i, body.id));
                }
            }
            if matches!(
                head(&reasons, n),
                Reason::Asleep
                    | Reason::Light
                    | Reason::Wreck
                    | Reason::Walker
                    | Reason::Hazard
                    | Reason::DeadEnd
            ) {
                since[n][1] = i;
            }
            for (longest, from) in [&mut standing.longest, &mut standing.gridlock].into_iter().zip(since[n]) {
                let time_s = (i - from) as f64 * DT;
                if longest.is_none_or(|l| time_s > l.0) {
                    *longest = Some((time_s, i, body.id));
                }
            }
        }
    }
    standing
}

fn stands(body: &Body, i: usize) -> bool {
    body.track[i].speed_mps.abs() < STANDING_MPS
        && body.track[i.saturating_sub(SAMPLE)].speed_mps.abs() < STANDING_MPS
}

/// The reason at the head of the queue that a vehicle stands in; its own if the queue bites its tail.
fn head(reasons: &[Option<Reason>], from: usize) -> Reason {
    let mut n = from;
    for _ in 0..reasons.len() {
        match reasons[n] {
            Some(Reason::Leader(ahead) | Reason::Exit(ahead)) if ahead != from => n = ahead,
            Some(reason) => return reason,
            // It moves: a vehicle that stands behind it is about to.
            None => return Reason::SettingOff,
        }
    }
    Reason::None
}

fn reason(film: &Film<'_>, n: usize, i: usize) -> Reason {
    let body = &film.vehicles[n];
    if body.is_wrecked(i) {
        return Reason::Wreck;
    }
    if film.is_asleep(body, i) {
        return Reason::Asleep;
    }
    let near = |other: &Body| (other.track[i].at - body.track[i].at).norm() < 30.0;
    let others: Vec<usize> = (0..film.vehicles.len())
        .filter(|&m| m != n && !body.is_coupled(&film.vehicles[m]) && near(&film.vehicles[m]))
        .collect();
    let Way { reached_m, junction, reason } = way_ahead(film, body, &others, i);
    let reason = reason
        .or_else(|| reason_ahead(film, body, &others, i))
        .or_else(|| reason_at_line(film, body, junction, i));
    if let Some(reason) = reason {
        return reason;
    }
    if reached_m < JUNCTION_M - 1.0 && junction.is_none() {
        return Reason::DeadEnd;
    }
    if let Some(junction) = junction {
        if wreck_in(film, junction, i) {
            return Reason::Wreck;
        }
        if junctions(film, body, i).into_iter().any(|junction| rivals(film, n, i, junction)) {
            return Reason::Priority;
        }
    }
    if others.iter().any(|&m| is_let_in(body, &film.vehicles[m], i)) {
        return Reason::LetIn;
    }
    if film.vehicles.iter().any(|other| !body.is_coupled(other) && comes_through(film, body, other, i)) {
        return Reason::Meeting;
    }
    Reason::None
}

/// What is found on the way that a vehicle goes later.
struct Way {
    /// How far it is known, metres.
    reached_m: f64,
    /// The first junction on it.
    junction: Option<usize>,
    /// What blocks it.
    reason: Option<Reason>,
}

/// Looks along the way ahead for wrecks, leaders and hazards on it.
fn way_ahead(film: &Film<'_>, body: &Body, others: &[usize], i: usize) -> Way {
    let mut way = Way { reached_m: 0.0, junction: None, reason: None };
    for (to, point) in body.ahead(i, WRECK_M) {
        way.reached_m = to;
        // A wreck that is askew blocks the way with a corner, too.
        let beside_m = 0.5 * body.size_m[1] + 0.1;
        let blocks =
            |m: &&usize| film.vehicles[**m].is_wrecked(i) && film.vehicles[**m].covers(i, point, beside_m);
        let leader = || others.iter().find(|&&m| film.vehicles[m].covers(i, point, 0.3));
        way.reason = if others.iter().any(|m| blocks(&m)) {
            Some(Reason::Wreck)
        } else if let Some(&m) = leader().filter(|_| to < LEADER_M) {
            Some(Reason::Leader(m))
        } else if hazard_ahead(film, body, i, point) {
            // A vehicle that waits for a gap to pass a hazard goes round it later: it lies ahead all the
            // same.
            Some(Reason::Hazard)
        } else {
            None
        };
        if way.reason.is_some() {
            break;
        }
        if way.junction.is_none() && to < JUNCTION_M {
            let at = film.map.nearest_driving_lane(*point);
            way.junction = at.and_then(|hit| film.map.lane(hit.lane)?.junction);
        }
    }
    way
}

/// Somebody straight ahead, or a walker on the way.
fn reason_ahead(film: &Film<'_>, body: &Body, others: &[usize], i: usize) -> Option<Reason> {
    if let Some(&m) = others.iter().find(|&&m| is_straight_ahead(body, &film.vehicles[m], i)) {
        let wrecked = film.vehicles[m].is_wrecked(i);
        return Some(if wrecked { Reason::Wreck } else { Reason::Leader(m) });
    }
    let walker = walker_ahead(film, body, i)?;
    Some(if walker.is_wrecked(i) { Reason::Wreck } else { Reason::Walker })
}

/// What holds a vehicle at a line: its light, its sign, or no room behind the junction; or that it is about
/// to set off.
fn reason_at_line(film: &Film<'_>, body: &Body, junction: Option<usize>, i: usize) -> Option<Reason> {
    let lines = film.lines_ahead(body, i, LINE_M);
    let held = |light: bool| {
        lines.iter().any(|(to, hold)| *to > -3.0 && hold.light.is_some() == light && hold.stops(i))
    };
    if held(true) {
        return Some(Reason::Light);
    }
    let later = (i + SETTING_OFF).min(film.states - 1);
    if body.track[later].speed_mps > STANDING_MPS {
        return Some(Reason::SettingOff);
    }
    // Vehicles that stop at a sign wait for room behind the junction, too.
    if junction.is_some()
        && let Some(m) = exit_blocked(film, body, i)
    {
        let wrecked = film.vehicles[m].is_wrecked(i);
        return Some(if wrecked { Reason::Wreck } else { Reason::Exit(m) });
    }
    held(false).then(|| {
        let wreck = junction.is_some_and(|j| wreck_in(film, j, i));
        if wreck { Reason::Wreck } else { Reason::Priority }
    })
}

/// Whether another vehicle that goes the same way, or a wreck, is right ahead of a vehicle's front.
fn is_straight_ahead(body: &Body, other: &Body, i: usize) -> bool {
    let (snap, [half_length, half_width]) = (&body.track[i], body.size_m.map(|v| 0.5 * v));
    let askew = frames::wrap_pi(other.track[i].yaw_rad - snap.yaw_rad).abs();
    let (sin, cos) = frames::math::sin_cos(snap.yaw_rad);
    let mut points = (1..).map(|k| 0.5 * f64::from(k)).take_while(|d| *d < STRAIGHT_M).flat_map(|d| {
        [-half_width, 0.0, half_width].map(|left| {
            let ahead = half_length + d;
            snap.at + nalgebra::Vector3::new(ahead * cos - left * sin, ahead * sin + left * cos, 0.0)
        })
    });
    (askew < ASKEW_RAD || other.is_wrecked(i)) && points.any(|p| other.covers(i, &p, 0.2))
}

/// Whether another vehicle beside the way ahead indicates that it wants to come over.
fn is_let_in(body: &Body, other: &Body, i: usize) -> bool {
    let (snap, there) = (&body.track[i], &other.track[i]);
    let [ahead, left] = snap.local(&there.at);
    // Blinkers flash: half a second before and after they burn at some time.
    let states = i.saturating_sub(SAMPLE)..(i + SAMPLE).min(other.track.len());
    let lamp = if left > 0.0 { schema::lights::BLINK_RIGHT } else { schema::lights::BLINK_LEFT };
    (0.0..0.5 * body.size_m[0] + LET_IN_M[0]).contains(&ahead)
        && (1.5..LET_IN_M[1]).contains(&left.abs())
        && frames::wrap_pi(there.yaw_rad - snap.yaw_rad).abs() < ASKEW_RAD
        && other.track[states].iter().any(|s| s.lamps & lamp != 0)
}

/// Whether another vehicle is on the ground that a vehicle needs ahead, or will be soon.
fn comes_through(film: &Film<'_>, body: &Body, other: &Body, i: usize) -> bool {
    let reach_m = NEEDED_M + RIVAL_M + RIVAL_S * other.track[i].speed_mps.abs();
    if other.id == body.id || (other.track[i].at - body.track[i].at).norm() > reach_m {
        return false;
    }
    let margin_m = reach_aside_m(body, i) + MEET_M;
    let last = (i + (RIVAL_S / DT) as usize).min(film.states - 1);
    let mut soon = (i..=last).step_by(SAMPLE);
    soon.any(|j| body.ahead(i, NEEDED_M).any(|(_, point)| other.covers(j, point, margin_m)))
}

/// How far a vehicle reaches to its sides on the way that it needs, metres: in a bend of radius R its front
/// corners are farther out by up to the square of the way from the rear axle to the bumper over 2 R.
fn reach_aside_m(body: &Body, i: usize) -> f64 {
    let points: Vec<_> = body.ahead(i, NEEDED_M).map(|(_, point)| point).collect();
    let directions: Vec<f64> =
        points.windows(9).step_by(8).map(|w| frames::math::atan2(w[8].y - w[0].y, w[8].x - w[0].x)).collect();
    let turns =
        directions.windows(2).map(|d| frames::wrap_pi(d[1] - d[0]).abs() / (8.0 * super::film::POINT_M));
    let axle_to_front_m = 0.5 * (body.size_m[0] + body.wheelbase_m);
    0.5 * (body.size_m[1] + turns.fold(0.0, f64::max) * axle_to_front_m * axle_to_front_m)
}

/// Whether something of a hazard is in the way of a vehicle: at a point of its way, or straight ahead.
fn hazard_ahead(film: &Film<'_>, body: &Body, i: usize, point: &nalgebra::Point3<f64>) -> bool {
    let [half_length, half_width] = body.size_m.map(|v| 0.5 * v);
    film.obstacles.iter().any(|o| {
        let [ahead, left] = body.track[i].local(&o.snap.at);
        let straight = (half_length..half_length + WRECK_M).contains(&ahead) && left.abs() < half_width + 0.5;
        let near = (body.track[i].at.z - o.snap.at.z).abs() < 3.0;
        (straight && near) || o.snap.covers(o.size_m, point, half_width + 0.2)
    })
}

/// A walker on the road close ahead.
fn walker_ahead<'a>(film: &'a Film<'_>, body: &Body, i: usize) -> Option<&'a Body> {
    let [reach, beside] = WALKER_M;
    film.walkers.iter().find(|walker| {
        let at = &walker.track[i].at;
        (at - body.track[i].at).norm() < reach + 20.0
            && body.ahead(i, reach).any(|(_, p)| (p - at).norm() < beside)
            && film.map.nearest_driving_lane(*at).is_some_and(|hit| hit.t_m.abs() < 0.5 * hit.width_m + 2.0)
    })
}

/// A slow vehicle on the way behind the junction, with not enough room before it.
fn exit_blocked(film: &Film<'_>, body: &Body, i: usize) -> Option<usize> {
    let mut left_at = None;
    let mut inside = false;
    for (to, point) in body.ahead(i, 120.0) {
        let hit = film.map.nearest_driving_lane(*point);
        let in_junction = hit.and_then(|h| film.map.lane(h.lane)?.junction).is_some();
        inside |= in_junction;
        if inside && !in_junction && left_at.is_none() {
            left_at = Some(to);
        }
        if left_at.is_some_and(|l| to > l + EXIT_M) {
            return None;
        }
        let slow = |o: &&Body| o.id != body.id && o.track[i].speed_mps < 2.0 && o.covers(i, point, 0.2);
        let found = film.vehicles.iter().position(|o| slow(&o));
        if found.is_some() {
            return found;
        }
    }
    None
}

/// The junctions that a vehicle goes through as one: there is no room to wait between them.
fn junctions(film: &Film<'_>, body: &Body, i: usize) -> Vec<usize> {
    let room_m = body.size_m[0] + BETWEEN_M;
    let mut found: Vec<usize> = Vec::new();
    let mut left_at = JUNCTION_M - room_m;
    for (to, point) in body.ahead(i, JUNCTIONS_M) {
        let hit = film.map.nearest_driving_lane(*point);
        if let Some(junction) = hit.and_then(|hit| film.map.lane(hit.lane)?.junction) {
            left_at = to;
            if !found.contains(&junction) {
                found.push(junction);
            }
        } else if to > left_at + room_m {
            break;
        }
    }
    found
}

/// A crashed vehicle in a junction.
fn wreck_in(film: &Film<'_>, junction: usize, i: usize) -> bool {
    let [low, high] = film.map.junctions()[junction].bounds;
    film.vehicles.iter().filter(|v| v.is_wrecked(i)).any(|v| {
        let at = v.track[i].at;
        let margin = 0.5 * v.size_m[0];
        (low.x - margin..high.x + margin).contains(&at.x) && (low.y - margin..high.y + margin).contains(&at.y)
    })
}

/// Others in the junction, or on their way to it, or at a line before it for longer.
fn rivals(film: &Film<'_>, n: usize, i: usize, junction: usize) -> bool {
    film.vehicles.iter().enumerate().any(|(m, other)| {
        let snap = &other.track[i];
        let reach = RIVAL_M.max(RIVAL_S * snap.speed_mps);
        if m == n || (snap.at - film.vehicles[n].track[i].at).norm() > ACROSS_M + reach {
            return false;
        }
        let here = |p: &nalgebra::Point3<f64>| {
            let hit = film.map.nearest_driving_lane(*p);
            hit.and_then(|h| film.map.lane(h.lane)?.junction) == Some(junction)
        };
        let front = |body: &Body, i: usize| {
            let (sin, cos) = frames::math::sin_cos(body.track[i].yaw_rad);
            body.track[i].at + 0.5 * body.size_m[0] * nalgebra::Vector3::new(cos, sin, 0.0)
        };
        let enters = |body: &Body| (i..film.states).step_by(SAMPLE).find(|&j| here(&front(body, j)));
        let me = &film.vehicles[n];
        let moves = snap.speed_mps > STANDING_MPS;
        let goes_first = || enters(other).is_some_and(|then| enters(me).is_none_or(|mine| then < mine));
        let waits = !moves && (stood_since(other, i) < stood_since(me, i) || goes_first());
        let reach_m = if waits { AT_LINE_M } else { reach };
        here(&snap.at)
            || here(&front(other, i))
            || ((moves || waits) && other.ahead(i, reach_m).step_by(2).any(|(_, p)| here(p)))
    })
}

/// The state since which a vehicle stands.
fn stood_since(body: &Body, i: usize) -> usize {
    let stood = body.track[..=i].iter().rev().take_while(|s| s.speed_mps.abs() < STANDING_MPS).count();
    i + 1 - stood
}
