//! Boxes that are held against each other.

use frames::math;
use schema::{AgentId, Difficulty};

/// A frame of an ego.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SampleId {
    /// Number of the scene.
    pub scene: u32,
    /// Frame number.
    pub frame: u32,
    /// The ego.
    pub ego: AgentId,
}

/// A box in the world, as far as metrics look at it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solid {
    /// Its middle, m.
    pub center_m: [f64; 3],
    /// Length, width, height, m.
    pub size_m: [f64; 3],
    /// Where its forward axis points, about the world's up axis from x to y, rad.
    pub yaw_rad: f64,
    /// Its velocity in the plane, m/s; NaN where it is not known.
    pub velocity_mps: [f64; 2],
}

impl Solid {
    /// Distance of the middles in the plane, m.
    pub(crate) fn planar_distance_m(&self, other: &Self) -> f64 {
        self.away_m(other.center_m)
    }

    /// How far the middle is from a place in the plane, m.
    pub(crate) fn away_m(&self, from_m: [f64; 3]) -> f64 {
        let away = [0, 1].map(|axis| self.center_m[axis] - from_m[axis]);
        (away[0] * away[0] + away[1] * away[1]).sqrt()
    }

    /// Distance of the middles, m.
    pub(crate) fn distance_m(&self, other: &Self) -> f64 {
        let away = [0, 1, 2].map(|axis| self.center_m[axis] - other.center_m[axis]);
        (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt()
    }

    /// How unlike the sizes are: 1 less the overlap over the union of both boxes, laid upon each other with
    /// their middles and axes, in 0..=1.
    pub(crate) fn scale_error(&self, other: &Self) -> f64 {
        let volume = |size: [f64; 3]| size[0] * size[1] * size[2];
        let common = volume([0, 1, 2].map(|axis| self.size_m[axis].min(other.size_m[axis])));
        1.0 - common / (volume(self.size_m) + volume(other.size_m) - common)
    }

    /// How unlike the headings are, rad, in 0..=`period` / 2.
    pub(crate) fn yaw_error_rad(&self, other: &Self, period_rad: f64) -> f64 {
        let turn = (self.yaw_rad - other.yaw_rad + period_rad / 2.0).rem_euclid(period_rad);
        (turn - period_rad / 2.0).abs()
    }

    /// Difference of the velocities in the plane, m/s; NaN where one of them is not known.
    pub(crate) fn velocity_error_mps(&self, other: &Self) -> f64 {
        let off = [0, 1].map(|axis| self.velocity_mps[axis] - other.velocity_mps[axis]);
        (off[0] * off[0] + off[1] * off[1]).sqrt()
    }

    /// The same box; at rest where its velocity is not known.
    pub(crate) fn at_rest_where_unknown(mut self) -> Self {
        if self.velocity_mps.iter().any(|v| v.is_nan()) {
            self.velocity_mps = [0.0; 2];
        }
        self
    }
}

/// Where the forward axis of a rotation points, about the world's up axis, rad; none of a quaternion (w, x,
/// y, z) that is no rotation.
pub(crate) fn yaw_of(quaternion: [f64; 4]) -> Option<f64> {
    let norm = quaternion.iter().map(|part| part * part).sum::<f64>();
    if !(norm.is_finite() && norm > 1e-12) {
        return None;
    }
    let [w, x, y, z] = quaternion;
    let (forward_x, forward_y) = (w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z));
    Some(math::atan2(forward_y, forward_x))
}

/// Whose lidars have points of a box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sighting {
    /// Nobody's of those that count.
    #[default]
    Nobody,
    /// Those of the ego, whoever else sees them.
    Ego,
    /// Those of partners alone.
    Partners,
}

/// A box that is to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Number of its class among those of the metric.
    pub class: usize,
    /// The box.
    pub solid: Solid,
    /// How far its middle is from the ego in the plane, m.
    pub distance_m: f64,
    /// How hard it is to find.
    pub difficulty: Difficulty,
    /// Whose lidars it has points of.
    pub sighting: Sighting,
    /// Its attribute, where it has one (nuScenes).
    pub attribute: Option<u8>,
}

/// A box that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Number of its class among those of the metric.
    pub class: usize,
    /// How sure it is: the higher the surer.
    pub score: f64,
    /// The box.
    pub solid: Solid,
    /// How far its middle is from the ego in the plane, m.
    pub distance_m: f64,
    /// Its attribute, where one is said (nuScenes).
    pub attribute: Option<u8>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_is_that_of_the_forward_axis() {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
        let (s, c) = (math::sin(FRAC_PI_4 / 2.0), math::cos(FRAC_PI_4 / 2.0));
        let yaw = |q| yaw_of(q).expect("is a rotation");
        assert!((yaw([c, 0.0, 0.0, s]) - FRAC_PI_4).abs() < 1e-12);
        // Of any length; turned over about its own forward axis it points where it pointed.
        assert!((yaw([3.0 * c, 0.0, 0.0, 3.0 * s]) - FRAC_PI_4).abs() < 1e-12);
        assert!((yaw([-0.5, -0.5, -0.5, -0.5]) - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(yaw([0.0, 1.0, 0.0, 0.0]), 0.0);
        assert_eq!(yaw_of([0.0; 4]), None);
        assert_eq!(yaw_of([1.0, f64::NAN, 0.0, 0.0]), None);
    }

    #[test]
    fn errors_are_those_of_their_definitions() {
        let one = Solid { size_m: [4.0, 2.0, 1.0], yaw_rad: 3.0, ..Solid::default() };
        let other = Solid {
            center_m: [3.0, 4.0, 12.0],
            size_m: [2.0, 2.0, 2.0],
            yaw_rad: -3.0,
            velocity_mps: [3.0, -4.0],
        };
        let turn = std::f64::consts::TAU;
        assert_eq!((one.planar_distance_m(&other), one.distance_m(&other)), (5.0, 13.0));
        assert!((one.scale_error(&other) - (1.0 - 4.0 / 12.0)).abs() < 1e-12);
        assert!((one.yaw_error_rad(&other, turn) - (turn - 6.0)).abs() < 1e-12);
        assert!((one.yaw_error_rad(&other, turn / 2.0) - (turn - 6.0)).abs() < 1e-12);
        assert_eq!(one.velocity_error_mps(&other), 5.0);
    }
}
