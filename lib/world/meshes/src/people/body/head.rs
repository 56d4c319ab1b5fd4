//! Neck, head, hair and hats. Lengths of the head are shares of its own height, from the chin up.

use crate::solids::MeshBuilder;
use catalogue::Age;
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Slice, lofted, slice, solid};
use super::stuffs::Stuffs;
use crate::people::figure::Figure;

use crate::people::appearance::{Hair, Hat};

const SIDES: usize = 11;

/// A head in the making.
struct Head<'a> {
    b: &'a mut MeshBuilder,
    /// Height of the head, and of the chin over the neck's lower end, metres.
    m: f32,
    chin: f32,
    /// The middle of the head before the neck.
    x: f32,
    /// Where the highest point has to be.
    top: f32,
}

impl Head<'_> {
    /// Slices `(height, front, back, half width)`.
    fn cut(&self, shape: &[(f32, f32, f32, f32)]) -> Vec<Slice> {
        let m = self.m;
        shape
            .iter()
            .map(|(t, front, back, half)| {
                slice(self.chin + t * m, front * m, back * m, half * m).at(self.x, 0.0)
            })
            .collect()
    }

    fn solid(&mut self, part: MeshPart, shape: &[(f32, f32, f32, f32)]) {
        let slices = self.cut(shape);
        lofted(self.b, &slices, SIDES, 0.95, |_, _| part);
    }

    fn blob(&mut self, part: MeshPart, [x, y, t]: [f32; 3], half: [f32; 3], rings: usize, sides: usize) {
        let m = self.m;
        let middle = Vec3::new(self.x + x * m, y * m, self.chin + t * m);
        self.b.ellipsoid(part, middle, Vec3::from_array(half) * m, rings, sides);
    }
}

pub(super) fn head(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let broad = if f.look.woman { 0.88 } else { 1.0 };
    let neck = |z: f32, front: f32, back: f32, half: f32| {
        slice(z, front * h * broad, back * h * broad, half * h * broad)
    };
    let covered = f.look.hat == Hat::Scarf;
    solid(
        b,
        if covered { s.extra } else { s.skin },
        &[
            neck(-0.022 * h, 0.038, 0.044, 0.048),
            neck(0.0, 0.031, 0.037, 0.036),
            neck(0.5 * f.neck_m, 0.030, 0.034, 0.032),
            neck(f.neck_m + 0.20 * f.head, 0.034, 0.034, 0.033),
        ],
        10,
    );
    let top = 1.0 + Figure::hat_share(&f.look) * h / f.head;
    let mut it = Head { b, m: f.head, chin: f.neck_m, x: 0.010 * h, top };
    face(&mut it, f, s);
    if !matches!(f.look.hat, Hat::Scarf | Hat::FullHelmet) {
        hair(&mut it, f, s);
    }
    hat(&mut it, f, s);
}

fn face(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    // Jaws of men are broader, children's faces rounder.
    let jaw = match (f.look.age, f.look.woman) {
        (Age::Child, _) => 0.95,
        (_, true) => 0.88,
        _ => 1.0,
    };
    it.solid(
        s.skin,
        &[
            (0.000, 0.300, 0.060, 0.080 * jaw),
            (0.030, 0.345, 0.140, 0.150 * jaw),
            (0.090, 0.370, 0.250, 0.215 * jaw),
            (0.180, 0.380, 0.330, 0.268 * jaw),
            (0.290, 0.385, 0.385, 0.300),
            (0.400, 0.378, 0.420, 0.322),
            (0.470, 0.372, 0.435, 0.330),
            (0.530, 0.390, 0.445, 0.335),
            (0.640, 0.388, 0.450, 0.337),
            (0.760, 0.350, 0.425, 0.312),
            (0.860, 0.285, 0.360, 0.258),
            (0.930, 0.205, 0.270, 0.190),
            (0.980, 0.090, 0.130, 0.090),
        ],
    );
    let dark = s.cloth([0.03, 0.02, 0.015]);
    let lips = s.cloth(std::array::from_fn(|k| f.look.skin_rgb[k] * [0.75, 0.48, 0.48][k]));
    it.blob(s.skin, [0.400, 0.0, 0.335], [0.070, 0.052, 0.055], 4, 6);
    it.blob(s.skin, [0.372, 0.0, 0.420], [0.045, 0.036, 0.085], 4, 6);
    it.blob(lips, [0.368, 0.0, 0.190], [0.026, 0.095, 0.022], 3, 6);
    for y in [-1.0, 1.0] {
        it.blob(s.skin, [-0.02, y * 0.330, 0.400], [0.060, 0.035, 0.100], 4, 6);
        it.blob(dark, [0.345, y * 0.140, 0.470], [0.032, 0.046, 0.024], 3, 6);
        it.blob(s.hair, [0.358, y * 0.145, 0.545], [0.034, 0.072, 0.014], 3, 6);
    }
    let beard = !f.look.woman && matches!(f.look.age, Age::Adult | Age::Elder) && f.look.hair == Hair::Thin;
    if beard {
        it.solid(
            s.hair,
            &[
                (-0.035, 0.300, 0.050, 0.100),
                (0.020, 0.372, 0.150, 0.185),
                (0.090, 0.386, 0.230, 0.238),
                (0.150, 0.368, 0.240, 0.276),
                (0.330, 0.230, 0.150, 0.316),
                (0.400, 0.100, 0.100, 0.310),
            ],
        );
    }
}

fn hair(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    // What is seen under a hat: the sides and the back only.
    let bare = f.look.hat == Hat::None;
    let top = it.top;
    match f.look.hair {
        Hair::Thin => {
            it.solid(
                s.hair,
                &[
                    (0.160, 0.020, 0.360, 0.270),
                    (0.300, 0.060, 0.432, 0.325),
                    (0.450, 0.100, 0.468, 0.352),
                    (0.620, 0.090, 0.480, 0.354),
                    (0.740, 0.020, 0.440, 0.322),
                    (0.800, 0.000, 0.390, 0.280),
                ],
            );
        }
        Hair::Curls if bare => {
            let middle = 0.62;
            let half = top - middle;
            it.blob(s.hair, [-0.085, 0.0, middle], [0.460, 0.430, half], 9, 14);
            it.blob(s.hair, [-0.170, 0.0, 0.40], [0.370, 0.390, 0.260], 7, 12);
        }
        style => {
            let long = matches!(style, Hair::Bob | Hair::Long);
            let thick = if long { 1.05 } else { 1.0 };
            let cap = [
                (0.130, 0.000, 0.340, 0.255),
                (0.270, 0.050, 0.430, 0.305),
                (0.400, 0.085, 0.472, 0.345 * thick),
                (0.540, 0.190, 0.492, 0.366 * thick),
                (0.640, 0.320, 0.494, 0.374 * thick),
                (0.710, 0.385, 0.484, 0.368 * thick),
                (0.800, 0.362, 0.448, 0.336),
                (0.890, 0.288, 0.368, 0.268),
                (0.960, 0.175, 0.240, 0.170),
                (top, 0.050, 0.070, 0.050),
            ];
            // A hat hides what is above its rim.
            it.solid(s.hair, if bare { &cap } else { &cap[..7] });
            if long {
                it.solid(
                    s.hair,
                    &[
                        (-0.060, -0.060, 0.370, 0.300),
                        (0.000, 0.020, 0.440, 0.365),
                        (0.200, 0.070, 0.475, 0.385),
                        (0.420, 0.110, 0.490, 0.385),
                        (0.600, 0.190, 0.485, 0.375),
                        (0.760, 0.150, 0.400, 0.300),
                    ],
                );
            }
            if style == Hair::Long {
                it.solid(
                    s.hair,
                    &[
                        (-0.640, -0.420, 0.520, 0.150),
                        (-0.560, -0.350, 0.545, 0.225),
                        (-0.300, -0.250, 0.530, 0.275),
                        (0.000, -0.120, 0.490, 0.315),
                        (0.300, -0.050, 0.470, 0.330),
                    ],
                );
            }
            if style == Hair::Bun {
                it.blob(s.hair, [-0.480, 0.0, 0.660], [0.150, 0.160, 0.150], 6, 10);
            }
            if style == Hair::Ponytail {
                let m = it.m;
                let at = |x: f32, t: f32| Vec3::new(it.x + x * m, 0.0, it.chin + t * m);
                let tail = [at(-0.44, 0.66), at(-0.62, 0.54), at(-0.64, 0.20), at(-0.58, -0.25)];
                let radius = [0.075, 0.105, 0.100, 0.030].map(|r| r * m);
                for k in 0..3 {
                    it.b.bar(s.hair, tail[k], tail[k + 1], [radius[k], radius[k + 1]], 9);
                    it.b.ellipsoid(s.hair, tail[k + 1], Vec3::splat(0.98 * radius[k + 1]), 5, 9);
                }
            }
        }
    }
}

fn hat(it: &mut Head<'_>, f: &Figure, s: &Stuffs) {
    let top = it.top;
    let shell = MeshPart::new(s.tag, Surface::Plain, f.look.extra_rgb);
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
            all.insert(0, (0.500, 0.395, 0.510, 0.390));
            it.solid(s.extra, &all);
            let rim = f.look.extra_rgb.map(|c| 0.7 * c);
            it.solid(s.cloth(rim), &[(0.520, 0.415, 0.530, 0.405), (0.650, 0.425, 0.525, 0.405)]);
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
        Hat::FullHelmet => {
            it.solid(
                shell,
                &[
                    (-0.080, 0.300, 0.330, 0.300),
                    (-0.020, 0.440, 0.440, 0.390),
                    (0.200, 0.480, 0.520, 0.430),
                    (0.450, 0.470, 0.570, 0.455),
                    (0.700, 0.455, 0.560, 0.445),
                    (0.880, 0.370, 0.455, 0.370),
                    (top - 0.060, 0.240, 0.300, 0.240),
                    (top, 0.070, 0.090, 0.070),
                ],
            );
            it.solid(
                dark,
                &[
                    (0.310, 0.495, 0.0, 0.400),
                    (0.380, 0.505, 0.0, 0.430),
                    (0.600, 0.490, 0.0, 0.430),
                    (0.650, 0.470, 0.0, 0.400),
                ],
            );
        }
        Hat::BicycleHelmet => {
            let mut all = crown(top);
            all[0] = (0.650, 0.430, 0.530, 0.395);
            all[1] = (0.740, 0.455, 0.560, 0.405);
            it.solid(shell, &all);
            for y in [-0.18, 0.0, 0.18] {
                let high = if y == 0.0 { 0.935 } else { 0.890 };
                it.blob(dark, [-0.02, y, high], [0.330, 0.040, 0.065], 4, 8);
            }
        }
    }
}
