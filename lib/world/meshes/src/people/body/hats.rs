//! What is worn on the head.

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::cranium::Head;
use super::shape::strip;
use super::stuffs::Stuffs;
use crate::people::appearance::Hat;
use crate::people::figure::Figure;

pub(super) fn hat(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let top = it.top;
    let shell = MeshPart::new(s.tag, Surface::Plain, f.look.extra_rgb);
    let accent = MeshPart::new(s.tag, Surface::Plain, f.look.accent_rgb);
    let glass = MeshPart::new(s.tag, Surface::Glass, [0.015, 0.016, 0.02]);
    let dark = MeshPart::new(s.tag, Surface::Plain, [0.012, 0.012, 0.014]);
    // From the forehead up a dome, a quarter of an ellipse.
    let crown = |tip: f32| {
        let rise = [0.0f32, 0.42, 0.84, 1.18, 1.42].map(sin_cos);
        let over = rise.map(|(s, c)| (0.700 + (tip - 0.700) * s, 0.412 * c, 0.502 * c, 0.388 * c));
        let mut all = vec![(0.590, 0.402, 0.505, 0.387)];
        all.extend(over);
        all.push((tip, 0.020, 0.025, 0.020));
        all
    };
    match f.look.hat {
        Hat::None => {}
        Hat::Cap => {
            let mut all = crown(top);
            (all[0].0, all[1].0) = (0.610, 0.720);
            it.solid(s.extra, &all);
            it.solid(
                s.extra,
                &[(0.600, 0.700, 0.0, 0.270), (0.618, 0.720, 0.0, 0.300), (0.660, 0.560, 0.0, 0.280)],
            );
        }
        Hat::Beanie => {
            let mut all = crown(top);
            all.insert(0, (0.560, 0.395, 0.510, 0.390));
            it.solid(s.extra, &all);
            let rim = [
                (0.555, 0.400, 0.515, 0.390),
                (0.570, 0.422, 0.535, 0.410),
                (0.640, 0.432, 0.538, 0.416),
                (0.690, 0.424, 0.526, 0.404),
                (0.700, 0.395, 0.500, 0.375),
            ];
            it.solid(s.cloth(f.look.extra_rgb.map(|c| 0.85 * c)), &rim);
            if f.look.face[0] > 0.6 {
                it.blob(accent, [-0.04, 0.0, top - 0.02], [0.10, 0.10, 0.02 + 0.08 * (top - 1.0)], 5, 8);
            }
        }
        Hat::SunHat => {
            it.solid(s.extra, &crown(top));
            it.solid(
                s.extra,
                &[(0.585, 0.720, 0.760, 0.700), (0.600, 0.740, 0.780, 0.720), (0.660, 0.420, 0.510, 0.392)],
            );
            it.solid(s.cloth([0.05; 3]), &[(0.660, 0.422, 0.512, 0.394), (0.730, 0.420, 0.505, 0.392)]);
        }
        Hat::Scarf => {
            // Round the face and down onto the shoulders; the face shows before it.
            it.solid(
                s.extra,
                &[
                    (-0.420, 0.260, 0.430, 0.480),
                    (-0.250, 0.270, 0.380, 0.360),
                    (-0.080, 0.330, 0.390, 0.310),
                    (0.040, 0.320, 0.440, 0.335),
                    (0.200, 0.290, 0.490, 0.365),
                    (0.400, 0.270, 0.510, 0.380),
                    (0.600, 0.330, 0.510, 0.388),
                    (0.720, 0.395, 0.500, 0.380),
                    (0.840, 0.368, 0.445, 0.338),
                    (0.930, 0.270, 0.340, 0.260),
                    (top, 0.070, 0.090, 0.070),
                ],
            );
        }
        Hat::Helmet => {
            it.solid(shell, &crown(top));
            it.solid(
                shell,
                &[(0.600, 0.600, 0.545, 0.440), (0.622, 0.600, 0.545, 0.440), (0.650, 0.425, 0.510, 0.392)],
            );
        }
        Hat::PeakedCap => {
            it.solid(
                shell,
                &[
                    (0.640, 0.400, 0.495, 0.378),
                    (0.780, 0.425, 0.505, 0.395),
                    (0.900, 0.520, 0.560, 0.500),
                    (top - 0.060, 0.500, 0.540, 0.480),
                    (top, 0.300, 0.330, 0.300),
                ],
            );
            it.solid(
                dark,
                &[(0.610, 0.600, 0.0, 0.300), (0.625, 0.610, 0.0, 0.310), (0.690, 0.440, 0.0, 0.330)],
            );
            let band = MeshPart::new(s.tag, Surface::Plain, [0.55, 0.56, 0.58]);
            it.blob(band, [0.440, 0.0, 0.815], [0.040, 0.060, 0.060], 4, 8);
        }
        Hat::FullHelmet => full_helmet(it, shell, accent, glass),
        Hat::BicycleHelmet => {
            let mut all = crown(top);
            all[0] = (0.665, 0.430, 0.530, 0.395);
            all[1] = (0.740, 0.455, 0.560, 0.408);
            it.solid(shell, &all);
            // Vents from front to back, a rim, straps down to the chin.
            for (y, high) in [(-0.24, 0.850), (-0.09, 0.925), (0.09, 0.925), (0.24, 0.850)] {
                it.blob(dark, [0.02, y, high], [0.350, 0.035, 0.075], 4, 8);
            }
            it.solid(
                accent,
                &[(0.655, 0.420, 0.520, 0.388), (0.668, 0.436, 0.538, 0.402), (0.690, 0.430, 0.530, 0.396)],
            );
            for y in [-1.0, 1.0] {
                let line = [(0.68f32, 1.15f32), (0.40, 1.28), (0.12, 1.05), (-0.005, 0.30)];
                let pairs: Vec<[Vec3; 2]> = line
                    .iter()
                    .map(|(t, angle)| {
                        [-0.05, 0.05].map(|d| {
                            let place = it.skull.bare(t.max(0.0), y * (angle + d));
                            it.place(place * Vec3::new(1.03, 1.05, 1.0) + Vec3::Z * t.min(0.0))
                        })
                    })
                    .collect();
                strip(it.b, dark, &pairs, 0.003, false);
            }
        }
    }
}

/// What motorcyclists wear: a shell with a chin bar, a visor, and a stripe over it.
fn full_helmet(it: &mut Head<'_>, shell: MeshPart, accent: MeshPart, glass: MeshPart) {
    let top = it.top;
    it.solid(
        shell,
        &[
            (-0.095, 0.330, 0.330, 0.300),
            (-0.060, 0.470, 0.420, 0.390),
            (0.080, 0.525, 0.490, 0.430),
            (0.230, 0.515, 0.545, 0.455),
            (0.300, 0.475, 0.560, 0.465),
            (0.450, 0.460, 0.580, 0.478),
            (0.620, 0.465, 0.580, 0.478),
            (0.780, 0.455, 0.560, 0.460),
            (0.920, 0.405, 0.500, 0.412),
            (top - 0.140, 0.335, 0.415, 0.345),
            (top - 0.060, 0.235, 0.295, 0.245),
            (top - 0.015, 0.125, 0.160, 0.130),
            (top, 0.040, 0.050, 0.040),
        ],
    );
    it.solid(
        glass,
        &[
            (0.285, 0.470, -0.02, 0.400),
            (0.305, 0.515, -0.02, 0.450),
            (0.400, 0.522, -0.02, 0.470),
            (0.560, 0.512, -0.02, 0.470),
            (0.650, 0.494, -0.02, 0.445),
            (0.665, 0.450, -0.02, 0.400),
        ],
    );
    // A band about the neck, and a stripe from the brow over the crown: `(height, ahead, behind)`.
    it.solid(
        accent,
        &[(-0.075, 0.470, 0.424, 0.392), (-0.040, 0.496, 0.448, 0.410), (0.000, 0.500, 0.456, 0.408)],
    );
    let line = [
        (0.690, 0.470, 0.586),
        (0.780, 0.466, 0.571),
        (0.920, 0.416, 0.511),
        (top - 0.140, 0.346, 0.426),
        (top - 0.060, 0.246, 0.306),
        (top - 0.012, 0.135, 0.170),
        (top + 0.002, 0.0, 0.0),
    ];
    let ahead = line.iter().map(|(t, x, _)| (*t, *x));
    let behind = line.iter().rev().skip(1).map(|(t, _, x)| (*t, -*x));
    let pairs: Vec<[Vec3; 2]> =
        ahead.chain(behind).map(|(t, x)| [-0.085, 0.085].map(|y| it.place(Vec3::new(x, y, t)))).collect();
    strip(it.b, accent, &pairs, 0.010, false);
}
