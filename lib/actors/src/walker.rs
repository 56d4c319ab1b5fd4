//! Walkers: torso and head, and arms and legs that swing with the gait.

use std::sync::Arc;

use glam::Vec3;
use schema::Tag;
use schema::geometry::{Part, Surface, TriMesh};
use schema::models::Model;

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::solids::MeshBuilder;

/// Colours of shirts and jackets, linear RGB.
pub(crate) const TOPS: [[f32; 3]; 10] = [
    [0.45, 0.05, 0.05],
    [0.04, 0.10, 0.35],
    [0.60, 0.58, 0.52],
    [0.05, 0.05, 0.06],
    [0.08, 0.26, 0.12],
    [0.60, 0.36, 0.06],
    [0.20, 0.22, 0.25],
    [0.32, 0.10, 0.30],
    [0.10, 0.32, 0.36],
    [0.75, 0.75, 0.73],
];
/// Colours of trousers and skirts.
pub(crate) const TROUSERS: [[f32; 3]; 6] = [
    [0.04, 0.06, 0.14],
    [0.03, 0.03, 0.03],
    [0.20, 0.17, 0.12],
    [0.12, 0.13, 0.14],
    [0.28, 0.26, 0.22],
    [0.06, 0.10, 0.20],
];
/// Skin tones.
pub(crate) const SKIN: [[f32; 3]; 5] =
    [[0.60, 0.38, 0.28], [0.48, 0.28, 0.19], [0.30, 0.16, 0.10], [0.14, 0.07, 0.045], [0.66, 0.45, 0.35]];
pub(crate) const HAIR: [[f32; 3]; 5] =
    [[0.02, 0.015, 0.01], [0.08, 0.04, 0.02], [0.25, 0.15, 0.06], [0.35, 0.34, 0.33], [0.18, 0.06, 0.02]];

/// High-visibility clothing: orange or yellow; and the bands on it.
const VESTS: [[f32; 3]; 2] = [[0.85, 0.25, 0.02], [0.62, 0.72, 0.03]];
const BAND: [f32; 3] = [0.75, 0.76, 0.74];
const HELMETS: [[f32; 3]; 3] = [[0.80, 0.58, 0.03], [0.80, 0.80, 0.78], [0.78, 0.22, 0.02]];
const UNIFORM: [f32; 3] = [0.015, 0.022, 0.06];

pub(crate) fn pick(colours: &[[f32; 3]], word: u32) -> [f32; 3] {
    colours[word as usize % colours.len()]
}

/// A walker; the variant dresses them.
pub(crate) fn walker(model: &Model, size: Vec3, variant: u32) -> ActorMesh {
    let woman = model.gender(variant) == "female";
    let elder = model.name == "walker.elder";
    let cloth = |rgb: [f32; 3]| Part::new(Tag::Pedestrian, Surface::Cloth, rgb);
    let (worker, police) = (model.special == "worker", model.special == "police");
    let (top, trousers) = match model.special {
        "worker" => (pick(&VESTS, variant), if variant % 4 < 2 { pick(&VESTS, variant) } else { UNIFORM }),
        "police" => (UNIFORM, UNIFORM),
        _ => (pick(&TOPS, variant), pick(&TROUSERS, variant / 3)),
    };
    let (top, trousers) = (cloth(top), cloth(trousers));
    let skin = cloth(pick(&SKIN, variant / 7));
    let hair = cloth(if elder { HAIR[3] } else { pick(&HAIR, variant / 11) });
    let skirt = woman && variant.is_multiple_of(3);
    let (length, width, height) = (size.x, size.y, size.z);
    let hip_z = 0.475 * height;
    let shoulder_z = 0.815 * height;
    let arm = 0.105 * width;
    let chest = 0.5 * width - 2.0 * arm + 0.01;
    let depth = 0.27 * length;

    let mut b = MeshBuilder::new();
    let at = |share: f32| Vec3::Z * share * height;
    let waist = if woman { 0.80 } else { 0.92 };
    let hips = if woman { 1.0 } else { 0.92 };
    b.stack(
        top,
        &[
            (at(0.50), hips * chest, 0.0),
            (at(0.50), depth * 0.92, hips * chest),
            (at(0.60), depth * 0.86, waist * chest),
            (at(0.74), depth, chest),
            (at(0.81), depth * 0.82, 0.93 * chest),
            (at(0.84), depth * 0.42, 0.36 * chest),
        ]
        .map(|(c, x, y)| (c, x.min(depth), y.max(0.02))),
        10,
    );
    let hem = if skirt { 0.30 } else { 0.455 };
    let flare = if skirt { 1.12 } else { 0.98 };
    b.stack(
        trousers,
        &[(at(hem), depth * flare, hips * chest * flare), (at(0.51), depth * 0.93, hips * chest)],
        10,
    );
    b.bar(skin, at(0.82), at(0.88), [0.055 * height / 1.75; 2], 6);
    let head_half = Vec3::new(0.058, 0.046, 0.066) * height;
    let head = Vec3::Z * (height - head_half.z - 0.004 * height);
    b.ellipsoid(skin, head, head_half, 7, 10);
    if worker || police {
        uniform(&mut b, worker, variant, [depth, chest, height], head);
    }
    // Hair is a cap on the back and top of the head; its crown is the top of the box.
    let back = if woman { 0.020 } else { 0.010 };
    b.ellipsoid(
        hair,
        head + Vec3::new(-back * height, 0.0, 0.012 * height),
        Vec3::new(0.054, 0.050, 0.058) * height,
        6,
        10,
    );
    if woman && !skirt {
        b.ellipsoid(hair, at(0.86) - Vec3::X * 0.035 * height, Vec3::new(0.028, 0.042, 0.055) * height, 5, 8);
    }
    if variant % 5 == 2 && !elder && !worker && !police {
        backpack(&mut b, size, chest, depth, variant);
    }
    let bounds = b.clone().finish().aabb();
    b.fit(
        bounds.min.max(Vec3::new(-0.5 * length, -0.5 * width, 0.0)),
        Vec3::new(bounds.max.x.min(0.5 * length), bounds.max.y.min(0.5 * width), height),
    );
    let body = Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed };

    let mut pieces = vec![body];
    let cloths = [if skirt { skin } else { trousers }, top, skin];
    pieces.extend(limbs(size, cloths, [hip_z, shoulder_z], [arm, 0.46 * chest]));
    ActorMesh { pieces }
}

/// A bag on the back.
fn backpack(b: &mut MeshBuilder, size: Vec3, chest: f32, depth: f32, variant: u32) {
    let bag = Part::new(Tag::Pedestrian, Surface::Cloth, pick(&TOPS, variant / 2 + 3));
    let back_x = -0.5 * size.x;
    b.tapered(
        bag,
        Vec3::new(back_x, -0.75 * chest, 0.58 * size.z),
        Vec3::new(-0.6 * depth, 0.75 * chest, 0.79 * size.z),
        0.9,
        0.8,
    );
}

/// Bands and a helmet or a cap. `[depth, chest, height]`: half the trunk's depth and width, and the walker's height.
fn uniform(b: &mut MeshBuilder, worker: bool, variant: u32, [depth, chest, height]: [f32; 3], head: Vec3) {
    let cloth = |rgb: [f32; 3]| Part::new(Tag::Pedestrian, Surface::Cloth, rgb);
    let at = |share: f32| Vec3::Z * share * height;
    // Bands around chest and belly; the police wear a vest under theirs.
    let bands: &[[f32; 2]] = if worker { &[[0.575, 0.605], [0.69, 0.72]] } else { &[[0.58, 0.64]] };
    for [low, high] in bands {
        let wide = |share: f32| (at(share), 1.03 * depth, 1.02 * chest);
        b.stack(cloth(if worker { BAND } else { VESTS[1] }), &[wide(*low), wide(*high)], 10);
    }
    // A helmet or a cap: a shell over the upper half of the head, its brim longer in front.
    let shell = Part::new(
        Tag::Pedestrian,
        Surface::Plain,
        if worker { pick(&HELMETS, variant / 5) } else { UNIFORM },
    );
    let crown = if worker { Vec3::new(0.064, 0.054, 0.046) } else { Vec3::new(0.066, 0.062, 0.026) } * height;
    let middle = head + Vec3::Z * if worker { 0.034 } else { 0.052 } * height;
    b.ellipsoid(shell, middle, crown, 6, 12);
    let brim = head + Vec3::new(0.014, 0.0, 0.026) * height;
    b.stack(
        shell,
        &[
            (brim, 0.066 * height, 0.055 * height),
            (brim + Vec3::Z * 0.005 * height, 0.062 * height, 0.052 * height),
        ],
        12,
    );
}

/// Legs and arms on their hinges. Cloth of legs and sleeves, and skin; heights of hips and shoulders; half the width of
/// an arm, and how far the legs stand from the middle.
fn limbs(
    size: Vec3,
    [legs, sleeves, skin]: [Part; 3],
    [hip_z, shoulder_z]: [f32; 2],
    [arm, stance]: [f32; 2],
) -> [Piece; 4] {
    let (length, width, height) = (size.x, size.y, size.z);
    let shoe = Part::new(Tag::Pedestrian, Surface::Rubber, [0.04; 3]);
    let foot = 0.29 * length;
    let leg = Arc::new(leg(legs, shoe, hip_z, 0.5 * height / 1.75, foot));
    let arm_mesh = Arc::new(arm_mesh(sleeves, skin, shoulder_z, arm));
    // The foot stays inside the box at the end of its swing: hip_z * sin(a) + foot <= length / 2.
    let reach = (0.5 * length - foot).max(0.0);
    let leg_swing = frames::math::f32::asin((reach / hip_z).min(0.6));
    let arm_swing = frames::math::f32::asin(((0.5 * length - 0.07).max(0.0) / (0.40 * height)).min(0.6));
    let limb = |mesh: &Arc<TriMesh>, y: f32, z: f32, swing_rad: f32| Piece {
        mesh: Arc::clone(mesh),
        joint: Joint::Limb { at: Vec3::new(0.0, y, z), swing_rad },
    };
    let arm_y = 0.5 * width - arm;
    [
        limb(&leg, stance, hip_z, leg_swing),
        limb(&leg, -stance, hip_z, -leg_swing),
        limb(&arm_mesh, arm_y, shoulder_z, -arm_swing),
        limb(&arm_mesh, -arm_y, shoulder_z, arm_swing),
    ]
}

/// A leg that hangs from its hinge down to the ground.
fn leg(
    cloth: schema::geometry::Part,
    shoe: schema::geometry::Part,
    hip_z: f32,
    scale: f32,
    foot: f32,
) -> TriMesh {
    let mut b = MeshBuilder::new();
    let down = |share: f32| Vec3::Z * -share * hip_z;
    b.stack(
        cloth,
        &[
            (down(0.93), 0.085 * scale, 0.08 * scale),
            (down(0.72), 0.105 * scale, 0.10 * scale),
            (down(0.48), 0.115 * scale, 0.11 * scale),
            (down(0.10), 0.16 * scale, 0.15 * scale),
            (down(-0.03), 0.12 * scale, 0.12 * scale),
        ],
        8,
    );
    b.tapered(
        shoe,
        Vec3::new(-foot, -0.09 * scale, -hip_z),
        Vec3::new(foot, 0.09 * scale, -0.91 * hip_z),
        0.72,
        0.8,
    );
    b.finish()
}

fn arm_mesh(
    sleeve: schema::geometry::Part,
    skin: schema::geometry::Part,
    shoulder_z: f32,
    radius: f32,
) -> TriMesh {
    let mut b = MeshBuilder::new();
    let down = |share: f32| Vec3::Z * -share * shoulder_z;
    b.stack(
        sleeve,
        &[
            (down(0.36), 0.70 * radius, 0.70 * radius),
            (down(0.19), 0.82 * radius, 0.82 * radius),
            (down(0.02), radius, radius),
            (down(-0.025), 0.6 * radius, 0.6 * radius),
        ],
        7,
    );
    b.ellipsoid(skin, down(0.40), Vec3::new(0.9 * radius, 0.55 * radius, 0.055 * shoulder_z), 4, 6);
    b.finish()
}
