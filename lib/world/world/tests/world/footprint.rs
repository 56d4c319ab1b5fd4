//! The footprints that block walkers are those of the meshes.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use std::collections::BTreeMap;

use crate::common::{demo, place, rules, start};
use frames::math::sin_cos;
use frames::{Object, Pose, World};
use meshes::actors::actor_mesh;
use nalgebra::Point3;
use opendrive::Map;
use schema::ActorKind;
use schema::footprint::{LightMount, WALKING_HEIGHT_M, footprint};
use schema::geometry::Surface;

/// Corners of what is solid of a triangle at walking height, in the object's frame: those of the part between
/// two planes.
fn clipped(corners: [glam::Vec3; 3], low: f32, high: f32) -> Vec<glam::Vec3> {
    let cut = |points: Vec<glam::Vec3>, keeps: &dyn Fn(f32) -> f32| -> Vec<glam::Vec3> {
        let mut kept = Vec::new();
        for (i, a) in points.iter().enumerate() {
            let b = points[(i + 1) % points.len()];
            let (da, db) = (keeps(a.z), keeps(b.z));
            if da >= 0.0 {
                kept.push(*a);
            }
            if da * db < 0.0 {
                kept.push(*a + (b - *a) * (da / (da - db)));
            }
        }
        kept
    };
    cut(cut(corners.to_vec(), &|z| z - low), &|z| high - z)
}

#[test]
fn footprints_hold_what_is_drawn_at_walking_height_and_little_more() {
    let map: Map = demo();
    let actors = place(&map, &rules(), start(&map), 1).actors;
    let mut seen: BTreeMap<ActorKind, usize> = BTreeMap::new();
    for actor in &actors {
        let Some(held) = footprint(actor) else {
            let is_paving = actor.semantic_tags == [schema::Tag::Sidewalk as u8];
            let mount = LightMount::from_variant(actor.variant);
            let is_high_light = actor.kind == ActorKind::TrafficLight
                && mount.hangs
                && f64::from(mount.height_m) >= WALKING_HEIGHT_M;
            let hangs_high = is_high_light || actor.model == "pole.wires";
            assert!(
                actor.kind == ActorKind::Surface || is_paving || actor.height_m < 0.06 || hangs_high,
                "{}",
                actor.model
            );
            continue;
        };
        let size = [actor.length_m, actor.width_m, actor.height_m];
        let mesh = actor_mesh(&actor.model, size, actor.variant).unwrap();
        let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
        let (sin, cos) = sin_cos(held.yaw_rad);
        let low = (held.xyz_m[2] - actor.xyz_m[2]) as f32;
        let mut reach = [0.0_f64; 2];
        for piece in &mesh.pieces {
            let Some(from_piece) = piece.joint.object_from_piece(&meshes::actors::Posture::default()) else {
                continue;
            };
            for i in 0..piece.mesh.triangles.len() {
                let leaves = piece.mesh.part(i).surface == Surface::Foliage;
                if leaves && actor.model.starts_with("tree") {
                    continue;
                }
                let corners = piece.mesh.corners(i).map(|p| from_piece.transform_point3(p));
                for p in clipped(corners, low, low + WALKING_HEIGHT_M as f32) {
                    let p = pose * Point3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z));
                    let (x, y) = (p.x - held.xyz_m[0], p.y - held.xyz_m[1]);
                    let local = [x * cos + y * sin, y * cos - x * sin];
                    reach = [0, 1].map(|k| reach[k].max(local[k].abs()));
                }
            }
        }
        // Trunks bend, and objects on a slope lean.
        let up = pose.rotate(nalgebra::Vector3::z());
        let leans = (up.x * up.x + up.y * up.y).sqrt() * actor.height_m.min(WALKING_HEIGHT_M);
        let spare = leans + if actor.model.starts_with("tree") { 0.12 } else { 0.02 };
        for k in 0..2 {
            assert!(reach[k] <= held.half_m[k] + spare, "{} reaches {reach:?} from {held:?}", actor.model);
            assert!(
                reach[k] >= held.half_m[k] - 0.3 || actor.kind == ActorKind::Building,
                "{} reaches but {reach:?} from {held:?}",
                actor.model
            );
        }
        *seen.entry(actor.kind).or_default() += 1;
    }
    let kinds = {
        use ActorKind::*;
        [Building, Vegetation, Pole, Prop, Parked, TrafficLight, Sign]
    };
    for kind in kinds {
        assert!(seen.contains_key(&kind), "no {kind:?} among {seen:?}");
    }
}
