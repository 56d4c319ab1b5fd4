//! What happens at lights: which vehicles pass at red, and how fast queues clear.

use opendrive::LaneId;

use super::film::{DT, Film};

/// The first vehicles of a queue lose time by setting off; those after this many flow.
const LOST: usize = 3;
/// Saturation flow is told in passenger cars: queues count up to the first vehicle longer than this, metres,
/// or on two wheels.
const CAR_M: f64 = 6.3;
/// A vehicle has queued that was slower than this since the light was red, m/s.
const QUEUED_MPS: f64 = 1.0;
/// It has set off when it is faster than this; a vehicle that stops again is held up by something else than
/// the queue.
const SET_OFF_MPS: f64 = 2.0;

#[derive(Debug, Default)]
pub(crate) struct Lights {
    /// Ordinary drivers whose front passed a line at red: (state, vehicle).
    pub(crate) red_runs: Vec<(usize, u16)>,
    /// The same of distracted and reckless ones.
    pub(crate) unruly_runs: usize,
    /// Passages at all.
    pub(crate) passages: usize,
    /// Time between vehicles that had queued, from the fourth after the light turned green on, seconds.
    pub(crate) headways_s: Vec<f64>,
}

/// A front that passed a line.
#[derive(Clone, Copy)]
struct Passage {
    state: usize,
    vehicle: usize,
}

pub(crate) fn measure(film: &Film<'_>) -> Lights {
    let mut result = Lights::default();
    let mut done: Vec<LaneId> = Vec::new();
    for hold in &film.holds {
        let Some(states) = &hold.light else { continue };
        for (pos, line) in &hold.lines {
            let mut passages: Vec<Passage> = Vec::new();
            for (vehicle, body) in film.vehicles.iter().enumerate() {
                if body.towed_by.is_some()
                    || body.track.iter().step_by(20).all(|s| (s.at - line.at).norm() > 40.0)
                {
                    continue;
                }
                let ahead = |i: usize| -> Option<f64> {
                    let snap = &body.track[i];
                    let [x, y] = line.local(&snap.at);
                    let along = frames::wrap_pi(snap.yaw_rad - line.yaw_rad).abs() < 0.5;
                    (along && y.abs() < 1.0 && (snap.at.z - line.at.z).abs() < 2.0)
                        .then_some(x + 0.5 * body.size_m[0])
                };
                for state in 1..film.states {
                    if let (Some(before), Some(after)) = (ahead(state - 1), ahead(state))
                        && before <= 0.0
                        && after > 0.0
                    {
                        passages.push(Passage { state, vehicle });
                    }
                }
            }
            passages.sort_by_key(|p| p.state);
            for passage in &passages {
                let body = &film.vehicles[passage.vehicle];
                if states[passage.state] == b'R' && !body.is_wrecked(passage.state) {
                    if body.ordinary {
                        result.red_runs.push((passage.state, body.id));
                    } else {
                        result.unruly_runs += 1;
                    }
                }
            }
            // One line may have several lights; their passages are the same.
            if !done.contains(&pos.lane) {
                done.push(pos.lane);
                result.passages += passages.len();
                headways(film, states, &passages, &mut result.headways_s);
            }
        }
    }
    result
}

/// A vehicle is through a junction this far behind its line, metres, and has gone straight on if it has
/// turned by less, radians.
const THROUGH_M: f64 = 30.0;
const STRAIGHT_RAD: f64 = 0.5;

/// Time between the vehicles of one queue.
fn headways(film: &Film<'_>, light: &[u8], passages: &[Passage], headways_s: &mut Vec<f64>) {
    let starts = (1..light.len()).filter(|&i| light[i] == b'G' && light[i - 1] != b'G');
    for start in starts {
        let end = (start..light.len()).find(|&i| light[i] == b'R').unwrap_or(light.len());
        let inside = passages.iter().filter(|p| (start..end).contains(&p.state));
        let red = light[..start].iter().rposition(|&s| s == b'G').unwrap_or(0);
        let queued = |p: &&Passage| {
            let body = &film.vehicles[p.vehicle];
            body.ordinary && (red..=p.state).any(|i| body.track[i].speed_mps < QUEUED_MPS)
        };
        let flows = |p: &&Passage| {
            let track = &film.vehicles[p.vehicle].track;
            let set_off = (start..p.state).find(|&i| track[i].speed_mps > SET_OFF_MPS).unwrap_or(p.state);
            (set_off..p.state).all(|i| track[i].speed_mps > QUEUED_MPS)
        };
        // Tight turns are slower; flows are given for lanes that go straight on.
        let straight = |p: &&Passage| {
            let track = &film.vehicles[p.vehicle].track;
            let far = |i: &usize| (track[*i].at - track[p.state].at).norm() > THROUGH_M;
            let later = (p.state..track.len()).find(far).unwrap_or(track.len() - 1);
            frames::wrap_pi(track[later].yaw_rad - track[p.state].yaw_rad).abs() < STRAIGHT_RAD
        };
        let car = |p: &&Passage| {
            let body = &film.vehicles[p.vehicle];
            body.size_m[0] < CAR_M && !body.two_wheeled
        };
        let queue: Vec<&Passage> =
            inside.take_while(queued).take_while(flows).take_while(car).take_while(straight).collect();
        let pairs = queue.windows(2).skip(LOST - 1);
        headways_s.extend(pairs.map(|p| (p[1].state - p[0].state) as f64 * DT));
    }
}
