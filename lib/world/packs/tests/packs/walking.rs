//! Pedestrians of packs: figures that follow from rigs, and pieces that walk.

use std::collections::BTreeMap;
use std::f32::consts::TAU;

use frames::Aabb;
use glam::Vec3;
use meshes::people::{Bone, Walker};
use packs::{Attachment, PackModel};

use crate::faults::read;
use crate::person::person;

/// From a slow walk to a fast run, m/s.
const SPEEDS_MPS: [f32; 6] = [0.3, 0.8, 1.4, 2.0, 3.0, 5.0];
/// How much longer legs are than hers.
const LEGS: [f32; 3] = [0.75, 1.0, 1.15];

fn page(legs: f32) -> String {
    let page = include_str!("../../../../../tests/packs/example/ada.toml");
    page.replace("1.755 ", &format!("{} ", 1.755 + 0.78 * (legs - 1.0)))
}

fn ada(legs: f32) -> (PackModel, Walker) {
    let model = read(&page(legs), person(legs).glb()).expect("is good");
    let walker = model.walker.clone().expect("walks");
    (model, walker)
}

fn placed(who: &Walker, phase_rad: f32, speed_mps: f32) -> Vec<(Bone, Vec<Vec3>)> {
    let bones = who.figure().walking(phase_rad, speed_mps);
    let at = |(bone, mesh): &(Bone, std::sync::Arc<schema::geometry::TriMesh>)| {
        let pose = bones.object_from_bone(*bone);
        (*bone, mesh.positions.iter().map(|p| pose.transform_point3(*p)).collect())
    };
    who.meshes().iter().map(at).collect()
}

fn bounds(who: &Walker, phase_rad: f32, speed_mps: f32) -> Aabb {
    placed(who, phase_rad, speed_mps)
        .iter()
        .flat_map(|(_, points)| points)
        .fold(Aabb::EMPTY, |b, p| b.with(*p))
}

#[test]
fn a_figure_has_the_measures_of_its_rig() {
    let (model, who) = ada(1.0);
    let f = who.figure();
    let near = |is: f32, want: f32| assert!((is - want).abs() < 2e-4, "{is} is not {want}: {f:?}");
    for (is, want) in [
        (f.hip_z, 0.90),
        (f.hip_y, 0.09),
        (f.thigh, 0.41),
        (f.shin, 0.405),
        (f.ankle, 0.085),
        (f.ball, 0.12),
        (f.heel, -0.07),
        (f.toe, 0.18),
        (f.waist, 0.16),
        (f.upper_arm, 0.28),
        (f.forearm, 0.25),
    ] {
        near(is, want);
    }
    assert!((f.shoulder - Vec3::new(0.0, 0.18, 0.34)).length() < 2e-4, "{f:?}");
    assert!((f.neck - Vec3::new(0.0, 0.0, 0.40)).length() < 2e-4, "{f:?}");
    let row = &model.row;
    assert_eq!((row.name.as_str(), row.age.as_str(), row.gender.as_str()), ("walker.ada", "adult", "female"));
    // Arms hang: she is no wider than shoulders and arms.
    assert!(row.size_m[1] > 0.40 && row.size_m[1] < 0.75 && (row.size_m[2] - 1.755).abs() < 0.01, "{row:?}");
}

#[test]
fn longer_legs_take_longer_strides() {
    let [short, usual, long] = LEGS.map(|legs| ada(legs).1);
    let strides = [&short, &usual, &long].map(|who| who.figure().stride_m(1.4));
    assert!(strides[0] < strides[1] && strides[1] < strides[2], "{strides:?}");
    let built_in = Walker::new(catalogue::models::find("walker.woman").expect("a model"), 2);
    let ratio = |who: &Walker| who.figure().stride_m(1.4) / who.figure().leg_m().sqrt();
    assert!((ratio(&usual) / ratio(&built_in) - 1.0).abs() < 0.03, "{} {}", ratio(&usual), ratio(&built_in));
}

#[test]
fn planted_feet_stand_still() {
    const STEPS: usize = 160;
    for (who, speed_mps) in LEGS.into_iter().flat_map(|legs| SPEEDS_MPS.map(|speed| (ada(legs).1, speed))) {
        let stride_m = who.figure().stride_m(speed_mps);
        let mut since: BTreeMap<(u8, usize), Vec3> = BTreeMap::new();
        let (mut slide, mut depth, mut touched) = (0.0_f32, 0.0_f32, 0);
        for k in 0..=2 * STEPS {
            let turns = k as f32 / STEPS as f32;
            let way = Vec3::X * turns * stride_m;
            for (bone, points) in placed(&who, TAU * turns, speed_mps) {
                let shoe = [Bone::FootLeft, Bone::FootRight, Bone::ToesLeft, Bone::ToesRight].contains(&bone);
                for (v, p) in points.iter().enumerate() {
                    depth = depth.max(-p.z);
                    let key = (bone as u8, v);
                    if p.z > 0.002 || !shoe {
                        since.remove(&key);
                    } else {
                        touched += 1;
                        let from = *since.entry(key).or_insert(*p + way);
                        slide = slide.max((*p + way - from).truncate().length());
                    }
                }
            }
        }
        assert!(
            slide < 0.02 && depth < 0.01 && touched > 0,
            "at {speed_mps} m/s: slides {slide}, {depth} deep"
        );
    }
}

#[test]
fn boxes_are_those_of_all_vertices() {
    let (model, who) = ada(1.0);
    for (k, speed_mps) in (0..8).flat_map(|k| [0.0, 0.7, 1.4, 3.0].map(|speed| (k, speed))) {
        let phase_rad = TAU * k as f32 / 8.0 + 0.2;
        let found = bounds(&who, phase_rad, speed_mps);
        let reach = found.max.max(-found.min);
        let size = who.box_m(phase_rad, speed_mps);
        let off = (size - Vec3::new(2.0 * reach.x, 2.0 * reach.y, found.max.z)).abs().max_element();
        assert!(off < 0.012, "at {speed_mps} m/s: {size} {found:?}");
        if speed_mps < 1.5 {
            assert!(found.min.z.abs() < 0.01, "at {speed_mps} m/s: {}", found.min.z);
        }
    }
    // A standing person fills the box that the log has.
    let (found, size) = (bounds(&who, 0.0, 0.0), who.size_m());
    let faces = [
        found.min.x + 0.5 * size.x,
        found.max.x - 0.5 * size.x,
        found.min.y + 0.5 * size.y,
        found.max.y - 0.5 * size.y,
        found.max.z - size.z,
    ];
    assert!(faces.iter().all(|off| off.abs() < 0.01), "{faces:?}");
    let logged = Vec3::from_array(model.row.size_m.map(|v| v as f32));
    assert!((logged - size).abs().max_element() < 0.0011, "{logged} {size}");
}

#[test]
fn pieces_are_closed_and_overlap() {
    let (model, _) = ada(1.0);
    let bones: Vec<Attachment> = model.levels[0].pieces.iter().map(|piece| piece.hang).collect();
    assert_eq!(bones.len(), 15, "{bones:?}");
    for piece in &model.levels[0].pieces {
        // Every edge has its other way round: what was cut is closed.
        let mut edges: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
        for t in 0..piece.mesh.triangles.len() {
            let corners = piece.mesh.corners(t).map(|c| c.to_array().map(f32::to_bits));
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]];
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        let open = edges.values().filter(|n| **n != 0).count();
        assert_eq!(open, 0, "{:?}: {open} open edges of {}", piece.hang, edges.len());
    }
    // The knee is in the pieces of thigh and shin.
    let knee = |bone: Bone| {
        let piece =
            model.levels[0].pieces.iter().find(|p| p.hang == Attachment::Bone(bone)).expect("is there");
        Aabb::from_points(&piece.mesh.positions)
    };
    assert!(knee(Bone::ThighLeft).min.z < -0.44 && knee(Bone::ShinLeft).max.z > 0.01);
}
