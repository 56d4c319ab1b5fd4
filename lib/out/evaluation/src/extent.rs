//! The part of the ego's surroundings in which boxes count.

use crate::boxes::Solid;
use crate::targets::Pose;

/// A rectangle in the ego's frame, x ahead and y to the left, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Its least x and y.
    pub from_m: [f64; 2],
    /// Its greatest x and y.
    pub to_m: [f64; 2],
}

impl Extent {
    /// Whether a box in the world has its middle in it, edges included.
    pub(crate) fn holds(&self, ego: &Pose, solid: &Solid) -> bool {
        let (sin, cos) = frames::math::sin_cos(ego.yaw_rad);
        let [x, y] = [0, 1].map(|axis| solid.center_m[axis] - ego.xyz_m[axis]);
        let local = [x * cos + y * sin, y * cos - x * sin];
        (0..2).all(|axis| self.from_m[axis] <= local[axis] && local[axis] <= self.to_m[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_turns_with_the_ego() {
        // The ego looks along y: 30 m ahead of it, 5 m to its left.
        let ego = Pose { id: 1, xyz_m: [100.0, 50.0, 0.0], yaw_rad: std::f64::consts::FRAC_PI_2 };
        let solid = Solid { center_m: [95.0, 80.0, 3.0], ..Solid::default() };
        let holds = |from_m, to_m| Extent { from_m, to_m }.holds(&ego, &solid);
        assert!(holds([0.0, 0.0], [31.0, 6.0]) && holds([29.9, 4.9], [30.1, 5.1]));
        assert!(!holds([0.0, -6.0], [31.0, 0.0]) && !holds([0.0, 0.0], [29.0, 6.0]));
    }
}
