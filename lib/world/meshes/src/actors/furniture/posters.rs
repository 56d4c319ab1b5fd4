//! What carries posters: columns, lit frames, billboards, boards, and the kiosk.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::mesh_textures::{Image, Wrap};
use std::sync::Arc;

use super::outline::along_y;
use super::parts::{BLACK, CONCRETE, DARK_STEEL, STEEL, block, loose, pick, still, turned};
use super::picture::{Lies, PRINTED, Skin, poster};
use crate::actors::canvas::Canvas;
use crate::solids::{Detail, MeshBuilder, circle};

/// From where to where posters reach on a column, as shares of its height, and its radius as one of its
/// box's.
const DRUM: [f32; 2] = [0.14, 0.84];
const DRUM_RADIUS: f32 = 0.90;
/// Posters round a column.
const AROUND: u32 = 4;

/// A round column under a cap, with posters all round.
pub(super) fn advert_column(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (r, h) = (0.5 * size.x, size.z);
    let metal =
        still(Surface::Metal, pick(&[[0.06, 0.11, 0.09], [0.10, 0.10, 0.11], [0.20, 0.21, 0.20]], variant));
    turned(
        b,
        CONCRETE,
        [0.0; 2],
        &[(0.0, r), (0.05 * h, r), (0.06 * h, 0.94 * r), (DRUM[0] * h, 0.92 * r)],
        20,
    );
    turned(b, PRINTED, [0.0; 2], &[(DRUM[0] * h, DRUM_RADIUS * r), (DRUM[1] * h, DRUM_RADIUS * r)], 20);
    let cap = [
        (DRUM[1] * h, 0.93 * r),
        (0.86 * h, r),
        (0.90 * h, r),
        (0.91 * h, 0.86 * r),
        (0.95 * h, 0.60 * r),
        (0.98 * h, 0.22 * r),
        (h, 0.06 * r),
    ];
    turned(b, metal, [0.0; 2], &cap, 20);
}

pub(super) fn advert_column_face(size: Vec3, variant: u32) -> Skin {
    let tall = (DRUM[1] - DRUM[0]) * size.z;
    let wide = std::f32::consts::PI * DRUM_RADIUS * size.x / AROUND as f32;
    // Two pairs, twice round.
    let mut canvas = Canvas::fine([2.0 * wide, tall], [0.50, 0.48, 0.43], 384.0);
    for k in 0..2 {
        let left = wide * k as f32;
        let (low, high) = ([left + 0.05, 0.10], [left + wide - 0.05, tall - 0.10]);
        if k == 0 {
            poster(&mut canvas, low, high, variant);
        } else {
            // Two smaller ones over each other.
            let middle = 0.5 * tall;
            poster(&mut canvas, low, [high[0], middle - 0.04], variant + 2);
            poster(&mut canvas, [low[0], middle + 0.04], high, variant + 3);
        }
    }
    let image = canvas.finish();
    let image = Arc::new(Image { levels: image.levels.clone(), wrap: [Wrap::Repeat, Wrap::Clamp] });
    let (low, high) = (Vec3::Z * DRUM[0] * size.z, Vec3::Z * DRUM[1] * size.z);
    Skin { image, lies: Lies::Round(0.5 * AROUND as f32), low, high }
}

/// Where the printed face of a lit frame is in its box: half its width and its heights, as shares.
const PANE: [f32; 3] = [0.90, 0.24, 0.96];

/// A lit frame with a poster on both sides.
pub(super) fn city_light(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let metal = still(
        Surface::Metal,
        pick(&[[0.30, 0.31, 0.32], [0.07, 0.075, 0.08], [0.05, 0.12, 0.10]], variant / 2),
    );
    block(b, metal, [0.0, 0.0], [half.x, 0.55 * half.y], [0.0, 0.04]);
    block(b, metal, [0.0, 0.0], [0.42 * half.x, 0.5 * half.y], [0.04, 0.20 * h]);
    block(b, metal, [0.0, 0.0], [0.66 * half.x, half.y], [0.20 * h, 0.985 * h]);
    let (low, high) = (Vec3::new(-0.66 * half.x, -half.y, 0.985 * h), Vec3::new(0.66 * half.x, half.y, h));
    b.tapered(metal, low, high, 0.6, 0.97);
    block(b, PRINTED, [0.0, 0.0], [0.70 * half.x, PANE[0] * half.y], [PANE[1] * h, PANE[2] * h]);
}

pub(super) fn city_light_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (PANE[0] * size.y, (PANE[2] - PANE[1]) * size.z);
    let mut canvas = Canvas::fine([wide, tall], [0.80; 3], 384.0);
    poster(&mut canvas, [0.03, 0.03], [wide - 0.03, tall - 0.03], variant);
    let low = Vec3::new(0.0, -0.5 * wide, PANE[1] * size.z);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}

/// Lower edge of a billboard as a share of its height.
const BOARD_FROM: f32 = 0.40;

/// A large board on two posts with struts behind it.
pub(super) fn billboard(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let post = pick(&[still(Surface::Wood, [0.24, 0.17, 0.11]), STEEL], variant / 3);
    let low = BOARD_FROM * h;
    for side in [-1.0f32, 1.0] {
        let y = side * (half.y - 0.16);
        block(b, post, [0.1 * half.x, y], [0.07, 0.08], [0.0, 0.97 * h]);
        b.bar(post, Vec3::new(-half.x + 0.06, y, 0.012), Vec3::new(0.0, y, low + 0.25 * h), [0.05; 2], 4);
    }
    let front = half.x - 0.03;
    let frame = still(Surface::Metal, [0.26, 0.27, 0.28]);
    block(b, frame, [front - 0.05, 0.0], [0.05, half.y], [low, h]);
    let (y, z) = (half.y - 0.09, [low + 0.09, h - 0.09]);
    b.cuboid(PRINTED, Vec3::new(front - 0.02, -y, z[0]), Vec3::new(front + 0.012, y, z[1]));
    // A walkway under it, battens on its back.
    block(b, frame, [half.x - 0.15, 0.0], [0.15, 0.98 * half.y], [low - 0.10, low - 0.06]);
    for z in [0.2f32, 0.5, 0.8] {
        let z = low + z * (h - low);
        block(b, post, [front - 0.125, 0.0], [0.03, 0.96 * half.y], [z - 0.04, z + 0.04]);
    }
}

pub(super) fn billboard_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (size.y - 0.18, (1.0 - BOARD_FROM) * size.z - 0.18);
    let mut canvas = Canvas::fine([wide, tall], [0.80; 3], 448.0);
    poster(&mut canvas, [0.0, 0.0], [wide, tall], variant);
    let low = Vec3::new(0.0, -0.5 * wide, BOARD_FROM * size.z + 0.09);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}

/// Two boards that lean against each other, written on like a slate.
pub(super) fn a_board(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let frame =
        loose(Surface::Wood, pick(&[[0.30, 0.19, 0.10], [0.10, 0.10, 0.10], [0.46, 0.44, 0.40]], variant));
    for side in [-1.0f32, 1.0] {
        let x = |share: f32, off: f32| side * (half.x - 0.012 - share * (half.x - 0.05) + off);
        let slab = |b: &mut MeshBuilder, part: MeshPart, z: [f32; 2], y: f32, off: [f32; 2]| {
            let at = |z: f32, off: f32| [x(z, off), z * h];
            along_y(
                b,
                part,
                &[at(z[0], off[0]), at(z[0], off[1]), at(z[1], off[1]), at(z[1], off[0])],
                [-y, y],
            );
        };
        slab(b, frame, [0.0, 1.0], half.y, [-0.035, 0.0]);
        slab(b, loose_print(), [0.12, 0.95], 0.88 * half.y, [-0.02, 0.008]);
    }
    block(b, DARK_STEEL, [0.0, 0.0], [0.05, 0.7 * half.y], [0.97 * h, h]);
}

const fn loose_print() -> MeshPart {
    MeshPart { tag: schema::Tag::Dynamic, ..PRINTED }
}

pub(super) fn a_board_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (0.88 * size.y, 0.83 * size.z);
    let ground = pick(&[[0.02, 0.025, 0.022], [0.03, 0.06, 0.045], [0.62, 0.58, 0.46]], variant);
    let ink = if variant % 3 == 2 { [0.25, 0.05, 0.03] } else { [0.78, 0.78, 0.74] };
    let mut canvas = Canvas::new([wide, tall], ground);
    let words = pick(
        &[["TODAY", "SOUP 4", "PIE 6"], ["COFFEE", "AND CAKE", "3 50"], ["SALE", "ALL DAY", "50 OFF"]],
        variant / 3,
    );
    for (k, word) in words.into_iter().enumerate() {
        let tall_m = if k == 0 { 0.15 } else { 0.10 } * tall;
        canvas.write(word, [0.5 * wide, (0.80 - 0.26 * k as f32) * tall], tall_m, 0.84 * wide, ink);
    }
    canvas.fill(
        &[
            [0.15 * wide, 0.66 * tall],
            [0.85 * wide, 0.66 * tall],
            [0.85 * wide, 0.675 * tall],
            [0.15 * wide, 0.675 * tall],
        ],
        ink,
    );
    let low = Vec3::new(0.0, -0.5 * wide, 0.12 * size.z);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}

/// A board with a map of the town on two legs.
pub(super) fn info_board(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let frame = pick(&[DARK_STEEL, still(Surface::Wood, [0.28, 0.18, 0.10])], variant);
    for side in [-1.0f32, 1.0] {
        block(b, frame, [0.0, side * (half.y - 0.06)], [0.6 * half.x, 0.05], [0.0, 0.94 * h]);
    }
    block(b, frame, [0.0, 0.0], [0.5 * half.x, half.y - 0.11], [0.42 * h, 0.94 * h]);
    let y = half.y - 0.16;
    block(b, PRINTED, [0.06, 0.0], [0.5 * half.x, y], [0.45 * h, 0.91 * h]);
    let roof = [[-half.x, 0.94 * h], [half.x, 0.94 * h], [0.0, h]];
    along_y(b, frame, &roof, [-half.y, half.y]);
}

pub(super) fn info_board_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (size.y - 0.32, 0.46 * size.z);
    let mut canvas = Canvas::fine([wide, tall], [0.66, 0.66, 0.56], 320.0);
    let at = |u: f32, v: f32| [u * wide, v * tall];
    // A park, a river, streets, and where one stands.
    canvas.fill(&[at(0.06, 0.10), at(0.34, 0.08), at(0.30, 0.42), at(0.05, 0.46)], [0.22, 0.42, 0.14]);
    canvas.fill(
        &[at(0.0, 0.55), at(0.4, 0.48), at(1.0, 0.66), at(1.0, 0.74), at(0.4, 0.56), at(0.0, 0.64)],
        [0.20, 0.40, 0.62],
    );
    for k in 0..5 {
        let u = 0.14 + 0.18 * k as f32 + 0.02 * (variant % 3) as f32;
        canvas.fill(&[at(u, 0.04), at(u + 0.02, 0.04), at(u + 0.05, 0.82), at(u + 0.03, 0.82)], [0.88; 3]);
    }
    for v in [0.14f32, 0.32, 0.46, 0.74] {
        canvas.fill(&[at(0.04, v), at(0.96, v + 0.04), at(0.96, v + 0.065), at(0.04, v + 0.025)], [0.88; 3]);
    }
    let dot: Vec<[f32; 2]> =
        circle(10).map(|(c, s)| [0.56 * wide + 0.03 * c, 0.36 * tall + 0.03 * s]).collect();
    canvas.fill(&dot, [0.65, 0.03, 0.03]);
    canvas.fill(&[at(0.0, 0.86), at(1.0, 0.86), at(1.0, 1.0), at(0.0, 1.0)], [0.05, 0.16, 0.30]);
    canvas.write("TOWN MAP", at(0.5, 0.93), 0.08 * tall, 0.8 * wide, [0.85; 3]);
    let low = Vec3::new(0.0, -0.5 * wide, 0.45 * size.z);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}

/// Heights of a kiosk's counter, opening and fascia, as shares of its height.
const KIOSK: [f32; 4] = [0.36, 0.72, 0.76, 0.90];

/// A kiosk with a counter, papers beside it, a fascia and a roof that sticks out.
pub(super) fn kiosk(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colour = pick(&[[0.06, 0.18, 0.12], [0.42, 0.08, 0.05], [0.10, 0.16, 0.28]], variant);
    let body = still(Surface::Plain, colour);
    let trim = still(Surface::Metal, [0.14, 0.14, 0.15]);
    let [x, y] = [half.x - 0.20, half.y - 0.16];
    let [counter, lintel, fascia, top] = KIOSK.map(|share| share * h);
    block(b, CONCRETE, [0.0, 0.0], [x + 0.03, y + 0.03], [0.0, 0.10]);
    block(b, body, [0.0, 0.0], [x, y], [0.10, counter]);
    // Above the counter the front is open between its corners: a dark room, and a shelf before it.
    let room = still(Surface::Plain, [0.05, 0.045, 0.04]);
    block(b, room, [-0.10, 0.0], [x - 0.10, y - 0.04], [counter, lintel]);
    block(b, body, [-x + 0.06, 0.0], [0.06, y], [counter, lintel]);
    for side in [-1.0f32, 1.0] {
        block(b, body, [0.5 * x - 0.05, side * (y - 0.10)], [0.5 * x + 0.05, 0.10], [counter, lintel]);
        block(b, body, [-0.5 * x, side * (y - 0.05)], [0.5 * x, 0.05], [counter, lintel]);
    }
    block(b, trim, [x + 0.06, 0.0], [0.14, y - 0.08], [counter - 0.01, counter + 0.03]);
    block(b, body, [0.0, 0.0], [x, y], [lintel, top]);
    block(b, trim, [0.0, 0.0], [half.x, half.y], [top, top + 0.06]);
    b.tapered(trim, Vec3::new(-half.x, -half.y, top + 0.06), Vec3::new(half.x, half.y, h), 0.55, 0.55);
    b.cuboid(PRINTED, Vec3::new(x - 0.02, -y + 0.06, fascia), Vec3::new(x + 0.03, y - 0.06, top - 0.02));
    if b.detail() > Detail::Full {
        return;
    }
    // Papers and sweets: rows of colours on the counter and below it.
    let colours =
        [[0.60, 0.08, 0.05], [0.72, 0.68, 0.55], [0.06, 0.20, 0.45], [0.70, 0.48, 0.05], [0.10, 0.34, 0.14]];
    for k in 0..7u32 {
        let y_at = (k as f32 - 3.0) * 0.26 * y;
        let paper = still(Surface::Plain, pick(&colours, 3 * k + variant));
        block(b, paper, [x + 0.012, y_at], [0.012, 0.10 * y], [0.42 * counter + 0.05, 0.80 * counter]);
    }
    for k in 0..4u32 {
        let part = still(Surface::Plain, pick(&colours, 2 * k + variant + 1));
        block(
            b,
            part,
            [x - 0.08, (k as f32 - 1.5) * 0.40 * y],
            [0.07, 0.12 * y],
            [counter + 0.03, counter + 0.18],
        );
    }
    let door = still(Surface::Plain, colour.map(|c| 0.6 * c));
    block(b, door, [-0.35 * x, -y], [0.38, 0.012], [0.12, 0.70 * h]);
    block(b, STEEL, [-0.35 * x + 0.30, -y - 0.02], [0.015, 0.02], [0.36 * h, 0.40 * h]);
    block(b, BLACK, [0.0, y + 0.004], [0.5 * x, 0.006], [0.46 * h, 0.66 * h]);
}

pub(super) fn kiosk_face(size: Vec3, variant: u32) -> Skin {
    let (wide, tall) = (size.y - 0.44, (KIOSK[3] - KIOSK[2]) * size.z - 0.02);
    let mut canvas = Canvas::fine(
        [wide, tall],
        pick(&[[0.66, 0.52, 0.20], [0.80, 0.76, 0.66], [0.75, 0.75, 0.72]], variant),
        384.0,
    );
    canvas.write("KIOSK", [0.5 * wide, 0.5 * tall], 0.62 * tall, 0.6 * wide, [0.10, 0.04, 0.03]);
    let low = Vec3::new(0.0, -0.5 * wide, KIOSK[2] * size.z);
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high: low + Vec3::new(0.0, wide, tall) }
}
