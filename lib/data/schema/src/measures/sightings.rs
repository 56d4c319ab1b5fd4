//! What `postprocess-valid` counts of the boxes that agents saw, agent by agent: an object that two agents
//! see counts twice.

/// Boxes by distance and lidar points in them, those with a point. Class: detection class; bin:
/// [`bin_of_points`].
pub const LIDAR_POINTS_AT: &str = "lidar_points_at";
/// The same of radar points.
pub const RADAR_POINTS_AT: &str = "radar_points_at";
/// Boxes around data-collection vehicles by place. Class: detection class; bin: [`bin_of_place`].
pub const SEEN_BY_VEHICLES: &str = "seen_by_vehicles";
/// The same around road-side units.
pub const SEEN_BY_RSUS: &str = "seen_by_rsus";

/// Width of a bin of distances, m, and how many there are.
pub const POINTS_STEP_M: f64 = 5.0;
/// Bins of distances to 120 m.
pub const POINTS_STEPS: i32 = 24;
/// Bins of points to each factor of ten.
pub const LEVELS_PER_DECADE: f64 = 8.0;
/// Bins of points, up to 100,000.
pub const LEVELS: i32 = 40;
/// Side of a square of places around an agent, m.
pub const PLACE_M: f64 = 5.0;
/// Squares along each side of what is counted: to 200 m ahead, behind, left and right.
pub const PLACES: i32 = 80;

/// The bin of a box with so many points (at least one) at a distance; none beyond the last.
#[must_use]
pub fn bin_of_points(distance_m: f64, points: u32) -> Option<i32> {
    let step = (distance_m / POINTS_STEP_M).floor();
    if points == 0 || !(0.0..f64::from(POINTS_STEPS)).contains(&step) {
        return None;
    }
    let level = (LEVELS_PER_DECADE * frames::math::log10(f64::from(points))).floor() as i32;
    Some(step as i32 * LEVELS + level.min(LEVELS - 1))
}

/// The bin of a box at an angle to the left of an agent's forward axis, rad, and a distance, m: a square, row
/// by row from the far left, as BEV masks are. None beyond the last.
#[must_use]
pub fn bin_of_place(angle_rad: f64, distance_m: f64) -> Option<i32> {
    let (sin, cos) = frames::math::sin_cos(angle_rad);
    let half = 0.5 * f64::from(PLACES);
    let square = |from_middle: f64| {
        Some((half - from_middle / PLACE_M).floor()).filter(|n| (0.0..2.0 * half).contains(n))
    };
    let (row, column) = (square(distance_m * cos)?, square(distance_m * sin)?);
    Some(row as i32 * PLACES + column as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_hold_what_they_should() {
        assert_eq!(bin_of_points(0.0, 1), Some(0));
        assert_eq!(bin_of_points(5.0, 9), Some(LEVELS + 7));
        assert_eq!(bin_of_points(119.9, 10), Some(23 * LEVELS + 8));
        assert_eq!(bin_of_points(1.0, u32::MAX), Some(LEVELS - 1));
        assert_eq!([bin_of_points(120.0, 9), bin_of_points(3.0, 0), bin_of_points(f64::NAN, 3)], [None; 3]);
        // 30 m ahead: 170 m from the edge, square 34; a little to the left of the middle and a little to the
        // right.
        assert_eq!(bin_of_place(0.001, 30.0), Some(34 * PLACES + 39));
        assert_eq!(bin_of_place(-0.001, 30.0), Some(34 * PLACES + 40));
        // 62 m to the left, 62 m behind on the right, in the corner beyond the circle of 200 m.
        assert_eq!(bin_of_place(std::f64::consts::FRAC_PI_2 - 0.001, 62.0), Some(39 * PLACES + 27));
        let corner = std::f64::consts::FRAC_PI_4;
        assert_eq!(bin_of_place(-3.0 * corner, 62.0 * 2.0_f64.sqrt()), Some(52 * PLACES + 52));
        assert_eq!(bin_of_place(corner, 199.0 * 2.0_f64.sqrt()), Some(0));
        assert_eq!(
            [bin_of_place(0.001, 200.1), bin_of_place(f64::NAN, 1.0), bin_of_place(0.0, f64::NAN)],
            [None; 3]
        );
    }
}
