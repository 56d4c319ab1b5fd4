//! Banking of fast curves.

use opendrive::Curve;

use crate::path::Path;
use crate::profile::Profile;
use crate::section::CrossSection;

/// Steepest banking, rise over run.
const MOST: f64 = 0.05;
/// Standard gravity, m/s2.
const GRAVITY: f64 = 9.80665;
/// Share of the sideways pull that friction takes; the rest is left to the banking.
const FRICTION: f64 = 0.06;
/// Ends of a road stay level this far, so that it meets its junctions level, metres.
const LEVEL_M: f64 = 5.0;

/// Roll about the reference line, radians, positive where the left side is higher: level in straights,
/// towards the inside in curves, changing along the clothoids. What friction cannot hold of `v^2 / (g r)` is
/// banked, up to 5 %.
pub(crate) fn banking(path: &Path, shape: &CrossSection) -> Profile {
    if !shape.banked {
        return Profile::constant(0.0);
    }
    let speed = shape.limit_kmh / 3.6;
    let roll = |curvature: f64| {
        let needed = (speed * speed * curvature.abs() / GRAVITY - FRICTION).clamp(0.0, MOST);
        // A left curve (positive curvature) falls to the left.
        -curvature.signum() * frames::math::atan(needed)
    };
    let mut knots: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    for (i, piece) in path.pieces.iter().enumerate() {
        let Curve::Arc { curvature } = piece.curve else { continue };
        let value = roll(curvature);
        let (from, to) = (piece.s, piece.s + piece.length_m);
        // Without a clothoid beside it, the arc itself has to be level at that end.
        let eased = |j: Option<usize>| {
            j.and_then(|j| path.pieces.get(j)).is_some_and(|p| matches!(p.curve, Curve::Spiral { .. }))
        };
        if value == 0.0 || !eased(i.checked_sub(1)) || !eased(Some(i + 1)) {
            continue;
        }
        let (before, after) = (path.pieces[i - 1].length_m, path.pieces[i + 1].length_m);
        if from - before < LEVEL_M || to + after > path.length_m - LEVEL_M {
            continue;
        }
        knots.extend([(from - before, 0.0), (from, value), (to, value), (to + after, 0.0)]);
    }
    knots.push((path.length_m, 0.0));
    knots.dedup();
    if knots.len() <= 2 { Profile::constant(0.0) } else { Profile::steps(&knots) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Pose2, Via};
    use crate::section::Side;

    #[test]
    fn fast_curves_fall_to_the_inside() {
        let from = Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        let to = Pose2 { x_m: 400.0, y_m: 400.0, heading_rad: std::f64::consts::FRAC_PI_2 };
        let via = [Via { at_m: [400.0, 0.0], radius_m: 150.0, ease_m: 60.0 }];
        let path = Path::through(from, &via, to);
        let fast = CrossSection::rural(Side::open(1, 3.5, 1.0), 90.0);
        let roll = banking(&path, &fast);
        // 25 m/s on 150 m: 0.42 g, of which 5 % is all that may be banked.
        assert!((roll.at(0.5 * path.length_m) + frames::math::atan(0.05)).abs() < 1e-12);
        assert_eq!([roll.at(0.0), roll.at(path.length_m)], [0.0; 2]);
        let slow = CrossSection { limit_kmh: 30.0, ..fast };
        assert!(banking(&path, &slow).records().is_empty());
    }
}
