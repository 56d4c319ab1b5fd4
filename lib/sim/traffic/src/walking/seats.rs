//! Seats on benches, for some of those who wait beside one.

use catalogue::{Model, Special, benches};
use frames::{Object, Pose, World};
use nalgebra::Point3;
use random::Stream;
use schema::Attribute;
use schema::tables::ActorRow;

use crate::walking::crowd::Crowd;

/// Share of those who would stand beside a bench that sit on it instead, if they may and find a seat.
const SIT: f64 = 0.85;
/// Nobody stands nearer to a free seat, metres from the circle about them.
const CLEAR_M: f64 = 0.15;

/// A place on a bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seat {
    /// The middle of the person on it, on the ground.
    pub(crate) point: Point3<f64>,
    /// Away from the back rest.
    pub(crate) yaw_rad: f64,
    /// Height of the seat over the ground, metres.
    pub(crate) seat_m: f64,
}

/// The places on a bench.
pub(crate) fn on_bench(bench: &ActorRow, pose: &Pose<World, Object>) -> [Seat; 2] {
    let ahead_m = benches::BACK_M + benches::SITS_M - 0.5 * bench.length_m;
    benches::PLACES.map(|left| Seat {
        point: pose.isometry() * Point3::new(ahead_m, left * bench.width_m, 0.0),
        yaw_rad: pose.yaw(),
        seat_m: benches::SEAT * bench.height_m,
    })
}

/// Whether somebody of a model may sit: grown-ups of the catalogue who have nothing with them and no uniform.
/// Children's feet would not reach the ground, and models of packs have clothes that only hang.
fn may_sit(model: &Model) -> bool {
    let child = model.facts().get(&Attribute::Age) == Some("child");
    !model.is_of_pack() && model.special == Special::None && model.wheel_radius_m == 0.0 && !child
}

/// The seat that somebody takes who waits beside some, if anybody does: a free one, from which they keep
/// others off.
pub(crate) fn take(seats: &[Seat], model: &Model, crowd: &Crowd, draw: &mut Stream) -> Option<Seat> {
    if seats.is_empty() || !may_sit(model) || !draw.chance(SIT) {
        return None;
    }
    let first = usize::from(draw.chance(0.5));
    let order = (0..seats.len()).map(|k| seats[(first + k) % seats.len()]);
    order.into_iter().find(|seat| crowd.keeps_off(seat.point, CLEAR_M))
}
