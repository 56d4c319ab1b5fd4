//! The pedestrian of the example: a skin on a rig, with arms stretched out and a cap that no skin bends.

use glam::{Mat4, Quat, Vec3};
use serde_json::json;

use crate::gltf::Maker;

/// A joint: its name, the one above it, and where it is (glTF's axes: x to the left, y up, z ahead; metres).
type Joint = (&'static str, Option<usize>, [f32; 3]);

/// A tube of rings with closed ends: along an axis, by place, its middle in the two other directions, and
/// radii in these.
struct Tube {
    axis: usize,
    sides: usize,
    middle: [f32; 2],
    rings: Vec<[f32; 3]>,
    material: usize,
}

/// Vertices of one material.
#[derive(Default)]
struct Shell {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u16; 3]>,
}

impl Shell {
    fn add(&mut self, tube: &Tube, squash: impl Fn([f32; 3]) -> [f32; 3]) {
        let (axis, sides) = (tube.axis, tube.sides);
        let at = |along: f32, [a, b]: [f32; 2]| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (along, tube.middle[0] + a, tube.middle[1] + b);
            squash(p)
        };
        let first = self.positions.len() as u16;
        for [along, a, b] in &tube.rings {
            for k in 0..sides {
                let (s, c) = frames::math::sin_cos(std::f64::consts::TAU * k as f64 / sides as f64);
                self.positions.push(at(*along, [a * c as f32, b * s as f32]));
            }
        }
        let n = sides as u16;
        let vertex = |ring: u16, k: u16| first + ring * n + k % n;
        let rings = tube.rings.len() as u16;
        for (ring, k) in (0..rings - 1).flat_map(|ring| (0..n).map(move |k| (ring, k))) {
            let [a, b, c, d] =
                [vertex(ring, k), vertex(ring, k + 1), vertex(ring + 1, k + 1), vertex(ring + 1, k)];
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
        for (ring, out) in [(0, false), (rings - 1, true)] {
            let pole = self.positions.len() as u16;
            self.positions.push(at(tube.rings[usize::from(ring)][0], [0.0; 2]));
            for k in 0..n {
                let (a, b) = (vertex(ring, k), vertex(ring, k + 1));
                self.triangles.push(if out { [a, b, pole] } else { [b, a, pole] });
            }
        }
    }

    fn normals(&self) -> Vec<[f32; 3]> {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| Vec3::from_array(self.positions[usize::from(v)]));
            triangle.iter().for_each(|v| sums[usize::from(*v)] += (b - a).cross(c - a));
        }
        sums.into_iter().map(|sum| sum.normalize_or(Vec3::Y).to_array()).collect()
    }
}

fn blend(from: f32, to: f32, x: f32) -> f32 {
    ((x - from) / (to - from)).clamp(0.0, 1.0)
}

const SKIN: usize = 0;
const SHIRT: usize = 1;
const TROUSERS: usize = 2;
const SHOES: usize = 3;
/// Of trousers as well.
const HIPS: usize = 4;

/// Heights above the hips are moved up by so much as legs are longer, those below stretched.
fn stretched(legs: f32, [x, y, z]: [f32; 3]) -> [f32; 3] {
    let y = if y < 0.12 {
        y
    } else if y < 0.9 {
        0.12 + (y - 0.12) * legs
    } else {
        y + 0.78 * (legs - 1.0)
    };
    [x, y, z]
}

fn joints(legs: f32) -> Vec<Joint> {
    let mut all: Vec<Joint> = vec![
        ("mixamorig:Hips", None, [0.0, 0.95, 0.0]),
        ("mixamorig:Spine", Some(0), [0.0, 1.06, 0.0]),
        ("mixamorig:Spine1", Some(1), [0.0, 1.25, 0.0]),
        ("mixamorig:Neck", Some(2), [0.0, 1.46, 0.0]),
        ("mixamorig:Head", Some(3), [0.0, 1.55, 0.0]),
    ];
    for (side, names) in [
        (1.0, ["mixamorig:LeftArm", "mixamorig:LeftForeArm", "mixamorig:LeftHand"]),
        (-1.0, ["mixamorig:RightArm", "mixamorig:RightForeArm", "mixamorig:RightHand"]),
    ] {
        for (k, (name, x)) in names.into_iter().zip([0.18, 0.46, 0.71]).enumerate() {
            let above = if k == 0 { 2 } else { all.len() - 1 };
            all.push((name, Some(above), [side * x, 1.40, 0.0]));
        }
    }
    for (side, names) in [
        (1.0, ["mixamorig:LeftUpLeg", "Shank left", "mixamorig:LeftFoot", "mixamorig:LeftToeBase"]),
        (-1.0, ["mixamorig:RightUpLeg", "Shank right", "mixamorig:RightFoot", "mixamorig:RightToeBase"]),
    ] {
        let places = [(0.90, 0.0), (0.49, 0.0), (0.085, 0.0), (0.03, 0.12)];
        for (k, (name, (y, z))) in names.into_iter().zip(places).enumerate() {
            let above = if k == 0 { 0 } else { all.len() - 1 };
            all.push((name, Some(above), [side * 0.09, y, z]));
        }
    }
    all.into_iter().map(|(name, above, at)| (name, above, stretched(legs, at))).collect()
}

/// The joints that a place hangs on, the first by a share and the second by the rest.
fn held([x, y, z]: [f32; 3], material: usize) -> ([u8; 2], f32) {
    let (arm, leg) = if x > 0.0 { (5, 11) } else { (8, 15) };
    let side = x.abs();
    match material {
        SHOES => ([leg + 2, leg + 3], 1.0 - blend(0.10, 0.14, z)),
        HIPS => ([0, 0], 1.0),
        TROUSERS if y > 0.7 => ([0, leg], blend(0.82, 0.90, y)),
        TROUSERS => ([leg, leg + 1], blend(0.43, 0.55, y)),
        _ if side > 0.6 => ([arm + 1, arm + 2], 1.0 - blend(0.68, 0.74, side)),
        _ if side > 0.30 => ([arm, arm + 1], 1.0 - blend(0.40, 0.52, side)),
        SHIRT if y > 1.3 && side > 0.13 => ([2, arm], 1.0 - blend(0.13, 0.22, side)),
        SHIRT => ([0, 1], 1.0 - blend(1.0, 1.12, y)),
        _ => ([3, 4], 1.0 - blend(1.5, 1.56, y)),
    }
}

fn shells(legs: f32) -> Vec<Shell> {
    let tube = |material, axis, sides, middle, rings: &[[f32; 3]]| Tube {
        axis,
        sides,
        middle,
        rings: rings.to_vec(),
        material,
    };
    let mut tubes = vec![
        tube(
            SKIN,
            1,
            10,
            [0.0; 2],
            &[
                [1.42, 0.05, 0.05],
                [1.50, 0.055, 0.055],
                [1.54, 0.085, 0.07],
                [1.62, 0.10, 0.08],
                [1.70, 0.09, 0.07],
                [1.74, 0.04, 0.03],
            ],
        ),
        tube(
            SHIRT,
            1,
            12,
            [0.0; 2],
            &[
                [0.93, 0.11, 0.16],
                [1.06, 0.10, 0.15],
                [1.20, 0.11, 0.165],
                [1.34, 0.115, 0.17],
                [1.43, 0.08, 0.13],
                [1.47, 0.06, 0.06],
            ],
        ),
        tube(HIPS, 1, 12, [0.0; 2], &[[0.78, 0.06, 0.08], [0.83, 0.10, 0.15], [0.97, 0.105, 0.155]]),
    ];
    for side in [1.0_f32, -1.0] {
        let leg = [
            [0.10, 0.045, 0.045],
            [0.25, 0.055, 0.052],
            [0.43, 0.058, 0.058],
            [0.46, 0.059, 0.059],
            [0.49, 0.060, 0.060],
            [0.52, 0.062, 0.061],
            [0.55, 0.064, 0.062],
            [0.70, 0.08, 0.075],
            [0.80, 0.085, 0.08],
            [0.84, 0.088, 0.083],
            [0.87, 0.088, 0.083],
            [0.90, 0.08, 0.075],
            [0.92, 0.06, 0.05],
        ];
        tubes.push(tube(TROUSERS, 1, 10, [0.0, 0.09 * side], &leg));
        let shoe = [
            [-0.07, 0.02, 0.03],
            [-0.055, 0.035, 0.05],
            [0.0, 0.045, 0.058],
            [0.06, 0.045, 0.045],
            [0.115, 0.05, 0.036],
            [0.125, 0.05, 0.034],
            [0.18, 0.04, 0.03],
            [0.20, 0.02, 0.022],
        ];
        tubes.push(tube(SHOES, 2, 10, [0.09 * side, 0.042], &shoe));
        let turned = |rings: &[[f32; 3]]| {
            let mut rings: Vec<[f32; 3]> = rings.iter().map(|[x, a, b]| [x * side, *a, *b]).collect();
            if side < 0.0 {
                rings.reverse();
            }
            rings
        };
        let sleeve = turned(&[
            [0.12, 0.05, 0.05],
            [0.145, 0.062, 0.06],
            [0.17, 0.066, 0.064],
            [0.195, 0.064, 0.062],
            [0.22, 0.06, 0.06],
            [0.40, 0.05, 0.05],
            [0.43, 0.049, 0.049],
            [0.46, 0.048, 0.048],
            [0.49, 0.047, 0.047],
            [0.52, 0.046, 0.046],
            [0.70, 0.036, 0.036],
        ]);
        tubes.push(tube(SHIRT, 0, 10, [1.40, 0.0], &sleeve));
        let hand =
            turned(&[[0.68, 0.028, 0.028], [0.74, 0.02, 0.042], [0.82, 0.02, 0.045], [0.90, 0.012, 0.025]]);
        tubes.push(tube(SKIN, 0, 8, [1.40, 0.0], &hand));
    }
    let mut shells: Vec<Shell> = (0..5).map(|_| Shell::default()).collect();
    for tube in &tubes {
        // Soles are flat.
        let flat = |[x, y, z]: [f32; 3]| if tube.material == SHOES { [x, y.max(0.0), z] } else { [x, y, z] };
        shells[tube.material].add(tube, flat);
    }
    for at in shells.iter_mut().flat_map(|shell| &mut shell.positions) {
        *at = stretched(legs, *at);
    }
    shells
}

/// Somebody of 1.755 m whose legs are longer by a factor than those of the example. Node 0 is above the
/// joints, these are nodes 1 to 19, the skinned mesh is node 20.
pub(crate) fn person(legs: f32) -> Maker {
    let mut m = Maker::new();
    let colours = [
        ("Skin", [0.42, 0.24, 0.16]),
        ("Shirt", [0.02, 0.30, 0.33]),
        ("Trousers", [0.30, 0.24, 0.16]),
        ("Shoes", [0.5, 0.06, 0.03]),
        ("Cap", [0.75, 0.55, 0.02]),
    ];
    for (name, rgb) in colours {
        m.material(name, rgb, None);
    }
    let mut primitives = Vec::new();
    let original = shells(1.0);
    for (material, (shell, plain)) in shells(legs).iter().zip(&original).enumerate() {
        let positions = m.floats(&shell.positions, true);
        let normals = m.floats(&shell.normals(), false);
        let (mut joints, mut weights) = (Vec::new(), Vec::new());
        for at in &plain.positions {
            let ([a, b], share) = held(*at, material);
            let share = (share * 255.0).round() as u8;
            joints.extend([a, b, 0, 0]);
            weights.extend([share, 255 - share, 0, 0]);
        }
        let (joints, weights) = (m.view(&joints), m.view(&weights));
        let count = shell.positions.len();
        let joints = m.put(
            "accessors",
            json!({ "bufferView": joints, "componentType": 5121, "count": count, "type": "VEC4" }),
        );
        let weights = m.put("accessors", json!({ "bufferView": weights, "componentType": 5121, "normalized": true, "count": count, "type": "VEC4" }));
        let indices: Vec<u8> = shell.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = m.view(&indices);
        let indices = m.put("accessors", json!({ "bufferView": view, "componentType": 5123, "count": 3 * shell.triangles.len(), "type": "SCALAR" }));
        primitives.push(json!({
            "attributes": { "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights },
            "indices": indices,
            "material": if material == HIPS { TROUSERS } else { material },
        }));
    }
    let mesh = m.put("meshes", json!({ "primitives": primitives }));

    // Joints in centimetres below a node that is smaller by as much; legs look down along their own y, as
    // programs have them.
    let joints = joints(legs);
    let turn = |joint: usize| if joint >= 11 { Quat::from_xyzw(1.0, 0.0, 0.0, 0.0) } else { Quat::IDENTITY };
    let placed: Vec<Mat4> = joints
        .iter()
        .enumerate()
        .map(|(joint, (_, _, at))| {
            Mat4::from_scale_rotation_translation(Vec3::ONE, turn(joint), 100.0 * Vec3::from_array(*at))
        })
        .collect();
    let rig = m.put("nodes", json!({ "name": "Armature", "scale": [0.01, 0.01, 0.01], "children": [1] }));
    for (joint, (name, above, _)) in joints.iter().enumerate() {
        let local = above.map_or(placed[joint], |above| placed[above].inverse() * placed[joint]);
        let (_, rotation, at) = local.to_scale_rotation_translation();
        let children: Vec<usize> =
            (0..joints.len()).filter(|k| joints[*k].1 == Some(joint)).map(|k| k + 1).collect();
        let mut node = json!({ "name": name, "translation": at.to_array(), "rotation": rotation.to_array() });
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        m.put("nodes", node);
    }
    let shrink = Mat4::from_scale(Vec3::splat(0.01));
    let binds: Vec<u8> = placed
        .iter()
        .flat_map(|joint| (shrink * *joint).inverse().to_cols_array())
        .flat_map(f32::to_le_bytes)
        .collect();
    let view = m.view(&binds);
    let binds = m.put(
        "accessors",
        json!({ "bufferView": view, "componentType": 5126, "count": joints.len(), "type": "MAT4" }),
    );
    let numbers: Vec<usize> = (1..=joints.len()).collect();
    m.put("skins", json!({ "joints": numbers, "inverseBindMatrices": binds }));
    let skin_node = m.put("nodes", json!({ "name": "Ada", "mesh": mesh, "skin": 0 }));

    // The cap is no part of the skin: it hangs on the head, in centimetres.
    let mut cap = Shell::default();
    let rings = [[10.0, 10.4, 8.4], [17.0, 9.6, 7.6], [20.5, 5.0, 4.0]].map(|[y, a, b]| [y, a, b]).to_vec();
    cap.add(&Tube { axis: 1, sides: 10, middle: [0.0; 2], rings, material: 4 }, |p| p);
    let (positions, normals) = (m.floats(&cap.positions, true), m.floats(&cap.normals(), false));
    let indices: Vec<u8> = cap.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let view = m.view(&indices);
    let indices = m.put("accessors", json!({ "bufferView": view, "componentType": 5123, "count": 3 * cap.triangles.len(), "type": "SCALAR" }));
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    let mesh = m.put(
        "meshes",
        json!({ "primitives": [{ "attributes": attributes, "indices": indices, "material": 4 }] }),
    );
    let node = m.put("nodes", json!({ "name": "Cap", "mesh": mesh }));
    m.list("nodes")[5]["children"] = json!([node]);
    m.json["scenes"][0]["nodes"] = json!([rig, skin_node]);
    m
}
