//! Bins of houses and shops, skips, crates and bags.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::outline::{along_x, along_y};
use super::parts::{BLACK, DARK_STEEL, STEEL, block, loose, pick, still, turned};
use crate::solids::{MeshBuilder, circle};

const TYRE: MeshPart = loose(Surface::Rubber, [0.03; 3]);
/// Lids of bins for paper, glass, packaging, leaves and the rest.
const LIDS: [[f32; 3]; 5] =
    [[0.03, 0.12, 0.40], [0.05, 0.26, 0.09], [0.70, 0.48, 0.03], [0.20, 0.10, 0.04], [0.06, 0.065, 0.07]];

/// A box that is wider at its top, from one rectangle to another one.
fn widening(b: &mut MeshBuilder, part: MeshPart, low: [Vec3; 2], high: [Vec3; 2]) {
    let ring = |[a, c]: [Vec3; 2]| -> Vec<Vec3> {
        vec![
            Vec3::new(a.x, a.y, a.z),
            Vec3::new(c.x, a.y, a.z),
            Vec3::new(c.x, c.y, a.z),
            Vec3::new(a.x, c.y, a.z),
        ]
    };
    b.loft(&[ring(low), ring(high)], |_, _| part, [part; 2]);
}

/// Bins on two wheels, side by side along y; their handles are at the back.
pub(super) fn wheelie_bins(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let count = (size.y / 0.66).floor().max(1.0) as u32;
    let body = loose(Surface::Plain, pick(&[[0.07, 0.075, 0.08], [0.045, 0.13, 0.06]], variant / 3));
    for k in 0..count {
        let step = size.y / count as f32;
        let y = -half.y + step * (k as f32 + 0.5);
        // One of them stands a little back.
        let back = if (k + variant) % 3 == 1 { 0.06 } else { 0.0 };
        let x = |share: f32| share * (half.x - 0.03) - back + 0.03;
        let wide = 0.27f32.min(0.46 * step);
        let lid = loose(Surface::Plain, pick(&LIDS, variant + 2 * k));
        widening(
            b,
            body,
            [Vec3::new(x(-0.55), y - 0.78 * wide, 0.06 * h), Vec3::new(x(0.55), y + 0.78 * wide, 0.0)],
            [Vec3::new(x(-0.78), y - wide, 0.90 * h), Vec3::new(x(0.90), y + wide, 0.0)],
        );
        let top = [
            [x(-0.86), 0.89 * h],
            [x(0.96), 0.89 * h],
            [x(0.96), 0.915 * h],
            [x(0.3), 0.975 * h],
            [x(-0.6), h],
            [x(-0.86), 0.97 * h],
        ];
        along_y(b, lid, &top, [y - 1.04 * wide, y + 1.04 * wide]);
        b.bar(
            body,
            Vec3::new(x(-0.90), y - 0.8 * wide, 0.93 * h),
            Vec3::new(x(-0.90), y + 0.8 * wide, 0.93 * h),
            [0.016; 2],
            5,
        );
        for side in [-1.0f32, 1.0] {
            let at = |y: f32| Vec3::new(x(-0.62), y, 0.10);
            let (from, to) = (y + side * 0.62 * wide, y + side * 0.92 * wide);
            b.bar(TYRE, at(from), at(to), [0.10; 2], 8);
        }
    }
}

/// A container of 1,100 litres on four castors, its lid round.
pub(super) fn container(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        loose(Surface::Plain, pick(&[[0.07, 0.075, 0.08], [0.05, 0.15, 0.07], [0.30, 0.31, 0.32]], variant));
    let lid = loose(Surface::Plain, pick(&LIDS, variant + 1));
    let wide = half.y - 0.05;
    widening(
        b,
        body,
        [Vec3::new(-0.82 * half.x, -0.86 * wide, 0.20), Vec3::new(0.82 * half.x, 0.86 * wide, 0.0)],
        [Vec3::new(-0.96 * half.x, -wide, 0.80 * h), Vec3::new(0.96 * half.x, wide, 0.0)],
    );
    block(b, body, [0.0, 0.0], [half.x, half.y - 0.04], [0.80 * h, 0.84 * h]);
    let round: Vec<[f32; 2]> =
        circle(16).take(9).map(|(c, s)| [0.97 * half.x * c, 0.84 * h + 0.16 * h * s]).collect();
    along_y(b, lid, &round, [-half.y + 0.05, half.y - 0.05]);
    for side in [-1.0f32, 1.0] {
        let pin = |y: f32| Vec3::new(0.0, side * y, 0.83 * h);
        b.bar(loose(Surface::Metal, [0.3; 3]), pin(wide - 0.02), pin(half.y), [0.025; 2], 6);
        for x in [-0.6, 0.6] {
            let at = |y: f32| Vec3::new(x * half.x, y, 0.08);
            let y = side * 0.62 * wide;
            b.bar(TYRE, at(y - 0.025), at(y + 0.025), [0.08; 2], 8);
            block(b, loose(Surface::Metal, [0.3; 3]), [x * half.x, y], [0.02, 0.05], [0.10, 0.22]);
        }
    }
    for k in [-1.0f32, 0.0, 1.0] {
        block(b, body, [0.93 * half.x, 0.55 * k * wide], [0.03, 0.025], [0.30, 0.80 * h]);
    }
    block(
        b,
        loose(Surface::Reflector, [0.80, 0.80, 0.76]),
        [0.95 * half.x, 0.0],
        [0.02, 0.22 * wide],
        [0.62 * h, 0.72 * h],
    );
}

/// A dumpster with a slanting top and black lids.
pub(super) fn dumpster(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Metal, pick(&[[0.05, 0.20, 0.10], [0.05, 0.12, 0.30], [0.30, 0.14, 0.05]], variant));
    let side = [
        [-0.92 * half.x, 0.10],
        [0.84 * half.x, 0.10],
        [half.x - 0.02, 0.24],
        [half.x - 0.02, 0.72 * h],
        [-half.x + 0.04, 0.96 * h],
        [-half.x + 0.04, 0.24],
    ];
    along_y(b, body, &side, [-half.y + 0.06, half.y - 0.06]);
    // Two lids on the slope.
    let lid = still(Surface::Plain, [0.03, 0.03, 0.035]);
    for (from, to) in [(-half.y + 0.05, -0.01), (0.01, half.y - 0.05)] {
        let slope =
            [[-half.x, 0.955 * h], [half.x, 0.72 * h], [half.x, 0.75 * h], [-half.x + 0.1, h], [-half.x, h]];
        along_y(b, lid, &slope, [from, to]);
    }
    for side in [-1.0f32, 1.0] {
        // Sleeves for the forks of a lorry, ribs.
        block(b, body, [0.0, side * (half.y - 0.03)], [0.80 * half.x, 0.03], [0.46 * h, 0.58 * h]);
        for x in [-0.75, 0.0, 0.7] {
            block(b, body, [x * half.x, side * (half.y - 0.045)], [0.03, 0.02], [0.14, 0.66 * h]);
        }
        for x in [-0.7, 0.66] {
            block(b, DARK_STEEL, [x * half.x, side * 0.7 * half.y], [0.10, 0.05], [0.0, 0.10]);
        }
    }
    for y in [-0.6, 0.0, 0.6] {
        block(b, body, [half.x - 0.015, y * half.y], [0.015, 0.035], [0.26, 0.70 * h]);
    }
}

/// A skip with rubble in it: its ends slope, its rim is flat.
pub(super) fn skip(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Metal, pick(&[[0.55, 0.36, 0.03], [0.05, 0.22, 0.34], [0.42, 0.09, 0.03]], variant));
    let wall = 0.92 * half.x;
    let side = [
        [-0.62 * half.y, 0.04],
        [0.62 * half.y, 0.04],
        [0.80 * half.y, 0.42 * h],
        [half.y - 0.03, 0.86 * h],
        [-half.y + 0.03, 0.86 * h],
        [-0.80 * half.y, 0.42 * h],
    ];
    along_x(b, body, &side, [-wall, wall]);
    // The rim, and what lies in it.
    for side in [-1.0f32, 1.0] {
        block(b, body, [side * (wall - 0.02), 0.0], [0.06, half.y], [0.84 * h, 0.92 * h]);
        block(b, body, [0.0, side * (half.y - 0.04)], [wall - 0.07, 0.04], [0.84 * h, 0.92 * h]);
        block(b, body, [side * 0.5 * wall, 0.0], [0.06, 0.62 * half.y], [0.0, 0.06]);
        for y in [-0.45, 0.45] {
            let x = side * (wall + 0.5 * (half.x - wall));
            block(b, DARK_STEEL, [x, y * half.y], [0.5 * (half.x - wall), 0.05], [0.52 * h, 0.62 * h]);
            block(b, body, [side * (wall + 0.01), y * half.y], [0.02, 0.04], [0.10, 0.86 * h]);
        }
    }
    let rubble = still(Surface::Gravel, [0.36, 0.31, 0.27]);
    let bump = |ring: usize, side: usize| 0.80 + 0.05 * ((ring * 5 + side * 7 + variant as usize) % 5) as f32;
    b.blob(rubble, Vec3::Z * 0.85 * h, Vec3::new(0.85 * wall, 0.86 * half.y, 0.15 * h), 4, 10, bump);
    let plank = still(Surface::Wood, [0.36, 0.25, 0.14]);
    b.bar(
        plank,
        Vec3::new(-0.4 * wall, -0.5 * half.y, 0.90 * h),
        Vec3::new(0.5 * wall, 0.3 * half.y, h - 0.04),
        [0.035; 2],
        4,
    );
}

/// Two round containers for bottles.
pub(super) fn recycling(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colours = [[0.05, 0.26, 0.09], [0.55, 0.55, 0.52], [0.24, 0.12, 0.04], [0.04, 0.16, 0.38]];
    let r = half.x.min(0.5 * half.y);
    for k in 0..2u32 {
        let y = (k as f32 - 0.5) * 2.0 * (half.y - r);
        let body = still(Surface::Plain, pick(&colours, variant + k));
        let dome = [
            (0.0, 0.80 * r),
            (0.06 * h, 0.96 * r),
            (0.42 * h, r),
            (0.66 * h, 0.90 * r),
            (0.84 * h, 0.62 * r),
            (0.93 * h, 0.28 * r),
        ];
        turned(b, body, [0.0, y], &dome, 14);
        // A hook on top, an opening on either side, a label.
        turned(b, STEEL, [0.0, y], &[(0.92 * h, 0.10 * r), (h, 0.06 * r)], 6);
        for side in [-1.0f32, 1.0] {
            let at = |x: f32| Vec3::new(side * x, y, 0.66 * h);
            b.bar(BLACK, at(0.6 * r), at(0.95 * r), [0.17 * r; 2], 10);
        }
        let label = still(Surface::Plain, [0.76, 0.76, 0.72]);
        block(b, label, [0.95 * r, y], [0.045 * r, 0.30 * r], [0.28 * h, 0.46 * h]);
    }
}

/// A bin with grit for winter.
pub(super) fn grit_bin(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.66, 0.46, 0.03], [0.05, 0.20, 0.10], [0.36, 0.36, 0.34]], variant));
    widening(
        b,
        body,
        [Vec3::new(-0.86 * half.x, -0.88 * half.y, 0.04), Vec3::new(0.86 * half.x, 0.88 * half.y, 0.0)],
        [Vec3::new(-0.96 * half.x, -0.96 * half.y, 0.62 * h), Vec3::new(0.96 * half.x, 0.96 * half.y, 0.0)],
    );
    let lid = [
        [-half.x, 0.62 * h],
        [half.x, 0.62 * h],
        [half.x, 0.68 * h],
        [-0.2 * half.x, h],
        [-half.x, 0.94 * h],
    ];
    along_y(b, body, &lid, [-half.y, half.y]);
    for y in [-0.6, 0.6] {
        block(b, BLACK, [0.0, y * half.y], [0.8 * half.x, 0.05], [0.0, 0.05]);
    }
    block(b, BLACK, [half.x - 0.02, 0.0], [0.015, 0.16], [0.55 * h, 0.60 * h]);
}

/// Crates of a shop in three stacks.
pub(super) fn crates(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colours =
        [[0.04, 0.22, 0.09], [0.05, 0.12, 0.36], [0.52, 0.06, 0.03], [0.62, 0.40, 0.05], [0.09, 0.09, 0.10]];
    let high = 0.30f32.min(h / 3.0);
    for (stack, count) in [3u32, 2, 1].into_iter().enumerate() {
        let count = if stack == 0 { 3 } else { count.min(1 + (variant + stack as u32) % 3) };
        let step = size.y / 3.0;
        let y = -half.y + step * (stack as f32 + 0.5);
        for level in 0..count {
            let part = loose(Surface::Plain, pick(&colours, variant + level + 2 * stack as u32));
            let z = high * level as f32;
            let off = 0.015 * ((level + stack as u32 + variant) % 3) as f32 - 0.015;
            let (x, y) = (off, y + off);
            let [a, c] = [half.x - 0.02, 0.5 * step - 0.025];
            block(b, part, [x, y], [0.94 * a, 0.94 * c], [z, z + 0.92 * high]);
            block(b, part, [x, y], [a, c], [z + 0.74 * high, z + 0.86 * high]);
            block(b, part, [x, y], [a, c], [z + 0.01, z + 0.12 * high]);
            let inside = loose(Surface::Plain, [0.03; 3]);
            block(b, inside, [x, y], [0.84 * a, 0.84 * c], [z + 0.85 * high, z + 0.93 * high]);
        }
    }
}

/// Bags full of rubbish.
pub(super) fn bags(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colours = [[0.03, 0.03, 0.035], [0.05, 0.09, 0.22], [0.50, 0.42, 0.10]];
    let part = loose(Surface::Rubber, pick(&colours, variant));
    let places = [
        ([-0.44, -0.64], 0.42, 0.86),
        ([0.36, -0.16], 0.46, 1.0),
        ([-0.30, 0.62], 0.44, 0.80),
        ([0.58, 0.62], 0.33, 0.62),
    ];
    for (k, ([x, y], r, tall)) in places.into_iter().enumerate() {
        let at = [x * half.x, y * half.y];
        let r = r * half.y.min(1.2 * half.x);
        let top = tall * h;
        let bump = |ring: usize, side: usize| {
            0.90 + 0.05 * ((ring * 3 + side * 5 + k + variant as usize) % 3) as f32
        };
        let half_z = 0.46 * top;
        b.blob(part, Vec3::new(at[0], at[1], half_z), Vec3::new(r, r, half_z), 5, 8, bump);
        // The knot.
        let neck = Vec3::new(at[0], at[1], 0.86 * top);
        b.bar(part, neck, Vec3::new(at[0] + 0.01, at[1], top - 0.01), [0.05, 0.06], 6);
    }
}
