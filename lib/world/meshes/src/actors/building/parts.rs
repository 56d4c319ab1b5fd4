//! Parts of buildings.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::solids::{Detail, MeshBuilder};

/// Walls round a middle, half so wide along x and y, from `z[0]` to `z[1]`, with a plinth of some height.
pub(super) fn storeys(
    b: &mut MeshBuilder,
    wall: MeshPart,
    base: MeshPart,
    roof: MeshPart,
    (middle, half): (Vec3, [f32; 2]),
    z: [f32; 2],
    plinth: f32,
) {
    let ring = |z: f32| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| middle + Vec3::new(x * half[0], y * half[1], z))
            .to_vec()
    };
    b.loft(
        &[ring(z[0]), ring(z[0] + plinth), ring(z[1])],
        |k, _| if k == 0 { base } else { wall },
        [base, roof],
    );
}

/// A band around a building whose upper edge is at `z`.
pub(super) fn cornice(
    b: &mut MeshBuilder,
    trim: MeshPart,
    (middle, half): (Vec3, [f32; 2]),
    z: f32,
    height: f32,
) {
    let out = Vec3::new(half[0], half[1], 0.0);
    b.cuboid(trim, middle - out + Vec3::Z * (z - height), middle + out + Vec3::Z * z);
}

/// A low wall along the edges of a roof.
pub(super) fn parapet(
    b: &mut MeshBuilder,
    trim: MeshPart,
    (middle, [x, y]): (Vec3, [f32; 2]),
    low: f32,
    high: f32,
) {
    for (min, max) in [
        ((-x, -y), (x, -y + 0.3)),
        ((-x, y - 0.3), (x, y)),
        ((-x, -y + 0.3), (-x + 0.3, y - 0.3)),
        ((x - 0.3, -y + 0.3), (x, y - 0.3)),
    ] {
        b.cuboid(trim, middle + Vec3::new(min.0, min.1, low), middle + Vec3::new(max.0, max.1, high));
    }
}

/// A balcony from a wall at `x[0]` out to `x[1]`: a slab, and bars or a sheet of metal around it.
pub(super) fn balcony(
    b: &mut MeshBuilder,
    slab: MeshPart,
    x: [f32; 2],
    [y0, y1]: [f32; 2],
    z: f32,
    variant: u32,
) {
    let rail =
        MeshPart::new(Tag::Building, Surface::Metal, [[0.06; 3], [0.18; 3], [0.32; 3]][variant as usize % 3]);
    b.cuboid(slab, Vec3::new(x[0] - 0.05, y0, z - 0.18), Vec3::new(x[1], y1, z));
    let top = z + 1.0;
    // Along the front, then along both ends.
    let runs = [
        [[x[1] - 0.04, y0], [x[1] - 0.04, y1]],
        [[x[0], y0 + 0.02], [x[1], y0 + 0.02]],
        [[x[0], y1 - 0.02], [x[1], y1 - 0.02]],
    ];
    for (run, [from, to]) in runs.into_iter().enumerate() {
        let at = |p: [f32; 2], z: f32| Vec3::new(p[0], p[1], z);
        let grow = Vec3::new(0.02, 0.02, 0.0);
        b.cuboid(rail, at(from, top - 0.05) - grow, at(to, top) + grow);
        // Far away bars look as a sheet does.
        if variant.is_multiple_of(2) || b.detail() == Detail::Coarse {
            b.cuboid(rail, at(from, z + 0.08) - 0.5 * grow, at(to, top - 0.12) + 0.5 * grow);
        } else if run == 0 {
            let bars = ((to[1] - from[1]) / 0.3).round().max(2.0) as usize;
            for k in 0..=bars {
                let y = from[1] + (to[1] - from[1]) * k as f32 / bars as f32;
                b.cuboid(rail, at([from[0], y], z) - 0.5 * grow, at([from[0], y], top - 0.05) + 0.5 * grow);
            }
        } else {
            b.cuboid(rail, at(from, z + 0.45) - 0.5 * grow, at(to, z + 0.5) + 0.5 * grow);
        }
    }
}

/// A pipe for the rain on a wall.
pub(super) fn downpipe(b: &mut MeshBuilder, [x, y]: [f32; 2], [low, high]: [f32; 2]) {
    let zinc = MeshPart::new(Tag::Building, Surface::Metal, [0.30, 0.31, 0.31]);
    b.bar(zinc, Vec3::new(x, y, low), Vec3::new(x, y, high - 0.2), [0.055; 2], 6);
}

/// A mast with a few bars.
pub(super) fn aerial(b: &mut MeshBuilder, [x, y]: [f32; 2], [low, high]: [f32; 2]) {
    let metal = MeshPart::new(Tag::Building, Surface::Metal, [0.25; 3]);
    b.bar(metal, Vec3::new(x, y, low), Vec3::new(x, y, high), [0.03; 2], 5);
    for k in 0..3 {
        let z = high - 0.06 - 0.16 * k as f32;
        b.cuboid(metal, Vec3::new(x - 0.012, y - 0.5, z - 0.012), Vec3::new(x + 0.012, y + 0.5, z + 0.012));
    }
}

/// A door of wood with a canopy over it.
pub(super) fn door(b: &mut MeshBuilder, wall_x: f32, front_x: f32, y: f32) {
    let wood = MeshPart::new(Tag::Building, Surface::Wood, [0.16, 0.09, 0.05]);
    b.cuboid(wood, Vec3::new(wall_x - 0.15, y - 0.6, 0.0), Vec3::new(wall_x + 0.05, y + 0.6, 2.2));
    let canopy = MeshPart::new(Tag::Building, Surface::Concrete, [0.3; 3]);
    b.cuboid(canopy, Vec3::new(wall_x - 0.1, y - 0.9, 2.35), Vec3::new(front_x, y + 0.9, 2.5));
}
