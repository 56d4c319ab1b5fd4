//! Hips and chest, with what is worn on them and carried on the back.

use crate::solids::MeshBuilder;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::shape::{Slice, lofted, slice, solid};
use super::stuffs::Stuffs;
use crate::people::appearance::{Appearance, Bottom, Build, Carried, Top};
use crate::people::figure::Figure;

const SIDES: usize = 12;
const BAND: [f32; 3] = [0.75, 0.76, 0.74];

/// How thick the clothes on the trunk are, as a factor.
fn cloth(look: &Appearance) -> f32 {
    match look.top {
        Top::Coat => 1.10,
        Top::Jacket | Top::Hoodie | Top::HiVis => 1.08,
        Top::Suit | Top::Uniform => 1.05,
        _ => 1.0,
    }
}

pub(super) fn pelvis(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let g = f.look.girth();
    let wide = if f.look.woman { 1.06 } else { 1.0 } * g;
    let cut = |z: f32, front: f32, back: f32, half: f32| slice(z * h, front * h, back * h, half * h);
    let slices = [
        cut(-0.060, 0.020, 0.030, 0.012),
        cut(-0.050, 0.034, 0.048, 0.036),
        cut(-0.028, 0.047 * g, 0.064, 0.084 * wide),
        cut(0.000, 0.054 * g, 0.072, 0.097 * wide),
        cut(0.035, 0.054 * g, 0.064, 0.094 * wide),
        cut(0.075, 0.051 * g, 0.051, 0.083 * g),
        cut(0.105, 0.046 * g, 0.046, 0.076 * g),
        cut(0.118, 0.030, 0.030, 0.050),
    ];
    lofted(b, &slices, SIDES, 0.92, |_, _| s.bottom);
    if f.look.bottom == Bottom::Skirt {
        let hang = [
            cut(-0.070, 0.068 * g, 0.084, 0.112 * wide),
            cut(-0.025, 0.061 * g, 0.078, 0.106 * wide),
            cut(0.035, 0.057 * g, 0.067, 0.097 * wide),
            cut(0.085, 0.053 * g, 0.053, 0.082 * g),
        ];
        solid(b, s.bottom, &hang, SIDES);
    }
}

/// The chest's slices from the waist up, in shares of the stature, bare.
fn ribs(f: &Figure) -> Vec<Slice> {
    let look = &f.look;
    let g = look.girth();
    let belly = if look.build == Build::Heavy { 1.22 } else { 1.0 };
    let (waist, across, bust) = if look.woman { (0.90, 0.93, 1.16) } else { (1.0, 1.0, 1.0) };
    // Shoulders: the chest ends inside the upper arms.
    let reach = (f.shoulder.y / f.stature) / 0.104;
    let cut = |z: f32, front: f32, back: f32, half: f32| slice(z, front, back, half);
    vec![
        cut(0.020, 0.052 * g * belly, 0.049, 0.081 * g * waist),
        cut(0.070, 0.056 * g * belly.sqrt(), 0.054, 0.088 * g * across),
        cut(0.110, 0.060 * g * bust, 0.058, 0.096 * g * across),
        cut(0.140, 0.060 * g * bust, 0.060, 0.100 * g * across),
        cut(0.168, 0.053 * g, 0.061, 0.108 * reach),
        cut(0.190, 0.045, 0.056, 0.110 * reach),
        cut(0.206, 0.038, 0.049, 0.098 * reach),
        cut(0.219, 0.033, 0.042, 0.070 * reach),
        cut(0.231, 0.027, 0.033, 0.042),
        cut(0.240, 0.020, 0.024, 0.025),
    ]
}

/// How far the hem of the top hangs below the waist, as a share of the stature; tops that are tucked in end
/// at the waist.
fn hem(look: &Appearance) -> f32 {
    match look.top {
        Top::Coat => 0.120,
        Top::Suit => 0.140,
        Top::Jacket | Top::Hoodie | Top::HiVis => 0.115,
        Top::Tee | Top::Shirt if look.bottom != Bottom::Skirt => 0.105,
        _ => 0.020,
    }
}

pub(super) fn chest(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let look = &f.look;
    let thick = cloth(look);
    let wide = if look.woman { 1.06 } else { 1.0 } * look.girth();
    // The chest's own measures are those of somebody whose neck begins at 0.219 of the stature over the
    // waist.
    let tall = f.neck.z / (0.219 * h);
    let low = hem(look);
    let mut slices: Vec<Slice> = Vec::new();
    if low > 0.05 {
        let over =
            |z: f32, front: f32, back: f32, half: f32| slice(z, front * look.girth(), back, half * wide);
        slices.push(over(-low, 0.064, 0.083, 0.114));
        if low > 0.10 {
            slices.push(over(-0.095, 0.063, 0.081, 0.112));
        }
        slices.push(over(-0.055, 0.058, 0.069, 0.101));
        slices.push(over(-0.020, 0.054, 0.055, 0.088));
    } else {
        slices.push(slice(-low, 0.053 * look.girth(), 0.053, 0.085 * look.girth()));
    }
    let hips = slices.len();
    slices.extend(ribs(f));
    let slices: Vec<Slice> = slices
        .into_iter()
        .map(|c| {
            let z = if c.z > 0.0 { c.z * tall } else { c.z };
            let by = if c.z > 0.21 { 1.0 } else { thick };
            Slice { z: h * z, ..c.wider(h * by) }
        })
        .collect();
    let front = |j: usize, reach: usize| j + 1 + reach >= SIDES || j < reach;
    let band = MeshPart::new(s.tag, Surface::Reflector, BAND);
    let white = s.cloth([0.70, 0.70, 0.68]);
    let tie = s.cloth([0.20, 0.02, 0.03]);
    let vest = s.cloth([0.60, 0.72, 0.03]);
    let zip = s.cloth(look.top_rgb.map(|c| 0.45 * c));
    let inside = s.cloth(if look.extra_rgb[2] < 0.05 { [0.30, 0.30, 0.29] } else { [0.025, 0.027, 0.032] });
    let top = look.top;
    lofted(b, &slices, SIDES, 0.88, |k, j| match top {
        Top::HiVis if k + 1 == hips || k == hips + 2 => band,
        Top::Uniform if k == hips || k == hips + 2 => vest,
        Top::Suit if k > hips + 2 && front(j, 0) => white,
        Top::Jacket | Top::Coat if k > hips + 3 && front(j, 0) => inside,
        Top::Jacket | Top::Coat | Top::Hoodie if front(j, 0) => zip,
        _ => s.top,
    });
    collar(b, f, s, tall);
    if look.top == Top::Suit && !look.woman {
        let at = |x: f32, z: f32| Vec3::new(x * h * thick, 0.0, z * tall * h);
        let wide = 0.052 * look.girth();
        b.bar(tie, at(wide + 0.003, 0.07), at(wide + 0.004, 0.14), [0.010 * h, 0.007 * h], 6);
        b.bar(tie, at(wide + 0.004, 0.14), at(0.034, 0.218), [0.007 * h, 0.006 * h], 6);
    }
    match look.carried {
        Carried::Backpack => backpack(b, f, s),
        Carried::ShoulderBag => shoulder_bag(b, f, s),
        _ => {}
    }
}

/// A collar, or the hood on the back.
fn collar(b: &mut MeshBuilder, f: &Figure, s: &Stuffs, tall: f32) {
    let h = f.stature;
    let at = |z: f32| z * tall * h;
    let part = if f.look.top == Top::Suit { s.cloth([0.70, 0.70, 0.68]) } else { s.top };
    match f.look.top {
        Top::Jacket | Top::Coat | Top::Suit | Top::Shirt | Top::Uniform | Top::HiVis => {
            let ring = [
                slice(at(0.205), 0.036 * h, 0.042 * h, 0.052 * h),
                slice(at(0.226), 0.033 * h, 0.038 * h, 0.040 * h),
                slice(at(0.240), 0.031 * h, 0.036 * h, 0.036 * h),
            ];
            solid(b, part, &ring, 12);
        }
        Top::Hoodie => {
            b.ellipsoid(
                s.top,
                Vec3::new(-0.044 * h, 0.0, at(0.215)),
                Vec3::new(0.030, 0.052, 0.034) * h,
                6,
                12,
            );
        }
        Top::Tee | Top::Dress => {}
    }
}

fn backpack(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let size = if f.stature < 1.4 { 0.9 } else { 1.0 };
    let cut = |z: f32, deep: f32, half: f32| {
        slice(z * h, 0.045 * h, deep * h * size, half * h * size).at(-0.052 * h, 0.0)
    };
    let slices = [
        cut(0.000, 0.050, 0.060),
        cut(0.012, 0.070, 0.076),
        cut(0.090, 0.078, 0.080),
        cut(0.160, 0.062, 0.076),
        cut(0.190, 0.045, 0.062),
        cut(0.198, 0.020, 0.040),
    ];
    lofted(b, &slices, 12, 0.6, |_, _| s.extra);
    let pocket = [
        slice(0.02 * h, 0.03 * h, 0.030 * h, 0.050 * h),
        slice(0.085 * h, 0.03 * h, 0.026 * h, 0.048 * h),
        slice(0.095 * h, 0.03 * h, 0.010 * h, 0.040 * h),
    ]
    .map(|c| c.at(-0.115 * h * size, 0.0));
    lofted(b, &pocket, 10, 0.6, |_, _| s.cloth(f.look.extra_rgb.map(|c| 0.6 * c)));
    let thick = cloth(&f.look);
    for y in [-0.052, 0.052] {
        let points = [
            Vec3::new(-0.055, y, 0.185),
            Vec3::new(-0.012, 1.08 * y, 0.214),
            Vec3::new(0.042, 1.12 * y, 0.185),
            Vec3::new(0.058 * thick, 1.15 * y, 0.120),
            Vec3::new(0.030, 1.65 * y, 0.060),
        ];
        for pair in points.windows(2) {
            b.bar(s.extra, pair[0] * h, pair[1] * h, [0.008 * h; 2], 5);
        }
    }
}

fn shoulder_bag(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let leather = MeshPart::new(s.tag, Surface::Cloth, f.look.extra_rgb);
    let side = -(0.122 * f.look.girth() * cloth(&f.look)) * h;
    let cut = |z: f32, long: f32, half: f32| slice(z * h, long * h, long * h, half * h).at(-0.035 * h, side);
    let slices = [
        cut(-0.165, 0.060, 0.018),
        cut(-0.155, 0.070, 0.024),
        cut(-0.090, 0.068, 0.022),
        cut(-0.066, 0.062, 0.012),
    ];
    lofted(b, &slices, 12, 0.6, |_, _| leather);
    let over = Vec3::new(0.0, 0.062, 0.214) * h;
    let thick = cloth(&f.look) * f.look.girth();
    for x in [0.060 * thick, -0.064 * thick] {
        let breast = Vec3::new(x, 0.012, 0.130) * h;
        let hip = Vec3::new(0.7 * x * h, side + 0.018 * h, -0.02 * h);
        let clasp = Vec3::new((-0.035 + if x > 0.0 { 0.04 } else { -0.04 }) * h, side, -0.075 * h);
        for pair in [over, breast, hip, clasp].windows(2) {
            b.bar(leather, pair[0], pair[1], [0.008 * h; 2], 5);
        }
    }
}
