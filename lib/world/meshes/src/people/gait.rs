//! How somebody walks and runs: the length of a stride by speed, and the way of each foot over it.
//!
//! A cycle is two steps. While a foot is on the ground it goes back, seen from the body, exactly as far as
//! the body goes on: heel, sole and ball stand still one after another. Then it swings through.

use std::f32::consts::TAU;

use catalogue::Age;
use frames::math::f32::sin_cos;
use glam::{Affine3A, Vec3, Vec3A};

use crate::people::figure::{Figure, Side};
use crate::people::joints::{about_y, about_z, frame};

/// Walking speed of somebody of usual height, m/s, and that height, metres.
pub(crate) const USUAL_MPS: f32 = 1.4;
const USUAL_M: f32 = 1.75;
/// Strides are not longer than those of this speed, m/s.
const FASTEST_MPS: f32 = 7.0;
/// Below this speed somebody stands, m/s.
const STANDS_MPS: f32 = 1e-3;
/// How far the toes look outward, radians.
const TOES_OUT: f32 = 0.10;

/// A walk at some speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gait {
    /// Way of a cycle, metres.
    pub(crate) stride: f32,
    /// Share of the cycle that a foot is on the ground.
    pub(crate) duty: f32,
    /// 0 standing still to 1 striding out.
    pub(crate) vigour: f32,
    /// 1 standing still to 0 walking: how much of what is done while one stands is seen.
    pub(crate) idle: f32,
    /// 0 walking to 1 running.
    pub(crate) run: f32,
    /// Middle of a foot's way before the hips, metres.
    ahead: f32,
    /// Angles of the foot as its heel comes down and as its toes leave, radians; height of its swing, metres.
    strike: f32,
    leave: f32,
    lift: f32,
}

/// Where a foot is: at its ankle, and how its toes are bent against it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub(crate) object_from_foot: Affine3A,
    pub(crate) toes_rad: f32,
}

fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

impl Figure {
    /// Speed compared to what is usual of somebody so tall (Froude's scaling).
    fn pace(&self, speed_mps: f32) -> f32 {
        speed_mps.clamp(0.0, FASTEST_MPS) / (USUAL_MPS * (self.stature / USUAL_M).sqrt())
    }

    /// Way that two steps take at a speed, metres: it grows with the root of the speed, as steps become
    /// quicker, too.
    #[must_use]
    pub fn stride_m(&self, speed_mps: f32) -> f32 {
        let share = if self.look.age == Age::Elder { 0.66 } else { 0.77 };
        share * self.stature * self.pace(speed_mps).sqrt()
    }
}

impl Figure {
    /// 0 of somebody who stands to 1 of one who strides out.
    pub(crate) fn vigour(&self, speed_mps: f32) -> f32 {
        if speed_mps < STANDS_MPS { 0.0 } else { (self.stride_m(speed_mps) / (0.75 * self.stature)).min(1.0) }
    }
}

impl Gait {
    pub(crate) fn new(figure: &Figure, speed_mps: f32) -> Self {
        let pace = figure.pace(speed_mps);
        let stride = if speed_mps < STANDS_MPS { 0.0 } else { figure.stride_m(speed_mps) };
        let run = smooth(1.35, 1.75, pace);
        let vigour = figure.vigour(speed_mps);
        let duty = mix(0.65 - 0.05 * pace.min(1.3), (0.46 - 0.05 * pace).max(0.28), run);
        Self {
            stride,
            duty,
            vigour,
            idle: (1.0 - vigour) * (1.0 - vigour),
            run,
            ahead: mix(-0.055, -0.05, run) * figure.stature * vigour,
            strike: mix(0.34, 0.10, run) * vigour,
            leave: mix(0.85, 0.95, run) * vigour,
            lift: mix(0.045, 0.15, run) * figure.stature * vigour,
        }
    }

    /// A foot at a share of its cycle, 0 as it comes down. `hips`: where the hips' middle is over the ground.
    pub(crate) fn foot(&self, figure: &Figure, side: Side, cycle: f32, hips: [f32; 2]) -> Foot {
        let c = cycle - cycle.floor();
        let out = side.sign() * TOES_OUT;
        let at = |x: f32| Vec3::new(hips[0] + x, hips[1] + side.sign() * figure.stance_y, figure.ankle);
        if c < self.duty {
            let (x, angle, pivot) = self.planted(figure, c / self.duty);
            return Foot { object_from_foot: turned(at(x), angle, pivot, out), toes_rad: angle.max(0.0) };
        }
        let w = (c - self.duty) / (1.0 - self.duty);
        let (x1, a1, p1) = self.planted(figure, 1.0);
        let (x0, a0, p0) = self.planted(figure, 0.0);
        let from = Vec3::from(turned(at(x1), a1, p1, out).translation);
        let to = Vec3::from(turned(at(x0), a0, p0, out).translation);
        // It leaves and comes down as fast as the ground goes by (Hermite).
        let slope = -0.8 * self.stride * (1.0 - self.duty);
        let (w2, w3) = (w * w, w * w * w);
        let blend = 3.0 * w2 - 2.0 * w3;
        let x = mix(from.x, to.x, blend) + slope * (w - 3.0 * w2 + 2.0 * w3);
        let rise = 6.75 * w * (1.0 - w) * (1.0 - w);
        let z = mix(from.z, to.z, blend) + self.lift * rise;
        // Runners' heels fly up behind them.
        let angle = if w < 0.6 {
            mix(a1, 0.0, smooth(0.0, 0.6, w)) + self.run * 0.5 * rise
        } else {
            mix(0.0, a0, smooth(0.6, 1.0, w))
        };
        let ankle = Vec3::new(x, mix(from.y, to.y, blend), z);
        let toes = a1.max(0.0) * (1.0 - smooth(0.0, 0.35, w));
        let mut object_from_foot = frame(about_z(out) * about_y(angle), ankle);
        // No part of it drags along the ground.
        let clear = 0.016 * self.vigour * (8.0 * w).min(8.0 * (1.0 - w)).min(1.0);
        object_from_foot.translation.z += (clearance(figure, angle, toes, z) + clear).max(0.0);
        Foot { object_from_foot, toes_rad: toes }
    }

    /// A planted foot, a share of its time on the ground: where its ankle would be were it flat, its angle
    /// (positive: heel up), and what of it stands still, from the ankle: the heel, then the hinge of the
    /// toes.
    fn planted(&self, figure: &Figure, u: f32) -> (f32, f32, Vec3) {
        let x = self.ahead + self.stride * self.duty * (0.5 - u);
        if u < 0.16 {
            let t = 1.0 - u / 0.16;
            return (x, -self.strike * t, Vec3::new(figure.heel, 0.0, -figure.ankle));
        }
        let t = ((u - 0.50) / 0.50).max(0.0);
        (x, self.leave * t * t, figure.hinge())
    }
}

/// A foot that has turned about a place of its own.
fn turned(flat_ankle: Vec3, angle: f32, pivot: Vec3, out: f32) -> Affine3A {
    let turn = about_z(out);
    let still = flat_ankle + Vec3::from(turn * Vec3A::from(pivot));
    let turn = turn * about_y(angle);
    frame(turn, still - Vec3::from(turn * Vec3A::from(pivot)))
}

/// How far the lowest point of a foot and its toes is below the ground.
fn clearance(figure: &Figure, angle: f32, toes: f32, ankle_z: f32) -> f32 {
    let (s, c) = sin_cos(angle);
    let below = |p: Vec3| s * p.x - c * p.z;
    let heel = below(Vec3::new(figure.heel, 0.0, -figure.ankle));
    let hinge = below(figure.hinge());
    let (s, c) = sin_cos(angle - toes);
    let sole = (figure.ankle + figure.hinge().z) * c;
    heel.max(hinge + sole).max(hinge + sole + (figure.toe - figure.ball) * s) - ankle_z
}

/// The share of a foot's cycle at a phase: the right foot comes down half a cycle after the left.
pub(crate) fn cycle(phase_rad: f32, side: Side) -> f32 {
    let c = phase_rad / TAU + if side == Side::Right { 0.5 } else { 0.0 };
    c - c.floor()
}
