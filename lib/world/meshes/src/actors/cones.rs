//! Cones and barriers around hazards.

use catalogue::{BarrierBody, ConeBody};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::solids::MeshBuilder;

const ORANGE: MeshPart = MeshPart::new(Tag::TrafficCone, Surface::Plain, [0.85, 0.18, 0.02]);
const WHITE: MeshPart = MeshPart::new(Tag::TrafficCone, Surface::Reflector, [0.85; 3]);
const RUBBER: MeshPart = MeshPart::new(Tag::TrafficCone, Surface::Rubber, [0.06; 3]);
const FACES: usize = 14;

/// Layers of a cone's body: height as a share, radius as a share of the foot's; and which of the bands
/// between them are white.
struct Profile {
    layers: &'static [(f32, f32)],
    white: &'static [usize],
    /// Radius at the foot as a share of the box's half width.
    foot: f32,
    /// Thickness of the base plate as a share of the height; 0: none.
    plate: f32,
    round_plate: bool,
    body: MeshPart,
}

const CONE: Profile = Profile {
    layers: &[(0.04, 1.0), (0.35, 0.70), (0.52, 0.54), (0.66, 0.41), (0.80, 0.28), (1.0, 0.12)],
    white: &[1, 3],
    foot: 0.82,
    plate: 0.05,
    round_plate: false,
    body: ORANGE,
};

fn profile(body: ConeBody) -> Profile {
    match body {
        ConeBody::Traffic => CONE,
        // Red without stripes.
        ConeBody::Plain => Profile {
            layers: &[(0.05, 1.0), (0.9, 0.25), (1.0, 0.12)],
            white: &[],
            body: MeshPart::new(Tag::TrafficCone, Surface::Plain, [0.70, 0.07, 0.03]),
            ..CONE
        },
        ConeBody::Big => Profile { plate: 0.07, foot: 0.78, ..CONE },
        // A roadside drum: four bands, a rubber ring around its foot.
        ConeBody::Barrel => Profile {
            layers: &[
                (0.0, 0.94),
                (0.12, 0.92),
                (0.30, 0.86),
                (0.48, 0.80),
                (0.66, 0.74),
                (0.84, 0.68),
                (1.0, 0.62),
            ],
            white: &[2, 4],
            foot: 0.94,
            plate: 0.08,
            round_plate: true,
            ..CONE
        },
        // A channelizer: a slim post with a bulb on top.
        ConeBody::Skinny => Profile {
            layers: &[
                (0.05, 0.52),
                (0.25, 0.42),
                (0.48, 0.36),
                (0.60, 0.34),
                (0.68, 0.33),
                (0.80, 0.30),
                (0.92, 0.27),
                (0.94, 0.16),
                (0.98, 0.16),
                (1.0, 0.10),
            ],
            white: &[2, 4],
            foot: 0.62,
            plate: 0.07,
            round_plate: true,
            ..CONE
        },
        ConeBody::Construction => {
            Profile { layers: &[(0.05, 1.0), (0.42, 0.64), (0.72, 0.35), (1.0, 0.10)], white: &[1], ..CONE }
        }
        ConeBody::Small => {
            Profile { layers: &[(0.05, 1.0), (0.45, 0.60), (0.68, 0.38), (1.0, 0.10)], white: &[1], ..CONE }
        }
    }
}

pub(crate) fn cone(body: ConeBody, size: Vec3) -> TriMesh {
    let profile = profile(body);
    let half = 0.5 * size;
    let mut b = MeshBuilder::new();
    let plate_z = profile.plate * size.z;
    if profile.round_plate {
        b.stack(
            RUBBER,
            &[(Vec3::ZERO, half.x, half.y), (Vec3::Z * plate_z, 0.96 * half.x, 0.96 * half.y)],
            FACES,
        );
    } else {
        b.cuboid(RUBBER, Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, plate_z));
    }
    let layers: Vec<(Vec3, f32, f32)> = profile
        .layers
        .iter()
        .map(|(share, wide)| {
            (Vec3::Z * share * size.z, wide * profile.foot * half.x, wide * profile.foot * half.y)
        })
        .collect();
    b.stack_with(|k| if profile.white.contains(&k) { WHITE } else { profile.body }, &layers, FACES);
    b.finish()
}

/// A barrier; its long side is the length.
pub(crate) fn barrier(body: BarrierBody, size: Vec3) -> TriMesh {
    match body {
        BarrierBody::Street => street(size),
        BarrierBody::Concrete => concrete(size),
        BarrierBody::Wooden => wooden(size),
    }
}

/// Two boards in red and white on feet.
fn street(size: Vec3) -> TriMesh {
    let dark = MeshPart::new(Tag::Barrier, Surface::Rubber, [0.07; 3]);
    let white = MeshPart::new(Tag::Barrier, Surface::Plain, [0.85; 3]);
    let half = 0.5 * size;
    let mut b = MeshBuilder::new();
    for x in [-0.78 * half.x, 0.78 * half.x] {
        b.cuboid(dark, Vec3::new(x - 0.09, -half.y, 0.0), Vec3::new(x + 0.09, half.y, 0.09));
        b.cuboid(white, Vec3::new(x - 0.03, -0.03, 0.09), Vec3::new(x + 0.03, 0.03, size.z));
    }
    for heights in [[0.68, 0.97], [0.28, 0.50]] {
        board(&mut b, size, heights, [0.75, 0.10, 0.05], 0.05);
    }
    b.finish()
}

/// A board in fields of a colour and white, between shares of the height, so far to either side of the
/// middle.
fn board(b: &mut MeshBuilder, size: Vec3, heights: [f32; 2], rgb: [f32; 3], half_thick: f32) {
    let fields = 6;
    for i in 0..fields {
        let x0 = -0.5 * size.x + size.x * i as f32 / fields as f32;
        let paint = MeshPart::new(Tag::Barrier, Surface::Reflector, if i % 2 == 0 { rgb } else { [0.85; 3] });
        b.cuboid(
            paint,
            Vec3::new(x0, -half_thick, heights[0] * size.z),
            Vec3::new(x0 + size.x / fields as f32, half_thick, heights[1] * size.z),
        );
    }
}

/// A concrete safety barrier: a broad foot, a narrow top (the profile of New Jersey).
fn concrete(size: Vec3) -> TriMesh {
    let stone = MeshPart::new(Tag::Barrier, Surface::Concrete, [0.46, 0.45, 0.43]);
    let half = 0.5 * size;
    let profile = [(1.0, 0.0), (1.0, 0.09), (0.62, 0.40), (0.34, 1.0)];
    let ring = |x: f32| -> Vec<Vec3> {
        let right = profile.iter().map(|(y, z)| Vec3::new(x, y * half.y, z * size.z));
        let left = profile.iter().rev().map(|(y, z)| Vec3::new(x, -y * half.y, z * size.z));
        right.chain(left).collect()
    };
    let mut b = MeshBuilder::new();
    b.loft(&[ring(-half.x), ring(half.x)], |_, _| stone, [stone; 2]);
    b.finish()
}

/// Two trestles of planks with boards in orange and white between them.
fn wooden(size: Vec3) -> TriMesh {
    let wood = MeshPart::new(Tag::Barrier, Surface::Wood, [0.42, 0.30, 0.17]);
    let half = 0.5 * size;
    let mut b = MeshBuilder::new();
    for x in [-0.72 * half.x, 0.72 * half.x] {
        for side in [-1.0, 1.0] {
            let foot = Vec3::new(x, side * (half.y - 0.05), 0.0);
            let top = Vec3::new(x, side * 0.06, 0.98 * size.z);
            b.bar(wood, foot, top, [0.045; 2], 4);
        }
    }
    board(&mut b, size, [0.78, 0.97], [0.85, 0.20, 0.02], 0.035);
    for side in [-1.0, 1.0] {
        let y = side * (0.55 * half.y);
        b.cuboid(
            wood,
            Vec3::new(-half.x, y - 0.015, 0.36 * size.z),
            Vec3::new(half.x, y + 0.015, 0.50 * size.z),
        );
    }
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    b.finish()
}
