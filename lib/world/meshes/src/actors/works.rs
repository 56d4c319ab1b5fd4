//! What lies about in road works.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{Tag, lights};

use crate::solids::MeshBuilder;

const fn of(surface: Surface, rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::Static, surface, rgb)
}

const STEEL: MeshPart = of(Surface::Metal, [0.30, 0.31, 0.32]);
const RUST: MeshPart = of(Surface::Metal, [0.28, 0.13, 0.06]);
const STONE: MeshPart = of(Surface::Concrete, [0.42, 0.42, 0.41]);
const TIMBER: MeshPart = of(Surface::Wood, [0.40, 0.28, 0.15]);
const SAND: MeshPart = of(Surface::Concrete, [0.46, 0.36, 0.22]);
const SACKING: MeshPart = of(Surface::Plain, [0.36, 0.30, 0.20]);
const RUBBER: MeshPart = of(Surface::Rubber, [0.04; 3]);
const YELLOW: MeshPart = of(Surface::Plain, [0.75, 0.48, 0.03]);

/// A thing of road works by name; it fills its box.
pub(crate) fn item(kind: &str, size: Vec3, variant: u32) -> Option<TriMesh> {
    let half = 0.5 * size;
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    let mut b = MeshBuilder::new();
    match kind {
        "barrel" => drum(&mut b, size),
        "sandbag_closed" => b.blob(SACKING, Vec3::Z * 0.4 * size.z, half, 5, 10, |_, _| 1.0),
        "sandbag_open" => open_sandbag(&mut b, size),
        "concrete_piece_1" => broken(&mut b, size, [0.72, 1.0, 0.80, 0.62], variant),
        "concrete_piece_2" => broken(&mut b, size, [0.95, 0.6, 0.7, 1.0], variant.wrapping_add(1)),
        "concrete_slab_1" => b.tapered(STONE, low, high, 0.985, 0.975),
        "concrete_slab_2" => two_slabs(&mut b, size),
        "cylinder" => gas_cylinder(&mut b, size),
        "electrical_box" => cabinet(&mut b, size),
        "floor_grill" => grill(&mut b, size),
        "gutter" => gutter(&mut b, size),
        "hand_truck" => hand_truck(&mut b, size),
        "pallet" => pallet(&mut b, size),
        "shovel" => shovel(&mut b, size),
        "stone_ring" => ring(&mut b, size),
        "toolbox" => toolbox(&mut b, size),
        "wheelbarrow" => wheelbarrow(&mut b, size),
        "wooden_wheel" => reel(&mut b, size),
        "bucket" => bucket(&mut b, size),
        "iron_plank" => beam(&mut b, size),
        "pipe" => pipe(&mut b, size),
        "construction_light" => light(&mut b, size),
        "pile" => pile(&mut b, size, variant),
        "floorboard" => floorboards(&mut b, size, variant),
        _ => return None,
    }
    b.fit(low, high);
    Some(b.finish())
}

/// A sack with sand in its mouth.
fn open_sandbag(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    b.blob(SACKING, Vec3::Z * 0.42 * size.z, Vec3::new(half.x, half.y, 0.42 * size.z), 6, 10, |_, _| 1.0);
    b.stack(
        SACKING,
        &[
            (Vec3::Z * 0.66 * size.z, 0.72 * half.x, 0.72 * half.y),
            (Vec3::Z * 0.88 * size.z, 0.86 * half.x, 0.86 * half.y),
        ],
        10,
    );
    b.ellipsoid(SAND, Vec3::Z * 0.86 * size.z, Vec3::new(0.74 * half.x, 0.74 * half.y, 0.14 * size.z), 4, 10);
}

/// Two slabs, one askew on the other.
fn two_slabs(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    b.cuboid(STONE, low, Vec3::new(high.x, high.y, 0.5 * size.z));
    b.tapered(
        STONE,
        Vec3::new(-0.9 * half.x, -0.94 * half.y, 0.5 * size.z),
        Vec3::new(0.8 * half.x, 0.96 * half.y, size.z),
        0.98,
        0.98,
    );
}

/// A box with a handle.
fn toolbox(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    b.cuboid(of(Surface::Metal, [0.55, 0.03, 0.02]), low, Vec3::new(high.x, high.y, 0.75 * size.z));
    b.cuboid(
        RUBBER,
        Vec3::new(-0.5 * half.x, -0.12 * half.y, 0.75 * size.z),
        Vec3::new(0.5 * half.x, 0.12 * half.y, size.z),
    );
}

/// An H-beam on its side.
fn beam(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let flange = 0.16 * half.y;
    for y in [-half.y, half.y - flange] {
        b.cuboid(RUST, Vec3::new(-half.x, y, 0.0), Vec3::new(half.x, y + flange, size.z));
    }
    b.cuboid(
        RUST,
        Vec3::new(-half.x, -half.y + flange, 0.42 * size.z),
        Vec3::new(half.x, half.y - flange, 0.58 * size.z),
    );
}

/// A pipe that lies along x.
fn pipe(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let outer = half.y.min(half.z);
    b.lathe(
        STONE,
        Vec3::ZERO,
        &[(0.78 * outer, -half.x), (outer, -half.x), (outer, half.x), (0.78 * outer, half.x)],
        18,
    );
    b.lay_down();
}

/// A heap of earth.
fn pile(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let earth = of(Surface::Concrete, [0.20, 0.14, 0.09]);
    let bump =
        |ring: usize, side: usize| 0.85 + 0.04 * ((ring * 3 + side * 7 + variant as usize % 4) % 4) as f32;
    b.blob(earth, Vec3::Z * 0.05 * size.z, half, 6, 12, bump);
}

/// Four boards, not quite in line.
fn floorboards(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    for i in 0..4 {
        let width = size.y / 4.0;
        let y = -half.y + width * i as f32;
        let back = 0.04 * ((i * 2 + variant as usize % 3) % 3) as f32 * size.x;
        b.cuboid(
            TIMBER,
            Vec3::new(-half.x + back, y + 0.006, 0.0),
            Vec3::new(half.x, y + width - 0.006, size.z),
        );
    }
}

/// A gas cylinder with its valve.
fn gas_cylinder(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    b.stack(
        of(Surface::Metal, [0.10, 0.22, 0.30]),
        &[
            (Vec3::ZERO, half.x, half.y),
            (Vec3::Z * 0.80 * size.z, half.x, half.y),
            (Vec3::Z * 0.89 * size.z, 0.6 * half.x, 0.6 * half.y),
            (Vec3::Z * 0.90 * size.z, 0.25 * half.x, 0.25 * half.y),
            (Vec3::Z * size.z, 0.25 * half.x, 0.25 * half.y),
        ],
        12,
    );
}

/// A bucket.
fn bucket(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    b.lathe(
        of(Surface::Plain, [0.04, 0.04, 0.05]),
        Vec3::ZERO,
        &[
            (0.0, 0.0),
            (0.75 * half.x, 0.0),
            (half.x, size.z),
            (0.92 * half.x, size.z),
            (0.68 * half.x, 0.06 * size.z),
            (0.0, 0.06 * size.z),
        ],
        14,
    );
}

/// A ring of a shaft.
fn ring(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    b.lathe(
        STONE,
        Vec3::ZERO,
        &[(0.74 * half.x, 0.0), (half.x, 0.0), (half.x, size.z), (0.74 * half.x, size.z)],
        20,
    );
}

/// A steel drum with two ribs.
fn drum(b: &mut MeshBuilder, size: Vec3) {
    let blue = of(Surface::Metal, [0.05, 0.14, 0.32]);
    let layer = |share: f32, wide: f32| (Vec3::Z * share * size.z, 0.5 * wide * size.x, 0.5 * wide * size.y);
    let ribs: Vec<(Vec3, f32, f32)> = [
        (0.0, 1.0),
        (0.03, 0.97),
        (0.32, 0.97),
        (0.34, 1.0),
        (0.36, 0.97),
        (0.64, 0.97),
        (0.66, 1.0),
        (0.68, 0.97),
        (0.97, 0.97),
        (1.0, 1.0),
    ]
    .map(|(share, wide)| layer(share, wide))
    .to_vec();
    b.stack(blue, &ribs, 14);
}

/// A broken block: each upper corner at its own share of the height.
fn broken(b: &mut MeshBuilder, size: Vec3, tops: [f32; 4], variant: u32) {
    let half = 0.5 * size;
    let corners = [(-1.0f32, -1.0f32), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let ring = |shares: [f32; 4], inset: f32| -> Vec<Vec3> {
        corners
            .iter()
            .zip(shares)
            .enumerate()
            .map(|(k, ((x, y), share))| {
                let cut = 1.0 - inset * (0.3 + 0.23 * ((k as u32 * 2 + variant % 4) % 4) as f32);
                Vec3::new(x * half.x * cut, y * half.y * cut, share * size.z)
            })
            .collect()
    };
    b.loft(&[ring([0.0; 4], 0.10), ring([0.35; 4], 0.0), ring(tops, 0.35)], |_, _| STONE, [STONE; 2]);
    // The reinforcement sticks out.
    for (k, y) in [-0.3, 0.25].into_iter().enumerate() {
        let from = Vec3::new(0.5 * half.x, y * size.y, (0.35 + 0.1 * k as f32) * size.z);
        b.bar(
            RUST,
            from,
            Vec3::new(half.x + 0.06, y * size.y + 0.02, (0.4 + 0.12 * k as f32) * size.z),
            [0.008; 2],
            4,
        );
    }
}

/// A switch cabinet with a door and a warning triangle.
fn cabinet(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let paint = of(Surface::Metal, [0.36, 0.40, 0.36]);
    b.cuboid(STONE, Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, 0.08 * size.z));
    b.cuboid(
        paint,
        Vec3::new(-0.92 * half.x, -0.95 * half.y, 0.08 * size.z),
        Vec3::new(0.88 * half.x, 0.95 * half.y, 0.95 * size.z),
    );
    b.tapered(
        paint,
        Vec3::new(-half.x, -half.y, 0.95 * size.z),
        Vec3::new(half.x, half.y, size.z),
        0.9,
        0.92,
    );
    b.cuboid(
        of(Surface::Metal, [0.42, 0.46, 0.42]),
        Vec3::new(0.88 * half.x, -0.82 * half.y, 0.14 * size.z),
        Vec3::new(0.93 * half.x, 0.82 * half.y, 0.90 * size.z),
    );
    let ring = |x: f32| -> Vec<Vec3> {
        [(-0.3, 0.52), (0.3, 0.52), (0.0, 0.74)].map(|(y, z)| Vec3::new(x, y * half.y, z * size.z)).to_vec()
    };
    b.loft(&[ring(0.92 * half.x), ring(0.95 * half.x)], |_, _| YELLOW, [YELLOW; 2]);
}

fn grill(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let edge = 0.035;
    for y in [-half.y, half.y - edge] {
        b.cuboid(STEEL, Vec3::new(-half.x, y, 0.0), Vec3::new(half.x, y + edge, size.z));
    }
    for x in [-half.x, half.x - edge] {
        b.cuboid(STEEL, Vec3::new(x, -half.y + edge, 0.0), Vec3::new(x + edge, half.y - edge, size.z));
    }
    let bars = (size.x / 0.07).floor().clamp(2.0, 40.0) as usize;
    for i in 1..bars {
        let x = -half.x + size.x * i as f32 / bars as f32;
        b.cuboid(
            STEEL,
            Vec3::new(x - 0.008, -half.y + edge, 0.1 * size.z),
            Vec3::new(x + 0.008, half.y - edge, 0.95 * size.z),
        );
    }
}

/// A drain channel: a trough along x.
fn gutter(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let ring = |x: f32| -> Vec<Vec3> {
        [
            (1.0, 0.0),
            (1.0, 1.0),
            (0.78, 1.0),
            (0.62, 0.30),
            (-0.62, 0.30),
            (-0.78, 1.0),
            (-1.0, 1.0),
            (-1.0, 0.0),
        ]
        .map(|(y, z)| Vec3::new(x, y * half.y, z * size.z))
        .to_vec()
    };
    b.loft(&[ring(-half.x), ring(half.x)], |_, _| STONE, [STONE; 2]);
}

/// A sack barrow that stands upright on its wheels and plate.
fn hand_truck(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let red = of(Surface::Metal, [0.50, 0.05, 0.03]);
    let radius = 0.10 * size.z;
    let back = -half.x + radius;
    for y in [-0.7 * half.y, 0.7 * half.y] {
        b.bar(red, Vec3::new(back, y, 0.03), Vec3::new(back - 0.02, y, 0.86 * size.z), [0.018; 2], 6);
        b.bar(
            red,
            Vec3::new(back - 0.02, y, 0.86 * size.z),
            Vec3::new(-half.x + 0.02, y, size.z),
            [0.02, 0.024],
            6,
        );
        let wheel = if y > 0.0 { [y + 0.02, half.y] } else { [-half.y, y - 0.02] };
        b.bar(RUBBER, Vec3::new(back, wheel[0], radius), Vec3::new(back, wheel[1], radius), [radius; 2], 12);
    }
    for z in [0.2, 0.42, 0.64, 0.84] {
        b.bar(
            red,
            Vec3::new(back, -0.7 * half.y, z * size.z),
            Vec3::new(back, 0.7 * half.y, z * size.z),
            [0.012; 2],
            5,
        );
    }
    b.cuboid(red, Vec3::new(back, -0.75 * half.y, 0.0), Vec3::new(half.x, 0.75 * half.y, 0.02));
}

fn pallet(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    for i in 0..3 {
        let y = (0.5 * i as f32 - 0.5) * (size.y - 0.1);
        b.cuboid(TIMBER, Vec3::new(-half.x, y - 0.05, 0.0), Vec3::new(half.x, y + 0.05, 0.84 * size.z));
    }
    for i in 0..7 {
        let x = -half.x + (size.x - 0.12) * i as f32 / 6.0;
        b.cuboid(TIMBER, Vec3::new(x, -half.y, 0.84 * size.z), Vec3::new(x + 0.12, half.y, size.z));
    }
}

/// A shovel that lies on the ground: the blade in front.
fn shovel(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let neck = half.x - 0.30;
    b.bar(
        TIMBER,
        Vec3::new(-half.x + 0.05, 0.0, 0.5 * size.z),
        Vec3::new(neck, 0.0, 0.75 * size.z),
        [0.018; 2],
        6,
    );
    b.bar(
        TIMBER,
        Vec3::new(-half.x + 0.03, -0.055, 0.5 * size.z),
        Vec3::new(-half.x + 0.03, 0.055, 0.5 * size.z),
        [0.018; 2],
        6,
    );
    let ring = |x: f32, wide: f32, z: f32| -> Vec<Vec3> {
        [(1.0, 0.008), (1.0, 0.030), (0.0, 0.012), (-1.0, 0.030), (-1.0, 0.008), (0.0, 0.0)]
            .map(|(y, up)| Vec3::new(x, y * wide * half.y, z + up))
            .to_vec()
    };
    let rings = [
        ring(neck - 0.02, 0.8, 0.6 * size.z),
        ring(neck + 0.05, 1.0, 0.5 * size.z),
        ring(half.x - 0.08, 0.95, 0.05 * size.z),
        ring(half.x, 0.3, 0.0),
    ];
    b.loft(&rings, |_, _| STEEL, [STEEL; 2]);
}

fn wheelbarrow(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let tray = of(Surface::Metal, [0.07, 0.24, 0.12]);
    let radius = 0.28 * size.z;
    let axle = Vec3::new(half.x - radius, 0.0, radius);
    b.bar(RUBBER, axle - Vec3::Y * 0.04, axle + Vec3::Y * 0.04, [radius; 2], 14);
    for side in [-1.0, 1.0] {
        let grip = Vec3::new(-half.x, side * 0.85 * half.y, 0.72 * size.z);
        b.bar(STEEL, axle + Vec3::Y * side * 0.06, grip, [0.016; 2], 6);
        b.bar(RUBBER, grip.lerp(axle, 0.12), grip, [0.022; 2], 6);
        let foot = Vec3::new(-0.28 * half.x, side * 0.6 * half.y, 0.0);
        b.bar(STEEL, foot, foot + Vec3::new(0.03, 0.0, 0.58 * size.z), [0.014; 2], 5);
    }
    // The tray: a trough with a sloping front, open at the top.
    let (floor, rim) = (0.46 * size.z, size.z);
    let ring = |x0: f32, x1: f32, y: f32, z: f32| -> Vec<Vec3> {
        [(x0, -y), (x1, -y), (x1, y), (x0, y)].map(|(x, y)| Vec3::new(x, y, z)).to_vec()
    };
    let rings = [
        ring(-0.30 * half.x, 0.20 * half.x, 0.62 * half.y, floor),
        ring(-0.46 * half.x, 0.62 * half.x, half.y, rim),
        ring(-0.44 * half.x, 0.59 * half.x, 0.95 * half.y, rim),
        ring(-0.28 * half.x, 0.18 * half.x, 0.58 * half.y, floor + 0.02),
    ];
    b.loft(&rings, |_, _| tray, [tray; 2]);
}

/// A cable reel that stands on its rims.
fn reel(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let radius = half.z;
    let at = |y: f32| Vec3::new(0.0, y, radius);
    for [from, to] in [[-half.y, -0.8 * half.y], [0.8 * half.y, half.y]] {
        b.bar(TIMBER, at(from), at(to), [radius; 2], 20);
    }
    b.bar(
        of(Surface::Rubber, [0.05, 0.05, 0.055]),
        at(-0.8 * half.y),
        at(0.8 * half.y),
        [0.68 * radius; 2],
        16,
    );
    for y in [-half.y - 0.01, 0.96 * half.y] {
        b.bar(STEEL, at(y), at(y + 0.04 * half.y + 0.01), [0.16 * radius; 2], 10);
    }
}

/// A work light: two floodlights on a tripod, which burn in the dark.
fn light(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let hub = Vec3::new(0.0, 0.0, 0.45 * size.z);
    for (x, y) in [(1.0, 0.0), (-0.6, 1.0), (-0.6, -1.0)] {
        b.bar(YELLOW, Vec3::new(x * (half.x - 0.02), y * (half.y - 0.02), 0.0), hub, [0.018; 2], 6);
    }
    b.bar(STEEL, Vec3::Z * 0.25 * size.z, Vec3::Z * 0.93 * size.z, [0.02; 2], 8);
    b.bar(
        STEEL,
        Vec3::new(0.0, -0.8 * half.y, 0.91 * size.z),
        Vec3::new(0.0, 0.8 * half.y, 0.91 * size.z),
        [0.018; 2],
        6,
    );
    let lens = of(Surface::Lamp(lights::WORK_LAMP), [0.85, 0.84, 0.78]);
    for y in [-0.55 * half.y, 0.55 * half.y] {
        let (low, high) = (Vec3::new(-0.05, y - 0.16, 0.87 * size.z), Vec3::new(0.06, y + 0.16, size.z));
        b.cuboid(YELLOW, low, high);
        b.cuboid(
            lens,
            Vec3::new(high.x - 0.01, low.y + 0.02, low.z + 0.02),
            Vec3::new(high.x + 0.015, high.y - 0.02, high.z - 0.02),
        );
    }
}
