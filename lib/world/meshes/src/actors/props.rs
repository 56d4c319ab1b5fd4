//! Benches, bins, racks, fences, walls and rocks.

use catalogue::benches;
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Paving, Surface, TriMesh};

use crate::solids::{Detail, MeshBuilder};

/// Those that are made of many small pieces close by.
pub(crate) const BORDERS: [&str; 3] = ["fence", "boards", "wire"];

/// Street furniture by name.
pub(crate) fn prop(kind: &str, size: Vec3, variant: u32, detail: Detail) -> Option<TriMesh> {
    let mut b = MeshBuilder::at(detail);
    match kind {
        "bench" => bench(&mut b, size),
        "rack" => rack(&mut b, size),
        "bin" => bin(&mut b, size, variant),
        "fence" => fence(&mut b, size, variant),
        "boards" => boards(&mut b, size, variant),
        "wire" => wire(&mut b, size, variant),
        "wall" => wall(&mut b, size, variant),
        "tree_pit" => pit(&mut b, size),
        "tree_stakes" => stakes(&mut b, size),
        "tree_grate" => grate(&mut b, size),
        "forecourt" => forecourt(&mut b, size, variant),
        "rock" => rock(&mut b, size, variant),
        _ => return None,
    }
    (!b.is_empty()).then(|| b.finish())
}

/// A bench; it looks along +x.
fn bench(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let wood = MeshPart::new(Tag::Static, Surface::Wood, [0.30, 0.16, 0.07]);
    let iron = MeshPart::new(Tag::Static, Surface::Metal, [0.06; 3]);
    // The seat looks along +x; the back rest is behind it.
    let (seat_z, back_x) = (benches::SEAT as f32 * size.z, -half.x + benches::BACK_M as f32);
    for y in [-0.8 * half.y, 0.8 * half.y] {
        b.cuboid(iron, Vec3::new(-half.x, y - 0.03, 0.0), Vec3::new(half.x, y + 0.03, 0.45 * size.z));
        b.cuboid(
            iron,
            Vec3::new(-half.x, y - 0.03, 0.45 * size.z),
            Vec3::new(-half.x + 0.06, y + 0.03, size.z),
        );
    }
    for i in 0..3 {
        let x = -half.x + 0.08 + 0.14 * i as f32;
        b.cuboid(
            wood,
            Vec3::new(x, -half.y, 0.45 * size.z),
            Vec3::new((x + 0.11).min(half.x), half.y, seat_z),
        );
    }
    for z in [0.66, 0.84] {
        b.cuboid(
            wood,
            Vec3::new(back_x - 0.03, -half.y, z * size.z),
            Vec3::new(back_x, half.y, (z + 0.13) * size.z),
        );
    }
}

/// A hoop to lock bicycles to; it runs along x.
fn rack(b: &mut MeshBuilder, size: Vec3) {
    let (half, r) = (0.5 * size, 0.5 * size.y);
    let steel = MeshPart::new(Tag::Static, Surface::Metal, [0.32, 0.33, 0.34]);
    let top = size.z - r;
    for x in [-half.x + r, half.x - r] {
        b.bar(steel, Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, top), [r; 2], 6);
    }
    b.bar(steel, Vec3::new(-half.x + r, 0.0, top), Vec3::new(half.x - r, 0.0, top), [r; 2], 6);
}

/// A litter bin.
fn bin(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let colour = [[0.05, 0.15, 0.06], [0.10, 0.10, 0.11], [0.25, 0.12, 0.04]][variant as usize % 3];
    let body = MeshPart::new(Tag::Static, Surface::Plain, colour);
    let lid = MeshPart::new(Tag::Static, Surface::Metal, [0.3; 3]);
    b.stack(
        body,
        &[
            (Vec3::ZERO, 0.40 * size.x, 0.40 * size.y),
            (Vec3::Z * 0.86 * size.z, 0.47 * size.x, 0.47 * size.y),
        ],
        12,
    );
    b.stack(
        lid,
        &[(Vec3::Z * 0.86 * size.z, half.x, half.y), (Vec3::Z * size.z, 0.7 * half.x, 0.7 * half.y)],
        12,
    );
}

/// A fence of wood or metal.
fn fence(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let wood = variant.is_multiple_of(2);
    let post = if wood {
        MeshPart::new(Tag::Fence, Surface::Wood, [0.32, 0.20, 0.10])
    } else {
        MeshPart::new(Tag::Fence, Surface::Metal, [0.12, 0.13, 0.13])
    };
    let count = (size.x / 2.0).ceil().max(1.0) as usize;
    for i in 0..=count {
        let x =
            (-half.x + 0.04 + (size.x - 0.08) * i as f32 / count as f32).clamp(-half.x + 0.04, half.x - 0.04);
        b.cuboid(post, Vec3::new(x - 0.04, -half.y, 0.0), Vec3::new(x + 0.04, half.y, size.z));
    }
    for z in [0.18, 0.80] {
        b.cuboid(
            post,
            Vec3::new(-half.x, -0.4 * half.y, z * size.z),
            Vec3::new(half.x, 0.4 * half.y, (z + 0.07) * size.z),
        );
    }
    // Palings at a spacing that keeps a fence light.
    let palings = (size.x / if wood { 0.22 } else { 0.30 }).floor().clamp(1.0, 120.0) as usize;
    let half_width = if wood { 0.05 } else { 0.012 };
    // Far away one is as wide as three.
    let by = if b.detail() == Detail::Coarse { 3 } else { 1 };
    let (palings, half_width) = (palings.div_ceil(by), half_width * by as f32);
    for i in 0..palings {
        let x = -half.x + size.x * (i as f32 + 0.5) / palings as f32;
        b.cuboid(
            post,
            Vec3::new(x - half_width, -0.25 * half.y, 0.08),
            Vec3::new(x + half_width, 0.25 * half.y, 0.96 * size.z),
        );
    }
}

/// A fence of boards side by side, and their posts; it runs along x.
fn boards(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let rgb = [[0.30, 0.19, 0.10], [0.20, 0.17, 0.14], [0.42, 0.40, 0.37]][variant as usize % 3];
    let shades = [0.92, 1.0, 1.08].map(|s| MeshPart::new(Tag::Fence, Surface::Wood, rgb.map(|c| s * c)));
    let bays = (size.x / 1.5).round().max(1.0) as usize;
    for i in 0..=bays {
        let x = (-half.x + size.x * i as f32 / bays as f32).clamp(-half.x + 0.05, half.x - 0.05);
        b.cuboid(shades[0], Vec3::new(x - 0.05, -half.y, 0.0), Vec3::new(x + 0.05, half.y, size.z));
    }
    let board_m = if b.detail() == Detail::Coarse { size.x } else { 0.25 };
    let count = (size.x / board_m).round().max(1.0) as usize;
    for i in 0..count {
        let at = |k: usize| -half.x + size.x * k as f32 / count as f32;
        // No two boards are of one length.
        let top = size.z - 0.04 - 0.015 * ((i * 7 + variant as usize) % 3) as f32;
        let (low, high) = (Vec3::new(at(i) + 0.004, -0.012, 0.05), Vec3::new(at(i + 1) - 0.004, 0.012, top));
        b.cuboid(shades[(i * 5 + variant as usize) % 3], low, high);
    }
}

/// A fence of wire mesh between posts; it runs along x.
fn wire(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let rgb = [[0.07, 0.16, 0.10], [0.30, 0.31, 0.32]][variant as usize % 2];
    let metal = MeshPart::new(Tag::Fence, Surface::Metal, rgb);
    let bays = (size.x / 1.5).round().max(1.0) as usize;
    for i in 0..=bays {
        let x = (-half.x + size.x * i as f32 / bays as f32).clamp(-half.x + half.y, half.x - half.y);
        b.bar(metal, Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, size.z), [half.y; 2], 6);
    }
    // Double rods lie closer together than a picture shows: every fourth is there, and stands for its
    // neighbours.
    let by = if b.detail() == Detail::Coarse { 3.0 } else { 1.0 };
    let rods = (size.z / (0.2 * by)).round().max(2.0) as usize;
    let r = 0.006 * by;
    for k in 0..rods {
        let z = 0.08 + (size.z - 0.14) * k as f32 / (rods - 1) as f32;
        b.cuboid(metal, Vec3::new(-half.x, -r, z - r), Vec3::new(half.x, r, z + r));
    }
    let uprights = (size.x / (0.2 * by)).round().max(1.0) as usize;
    for k in 0..uprights {
        let x = -half.x + size.x * (k as f32 + 0.5) / uprights as f32;
        b.cuboid(metal, Vec3::new(x - r, -r, 0.06), Vec3::new(x + r, r, size.z - 0.04));
    }
}

/// A wall with a cap.
fn wall(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    let colour = [[0.42, 0.40, 0.37], [0.36, 0.18, 0.12], [0.55, 0.52, 0.46]][variant as usize % 3];
    let stone = MeshPart::new(Tag::Wall, Surface::Concrete, colour);
    let cap = MeshPart::new(Tag::Wall, Surface::Concrete, [0.5; 3]);
    b.cuboid(stone, low + Vec3::new(0.02, 0.04, 0.0), Vec3::new(high.x - 0.02, high.y - 0.04, 0.93 * size.z));
    b.cuboid(cap, Vec3::new(low.x, low.y, 0.93 * size.z), high);
}

/// Soil round a stem, with an edge of stone.
fn pit(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let soil = MeshPart::new(Tag::Static, Surface::Gravel, [0.13, 0.09, 0.06]);
    let stone = MeshPart::new(Tag::Static, Surface::Concrete, [0.35, 0.34, 0.32]);
    let (low, high, edge_m) = (-half.x, half.x, 0.07);
    for (min, max) in [
        ([low, low], [high, low + edge_m]),
        ([low, high - edge_m], [high, high]),
        ([low, low + edge_m], [low + edge_m, high - edge_m]),
        ([high - edge_m, low + edge_m], [high, high - edge_m]),
    ] {
        b.cuboid(stone, Vec3::new(min[0], min[1], 0.0), Vec3::new(max[0], max[1], size.z.min(0.04)));
    }
    let inner = half.x - edge_m;
    b.cuboid(soil, Vec3::new(-inner, -inner, 0.0), Vec3::new(inner, inner, 0.5 * size.z.min(0.04)));
}

/// Soil round a young stem, and the three stakes that hold it.
fn stakes(b: &mut MeshBuilder, size: Vec3) {
    pit(b, size);
    let wood = MeshPart::new(Tag::Static, Surface::Wood, [0.36, 0.26, 0.16]);
    let far_m = 0.32 * size.x;
    let places = [0, 1, 2].map(|k| {
        let (sin, cos) = frames::math::f32::sin_cos(std::f32::consts::TAU * (k as f32 + 0.25) / 3.0);
        Vec3::new(far_m * cos, far_m * sin, 0.0)
    });
    for (k, place) in places.into_iter().enumerate() {
        b.bar(wood, place, place + Vec3::Z * size.z, [0.035; 2], 6);
        let (next, up) = (places[(k + 1) % 3], Vec3::Z * (size.z - 0.12));
        b.bar(wood, place + up, next + up, [0.02; 2], 4);
    }
}

/// An iron grate round a stem.
fn grate(b: &mut MeshBuilder, size: Vec3) {
    let half = 0.5 * size;
    let iron = MeshPart::new(Tag::Static, Surface::Metal, [0.09, 0.085, 0.08]);
    let bars = 12;
    for k in 0..bars {
        let at = |k: usize| -half.x + size.x * k as f32 / bars as f32;
        let (x0, x1) = (at(k) + 0.012, at(k + 1) - 0.012);
        // Bars end before the stem.
        let open_m = if x0.abs().min(x1.abs()) < 0.24 { 0.24 } else { 0.0 };
        for side in [-1.0, 1.0] {
            let (a, z) = (side * half.y, side * open_m);
            b.cuboid(iron, Vec3::new(x0, a.min(z), 0.0), Vec3::new(x1, a.max(z), size.z));
        }
    }
}

/// A slab of paving.
fn forecourt(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let (paving, rgb) = [
        (Paving::Slabs, [0.34, 0.33, 0.31]),
        (Paving::Setts, [0.24, 0.235, 0.23]),
        (Paving::Tiles, [0.33, 0.30, 0.27]),
        (Paving::Cast, [0.36, 0.355, 0.34]),
    ][variant as usize % 4];
    let ring = |z: f32| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| Vec3::new(x * half.x, y * half.y, z))
            .to_vec()
    };
    let edge = MeshPart::new(Tag::Sidewalk, Surface::Concrete, [0.4, 0.39, 0.37]);
    let top = MeshPart::new(Tag::Sidewalk, Surface::Paving(paving), rgb);
    b.loft(&[ring(0.0), ring(size.z)], |_, _| edge, [edge, top]);
}

/// A lump of stone.
fn rock(b: &mut MeshBuilder, size: Vec3, variant: u32) {
    let half = 0.5 * size;
    let (low, high) = (Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    let stone = MeshPart::new(Tag::Rock, Surface::Concrete, [0.27, 0.26, 0.24]);
    let bump = |ring: usize, side: usize| 0.80 + 0.05 * ((ring * 5 + side * 3 + variant as usize) % 5) as f32;
    b.blob(stone, Vec3::Z * 0.3 * size.z, half, 5, 8, bump);
    b.fit(low, high);
}
