//! How vehicles move: accelerations, speeds against the limit, offsets from their lanes, sideways sliding.

use frames::math::sin_cos;
use opendrive::LaneId;

use super::film::{Body, DT, Film, SAMPLE};

/// A lane without a limit counts as one of this, m/s.
const DEFAULT_LIMIT_MPS: f64 = 50.0 / 3.6;
/// A free driver has nobody this far ahead, metres and seconds.
const FREE_M: f64 = 40.0;
const FREE_S: f64 = 5.0;
/// Slower ones are held up by something, m/s.
const MOVING_MPS: f64 = 3.0;
/// A free driver has gone on like this for that long, states, and will (4 s).
const STEADY: usize = 80;
/// Vehicles that change lanes are off their lane by more than this before and after, metres.
const CHANGING_M: f64 = 0.25;
/// Vehicles go over to a lane that lies apart within this way before the end of the one that leads there, for
/// each metre.
const LEAP_M_PER_M: f64 = 4.0;

/// States over which jerk is told (half a second).
const JERK_STATES: usize = 10;

/// Figures of ordinary drivers who never crashed.
#[derive(Debug, Default)]
pub(crate) struct Motion {
    /// Along the heading, m/s2.
    pub(crate) acceleration: Vec<f64>,
    /// Across the heading, of the middle of the footprint, m/s2.
    pub(crate) sideways: Vec<f64>,
    /// Change of the acceleration along the heading over half a second, m/s3.
    pub(crate) jerk: Vec<f64>,
    /// Speed over the limit in free flow.
    pub(crate) free_flow: Vec<f64>,
    /// From the middle of the lane, metres, outside lane changes.
    pub(crate) offset_m: Vec<f64>,
    /// Largest offset: state, vehicle.
    pub(crate) worst_offset: Option<(f64, usize, u16)>,
    /// Strongest braking: state, vehicle.
    pub(crate) worst_braking: Option<(f64, usize, u16)>,
    /// Strongest acceleration sideways: state, vehicle.
    pub(crate) worst_sideways: Option<(f64, usize, u16)>,
    /// Sideways speed of the rear axle's middle, m/s.
    pub(crate) slide_mps: Vec<f64>,
    pub(crate) lane_changes: usize,
}

pub(crate) fn measure(film: &Film<'_>) -> Motion {
    let mut motion = Motion::default();
    for body in film.vehicles.iter().filter(|b| b.ordinary && b.towed_by.is_none()) {
        let end = body.touched.unwrap_or(film.states);
        forces(body, end, &mut motion);
        on_lanes(film, body, end, &mut motion);
    }
    motion
}

fn forces(body: &Body, end: usize, motion: &mut Motion) {
    let rear = |i: usize| {
        let snap = &body.track[i];
        let (sin, cos) = sin_cos(snap.yaw_rad);
        let half = 0.5 * body.wheelbase_m;
        [snap.at.x - half * cos, snap.at.y - half * sin]
    };
    let accelerations: Vec<f64> =
        (1..end).map(|i| (body.track[i].speed_mps - body.track[i - 1].speed_mps) / DT).collect();
    let changes = accelerations.iter().zip(accelerations.iter().skip(JERK_STATES));
    motion.jerk.extend(changes.map(|(a, b)| (b - a) / (JERK_STATES as f64 * DT)));
    for i in 2..end {
        let sideways = across(body, i).abs();
        motion.sideways.push(sideways);
        if motion.worst_sideways.is_none_or(|w| sideways > w.0) {
            motion.worst_sideways = Some((sideways, i, body.id));
        }
    }
    for i in 1..end {
        let (a, b) = (&body.track[i - 1], &body.track[i]);
        let turn = frames::wrap_pi(b.yaw_rad - a.yaw_rad);
        let acceleration = accelerations[i - 1];
        if motion.worst_braking.is_none_or(|w| acceleration < w.0) {
            motion.worst_braking = Some((acceleration, i, body.id));
        }
        motion.acceleration.push(acceleration);
        let ([x0, y0], [x1, y1]) = (rear(i - 1), rear(i));
        let (sin, cos) = sin_cos(a.yaw_rad + 0.5 * turn);
        motion.slide_mps.push((((y1 - y0) * cos - (x1 - x0) * sin) / DT).abs());
    }
}

/// How much a body's velocity changes across its heading, from its places at three states, m/s2.
fn across(body: &Body, i: usize) -> f64 {
    let [a, b, c] = [i - 2, i - 1, i].map(|k| body.track[k].at);
    let change = (c - b) - (b - a);
    let (sin, cos) = sin_cos(body.track[i - 1].yaw_rad);
    (change.y * cos - change.x * sin) / (DT * DT)
}

fn on_lanes(film: &Film<'_>, body: &Body, end: usize, motion: &mut Motion) {
    let samples: Vec<usize> = film.samples().filter(|i| *i < end).collect();
    let hits: Vec<_> = samples.iter().map(|&i| film.lane(&body.track[i])).collect();
    let changes: Vec<usize> = (1..hits.len())
        .filter(|&k| match (&hits[k - 1], &hits[k]) {
            (Some(a), Some(b)) => changes_over(film, a.lane, b.lane),
            _ => false,
        })
        .map(|k| samples[k])
        .collect();
    motion.lane_changes += changes.len();
    let offsets: Vec<f64> = hits.iter().map(|hit| hit.map_or(3.5, |h| h.distance_m)).collect();
    // What is off the lane without a break before or after a change, or when the scene ends, belongs to a
    // change; so does what is off where the map itself leads from the end of one lane to the beginning of
    // another one that lies apart.
    let mut changing = vec![false; offsets.len() + 1];
    let led_over = (0..samples.len()).filter(|&k| {
        let at = body.track[samples[k]].at;
        film.leaps.iter().any(|(leap, apart_m)| (leap - at).norm() < LEAP_M_PER_M * apart_m)
    });
    for k in changes.iter().map(|c| c / SAMPLE).chain(led_over).chain([offsets.len()]) {
        changing[k] = true;
        (k..offsets.len()).take_while(|&j| offsets[j] > CHANGING_M).for_each(|j| changing[j] = true);
        (0..k).rev().take_while(|&j| offsets[j] > CHANGING_M).for_each(|j| changing[j] = true);
    }
    for (k, &offset) in offsets.iter().enumerate().filter(|(k, _)| !changing[*k]) {
        motion.offset_m.push(offset);
        if motion.worst_offset.is_none_or(|w| offset > w.0) {
            motion.worst_offset = Some((offset, samples[k], body.id));
        }
    }
    if body.two_wheeled {
        return;
    }
    for (k, &i) in samples.iter().enumerate() {
        let Some(hit) = hits[k].filter(|_| i >= STEADY && i + STEADY < end) else { continue };
        if is_free(film, body, i) {
            let limit = film.map.speed_limit(hit.lane, hit.s).unwrap_or(DEFAULT_LIMIT_MPS);
            motion.free_flow.push(body.track[i].speed_mps / limit);
        }
    }
}

/// Whether a vehicle on one lane and then on another one has changed lanes: outside junctions, not to what
/// the first lane leads to, but to another lane of the same road or beside what it leads to.
fn changes_over(film: &Film<'_>, from: LaneId, to: LaneId) -> bool {
    let outside = film.map.lane(to).is_some_and(|l| l.junction.is_none());
    let beside = || {
        let lanes = [film.map.left_of(to), film.map.right_of(to)].into_iter().flatten();
        lanes.filter(|l| film.map.same_direction(*l, to)).any(|l| leads_to(film, from, l))
    };
    from != to && outside && !leads_to(film, from, to) && (from.road == to.road || beside())
}

/// Whether a lane leads to another one, over at most one between.
fn leads_to(film: &Film<'_>, from: LaneId, to: LaneId) -> bool {
    let on = |id: LaneId| film.map.successors(id);
    on(from).iter().any(|next| *next == to || on(*next).contains(&to))
}

/// Whether nothing but the limit sets a vehicle's speed: it goes steadily and straight on between junctions,
/// with nobody and no line near ahead.
fn is_free(film: &Film<'_>, body: &Body, i: usize) -> bool {
    let snap = &body.track[i];
    let around = (i - STEADY..=i + STEADY).step_by(SAMPLE);
    let straight = around.clone().all(|k| frames::wrap_pi(body.track[k].yaw_rad - snap.yaw_rad).abs() < 0.1);
    let reach = FREE_M + FREE_S * snap.speed_mps;
    straight
        && around.clone().all(|k| body.track[k].speed_mps > MOVING_MPS)
        && (body.track[i + SAMPLE].speed_mps - body.track[i - SAMPLE].speed_mps).abs() < 0.2
        && around.clone().all(|k| film.junction(&body.track[k]).is_none())
        && film.lines_ahead(body, i, reach).iter().all(|(to, _)| *to < 0.0)
        && film.vehicles.iter().filter(|o| o.id != body.id).all(|other| {
            let [ahead, left] = snap.local(&other.track[i].at);
            !(0.0..reach).contains(&ahead) || left.abs() > 8.0
        })
}
