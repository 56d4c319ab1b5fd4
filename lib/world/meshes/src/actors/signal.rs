//! Traffic lights: heads for drivers and for people who walk, on poles, on arms, or on what stands there.

use std::f32::consts::TAU;

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::footprint::LightMount;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{Tag, lights};

use crate::solids::{Detail, MeshBuilder};

const STEEL: MeshPart = MeshPart::new(Tag::Pole, Surface::Metal, [0.22, 0.23, 0.24]);
const BLACK: MeshPart = MeshPart::new(Tag::TrafficLight, Surface::Plain, [0.03, 0.03, 0.03]);
/// From the axis of the pole to the back of a housing, metres.
const BEHIND_M: f32 = 0.07;

const fn glass(bits: u32, rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::TrafficLight, Surface::Lamp(bits), rgb)
}

const RED: MeshPart = glass(lights::SIGNAL_RED, [0.45, 0.02, 0.02]);
const YELLOW: MeshPart = glass(lights::SIGNAL_YELLOW, [0.45, 0.30, 0.02]);
const GREEN: MeshPart = glass(lights::SIGNAL_GREEN, [0.02, 0.35, 0.15]);

/// The housing stands on z = 0 and looks along +x; seen from there the pole is to the left when it is at the
/// traffic's right, that is towards +y.
pub(crate) fn light(kind: &str, size: Vec3, variant: u32, detail: Detail) -> Option<TriMesh> {
    let mount = LightMount::from_variant(variant);
    let mut b = MeshBuilder::at(detail);
    match kind {
        "signal" => {
            signal(&mut b, size);
            // A mast with an arm is thicker.
            let radii = if mount.arm_m > 0.0 { [0.15, 0.10] } else { [0.10, 0.07] };
            hold(&mut b, size, mount, radii);
        }
        "walkers" => {
            walkers(&mut b, size);
            hold(&mut b, size, mount, [0.06, 0.055]);
        }
        _ => return None,
    }
    Some(b.finish())
}

/// Three lenses one over the other.
fn signal(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    b.cuboid(BLACK, Vec3::new(-half.x, -half.y, 0.0), Vec3::new(0.25 * half.x, half.y, size.z));
    let radius = (0.145 * size.z).min(0.8 * half.y);
    for (i, lens) in [GREEN, YELLOW, RED].into_iter().enumerate() {
        let z = size.z * (i as f32 + 0.5) / 3.0;
        let at = |x: f32| Vec3::new(x * half.x, 0.0, z);
        b.bar(lens, at(0.2), at(0.45), [radius, 0.8 * radius], 12);
        hood(b, [0.2 * half.x, half.x], z, radius);
    }
}

/// The hood over a lens: half a tube, thin boxes around its upper half.
fn hood(b: &mut MeshBuilder, [from, to]: [f32; 2], z: f32, radius: f32) {
    if b.detail() == Detail::Coarse {
        return;
    }
    for k in 0..5 {
        let angle = |step: usize| TAU * (0.02 + 0.092 * step as f32);
        let ((s0, c0), (s1, c1)) = (sin_cos(angle(k)), sin_cos(angle(k + 1)));
        let ring = |x: f32| -> Vec<Vec3> {
            let (inner, outer) = (1.02 * radius, 1.10 * radius);
            [(inner, c0, s0), (outer, c0, s0), (outer, c1, s1), (inner, c1, s1)]
                .map(|(r, c, s)| Vec3::new(x, r * c, z + r * s))
                .to_vec()
        };
        b.loft(&[ring(from), ring(to)], |_, _| BLACK, [BLACK; 2]);
    }
}

/// Strokes of a figure: from and to, to the right and up as one sees it, and how broad, in halves of its
/// height.
type Stroke = ([f32; 2], [f32; 2], f32);
const STANDS: [Stroke; 3] = [
    ([0.0, -0.12], [0.0, 0.46], 0.40),
    ([-0.115, -0.95], [-0.115, -0.12], 0.17),
    ([0.115, -0.95], [0.115, -0.12], 0.17),
];
const WALKS: [Stroke; 6] = [
    ([0.02, -0.12], [-0.04, 0.46], 0.30),
    ([0.04, -0.10], [-0.32, -0.92], 0.17),
    ([0.0, -0.10], [0.20, -0.50], 0.18),
    ([0.20, -0.46], [0.36, -0.92], 0.16),
    ([-0.10, 0.40], [-0.40, -0.02], 0.12),
    ([0.02, 0.40], [0.36, 0.06], 0.12),
];

/// A figure that stands over one that walks, each in a dark square under a hood.
fn walkers(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let face = 0.1 * half.x;
    b.cuboid(BLACK, Vec3::new(-half.x, -half.y, 0.0), Vec3::new(face, half.y, size.z));
    let figures: [(MeshPart, &[Stroke]); 2] = [(GREEN, &WALKS), (RED, &STANDS)];
    for (i, (lens, strokes)) in figures.into_iter().enumerate() {
        let (z, tall) = (size.z * (i as f32 + 0.5) / 2.0, 0.205 * size.z);
        if b.detail() == Detail::Coarse {
            // As much light as the figure gives.
            let reach = Vec3::new(0.0, 0.30 * tall, 0.85 * tall);
            let middle = Vec3::new(face, 0.0, z);
            b.cuboid(lens, middle - reach - Vec3::X * 0.01, middle + reach + Vec3::X * 0.02);
            continue;
        }
        let [low, high] = [face - 0.005, face + 0.012];
        for &([y0, z0], [y1, z1], broad) in strokes {
            let way = glam::Vec2::new(y1 - y0, z1 - z0).normalize_or_zero();
            let aside = 0.5 * broad * way.perp();
            let ring = |x: f32| -> Vec<Vec3> {
                [(y0, z0, 1.0), (y0, z0, -1.0), (y1, z1, -1.0), (y1, z1, 1.0)]
                    .map(|(y, up, side)| {
                        let p = glam::Vec2::new(y, up) + side * aside;
                        Vec3::new(x, tall * p.x, z + tall * p.y)
                    })
                    .to_vec()
            };
            b.loft(&[ring(low), ring(high)], |_, _| lens, [lens; 2]);
        }
        let lean = if i == 0 { -0.02 } else { 0.0 };
        let head = |x: f32| Vec3::new(x, tall * lean, z + 0.74 * tall);
        b.bar(lens, head(low), head(high), [0.23 * tall; 2], 8);
        // A hood above and at both sides.
        let (wide, top) = (0.9 * half.y, z + 1.12 * tall);
        b.cuboid(BLACK, Vec3::new(face - 0.005, -wide, top), Vec3::new(half.x, wide, top + 0.008));
        for y in [-wide, wide - 0.008] {
            let high = Vec3::new(0.6 * half.x, y + 0.008, top);
            b.cuboid(BLACK, Vec3::new(face - 0.005, y, z - 0.6 * tall), high);
        }
    }
}

/// The bracket of a housing, and unless it hangs on another's, its pole of some radii and its arm.
fn hold(b: &mut MeshBuilder, size: Vec3, mount: LightMount, radii: [f32; 2]) {
    let half = 0.5 * size;
    let side = if mount.pole_right { 1.0 } else { -1.0 };
    let back = -half.x - BEHIND_M;
    b.cuboid(STEEL, Vec3::new(back, -0.04, 0.5 * size.z), Vec3::new(-half.x + 0.01, 0.04, 0.62 * size.z));
    if mount.hangs {
        return;
    }
    let foot = Vec3::new(back, side * mount.arm_m, -mount.height_m - 0.15);
    let top = if mount.arm_m > 0.0 { 0.75 * size.z + 0.5 } else { 0.9 * size.z };
    b.bar(STEEL, foot, Vec3::new(back, side * mount.arm_m, top), radii, 8);
    b.bar(STEEL, foot, foot + Vec3::Z * 0.5, radii.map(|r| (1.7 * r).min(r + 0.05).min(0.17)), 8);
    if mount.arm_m > 0.0 {
        let z = 0.55 * size.z;
        let [from, to] = [side * mount.arm_m, -side * 0.15];
        b.bar(STEEL, Vec3::new(back, from, z), Vec3::new(back, to, z + 0.05), [0.08, 0.045], 8);
    }
}
