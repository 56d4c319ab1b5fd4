//! Rigs: where the bones of people are in a posture of the object that they walk, ride or sit in.

use std::f32::consts::PI;

use crate::people::{Figure, Seat, Walker, about_y};
use frames::math::f32::{cos, sin, sin_cos};
use glam::{Vec3, Vec3A};

use crate::actors::posture::Posture;

/// What moves bones.
#[derive(Clone, Debug)]
pub enum Rig {
    /// A walker's gait, or how it sits on a bench.
    Walks(Walker),
    /// Somebody on a two-wheeler.
    Rides(Rider),
    /// Somebody in a wheelchair.
    Pushes(Pusher),
}

impl Rig {
    /// A posture with its bones.
    #[must_use]
    pub fn posed(&self, posture: Posture) -> Posture {
        let bones = match self {
            Self::Walks(walker) => walker.bones(posture.phase_rad, posture.gait_mps, posture.seat_m),
            Self::Rides(rider) => rider.figure.seated(&rider.seat_at(posture.phase_rad)),
            Self::Pushes(pusher) => pusher.figure.seated(&pusher.seat_at(posture.phase_rad)),
        };
        Posture { bones: Some(bones), ..posture }
    }
}

/// Pedals that feet stand on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pedals {
    /// Axle of the crank, object frame, metres.
    pub crank: Vec3,
    /// Length of a crank, metres.
    pub arm_m: f32,
    /// How far each pedal's middle is from the frame's plane, metres.
    pub aside_m: f32,
    /// Turns of the crank for one of the wheels.
    pub gear: f32,
}

impl Pedals {
    /// From the crank's axle to the left (1) or right (-1) pedal while the crank stands at 0.
    pub(crate) fn arm(&self, side: f32) -> Vec3 {
        Vec3::new(0.0, side * self.aside_m, side * self.arm_m)
    }
}

/// The rider of a two-wheeler.
#[derive(Clone, Debug)]
pub struct Rider {
    /// Who.
    pub figure: Figure,
    /// How they sit.
    pub seat: Seat,
    /// A bicycle's pedals.
    pub pedals: Option<Pedals>,
}

impl Rider {
    fn seat_at(&self, phase_rad: f32) -> Seat {
        let Some(pedals) = &self.pedals else { return self.seat };
        let turn = about_y(pedals.gear * phase_rad);
        let ball =
            |side: f32| pedals.crank + Vec3::from(turn * Vec3A::from(pedals.arm(side))) + Vec3::Z * PEDAL_M;
        Seat { balls: [ball(1.0), ball(-1.0)], ..self.seat }
    }
}

/// Half the height of a pedal, metres.
pub(crate) const PEDAL_M: f32 = 0.012;

/// A person in a wheelchair who pushes its wheels.
#[derive(Clone, Debug)]
pub struct Pusher {
    /// Who.
    pub figure: Figure,
    /// How they sit.
    pub seat: Seat,
    /// Axle of the wheels, object frame, metres.
    pub axle: Vec3,
    /// Radius of the hand rims, metres.
    pub rim_m: f32,
    /// How far the hands are from the middle, metres.
    pub aside_m: f32,
}

/// A push begins behind the top of the wheel and turns it so far while the hand holds on; the hand then goes
/// back over as much.
const PUSH_FROM_RAD: f32 = -0.50;
const PUSH_RAD: f32 = 1.25;
/// How far the hands are off the rims on their way back, metres.
const BACK_M: f32 = 0.06;

impl Pusher {
    /// Hands at a rotation of the wheels.
    fn seat_at(&self, phase_rad: f32) -> Seat {
        let turned = phase_rad.rem_euclid(2.0 * PUSH_RAD);
        let (angle, off) = if turned < PUSH_RAD {
            (PUSH_FROM_RAD + turned, 0.0)
        } else {
            let w = (turned - PUSH_RAD) / PUSH_RAD;
            (PUSH_FROM_RAD + 0.5 * PUSH_RAD * (1.0 + cos(PI * w)), BACK_M * sin(PI * w))
        };
        let (s, c) = sin_cos(angle);
        let hand = |side: f32| {
            self.axle + Vec3::new((self.rim_m + off) * s, side * self.aside_m, (self.rim_m + off) * c)
        };
        Seat { hands: [hand(1.0), hand(-1.0)], ..self.seat }
    }
}
