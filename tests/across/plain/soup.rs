//! All triangles of a frame, in the world.

use nalgebra::{Matrix3, Vector3};
use schema::geometry::{Instance, Snapshot, TriMesh};
use schema::{ObjectId, Tag};

/// A triangle in the world, metres.
pub(super) struct Piece {
    pub(super) object: ObjectId,
    pub(super) tag: Tag,
    pub(super) corners: [Vector3<f64>; 3],
}

/// All triangles of a frame.
pub(super) fn pieces(snapshot: &Snapshot) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        for (vertices, &part) in mesh.triangles.iter().zip(&mesh.triangle_part) {
            let corners = vertices.map(|v| place(snapshot, instance, mesh.positions[v as usize].to_array()));
            pieces.push(Piece { object: instance.object, tag: mesh.parts[usize::from(part)].tag, corners });
        }
    }
    pieces
}

/// A point of an instance in the world.
fn place(snapshot: &Snapshot, instance: &Instance, point: [f32; 3]) -> Vector3<f64> {
    let columns = instance.local_from_object.matrix3.to_cols_array().map(f64::from);
    let turn = Matrix3::from_column_slice(&columns);
    let shift = Vector3::from(instance.local_from_object.translation.to_array().map(f64::from));
    turn * Vector3::from(point.map(f64::from)) + shift + Vector3::from(snapshot.origin.world_xyz())
}

/// Middle of the bottom of the box around a mesh, in the world, and the box's volume.
pub(super) fn base(snapshot: &Snapshot, instance: &Instance, mesh: &TriMesh) -> (Vector3<f64>, f64) {
    let side = |axis: usize| {
        let values = || mesh.positions.iter().map(move |p| p[axis]);
        (values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max))
    };
    let [(west, east), (south, north), (low, high)] = [side(0), side(1), side(2)];
    let middle = [0.5 * (west + east), 0.5 * (south + north), low];
    let volume = f64::from(east - west) * f64::from(north - south) * f64::from(high - low);
    (place(snapshot, instance, middle), volume)
}
