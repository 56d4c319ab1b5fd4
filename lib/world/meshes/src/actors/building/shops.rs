//! Ground floors that are shops.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, Wall};

use super::fascias;
use super::style::TAG;
use crate::solids::{Detail, MeshBuilder};

/// Width of a shop's front, metres, and of the posts between them.
const SHOP_M: f32 = 6.4;
const POST_M: f32 = 0.35;
/// Where glass begins, and how far below the next floor the sign over it begins and ends, metres.
const RISER_M: f32 = 0.45;
const SIGN_M: [f32; 2] = [1.05, 0.42];
/// The lowest edge of awnings, and how far they reach out, metres.
const AWNING_M: [f32; 2] = [2.4, 0.8];
/// Shops along a front wall at `x`, from one end to the other, under a floor at `ground`. Gives the numbers
/// of the boards over them.
pub(super) fn shops(
    b: &mut MeshBuilder,
    x: f32,
    [y0, y1]: [f32; 2],
    ground: f32,
    trim: MeshPart,
    variant: u32,
) -> Vec<usize> {
    let mut boards = Vec::new();
    let glass = MeshPart::new(TAG, Surface::Facade(Wall::Curtain), [0.10, 0.10, 0.11]);
    let count = ((y1 - y0) / SHOP_M).round().max(1.0) as u32;
    let wide = (y1 - y0) / count as f32;
    for k in 0..count {
        let number = fascias::number(variant, k);
        let (rgb, sign) = (fascias::ground(number), fascias::part(number, k));
        boards.push(number);
        let riser = MeshPart::new(TAG, Surface::Plain, rgb.map(|c| 0.5 * c + 0.02));
        let left = y0 + wide * k as f32;
        let [a, c] = [left + POST_M, left + wide - POST_M];
        // The way in is at one end of the shop; the middle of a house is the way to the flats.
        let door_left = (variant + k).is_multiple_of(2);
        let door = if door_left { [a, a + 1.1] } else { [c - 1.1, c] };
        let pane = if door_left { [a + 1.2, c] } else { [a, c - 1.2] };
        let high = ground - SIGN_M[0];
        b.cuboid(riser, Vec3::new(x - 0.05, pane[0], 0.0), Vec3::new(x + 0.07, pane[1], RISER_M));
        b.cuboid(glass, Vec3::new(x - 0.05, pane[0], RISER_M), Vec3::new(x + 0.03, pane[1], high));
        b.cuboid(glass, Vec3::new(x - 0.05, door[0] + 0.08, 0.12), Vec3::new(x + 0.02, door[1] - 0.08, 2.2));
        for y in door {
            b.cuboid(riser, Vec3::new(x - 0.05, y - 0.06, 0.0), Vec3::new(x + 0.05, y + 0.06, high));
        }
        b.cuboid(riser, Vec3::new(x - 0.05, door[0], 2.2), Vec3::new(x + 0.04, door[1], high));
        b.cuboid(trim, Vec3::new(x - 0.05, door[0] - 0.1, 0.0), Vec3::new(x + 0.3, door[1] + 0.1, 0.12));
        b.cuboid(sign, Vec3::new(x - 0.05, a - 0.1, high), Vec3::new(x + 0.16, c + 0.1, ground - SIGN_M[1]));
        for y in [left, left + wide - POST_M] {
            b.cuboid(trim, Vec3::new(x - 0.05, y, 0.0), Vec3::new(x + 0.10, y + POST_M, ground - SIGN_M[1]));
        }
        if !(variant / 2 + k).is_multiple_of(3) {
            awning(b, rgb, x, pane, high);
        }
    }
    boards
}

/// An awning over a window: a sheet that falls to the front, with a strip hanging from its edge.
fn awning(b: &mut MeshBuilder, rgb: [f32; 3], x: f32, [y0, y1]: [f32; 2], top: f32) {
    let stripe = MeshPart::new(TAG, Surface::Plain, rgb.map(|c| (1.3 * c + 0.03).min(0.8)));
    let light = MeshPart::new(TAG, Surface::Plain, [0.62, 0.60, 0.55]);
    let low = AWNING_M[0].min(top - 0.15);
    let out = x + AWNING_M[1];
    let stripe_m = if b.detail() == Detail::Coarse { y1 - y0 } else { 0.45 };
    let stripes = ((y1 - y0) / stripe_m).round().max(1.0) as u32;
    for k in 0..stripes {
        let at = |k: u32| y0 + (y1 - y0) * k as f32 / stripes as f32;
        let ring = |y: f32| -> Vec<Vec3> {
            [
                (x, top - 0.03),
                (out, low + 0.17),
                (out, low),
                (out + 0.02, low),
                (out + 0.02, low + 0.2),
                (x, top),
            ]
            .map(|(x, z)| Vec3::new(x, y, z))
            .to_vec()
        };
        let part = if k.is_multiple_of(2) { stripe } else { light };
        b.loft(&[ring(at(k)), ring(at(k + 1))], |_, _| part, [part; 2]);
    }
}
