//! Lenses: where directions fall on a picture, and where pixels look.

use frames::math;
use serde::{Deserialize, Serialize};

/// What bends the rays of a camera. Places are those on a picture of focal length 1 about its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "lowercase")]
pub enum Lens {
    /// Nothing.
    #[default]
    Pinhole,
    /// Brown, "Decentering distortion of lenses", 1966, as OpenCV has it: with x and y the tangents of the
    /// ray and r2 = x x + y y, a ray falls on x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x x),
    /// and on y likewise with p1 (r2 + 2 y y) + 2 p2 x y.
    Brown {
        /// k1, k2, k3.
        k: [f64; 3],
        /// p1, p2.
        p: [f64; 2],
    },
    /// Kannala and Brandt, "A generic camera model and calibration method", 2006, eq. 6, as OpenCV's fisheye
    /// has it: a ray at angle a off the axis falls a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8) away from it.
    /// Without coefficients it is equidistant.
    Fisheye {
        /// k1 to k4.
        k: [f64; 4],
    },
}

/// Directions farther off the axis than this are not looked for through a lens that is made of tangents: 87
/// degrees.
const MOST_TANGENT: f64 = 19.0;
/// Steps in which the end of a lens is searched.
const STEPS: u32 = 4096;
/// Newton's steps: each doubles the digits.
const NEWTON: usize = 40;

/// A lens that bends light, with the part of its formula that is one to one.
#[derive(Clone, Debug, PartialEq)]
pub struct LensModel {
    formula: Formula,
    /// The formula holds up to here: tangent of the angle off the axis (Brown) or the angle itself (fisheye).
    limit: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Formula {
    Brown { k: [f64; 3], p: [f64; 2] },
    Fisheye { k: [f64; 4] },
}

impl LensModel {
    /// The model of a lens; none for pinholes, which bend nothing.
    #[must_use]
    pub fn of(lens: &Lens) -> Option<Self> {
        let formula = match *lens {
            Lens::Pinhole => return None,
            Lens::Brown { k, p } => Formula::Brown { k, p },
            Lens::Fisheye { k } => Formula::Fisheye { k },
        };
        let most = match formula {
            Formula::Brown { .. } => MOST_TANGENT,
            Formula::Fisheye { .. } => std::f64::consts::PI,
        };
        Some(Self { formula, limit: formula.rises_until(most) })
    }

    /// Where a direction falls on a picture of focal length 1 about its axis, and whether the lens shows it:
    /// of what it does not show, where the outermost direction on that side falls.
    #[must_use]
    pub fn project(&self, [x, y, z]: [f64; 3]) -> ([f64; 2], bool) {
        let across = math::hypot(x, y);
        match self.formula {
            Formula::Brown { k, p } => {
                let (tangent, is_ahead) = (across / z, z > 0.0);
                if is_ahead && tangent <= self.limit {
                    return (brown(k, p, [x / z, y / z]), true);
                }
                let scale = if across > 0.0 { self.limit / across } else { 0.0 };
                (brown(k, p, [x * scale, y * scale]), false)
            }
            Formula::Fisheye { k } => {
                let angle = math::atan2(across, z);
                let radius = fisheye(k, angle.min(self.limit));
                let scale = if across > 0.0 { radius / across } else { 0.0 };
                ([x * scale, y * scale], angle <= self.limit)
            }
        }
    }

    /// The direction that falls on a place of a picture of focal length 1 about its axis: 1 long along the
    /// axis (Brown) or 1 long (fisheye). None where the lens shows nothing.
    #[must_use]
    pub fn direction(&self, at: [f64; 2]) -> Option<[f64; 3]> {
        match self.formula {
            Formula::Brown { k, p } => {
                let [x, y] = unbent(k, p, at)?;
                (math::hypot(x, y) <= self.limit).then_some([x, y, 1.0])
            }
            Formula::Fisheye { k } => {
                let radius = math::hypot(at[0], at[1]);
                let angle = angle_of(k, radius, self.limit)?;
                let (sin, cos) = math::sin_cos(angle);
                let scale = if radius > 0.0 { sin / radius } else { 0.0 };
                Some([at[0] * scale, at[1] * scale, cos])
            }
        }
    }
}

impl Formula {
    /// Up to where its radius grows with the angle, at most `most`.
    fn rises_until(&self, most: f64) -> f64 {
        let slope = |at: f64| {
            let s = at * at;
            match *self {
                Self::Brown { k: [k1, k2, k3], .. } => 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3)),
                Self::Fisheye { k: [k1, k2, k3, k4] } => {
                    1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)))
                }
            }
        };
        let step = most / f64::from(STEPS);
        let first = (1..=STEPS).map(|i| f64::from(i) * step).find(|&at| slope(at) <= 0.0);
        first.map_or(most, |at| at - step)
    }
}

/// Brown's formula for a direction's tangents.
fn brown([k1, k2, k3]: [f64; 3], [p1, p2]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    let s = x * x + y * y;
    let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
    let (tangential_x, tangential_y) =
        (2.0 * p1 * x * y + p2 * (s + 2.0 * x * x), p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y);
    [x * radial + tangential_x, y * radial + tangential_y]
}

/// The tangents that Brown's formula takes to a place: Newton's method from the place itself.
fn unbent(k: [f64; 3], p: [f64; 2], at: [f64; 2]) -> Option<[f64; 2]> {
    let [k1, k2, k3] = k;
    let [p1, p2] = p;
    let [mut x, mut y] = at;
    for _ in 0..NEWTON {
        let s = x * x + y * y;
        let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
        let bend = k1 + s * (2.0 * k2 + s * 3.0 * k3);
        let xx = radial + 2.0 * x * x * bend + 2.0 * p1 * y + 6.0 * p2 * x;
        let yy = radial + 2.0 * y * y * bend + 6.0 * p1 * y + 2.0 * p2 * x;
        let xy = 2.0 * x * y * bend + 2.0 * p1 * x + 2.0 * p2 * y;
        let area = xx * yy - xy * xy;
        let [u, v] = brown(k, p, [x, y]);
        let (du, dv) = (u - at[0], v - at[1]);
        // Where the formula folds there is no way back.
        if !(xx > 0.0 && area > 0.0) {
            return None;
        }
        if du.abs().max(dv.abs()) < 1e-14 * (1.0 + at[0].abs() + at[1].abs()) {
            return Some([x, y]);
        }
        x -= (yy * du - xy * dv) / area;
        y -= (xx * dv - xy * du) / area;
    }
    let [u, v] = brown(k, p, [x, y]);
    ((u - at[0]).abs().max((v - at[1]).abs()) < 1e-9).then_some([x, y])
}

/// Kannala and Brandt's radius of an angle.
fn fisheye([k1, k2, k3, k4]: [f64; 4], angle: f64) -> f64 {
    let s = angle * angle;
    angle * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4))))
}

/// The angle whose radius is given, if it is at most `limit`: up to there radii grow. Newton's method within
/// a bracket.
fn angle_of(k: [f64; 4], radius: f64, limit: f64) -> Option<f64> {
    let edge = fisheye(k, limit);
    if radius > edge || !radius.is_finite() || !edge.is_finite() {
        return None;
    }
    let [k1, k2, k3, k4] = k;
    let (mut low, mut high) = (0.0, limit);
    let mut angle = radius.min(limit);
    for _ in 0..2 * NEWTON {
        let off = fisheye(k, angle) - radius;
        if off.abs() < 1e-15 * (1.0 + radius) {
            break;
        }
        if off > 0.0 {
            high = angle
        } else {
            low = angle
        }
        let s = angle * angle;
        let slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)));
        let next = angle - off / slope;
        angle = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    Some(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BROWN: Lens = Lens::Brown { k: [-0.3, 0.12, -0.02], p: [1e-3, -2e-3] };
    const FISHEYE: Lens = Lens::Fisheye { k: [-0.02, 0.004, -0.001, 1e-4] };

    #[test]
    fn formulas_are_those_of_the_books() {
        // Worked out by hand: x = 0.5, y = -0.25, r2 = 0.3125.
        let model = LensModel::of(&Lens::Brown { k: [0.1, 0.2, 0.0], p: [0.01, 0.02] }).expect("bends");
        let radial = 1.0 + 0.03125 + 0.2 * 0.097_656_25;
        let want = [
            0.5 * radial + 2.0 * 0.01 * -0.125 + 0.02 * (0.3125 + 0.5),
            -0.25 * radial + 0.01 * (0.3125 + 0.125) + 2.0 * 0.02 * -0.125,
        ];
        let ([x, y], shown) = model.project([1.0, -0.5, 2.0]);
        assert!(shown && (x - want[0]).abs() < 1e-15 && (y - want[1]).abs() < 1e-15, "{x} {y}");
        // Equidistant: 90 degrees to the right and 45 degrees down are pi / 2 and pi / 4 off the axis.
        let plain = LensModel::of(&Lens::Fisheye { k: [0.0; 4] }).expect("bends");
        let quarter = std::f64::consts::FRAC_PI_2;
        let ([x, y], shown) = plain.project([3.0, 0.0, 0.0]);
        assert!(shown && (x - quarter).abs() < 1e-15 && y == 0.0);
        let ([x, y], _) = plain.project([0.0, 2.0, 2.0]);
        assert!(x == 0.0 && (y - 0.5 * quarter).abs() < 1e-15);
        let bent = LensModel::of(&Lens::Fisheye { k: [0.1, 0.0, 0.0, 0.01] }).expect("bends");
        let ([x, _], _) = bent.project([1.0, 0.0, 0.0]);
        let want = quarter + 0.1 * math::pow(quarter, 3.0) + 0.01 * math::pow(quarter, 9.0);
        assert!((x - want).abs() < 1e-12, "{x} {want}");
        assert_eq!(LensModel::of(&Lens::Pinhole), None);
    }

    #[test]
    fn directions_fall_back_where_they_came_from() {
        for lens in
            [BROWN, FISHEYE, Lens::Fisheye { k: [0.0; 4] }, Lens::Brown { k: [0.4, 0.1, 0.0], p: [0.0; 2] }]
        {
            let model = LensModel::of(&lens).expect("bends");
            for i in 0..40 {
                for j in 0..40 {
                    let at = [f64::from(i - 20) * 0.03, f64::from(j - 20) * 0.02];
                    let direction = model.direction(at).expect("is shown");
                    let (back, shown) = model.project(direction);
                    let off = (back[0] - at[0]).abs().max((back[1] - at[1]).abs());
                    assert!(shown && off < 1e-12, "{lens:?} {at:?}: {off}");
                }
            }
        }
    }

    #[test]
    fn what_a_lens_does_not_show_falls_on_its_edge() {
        // Barrel: the radius r - 0.1 r^3 grows up to r = sqrt(10 / 3) = 1.826, where it is 1.217.
        let model = LensModel::of(&Lens::Brown { k: [-0.1, 0.0, 0.0], p: [0.0; 2] }).expect("bends");
        assert_eq!(model.direction([1.3, 0.0]), None);
        assert!(model.direction([1.2, 0.0]).is_some());
        for outside in [[5.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, -3.0]] {
            let ([x, y], shown) = model.project(outside);
            assert!(!shown && (x - 1.217).abs() < 2e-3 && y == 0.0, "{outside:?}: {x}");
        }
        // Behind an equidistant fisheye is the edge at pi.
        let model = LensModel::of(&Lens::Fisheye { k: [0.0; 4] }).expect("bends");
        assert!(model.direction([3.2, 0.0]).is_none() && model.direction([3.1, 0.0]).is_some());
    }
}
