//! Bus shelters.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::outline::along_y;
use super::parts::{block, pick, still};
use super::picture::{Lies, PRINTED, Skin, poster};
use crate::actors::canvas::Canvas;
use crate::solids::{Detail, MeshBuilder};

/// Lower and upper edge of the poster at its end, metres, and half its width as a share of the shelter's
/// depth.
const POSTER: [f32; 2] = [0.42, 2.08];
const POSTER_HALF: f32 = 0.40;

/// A roof on posts, clear panes at the back and at one end, a lit frame at the other one, a bench.
pub(super) fn bus_shelter(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let metal =
        still(Surface::Metal, pick(&[[0.08, 0.085, 0.09], [0.32, 0.33, 0.34], [0.05, 0.14, 0.11]], variant));
    let band = still(Surface::Plain, [0.70, 0.71, 0.70]);
    let wood = still(Surface::Wood, [0.34, 0.22, 0.12]);
    let post = 0.04;
    let back = -half.x + 0.10;
    let end = half.y - 0.10;
    let under = h - 0.20;
    // The back: five posts, rails, two printed bands.
    for k in 0..5 {
        let y = -end + 2.0 * end * k as f32 / 4.0;
        block(b, metal, [back, y], [post, post], [0.0, under]);
    }
    for (z, high) in [(0.16, 0.06), (under - 0.06, 0.06)] {
        block(b, metal, [back, 0.0], [0.025, end], [z, z + high]);
    }
    for z in [0.95, 1.45] {
        block(b, band, [back, 0.0], [0.006, end], [z, z + 0.09]);
    }
    // The end without poster, narrower than the roof.
    let front = 0.42 * half.x;
    block(b, metal, [front, -end], [post, post], [0.0, under]);
    let (middle, reach) = (0.5 * (back + front), 0.5 * (front - back) - post);
    for (z, high) in [(0.16, 0.06), (under - 0.06, 0.06)] {
        block(b, metal, [middle, -end], [reach, 0.025], [z, z + high]);
    }
    let bands: &[f32] = if b.detail() == Detail::Full { &[0.95, 1.45] } else { &[] };
    for z in bands.iter().copied() {
        block(b, band, [middle, -end], [reach, 0.006], [z, z + 0.09]);
    }
    // The frame at the other end.
    let x = POSTER_HALF * size.x;
    block(b, metal, [0.0, end], [x + 0.06, 0.07], [0.30, 2.20]);
    for x in [-x, x] {
        block(b, metal, [x, end], [0.04, 0.05], [0.0, 0.30]);
    }
    block(b, metal, [-x, end], [0.04, 0.05], [2.20, under]);
    block(b, metal, [x, end], [0.04, 0.05], [2.20, under]);
    block(b, PRINTED, [0.0, end], [x, 0.076], POSTER);
    // The roof: it falls to the back, with a fascia in front.
    let slab: MeshPart = still(Surface::Metal, [0.20, 0.21, 0.22]);
    let front = half.x - 0.01;
    let side = [[-half.x, under], [front, under + 0.05], [front, h], [front - 0.06, h], [-half.x, h - 0.10]];
    along_y(b, slab, &side, [-half.y, half.y]);
    let name = still(Surface::Plain, pick(&[[0.70, 0.55, 0.05], [0.70; 3], [0.60, 0.62, 0.60]], variant));
    block(b, name, [half.x - 0.004, 0.0], [0.004, 0.62 * half.y], [under + 0.075, h - 0.025]);
    // The bench.
    for y in [-0.52f32, 0.10] {
        block(b, metal, [back + 0.32, y * end], [0.14, 0.025], [0.0, 0.42]);
    }
    if b.detail() > Detail::Full {
        block(b, wood, [back + 0.33, -0.21 * end], [0.185, 0.42 * end], [0.42, 0.46]);
        return;
    }
    for k in 0..3 {
        let x = back + 0.20 + 0.13 * k as f32;
        block(b, wood, [x, -0.21 * end], [0.055, 0.42 * end], [0.42, 0.46]);
    }
    // The times.
    block(b, metal, [back + 0.04, 0.55 * end], [0.02, 0.30], [1.05, 1.75]);
    block(b, band, [back + 0.055, 0.55 * end], [0.012, 0.26], [1.09, 1.71]);
}

pub(super) fn bus_shelter_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (2.0 * POSTER_HALF * size.x, POSTER[1] - POSTER[0]);
    let mut canvas = Canvas::fine([wide, tall], [0.80; 3], 384.0);
    poster(&mut canvas, [0.03, 0.03], [wide - 0.03, tall - 0.03], variant);
    let low = Vec3::new(-0.5 * wide, 0.0, POSTER[0]);
    Skin { image: canvas.finish(), lies: Lies::AlongY, low, high: low + Vec3::new(wide, 0.0, tall) }
}
