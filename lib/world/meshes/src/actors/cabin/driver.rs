//! The driver: the parts that show above a seat.

use crate::people::{Appearance, Bone, Figure, Hat, Seat};
use crate::solids::{Detail, Fit};
use catalogue::Model;
use glam::Vec3;
use schema::geometry::TriMesh;
use schema::{Normal, Tag};

use super::plan::Plan;
use super::room::Room;
use super::seats::wheel_at;

/// How high the crown is above the hips of somebody who sits upright, as a share of the stature.
const SITTING: f32 = 0.485;

/// Trunk, head, arms and thighs; the hands are at the steering wheel.
pub(super) fn driver(model: &Model, tag: Tag, plan: &Plan, room: &Room<'_>, fit: &Fit) -> TriMesh {
    let look = Appearance { hat: Hat::None, ..Appearance::new(model, 0).seated() };
    let hips = Vec3::from(plan.driver) + Vec3::new(-0.02, 0.0, -0.02);
    let crown = room.held(hips.with_z(hips.z + 1.2) - Vec3::X * 0.15).z - 0.02;
    let figure = Figure::new(look, ((crown - hips.z) / SITTING).clamp(1.45, 1.84));
    let (wheel, towards) = wheel_at(plan);
    let up = -towards.cross(Vec3::Y);
    let hand = |side: f32| wheel + (Vec3::Y * side * 0.9 + up * 0.35) * plan.wheel[0];
    let ball = |side: f32| Vec3::new(hips.x + 0.70, hips.y + side * 0.12, (hips.z - 0.45).max(plan.floor_z));
    let bones = figure.seated(&Seat {
        hips,
        lean_rad: -plan.lean_rad,
        hands: [hand(1.0), hand(-1.0)],
        balls: [ball(1.0), ball(-1.0)],
        heels_rad: 0.0,
        knees: Vec3::new(0.6, 0.15, 1.0),
        elbows: Vec3::new(-0.3, 0.45, -1.0),
    });
    let mut whole = TriMesh::default();
    for (bone, mesh) in figure.meshes(tag, Detail::Half) {
        if matches!(
            bone,
            Bone::ShinLeft
                | Bone::ShinRight
                | Bone::FootLeft
                | Bone::FootRight
                | Bone::ToesLeft
                | Bone::ToesRight
        ) {
            continue;
        }
        let pose = bones.object_from_bone(bone);
        let first = whole.positions.len() as u32;
        whole
            .positions
            .extend(mesh.positions.iter().map(|p| fit.apply(room.held(pose.transform_point3(*p)))));
        for i in 0..mesh.triangles.len() {
            let part = whole.part_index(*mesh.part(i));
            whole.triangles.push(mesh.triangles[i].map(|v| first + v));
            whole.triangle_part.push(part);
        }
        let turned = |n: &Normal| Normal::new(pose.transform_vector3(n.get()));
        whole.corner_normals.extend(mesh.corner_normals.iter().map(|n| n.each_ref().map(turned)));
    }
    whole
}
