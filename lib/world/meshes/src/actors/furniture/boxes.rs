//! Post boxes, cabinets, machines, phone boxes, chargers.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::outline::{along_x, along_y};
use super::parts::{BLACK, CONCRETE, DARK_STEEL, STEEL, block, pick, still, turned};
use super::picture::{Lies, PRINTED, Skin};
use crate::actors::canvas::Canvas;
use crate::solids::{MeshBuilder, circle};

const LABEL: MeshPart = still(Surface::Plain, [0.78, 0.78, 0.74]);
const SCREEN: MeshPart = still(Surface::Glass, [0.03, 0.05, 0.06]);

/// An outline with a round top: half widths, foot and height.
fn round_top(half: f32, low: f32, high: f32) -> Vec<[f32; 2]> {
    let mut outline = vec![[-half, low], [half, low]];
    outline.extend(circle(16).take(9).map(|(c, s)| [half * c, high - half + half * s]));
    outline
}

/// A large box on four feet, its top round.
pub(super) fn postbox_round_top(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.03, 0.09, 0.30], [0.04, 0.22, 0.10], [0.45, 0.05, 0.03]], variant));
    for x in [-0.78, 0.78] {
        for y in [-0.78, 0.78] {
            block(b, body, [x * half.x, y * half.y], [0.03, 0.03], [0.0, 0.14]);
        }
    }
    along_y(b, body, &round_top(0.94 * half.x, 0.12, h), [-half.y, half.y]);
    // The flap with its handle, a label, the door at the foot.
    let front = 0.94 * half.x;
    block(b, STEEL, [front - 0.007, 0.0], [0.02, 0.72 * half.y], [0.70 * h, 0.715 * h]);
    block(b, BLACK, [front, 0.0], [0.006, 0.72 * half.y], [0.765 * h, 0.78 * h]);
    block(b, LABEL, [front, 0.0], [0.008, 0.5 * half.y], [0.52 * h, 0.63 * h]);
    for z in [0.20, 0.46] {
        block(b, BLACK, [front, 0.0], [0.005, 0.8 * half.y], [z * h, z * h + 0.008]);
    }
    block(b, STEEL, [front, 0.6 * half.y], [0.012, 0.02], [0.32 * h, 0.36 * h]);
}

/// A round pillar with a cap.
pub(super) fn postbox_pillar(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.52, 0.02, 0.02], [0.05, 0.26, 0.12], [0.62, 0.42, 0.03]], variant));
    let r = half.x;
    turned(b, BLACK, [0.0; 2], &[(0.0, 0.94 * r), (0.12 * h, 0.94 * r), (0.13 * h, 0.88 * r)], 14);
    turned(b, body, [0.0; 2], &[(0.12 * h, 0.86 * r), (0.86 * h, 0.86 * r)], 14);
    let cap = [(0.86 * h, r), (0.90 * h, r), (0.95 * h, 0.88 * r), (0.985 * h, 0.55 * r), (h, 0.12 * r)];
    turned(b, body, [0.0; 2], &cap, 14);
    let front = 0.86 * r;
    block(b, BLACK, [front - 0.01, 0.0], [0.022, 0.42 * r], [0.76 * h, 0.785 * h]);
    block(b, body, [front - 0.01, 0.0], [0.035, 0.46 * r], [0.79 * h, 0.80 * h]);
    block(b, LABEL, [front - 0.02, 0.0], [0.03, 0.26 * r], [0.58 * h, 0.70 * h]);
    block(b, STEEL, [front - 0.02, 0.3 * r], [0.03, 0.03], [0.40 * h, 0.44 * h]);
}

/// A box with a slanting lid on a post.
pub(super) fn postbox_on_post(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.72, 0.46, 0.02], [0.50, 0.03, 0.03], [0.03, 0.16, 0.42]], variant));
    block(b, DARK_STEEL, [0.0, 0.0], [0.05, 0.05], [0.012, 0.6 * h]);
    block(b, DARK_STEEL, [0.0, 0.0], [0.11, 0.11], [0.0, 0.012]);
    let side = [
        [-half.x, 0.58 * h],
        [0.92 * half.x, 0.58 * h],
        [0.92 * half.x, 0.93 * h],
        [0.6 * half.x, 0.985 * h],
        [-half.x, h],
    ];
    along_y(b, body, &side, [-half.y, half.y]);
    let front = 0.92 * half.x;
    block(b, BLACK, [front, 0.0], [0.006, 0.74 * half.y], [0.885 * h, 0.905 * h]);
    block(b, body, [front + 0.004, 0.0], [0.008, 0.8 * half.y], [0.908 * h, 0.922 * h]);
    block(b, LABEL, [front, 0.0], [0.006, 0.34 * half.y], [0.72 * h, 0.82 * h]);
    block(b, BLACK, [front, 0.0], [0.004, 0.8 * half.y], [0.64 * h, 0.646 * h]);
}

/// A house's letter box on a post: with a round top and a flag, or a box with a roof.
pub(super) fn letterbox(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colour =
        pick(&[[0.40, 0.41, 0.42], [0.05, 0.05, 0.06], [0.50, 0.50, 0.47], [0.06, 0.16, 0.10]], variant);
    let body = still(Surface::Metal, colour);
    let wood = still(Surface::Wood, [0.28, 0.19, 0.11]);
    block(b, wood, [0.0, 0.0], [0.05, 0.05], [0.0, 0.80 * h]);
    if variant.is_multiple_of(2) {
        block(b, wood, [0.0, 0.0], [0.9 * half.x, 0.05], [0.76 * h, 0.80 * h]);
        let wide = 0.86 * half.y;
        along_x(b, body, &round_top(wide, 0.80 * h, h), [-half.x, 0.97 * half.x]);
        along_x(b, BLACK, &round_top(0.93 * wide, 0.81 * h, h - 0.01), [0.97 * half.x, half.x]);
        let flag = still(Surface::Plain, [0.60, 0.03, 0.02]);
        block(b, flag, [0.2 * half.x, 0.93 * half.y], [0.012, 0.07 * half.y], [0.86 * h, 0.985 * h]);
        block(b, flag, [0.32 * half.x, 0.93 * half.y], [0.04, 0.07 * half.y], [0.95 * h, 0.985 * h]);
    } else {
        block(b, body, [0.0, 0.0], [0.62 * half.x, half.y - 0.01], [0.72 * h, 0.95 * h]);
        let roof = [[-half.x, 0.95 * h], [half.x, 0.95 * h], [0.0, h]];
        along_y(b, body, &roof, [-half.y, half.y]);
        block(b, BLACK, [0.62 * half.x, 0.0], [0.006, 0.7 * half.y], [0.90 * h, 0.915 * h]);
        block(b, LABEL, [0.62 * half.x, 0.0], [0.006, 0.35 * half.y], [0.80 * h, 0.84 * h]);
    }
}

/// Where the letter on a pay machine stands, as shares of its height.
const LETTER: [f32; 2] = [0.80, 0.97];

/// A machine that sells parking tickets.
pub(super) fn pay_machine(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Metal, pick(&[[0.20, 0.22, 0.23], [0.07, 0.10, 0.16], [0.40, 0.40, 0.38]], variant));
    block(b, DARK_STEEL, [0.0, 0.0], [0.8 * half.x, 0.8 * half.y], [0.0, 0.06 * h]);
    let side = [
        [-half.x, 0.06 * h],
        [0.7 * half.x, 0.06 * h],
        [0.7 * half.x, 0.58 * h],
        [half.x - 0.01, 0.62 * h],
        [0.45 * half.x, 0.76 * h],
        [0.45 * half.x, 0.78 * h],
        [-half.x, 0.78 * h],
    ];
    along_y(b, body, &side, [-half.y, half.y]);
    // The screen lies on the slanting desk.
    let desk = |share: f32, out: f32| {
        [half.x - 0.01 - share * (0.55 * half.x - 0.01) + out, (0.62 + 0.14 * share) * h + 0.3 * out]
    };
    let screen = [desk(0.25, -0.01), desk(0.25, 0.008), desk(0.85, 0.008), desk(0.85, -0.01)];
    along_y(b, SCREEN, &screen, [-0.55 * half.y, 0.55 * half.y]);
    block(b, BLACK, [0.7 * half.x, 0.0], [0.008, 0.5 * half.y], [0.30 * h, 0.38 * h]);
    block(
        b,
        still(Surface::Plain, [0.05, 0.30, 0.10]),
        [0.7 * half.x, -0.4 * half.y],
        [0.008, 0.12 * half.y],
        [0.48 * h, 0.52 * h],
    );
    block(b, STEEL, [0.7 * half.x, 0.4 * half.y], [0.010, 0.16 * half.y], [0.46 * h, 0.53 * h]);
    // The letter on a board over it.
    block(b, DARK_STEEL, [-0.2 * half.x, 0.0], [0.03, 0.03], [0.78 * h, 0.82 * h]);
    let x = -0.2 * half.x;
    b.cuboid(PRINTED, Vec3::new(x - 0.02, -half.y, LETTER[0] * h), Vec3::new(x + 0.02, half.y, h));
}

/// The letter P.
pub(super) fn pay_machine_face(size: Vec3, _variant: u32) -> Skin {
    let [wide, tall] = [size.y, (1.0 - LETTER[0]) * size.z];
    let mut canvas = Canvas::new([wide, tall], [0.02, 0.10, 0.45]);
    canvas.write("P", [0.5 * wide, 0.5 * tall], 0.72 * tall, wide, [0.85; 3]);
    let (low, high) =
        (Vec3::new(0.0, -0.5 * size.y, LETTER[0] * size.z), Vec3::new(0.0, 0.5 * size.y, size.z));
    Skin { image: canvas.finish(), lies: Lies::AlongX, low, high }
}

/// A cabinet on a plinth, with doors, vents and a lid.
pub(super) fn cabinet(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.36, 0.37, 0.35], [0.16, 0.22, 0.17], [0.46, 0.44, 0.38]], variant));
    block(b, CONCRETE, [0.0, 0.0], [0.92 * half.x, 0.97 * half.y], [0.0, 0.10 * h]);
    block(b, body, [0.0, 0.0], [half.x - 0.025, half.y - 0.02], [0.10 * h, 0.95 * h]);
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.95 * h), Vec3::new(half.x, half.y, h));
    b.tapered(body, low, high, 0.85, 0.95);
    let front = half.x - 0.025;
    let doors = if size.y > 0.9 { 2 } else { 1 };
    for k in 0..doors {
        let wide = (2.0 * half.y - 0.10) / doors as f32;
        let y = -half.y + 0.05 + wide * (k as f32 + 0.5);
        block(b, body, [front + 0.006, y], [0.010, 0.5 * wide - 0.012], [0.14 * h, 0.91 * h]);
        block(b, BLACK, [front + 0.014, y + 0.32 * wide], [0.010, 0.012], [0.48 * h, 0.58 * h]);
        for slot in 0..4 {
            let z = 0.18 * h + 0.035 * slot as f32;
            block(b, BLACK, [front + 0.013, y], [0.006, 0.28 * wide], [z, z + 0.012]);
        }
    }
    let yellow = still(Surface::Plain, [0.70, 0.50, 0.03]);
    block(b, yellow, [front + 0.013, -0.25 * half.y], [0.006, 0.045], [0.74 * h, 0.80 * h]);
}

/// A phone box: a frame with clear panes, the phone on its back wall.
pub(super) fn phone_box(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let frame =
        still(Surface::Plain, pick(&[[0.50, 0.02, 0.02], [0.05, 0.07, 0.09], [0.58, 0.10, 0.30]], variant));
    let post = 0.035;
    block(b, frame, [0.0, 0.0], [half.x, half.y], [0.0, 0.04]);
    for x in [-half.x + post, half.x - post] {
        for y in [-half.y + post, half.y - post] {
            block(b, frame, [x, y], [post, post], [0.04, h - 0.22]);
        }
    }
    block(b, frame, [0.0, 0.0], [half.x - 0.008, half.y - 0.008], [h - 0.24, h - 0.08]);
    let (low, high) = (Vec3::new(-half.x, -half.y, h - 0.08), Vec3::new(half.x, half.y, h));
    b.tapered(frame, low, high, 0.72, 0.72);
    for side in [-1.0f32, 1.0] {
        block(b, LABEL, [side * (half.x - 0.004), 0.0], [0.004, 0.72 * half.y], [h - 0.20, h - 0.12]);
        // Bars across the panes of the sides, a solid foot.
        let y = side * (half.y - post);
        block(b, frame, [0.0, y], [half.x - 2.0 * post, 0.015], [0.04, 0.45]);
        for z in [0.85, 1.25, 1.65] {
            block(b, frame, [0.0, y], [half.x - 2.0 * post, 0.012], [z, z + 0.025]);
        }
    }
    let back = -half.x + 0.03;
    block(b, frame, [back, 0.0], [0.015, half.y - 2.0 * post], [0.04, h - 0.24]);
    block(b, DARK_STEEL, [back + 0.10, 0.0], [0.09, 0.18], [0.95, 1.60]);
    block(b, SCREEN, [back + 0.19, 0.03], [0.006, 0.10], [1.42, 1.54]);
    block(b, STEEL, [back + 0.19, 0.05], [0.008, 0.06], [1.12, 1.34]);
    b.bar(BLACK, Vec3::new(back + 0.20, -0.12, 1.20), Vec3::new(back + 0.20, -0.12, 1.45), [0.022; 2], 6);
}

/// A charger for cars: a slim body with a screen and a cable that hangs.
pub(super) fn charger(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let body =
        still(Surface::Plain, pick(&[[0.66, 0.67, 0.66], [0.10, 0.11, 0.12], [0.20, 0.42, 0.24]], variant));
    let accent =
        still(Surface::Plain, pick(&[[0.08, 0.50, 0.16], [0.04, 0.30, 0.62], [0.75, 0.75, 0.72]], variant));
    block(b, CONCRETE, [0.0, 0.0], [half.x, 0.9 * half.y], [0.0, 0.05]);
    let side = [
        [-0.8 * half.x, 0.05],
        [0.62 * half.x, 0.05],
        [0.62 * half.x, 0.95 * h],
        [0.4 * half.x, h],
        [-0.8 * half.x, h],
    ];
    along_y(b, body, &side, [-0.74 * half.y, 0.74 * half.y]);
    let front = 0.62 * half.x;
    block(b, SCREEN, [front, 0.0], [0.006, 0.48 * half.y], [0.74 * h, 0.86 * h]);
    block(b, accent, [front, 0.0], [0.005, 0.6 * half.y], [0.895 * h, 0.925 * h]);
    for side in [-1.0f32, 1.0] {
        let y = side * 0.74 * half.y;
        block(b, BLACK, [0.2 * half.x, y], [0.05, 0.035], [0.56 * h, 0.64 * h]);
        // A loop of cable from the plug to the foot.
        let out = side * (half.y - 0.02);
        let cable = [
            Vec3::new(0.35 * half.x, out, 0.58 * h),
            Vec3::new(0.75 * half.x, out, 0.34 * h),
            Vec3::new(0.55 * half.x, out, 0.16 * h),
            Vec3::new(0.15 * half.x, side * 0.78 * half.y, 0.26 * h),
        ];
        for pair in cable.windows(2) {
            b.bar(BLACK, pair[0], pair[1], [0.014; 2], 5);
        }
    }
}

/// Two boxes for newspapers side by side.
pub(super) fn newspaper_boxes(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let colours =
        [[0.55, 0.05, 0.03], [0.04, 0.16, 0.40], [0.70, 0.45, 0.03], [0.05, 0.28, 0.14], [0.30, 0.30, 0.30]];
    for k in 0..2u32 {
        let body = still(Surface::Plain, pick(&colours, 2 * variant + 3 * k));
        let y = (k as f32 - 0.5) * half.y;
        let wide = 0.5 * half.y - 0.02;
        block(b, DARK_STEEL, [0.0, y], [0.75 * half.x, 0.6 * wide], [0.0, 0.30 * h]);
        let side = [
            [-half.x, 0.30 * h],
            [0.9 * half.x, 0.30 * h],
            [0.9 * half.x, 0.72 * h],
            [0.55 * half.x, h],
            [-half.x, h],
        ];
        along_y(b, body, &side, [y - wide, y + wide]);
        let front = 0.9 * half.x;
        block(b, SCREEN, [front, y], [0.006, 0.78 * wide], [0.46 * h, 0.68 * h]);
        block(b, LABEL, [front, y], [0.010, 0.62 * wide], [0.48 * h, 0.58 * h]);
        block(b, STEEL, [front + 0.004, y], [0.015, 0.4 * wide], [0.69 * h, 0.705 * h]);
    }
}
