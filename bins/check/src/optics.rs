//! Pictures of cameras: where points fall in them, and where pixels look.

use serde_json::Value;

use crate::space::{V3, norm};

/// Steps in which inverses are looked for.
const STEPS: usize = 60;
/// Directions of tangent lenses are not followed farther off the axis than this tangent.
const MOST_TANGENT: f64 = 19.0;

/// Size, focal lengths, axis and lens of a camera, as its configuration has them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Optics {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Columns and rows.
    focal: [f64; 2],
    axis: [f64; 2],
    lens: Lens,
    /// The same as the configuration writes it.
    pub(crate) lens_written: Value,
    /// Tangent or angle off the axis up to which the lens is one to one.
    limit: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Lens {
    Pinhole,
    Brown { k: [f64; 3], p: [f64; 2] },
    Fisheye { k: [f64; 4] },
}

impl Optics {
    pub(crate) fn of(about: &Value) -> Self {
        let number = |key: &str| about[key].as_f64().unwrap_or(f64::NAN);
        let written = &about["lens"];
        let part = |key: &str, at: usize| written[key][at].as_f64().unwrap_or(f64::NAN);
        let lens = match written["model"].as_str() {
            Some("brown") => {
                Lens::Brown { k: [0, 1, 2].map(|i| part("k", i)), p: [0, 1].map(|i| part("p", i)) }
            }
            Some("fisheye") => Lens::Fisheye { k: [0, 1, 2, 3].map(|i| part("k", i)) },
            _ => Lens::Pinhole,
        };
        let size = |key: &str| about[key].as_u64().unwrap_or(0) as usize;
        Self {
            width: size("width"),
            height: size("height"),
            focal: [number("fx"), number("fy")],
            axis: [number("cx"), number("cy")],
            lens,
            lens_written: written.clone(),
            limit: lens.limit(),
        }
    }

    /// The matrix that calibrations state.
    pub(crate) fn matrix(&self) -> [[f64; 3]; 3] {
        [[self.focal[0], 0.0, self.axis[0]], [0.0, self.focal[1], self.axis[1]], [0.0, 0.0, 1.0]]
    }

    /// Whether straight edges are straight in its pictures.
    pub(crate) fn is_straight(&self) -> bool {
        self.lens == Lens::Pinhole
    }

    /// What a depth image of it holds of a point: how far it is along the axis, of fisheyes how far along the
    /// ray.
    pub(crate) fn depth_of(&self, point: V3) -> f64 {
        if matches!(self.lens, Lens::Fisheye { .. }) { norm(point) } else { point[2] }
    }

    /// Where a point of the optical frame falls, pixels; none where the lens does not look.
    pub(crate) fn project(&self, [x, y, z]: V3) -> Option<[f64; 2]> {
        let place = match self.lens {
            Lens::Pinhole if z > 0.0 => [x / z, y / z],
            Lens::Brown { k, p } if z > 0.0 => {
                let at = [x / z, y / z];
                (libm::hypot(at[0], at[1]) <= self.limit).then(|| brown(k, p, at))?
            }
            Lens::Fisheye { k } => {
                let across = libm::hypot(x, y);
                let angle = libm::atan2(across, z);
                let scale = if across > 0.0 { radius(k, angle) / across } else { 0.0 };
                (angle <= self.limit).then_some([x * scale, y * scale])?
            }
            _ => return None,
        };
        Some([0, 1].map(|i| self.axis[i] + self.focal[i] * place[i]))
    }

    /// The direction in which a place in the picture looks: a surface of depth d is d times as far, by what
    /// depth images of this lens hold: along the axis, of fisheyes along the ray.
    pub(crate) fn ray(&self, [u, v]: [f64; 2]) -> V3 {
        let at = [(u - self.axis[0]) / self.focal[0], (v - self.axis[1]) / self.focal[1]];
        match self.lens {
            Lens::Pinhole => [at[0], at[1], 1.0],
            Lens::Brown { k, p } => {
                let [x, y] = unbent(k, p, self.limit, at);
                [x, y, 1.0]
            }
            Lens::Fisheye { k } => {
                let wanted = libm::hypot(at[0], at[1]);
                let (sin, cos) = libm::sincos(inverse(|angle| radius(k, angle), self.limit, wanted));
                let scale = if wanted > 0.0 { sin / wanted } else { 0.0 };
                [at[0] * scale, at[1] * scale, cos]
            }
        }
    }
}

impl Lens {
    /// How far off the axis the lens is one to one.
    fn limit(&self) -> f64 {
        let (most, of): (f64, &dyn Fn(f64) -> f64) = match self {
            Self::Pinhole => return f64::INFINITY,
            Self::Brown { k, .. } => (MOST_TANGENT, &|at| brown(*k, [0.0; 2], [at, 0.0])[0]),
            Self::Fisheye { k } => (std::f64::consts::PI, &|at| radius(*k, at)),
        };
        let place = |i: usize| most * i as f64 / 4096.0;
        let end = (1..=4096).find(|&i| of(place(i)) <= of(place(i - 1)));
        end.map_or(most, |i| place(i - 1))
    }
}

fn brown([k1, k2, k3]: [f64; 3], [p1, p2]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    let r2 = x * x + y * y;
    let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    [
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    ]
}

/// Where a growing function from 0 to `most` has a value, by halving.
fn inverse(of: impl Fn(f64) -> f64, most: f64, value: f64) -> f64 {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if of(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The place that a Brown lens bends to `bent`. Halving finds it for a lens without tangential parts; from
/// there Newton's method goes on in both directions, by a shorter step where a whole one leads away.
fn unbent(k: [f64; 3], p: [f64; 2], limit: f64, bent: [f64; 2]) -> [f64; 2] {
    let wanted = libm::hypot(bent[0], bent[1]);
    if wanted == 0.0 && p == [0.0; 2] {
        return bent;
    }
    let radial = inverse(|at| brown(k, [0.0; 2], [at, 0.0])[0], limit, wanted);
    let mut place = if wanted > 0.0 { bent.map(|part| part * radial / wanted) } else { bent };
    let rest = |place: [f64; 2]| {
        let there = brown(k, p, place);
        [bent[0] - there[0], bent[1] - there[1]]
    };
    let mut left = rest(place);
    for _ in 0..STEPS {
        let [[a, b], [c, d]] = slopes(k, p, place);
        let determinant = a * d - b * c;
        let step = [(d * left[0] - b * left[1]) / determinant, (a * left[1] - c * left[0]) / determinant];
        let far = libm::hypot(left[0], left[1]);
        let shares = (0..20).map(|halvings| libm::exp2(-f64::from(halvings)));
        let mut tried = shares.map(|share| [place[0] + share * step[0], place[1] + share * step[1]]);
        let nearer = tried.find(|place| {
            let left = rest(*place);
            libm::hypot(left[0], left[1]) < far
        });
        let Some(nearer) = nearer else { break };
        (place, left) = (nearer, rest(nearer));
    }
    place
}

/// Derivatives of [`brown`]: rows are those of its two results by x and y.
fn slopes([k1, k2, k3]: [f64; 3], [p1, p2]: [f64; 2], [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    let r2 = x * x + y * y;
    let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    // By r2.
    let growth = k1 + 2.0 * k2 * r2 + 3.0 * k3 * r2 * r2;
    let across = 2.0 * (x * y * growth + p1 * x + p2 * y);
    [
        [radial + 2.0 * x * x * growth + 2.0 * p1 * y + 6.0 * p2 * x, across],
        [across, radial + 2.0 * y * y * growth + 6.0 * p1 * y + 2.0 * p2 * x],
    ]
}

fn radius([k1, k2, k3, k4]: [f64; 4], angle: f64) -> f64 {
    let a2 = angle * angle;
    let (a3, a5) = (a2 * angle, a2 * a2 * angle);
    angle + k1 * a3 + k2 * a5 + k3 * a5 * a2 + k4 * a5 * a2 * a2
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rays_lead_to_where_points_fall() {
        for lens in [
            json!({"model": "pinhole"}),
            json!({"model": "brown", "k": [-0.3, 0.12, -0.02], "p": [0.001, -0.002]}),
            json!({"model": "fisheye", "k": [-0.02, 0.004, -0.001, 0.0001]}),
        ] {
            let about = json!({"width": 640, "height": 480, "fx": 400, "fy": 410, "cx": 330, "cy": 235, "lens": lens});
            let optics = Optics::of(&about);
            assert_eq!(optics.matrix()[1], [0.0, 410.0, 235.0]);
            for at in [[330.0, 235.0], [0.5, 0.5], [639.5, 479.5], [10.0, 300.0]] {
                let back = optics.project(optics.ray(at).map(|part| 7.0 * part)).expect("is shown");
                assert!(
                    (back[0] - at[0]).abs().max((back[1] - at[1]).abs()) < 1e-9,
                    "{lens} {at:?} {back:?}"
                );
            }
            assert_eq!(optics.project([0.0, 0.0, -1.0]).is_some(), lens["model"] == "fisheye");
        }
    }
    /// The place whose cubic `r + k r^3` is `bent`, by the closed form for one real root (k > 0) or the least
    /// of three.
    fn cubic_root(k: f64, bent: f64) -> f64 {
        let scale = libm::sqrt(3.0 * k.abs());
        let third = 1.5 * bent * scale;
        let part =
            if k > 0.0 { libm::sinh(libm::asinh(third) / 3.0) } else { libm::sin(libm::asin(third) / 3.0) };
        2.0 * part / scale
    }

    #[test]
    fn radial_bends_are_undone_as_the_closed_form_does() {
        // Slopes 1 + 3 k r^2 at the far end, from nearly flat barrels to pincushions of 3 (where r taken off
        // again diverges).
        for slope in [0.02, 0.3, 0.8, 1.5, 2.0, 2.5, 3.0] {
            for end in [0.3, 1.0, 2.5] {
                let k = (slope - 1.0) / (3.0 * end * end);
                let lens = Lens::Brown { k: [k, 0.0, 0.0], p: [0.0; 2] };
                for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                    let bent = (end + k * end * end * end) * share;
                    let want = cubic_root(k, bent);
                    let limit = lens.limit();
                    for turn in [0.0, 0.7, 2.0, 4.5] {
                        let (sin, cos) = libm::sincos(turn);
                        let [x, y] = unbent([k, 0.0, 0.0], [0.0; 2], limit, [bent * cos, bent * sin]);
                        let off = libm::hypot(x - want * cos, y - want * sin);
                        assert!(off < 1e-9, "slope {slope} to {end}, {share} at {turn}: {off}");
                    }
                }
            }
        }
    }

    #[test]
    fn bends_of_all_parts_are_undone() {
        for (k, end) in [
            ([-0.3, 0.12, -0.02], 1.0),
            ([0.4, 0.1, 0.01], 0.9),
            ([0.05, 0.2, 0.05], 1.0),
            ([1.5, -0.3, 0.02], 0.7),
        ] {
            for p in [[0.0; 2], [0.001, -0.002], [-0.05, 0.03]] {
                let limit = Lens::Brown { k, p }.limit();
                for place in [[end, 0.0], [0.0, -end], [0.6 * end, 0.8 * end], [-0.1, 0.02], [0.0, 0.0]] {
                    let [x, y] = unbent(k, p, limit, brown(k, p, place));
                    let off = libm::hypot(x - place[0], y - place[1]);
                    assert!(off < 1e-10, "{k:?} {p:?} {place:?}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn slopes_are_those_of_small_steps() {
        let (k, p, at, h) = ([-0.3, 0.12, -0.02], [0.01, -0.02], [0.4, -0.7], 1e-6);
        let found = slopes(k, p, at);
        for axis in 0..2 {
            let step = |by: f64| {
                let mut place = at;
                place[axis] += by;
                brown(k, p, place)
            };
            let (before, after) = (step(-h), step(h));
            for row in 0..2 {
                let want = (after[row] - before[row]) / (2.0 * h);
                assert!((found[row][axis] - want).abs() < 1e-8, "{row} {axis}: {found:?}");
            }
        }
    }
}
