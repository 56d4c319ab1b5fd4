//! Houses, blocks, towers, shops and halls.
//!
//! A building stands in its box; what sticks out of its front wall stays inside of that.

mod block;
mod fascias;
mod parts;
mod shops;
mod style;

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::solids::{Detail, MeshBuilder};
use parts::{cornice, door, downpipe, storeys};
use style::{BuildingStyle, TAG};

/// A building with its entrance on the side of +x.
pub(crate) fn building(kind: &str, size: Vec3, variant: u32, detail: Detail) -> Option<TriMesh> {
    let half = 0.5 * size;
    let look = BuildingStyle::of(kind, variant);
    let mut b = MeshBuilder::at(detail);
    let mut boards = Vec::new();
    match kind {
        "house" => house(&mut b, size, &look, variant),
        "tower" => tower(&mut b, size, &look, variant),
        "shop" | "block" => boards = block::block(&mut b, size, &look, variant, kind == "block"),
        "hall" => hall(&mut b, size, &look),
        _ => return None,
    }
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    let mut mesh = b.finish_flat();
    fascias::lay_on(&mut mesh, &boards);
    Some(mesh)
}

/// A house with a gable roof.
fn house(b: &mut MeshBuilder, size: Vec3, look: &BuildingStyle, variant: u32) {
    let half = 0.5 * size;
    let BuildingStyle { wall_rgb, wall, base, trim, flat_roof, tiles, .. } = *look;
    let eaves = 0.64 * size.z;
    let (x, y) = (half.x - 0.45, half.y - 0.30);
    storeys(b, wall, base, flat_roof, (Vec3::ZERO, [x, y]), [0.0, eaves], 0.4);
    // A gable roof with its ridge along y, overhanging on all sides, and its gable walls under it.
    let ring = |y: f32, x: f32, drop: f32| {
        vec![
            Vec3::new(-x, y, eaves - drop),
            Vec3::new(-x, y, eaves),
            Vec3::new(0.0, y, size.z),
            Vec3::new(x, y, eaves),
            Vec3::new(x, y, eaves - drop),
        ]
    };
    let wall_plain = MeshPart::new(TAG, Surface::Concrete, wall_rgb);
    let under = MeshPart::new(TAG, Surface::Wood, [0.3, 0.22, 0.15]);
    let rings = [ring(-half.y, half.x, 0.12), ring(half.y, half.x, 0.12)];
    b.loft(&rings, |_, j| if j == 4 { under } else { tiles }, [wall_plain; 2]);
    let chimney = MeshPart::new(TAG, Surface::Concrete, [0.3, 0.14, 0.10]);
    b.cuboid(
        chimney,
        Vec3::new(-0.35 * half.x - 0.3, 0.3 * half.y, eaves),
        Vec3::new(-0.35 * half.x + 0.3, 0.3 * half.y + 0.6, size.z),
    );
    // Gutters along the eaves, and pipes down from them.
    let zinc = MeshPart::new(TAG, Surface::Metal, [0.30, 0.31, 0.31]);
    for side in [-1.0, 1.0] {
        let gutter = |y: f32| Vec3::new(side * (half.x - 0.06), y * half.y, eaves - 0.09);
        b.bar(zinc, gutter(-1.0), gutter(1.0), [0.06; 2], 6);
        downpipe(b, [side * (x + 0.07), side * (y - 0.2)], [0.0, eaves]);
    }
    // The way up to the ridge is even: where a dormer's foot and its top meet the slope.
    let slope_x = |z: f32| half.x * (1.0 - (z - eaves) / (size.z - eaves));
    let places: &[f32] = [&[0.0][..], &[-0.45, 0.45], &[0.4]][variant as usize / 2 % 3];
    for at in places.iter().filter(|_| size.z - eaves > 2.2 && !variant.is_multiple_of(5)) {
        let (at, z) = (at * half.y, [eaves + 0.35, eaves + 1.65]);
        let (front, behind) = (slope_x(z[0]), slope_x(z[1]) - 0.1);
        b.cuboid(wall, Vec3::new(behind, at - 0.9, z[0]), Vec3::new(front, at + 0.9, z[1]));
        b.cuboid(
            trim,
            Vec3::new(behind - 0.2, at - 1.0, z[1]),
            Vec3::new(front + 0.15, at + 1.0, z[1] + 0.12),
        );
    }
    let stone = MeshPart::new(TAG, Surface::Concrete, [0.38, 0.37, 0.35]);
    for (k, height) in [0.34, 0.17].into_iter().enumerate() {
        let out = x + 0.2 * (k + 1) as f32;
        b.cuboid(stone, Vec3::new(x - 0.1, -0.9, 0.0), Vec3::new(out.min(half.x), 0.9, height));
    }
    if variant % 3 == 1 && y > 3.2 {
        // A bay of windows beside the door.
        let side = if variant.is_multiple_of(2) { 0.55 } else { -0.55 };
        let [low, high] = [side * y - 1.15, side * y + 1.15];
        b.cuboid(base, Vec3::new(x - 0.1, low, 0.0), Vec3::new(half.x - 0.04, high, 0.7));
        b.cuboid(wall, Vec3::new(x - 0.1, low, 0.7), Vec3::new(half.x - 0.05, high, 2.65));
        b.cuboid(trim, Vec3::new(x - 0.1, low - 0.1, 2.65), Vec3::new(half.x, high + 0.1, 2.8));
    }
    door(b, x, half.x - 0.1, 0.0);
}

/// A tower on a podium.
fn tower(b: &mut MeshBuilder, size: Vec3, look: &BuildingStyle, variant: u32) {
    let half = 0.5 * size;
    let BuildingStyle { wall, base, trim, flat_roof, .. } = *look;
    let inset = 0.25;
    let podium = (0.18 * size.z).min(8.0);
    let (x, y) = (half.x - inset, half.y - inset);
    storeys(b, wall, base, flat_roof, (Vec3::ZERO, [x, y]), [0.0, podium], 0.6);
    let slim = [0.86 * x, 0.86 * y];
    let step = if variant.is_multiple_of(2) { 0.78 } else { 0.999 };
    storeys(b, wall, trim, flat_roof, (Vec3::ZERO, slim), [podium, step * (size.z - 3.0)], 0.3);
    if step < 0.9 {
        storeys(
            b,
            wall,
            trim,
            flat_roof,
            (Vec3::ZERO, [0.8 * slim[0], 0.8 * slim[1]]),
            [step * (size.z - 3.0), size.z - 3.0],
            0.3,
        );
    }
    cornice(b, trim, (Vec3::ZERO, [half.x, half.y]), podium - 0.12, 0.35);
    let plant = MeshPart::new(TAG, Surface::Metal, [0.35; 3]);
    b.cuboid(
        plant,
        Vec3::new(-0.4 * half.x, -0.4 * half.y, size.z - 3.1),
        Vec3::new(0.4 * half.x, 0.4 * half.y, size.z),
    );
    door(b, x, half.x, 0.25 * half.y);
}

/// A hall with a shed roof.
fn hall(b: &mut MeshBuilder, size: Vec3, look: &BuildingStyle) {
    let half = 0.5 * size;
    let BuildingStyle { wall_rgb, base, flat_roof, .. } = *look;
    let (x, y) = (half.x - 0.1, half.y - 0.1);
    let metal = MeshPart::new(TAG, Surface::Metal, wall_rgb);
    let top = 0.9 * size.z;
    storeys(b, metal, base, flat_roof, (Vec3::ZERO, [x, y]), [0.0, top], 0.8);
    // A shed roof in ridges along x.
    let ridges = 3;
    for i in 0..ridges {
        let y0 = -half.y + size.y * i as f32 / ridges as f32;
        let y1 = y0 + size.y / ridges as f32;
        let ring = |x: f32| {
            vec![
                Vec3::new(x, y0, top - 0.05),
                Vec3::new(x, y1, top - 0.05),
                Vec3::new(x, y0 + 0.15 * (y1 - y0), size.z),
            ]
        };
        b.loft(&[ring(-half.x), ring(half.x)], |_, _| flat_roof, [metal; 2]);
    }
    let gate = MeshPart::new(TAG, Surface::Metal, [0.5, 0.5, 0.52]);
    for share in [-0.5, 0.4] {
        b.cuboid(
            gate,
            Vec3::new(x - 0.1, share * y - 1.9, 0.0),
            Vec3::new(half.x, share * y + 1.9, 0.5 * top),
        );
    }
}
