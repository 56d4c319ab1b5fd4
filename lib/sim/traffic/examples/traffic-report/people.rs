//! How people move: how fast they walk, turn, and change their velocity.

use super::film::{Body, DT, Film};

/// Slower than this somebody stands, m/s.
const STANDS_MPS: f64 = 0.3;

/// One kind's figures.
#[derive(Debug, Default)]
pub(crate) struct Moves {
    /// Of those who walk, m/s.
    pub(crate) speed_mps: Vec<f64>,
    /// Turning while standing and while walking, degrees per second.
    pub(crate) turn_standing_degps: Vec<f64>,
    pub(crate) turn_walking_degps: Vec<f64>,
    /// Change of velocity in the plane, and up and down, m/s2.
    pub(crate) acceleration: Vec<f64>,
    pub(crate) upwards: Vec<f64>,
    /// Velocity across the heading of those who walk, as a share of their speed.
    pub(crate) aside: Vec<f64>,
    /// Greatest acceleration and turn: state, walker.
    pub(crate) worst_acceleration: Option<(f64, usize, u16)>,
    pub(crate) worst_turn: Option<(f64, usize, u16)>,
}

/// Walkers whom nothing has hit.
#[derive(Debug, Default)]
pub(crate) struct People {
    pub(crate) on_foot: Moves,
    /// Wheelchairs and prams.
    pub(crate) rolling: Moves,
}

pub(crate) fn measure(film: &Film<'_>) -> People {
    let mut people = People::default();
    for body in film.walkers.iter().filter(|b| !b.sits) {
        let moves = if body.rolls { &mut people.rolling } else { &mut people.on_foot };
        add(body, body.touched.unwrap_or(film.states), moves);
    }
    people
}

fn add(body: &Body, end: usize, moves: &mut Moves) {
    for i in 2..end {
        let [a, b, c] = [i - 2, i - 1, i].map(|k| &body.track[k]);
        let speed_mps = (c.at - b.at).xy().norm() / DT;
        let turn_degps = (frames::wrap_pi(c.yaw_rad - b.yaw_rad) / DT).to_degrees().abs();
        let change = ((c.at - b.at) - (b.at - a.at)) / (DT * DT);
        let acceleration = change.xy().norm();
        moves.acceleration.push(acceleration);
        moves.upwards.push(change.z.abs());
        if speed_mps < STANDS_MPS {
            moves.turn_standing_degps.push(turn_degps);
        } else {
            moves.speed_mps.push(speed_mps);
            moves.turn_walking_degps.push(turn_degps);
            let [_, left] = c.local(&b.at);
            moves.aside.push(left.abs() / (DT * speed_mps));
        }
        for (worst, value) in
            [(&mut moves.worst_acceleration, acceleration), (&mut moves.worst_turn, turn_degps)]
        {
            if worst.is_none_or(|w| value > w.0) {
                *worst = Some((value, i, body.id));
            }
        }
    }
}
