//! Pictures of cameras: where points fall in them, and where pixels look.

use serde_json::Value;

use crate::space::{V3, norm};

/// Steps in which inverses are looked for.
const STEPS: usize = 200;
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

    /// What a depth image of it holds of a point: how far it is along the axis, of fisheyes how far along the ray.
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

    /// The direction in which a place in the picture looks: a surface of depth d is d times as far, by what depth images of
    /// this lens hold: along the axis, of fisheyes along the ray.
    pub(crate) fn ray(&self, [u, v]: [f64; 2]) -> V3 {
        let at = [(u - self.axis[0]) / self.focal[0], (v - self.axis[1]) / self.focal[1]];
        match self.lens {
            Lens::Pinhole => [at[0], at[1], 1.0],
            Lens::Brown { k, p } => {
                let [mut x, mut y] = at;
                for _ in 0..STEPS {
                    // What is left over is taken off again: the bend is small against the place itself.
                    let [back_x, back_y] = brown(k, p, [x, y]);
                    let (dx, dy) = (at[0] - back_x, at[1] - back_y);
                    (x, y) = (x + dx, y + dy);
                    if dx.abs().max(dy.abs()) < 1e-13 {
                        break;
                    }
                }
                [x, y, 1.0]
            }
            Lens::Fisheye { k } => {
                let wanted = libm::hypot(at[0], at[1]);
                let (mut low, mut high) = (0.0, self.limit);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if radius(k, middle) < wanted { low = middle } else { high = middle }
                }
                let (sin, cos) = libm::sincos(0.5 * (low + high));
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
}
