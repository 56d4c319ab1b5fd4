//! How people beside the road keep out of what long vehicles sweep there.

use nalgebra::{Point3, Vector2};

use crate::swept_path::SweptPaths;
use crate::walking::crowd::DesiredVelocity;

/// A walker in the way of a vehicle's corner steps back as fast as this, m/s, and looks this far ahead,
/// seconds.
const STEPS_BACK_MPS: f64 = 1.4;
const STEPS_BACK_S: f64 = 0.5;
/// It looks for room this far around, metres.
const STEP_M: f64 = 0.8;

/// The wish of a walker at a place beside the road, given what else it wishes for: out of the way of what may
/// come there, or not into it.
pub(crate) fn out_of_the_way(
    sweeps: &SweptPaths,
    at: &Point3<f64>,
    radius_m: f64,
    wish: DesiredVelocity,
) -> DesiredVelocity {
    let left = Vector2::new(-wish.ahead.y, wish.ahead.x);
    let after = |step: Vector2<f64>| Point3::new(at.x + step.x, at.y + step.y, at.z);
    let next = after(wish.ahead * (wish.speed_mps * STEPS_BACK_S));
    if !sweeps.is_swept(at, radius_m) {
        let into = sweeps.is_swept(&next, radius_m);
        return if into { DesiredVelocity { speed_mps: 0.0, ..wish } } else { wish };
    }
    // On the sidewalk, to wherever there is most room.
    let asides = [wish.room_m[0].clamp(-STEP_M, -0.3), 0.0, wish.room_m[1].clamp(0.3, STEP_M)];
    let steps =
        [0.0, -STEP_M, STEP_M].into_iter().flat_map(|on| asides.map(|aside| wish.ahead * on + left * aside));
    let mut best = (f64::NEG_INFINITY, Vector2::zeros());
    for step in steps {
        let clear_m = sweeps.clear_m(&after(step), radius_m);
        if clear_m > best.0 + 1e-6 {
            best = (clear_m, step);
        }
    }
    let ahead = best.1.try_normalize(1e-6).unwrap_or(wish.ahead);
    let speed_mps = if best.1.norm() > 0.0 { STEPS_BACK_MPS } else { 0.0 };
    DesiredVelocity { ahead, speed_mps, aside_m: 0.0, room_m: [-0.3, 0.3] }
}
