//! Blocks of flats and offices over shops.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, Wall};

use super::parts::{aerial, balcony, cornice, door, downpipe, parapet, storeys};
use super::shops::shops;
use super::style::{BuildingStyle, TAG};
use crate::solids::MeshBuilder;

/// The front wall stands back from the front of the box: room for awnings and balconies, metres.
pub(super) const FRONT_M: f32 = 0.9;
/// The other walls do so, metres.
const SIDE_M: f32 = 0.25;
/// Height of storeys above the ground floor, and width of a bay, metres.
const STOREY_M: f32 = 3.0;
const BAY_M: f32 = 3.4;
/// Blocks this high have steep roofs at most, metres.
const PITCHED_M: f32 = 19.0;

/// Floors over shops, and the numbers of the boards over these.
pub(super) fn block(
    b: &mut MeshBuilder,
    size: Vec3,
    look: &BuildingStyle,
    variant: u32,
    is_block: bool,
) -> Vec<usize> {
    let half = 0.5 * size;
    let BuildingStyle { wall, base, trim, flat_roof, tiles, .. } = *look;
    let is_old = matches!(wall.surface, Surface::Facade(Wall::Plaster | Wall::Brick | Wall::Ashlar));
    let is_pitched = is_block && is_old && variant % 3 != 1 && size.z < PITCHED_M;
    let ground = 3.9f32.min(0.8 * size.z);
    let (x, y) = (half.x - FRONT_M, half.y - SIDE_M);
    let back = -half.x + SIDE_M;
    let top = if is_pitched { size.z - 3.4 } else { size.z - 0.9 };
    let middle = Vec3::new(0.5 * (x + back), 0.0, 0.0);
    let walls = [0.5 * (x - back), y];
    storeys(b, wall, base, flat_roof, (middle, walls), [0.0, top], 0.5);
    let boards = shops(b, x, [-y, y], ground, trim, variant);
    cornice(b, trim, (middle, [walls[0] + 0.12, y + 0.12]), ground, 0.30);
    cornice(b, trim, (middle, [walls[0] + 0.2, y + 0.2]), top + 0.02, 0.22);
    for side in [-1.0, 1.0] {
        downpipe(b, [x + 0.09, side * (y - 0.3)], [ground, top]);
    }
    if is_block && (variant / 3) % 3 != 2 {
        balconies(b, [x, y], [ground, top], trim, variant);
    }
    if is_pitched {
        steep_roof(b, (middle, walls), [top, size.z], look, tiles);
    } else {
        roofscape(b, (middle, walls), [top, size.z], trim, variant);
    }
    door(b, x, half.x - 0.1, 0.0);
    boards
}

/// Balconies on every second bay, floor by floor.
fn balconies(b: &mut MeshBuilder, [x, y]: [f32; 2], [ground, top]: [f32; 2], trim: MeshPart, variant: u32) {
    let floors = ((top - ground) / STOREY_M).floor() as usize;
    let bays = (2.0 * y / BAY_M).floor().max(1.0) as usize;
    for floor in 0..floors {
        let z = ground + STOREY_M * floor as f32 + 0.12;
        // The first floor has none where awnings are.
        for bay in (0..bays).filter(|bay| (bay + variant as usize).is_multiple_of(2) && floor > 0) {
            let middle = -y + 2.0 * y * (bay as f32 + 0.5) / bays as f32;
            balcony(b, trim, [x, x + FRONT_M - 0.06], [middle - 1.25, middle + 1.25], z, variant / 9);
        }
    }
}

/// A steep roof of tiles with dormers and chimneys.
fn steep_roof(
    b: &mut MeshBuilder,
    (middle, half): (Vec3, [f32; 2]),
    [low, high]: [f32; 2],
    look: &BuildingStyle,
    tiles: MeshPart,
) {
    let ([x, y], mid) = (half, middle.x);
    let out = 0.3;
    // Steep up to a flat top, as old town houses have it.
    let flat = 0.45 * x;
    let ring = |share: f32, z: f32| -> Vec<Vec3> {
        let (hx, hy) = (x + out - share * (x + out - flat), y + 0.05 - share * 0.35);
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(u, v)| Vec3::new(mid + u * hx, v * hy, z))
            .to_vec()
    };
    let ridge = high - 0.7;
    b.loft(
        &[ring(0.0, low), ring(0.0, low + 0.12), ring(1.0, ridge)],
        |_, _| tiles,
        [look.trim, look.flat_roof],
    );
    let bays = (2.0 * y / (1.6 * BAY_M)).floor().max(1.0) as usize;
    for bay in 0..bays {
        let at = -y + 2.0 * y * (bay as f32 + 0.5) / bays as f32;
        for side in [-1.0, 1.0] {
            let front = mid + side * (x - 0.25);
            let inside = mid + side * (x - 2.0);
            let (x0, x1) = (front.min(inside), front.max(inside));
            let z = [low + 0.35, low + 1.95];
            b.cuboid(look.wall, Vec3::new(x0, at - 0.8, z[0]), Vec3::new(x1, at + 0.8, z[1]));
            b.cuboid(look.trim, Vec3::new(x0, at - 0.92, z[1]), Vec3::new(x1 + 0.08, at + 0.92, z[1] + 0.14));
        }
    }
    let brick = MeshPart::new(TAG, Surface::Concrete, [0.3, 0.14, 0.10]);
    for side in [-0.6, 0.55] {
        let (cx, cy) = (mid + 0.2 * x, side * y);
        b.cuboid(brick, Vec3::new(cx - 0.35, cy - 0.55, ridge - 0.6), Vec3::new(cx + 0.35, cy + 0.55, high));
    }
}

/// What is on a flat roof: a parapet, the head of the stairs, ducts and aerials.
fn roofscape(
    b: &mut MeshBuilder,
    (middle, [x, y]): (Vec3, [f32; 2]),
    [top, high]: [f32; 2],
    trim: MeshPart,
    variant: u32,
) {
    parapet(b, trim, (middle, [x, y]), top, high - 0.35);
    let metal = MeshPart::new(TAG, Surface::Metal, [0.4; 3]);
    let place = |u: f32, v: f32| [middle.x + u * x, v * y];
    for k in 0..(2 + variant % 3) {
        let share = |n: u32| (f32::from((variant * 7 + k * 13 + n * 5) as u8 % 17) / 8.0) - 1.0;
        let [cx, cy] = place(0.6 * share(0), 0.75 * share(1));
        let (hx, hy) = (0.6 + 0.3 * share(2).abs(), 0.8 + 0.4 * share(3).abs());
        b.cuboid(metal, Vec3::new(cx - hx, cy - hy, top), Vec3::new(cx + hx, cy + hy, high - 0.1));
    }
    for k in 0..2 {
        let [cx, cy] = place(-0.5, 0.8 - 1.3 * k as f32);
        aerial(b, [cx, cy], [top, high]);
    }
}
