//! Poles: of lines, flags, clocks and bus stops. Each stands in the middle of its box.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use super::parts::{block, pick, turned};
use super::picture::{Lies, PRINTED, Skin};
use crate::actors::canvas::Canvas;
use crate::solids::MeshBuilder;

const fn pole(surface: Surface, rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::Pole, surface, rgb)
}

const GREY: MeshPart = pole(Surface::Metal, [0.30, 0.31, 0.32]);
const DARK: MeshPart = pole(Surface::Metal, [0.05, 0.055, 0.06]);

/// A wooden pole with a cross arm along x, insulators, and a transformer on one of three.
pub(super) fn utility(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let wood =
        pole(Surface::Wood, pick(&[[0.20, 0.14, 0.09], [0.24, 0.20, 0.16], [0.17, 0.12, 0.08]], variant));
    b.bar(wood, Vec3::ZERO, Vec3::Z * h, [0.15, 0.10], 10);
    let glass = pole(Surface::Plain, [0.22, 0.12, 0.08]);
    let arms: &[f32] = if variant % 3 == 1 { &[0.93, 0.83] } else { &[0.93] };
    for share in arms {
        let z = share * h;
        block(b, wood, [0.0, 0.10], [half.x, 0.05], [z - 0.06, z + 0.06]);
        for x in [-0.94f32, -0.42, 0.42, 0.94] {
            let at = [x * (half.x - 0.02), 0.10];
            turned(
                b,
                glass,
                at,
                &[(z + 0.05, 0.03), (z + 0.12, 0.05), (z + 0.15, 0.02), (z + 0.21, 0.045), (z + 0.23, 0.02)],
                6,
            );
        }
        for side in [-1.0f32, 1.0] {
            let (low, high) =
                (Vec3::new(side * 0.08, 0.13, z - 0.55), Vec3::new(side * 0.5 * half.x, 0.13, z - 0.05));
            b.bar(GREY, low, high, [0.018; 2], 4);
        }
    }
    turned(b, glass, [0.0; 2], &[(h - 0.02, 0.05), (h - 0.001, 0.045)], 6);
    if variant.is_multiple_of(3) {
        // A transformer hangs on its back.
        let at = [0.0, -half.y + 0.22];
        turned(b, GREY, at, &[(0.70 * h, 0.18), (0.71 * h, 0.21), (0.795 * h, 0.21), (0.805 * h, 0.16)], 10);
        block(b, GREY, [0.0, -0.5 * half.y + 0.10], [0.05, 0.5 * half.y - 0.05], [0.735 * h, 0.75 * h]);
        for x in [-0.09, 0.09] {
            turned(b, glass, [x, at[1]], &[(0.80 * h, 0.035), (0.825 * h, 0.035)], 5);
        }
    }
}

/// A flag on a pole; it hangs along +y.
pub(super) fn flag(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let white = pole(Surface::Metal, [0.62, 0.62, 0.60]);
    turned(
        b,
        pole(Surface::Concrete, [0.40, 0.39, 0.37]),
        [0.0; 2],
        &[(0.0, half.x), (0.10, half.x), (0.12, 0.6 * half.x)],
        10,
    );
    b.bar(white, Vec3::Z * 0.1, Vec3::Z * (h - 0.12), [0.055, 0.035], 8);
    b.ellipsoid(pole(Surface::Metal, [0.55, 0.40, 0.08]), Vec3::Z * (h - 0.07), Vec3::splat(0.07), 4, 8);
    let colours = pick(
        &[
            [[0.05, 0.24, 0.28], [0.76, 0.48, 0.05], [0.05, 0.24, 0.28]],
            [[0.40, 0.06, 0.22], [0.76, 0.74, 0.70], [0.40, 0.06, 0.22]],
            [[0.76, 0.76, 0.74], [0.10, 0.32, 0.60], [0.76, 0.76, 0.74]],
        ],
        variant,
    );
    // Cloth in folds: three stripes one below the other.
    let steps = 5;
    let (top, tall) = (h - 0.22, 0.42f32.min(0.08 * h));
    for (k, rgb) in colours.into_iter().enumerate() {
        let cloth = MeshPart::new(Tag::Other, Surface::Cloth, rgb);
        let rings: Vec<Vec<Vec3>> = (0..=steps)
            .map(|i| {
                let share = i as f32 / steps as f32;
                let y = 0.04 + share * (half.y - 0.04);
                let x = 0.55 * half.x * [0.0, 0.6, -0.4, 0.5, -0.6, 0.3][i % 6];
                let high = top - tall * k as f32 - 0.35 * share * share;
                let t = 0.008;
                vec![
                    Vec3::new(x - t, y, high),
                    Vec3::new(x + t, y, high),
                    Vec3::new(x + t, y, high - tall),
                    Vec3::new(x - t, y, high - tall),
                ]
            })
            .collect();
        b.loft(&rings, |_, _| cloth, [cloth; 2]);
    }
}

/// A clock with two faces on a post.
pub(super) fn clock(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let metal =
        pole(Surface::Metal, pick(&[[0.05, 0.055, 0.06], [0.05, 0.12, 0.09], [0.26, 0.27, 0.28]], variant));
    let r = half.y;
    let foot = [
        (0.0, 0.9 * half.x),
        (0.10, 0.9 * half.x),
        (0.16, 0.55 * half.x),
        (0.9, 0.45 * half.x),
        (0.95, 0.30 * half.x),
        (h - 2.0 * r, 0.26 * half.x),
    ];
    turned(b, metal, [0.0; 2], &foot, 10);
    let at = |x: f32| Vec3::new(x, 0.0, h - r);
    b.bar(metal, at(-half.x + 0.02), at(half.x - 0.02), [r; 2], 18);
    let face = MeshPart::new(Tag::Pole, Surface::Plain, [0.82, 0.82, 0.78]);
    for side in [-1.0f32, 1.0] {
        let x = |off: f32| side * (half.x - 0.02 + off);
        b.bar(face, at(x(-0.02)), at(x(0.008)), [0.88 * r; 2], 18);
        let ink = MeshPart::new(Tag::Pole, Surface::Plain, [0.02; 3]);
        let hand = |b: &mut MeshBuilder, [y, z]: [f32; 2], wide: f32| {
            let to = Vec3::new(x(0.004), side * y * r, h - r + z * r);
            b.bar(ink, at(x(0.004)), to, [wide, 0.5 * wide], 4);
        };
        hand(b, [0.32, 0.34], 0.014);
        hand(b, [-0.62, 0.30], 0.010);
        for k in 0..4 {
            let (s, c) = frames::math::f32::sin_cos(std::f32::consts::TAU * k as f32 / 4.0);
            let p = Vec3::new(x(0.010), 0.76 * r * s, h - r + 0.76 * r * c);
            let e = Vec3::new(0.010, 0.022, 0.022);
            b.cuboid(ink, p - e, p + e);
        }
    }
}

/// From where on a bus stop's plate reaches up, as a share of its height; its timetable's heights, metres.
const PLATE_FROM: f32 = 0.80;
const TIMES: [f32; 2] = [1.05, 1.65];

/// The flag of a bus stop: a plate with a bus on it, a case with the times.
pub(super) fn bus_stop(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let post = pick(&[GREY, DARK], variant);
    b.bar(post, Vec3::ZERO, Vec3::Z * (h - 0.01), [0.035; 2], 8);
    turned(b, post, [0.0; 2], &[(0.0, half.x), (0.015, half.x)], 8);
    let plate = MeshPart { tag: Tag::Pole, ..PRINTED };
    block(b, plate, [0.0, 0.0], [0.042, half.y], [PLATE_FROM * h, h]);
    let case = MeshPart::new(Tag::Pole, Surface::Metal, [0.16, 0.17, 0.18]);
    block(b, case, [0.0, 0.0], [0.045, 0.62 * half.y], TIMES);
    let paper = MeshPart::new(Tag::Pole, Surface::Plain, [0.76, 0.76, 0.72]);
    block(b, paper, [0.0, 0.0], [0.05, 0.52 * half.y], [TIMES[0] + 0.05, TIMES[1] - 0.05]);
}

pub(super) fn bus_stop_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (size.y, (1.0 - PLATE_FROM) * size.z);
    let ground = pick(&[[0.70, 0.55, 0.05], [0.05, 0.14, 0.40], [0.05, 0.28, 0.16]], variant);
    let ink = if variant.is_multiple_of(3) { [0.03, 0.16, 0.08] } else { [0.82; 3] };
    let mut canvas = Canvas::new([wide, tall], ground);
    let at = |u: f32, v: f32| [u * wide, v * tall];
    canvas.fill(&[at(0.18, 0.42), at(0.82, 0.42), at(0.82, 0.88), at(0.18, 0.88)], ink);
    for u in [0.23f32, 0.43, 0.63] {
        canvas.fill(&[at(u, 0.62), at(u + 0.14, 0.62), at(u + 0.14, 0.80), at(u, 0.80)], ground);
    }
    for u in [0.32f32, 0.68] {
        let wheel: Vec<[f32; 2]> =
            crate::solids::circle(10).map(|(c, s)| [u * wide + 0.04 * c, 0.41 * tall + 0.04 * s]).collect();
        canvas.fill(&wheel, ink);
    }
    canvas.write("BUS", at(0.5, 0.17), 0.20 * tall, 0.8 * wide, ink);
    let low = Vec3::new(0.0, -0.5 * wide, PLATE_FROM * size.z);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}
