//! What lies on a skin: lamps, plates, grilles, strips. Each is a closed solid, a curved face whose edge runs
//! to a point inside.

use crate::solids::{MeshBuilder, circle};
use glam::Vec3;
use schema::geometry::MeshPart;

/// A four-sided piece of `nu` by `nv` cells: `at` takes 0 to 1 each way to the skin; `inward` reaches from
/// its middle to where it is closed.
pub(crate) fn patch(
    b: &mut MeshBuilder,
    part: MeshPart,
    [nu, nv]: [usize; 2],
    inward: Vec3,
    at: &dyn Fn(f32, f32) -> Vec3,
) {
    let point = |i: usize, j: usize| at(i as f32 / nu as f32, j as f32 / nv as f32);
    let middle = at(0.5, 0.5);
    // Whether u, v run counter-clockwise seen from outside.
    let turned = (at(1.0, 0.5) - at(0.0, 0.5)).cross(at(0.5, 1.0) - at(0.5, 0.0)).dot(inward) > 0.0;
    let index = b.part_index(part);
    let ids: Vec<Vec<u32>> = (0..=nv).map(|j| (0..=nu).map(|i| b.vertex(point(i, j))).collect()).collect();
    let face = |b: &mut MeshBuilder, [x, y, z]: [u32; 3]| {
        b.triangle(index, if turned { [x, z, y] } else { [x, y, z] });
    };
    for j in 0..nv {
        for i in 0..nu {
            let (p, q, r, s) = (ids[j][i], ids[j][i + 1], ids[j + 1][i + 1], ids[j + 1][i]);
            face(b, [p, q, r]);
            face(b, [p, r, s]);
        }
    }
    let mut rim: Vec<u32> = ids[0][..nu].to_vec();
    rim.extend(ids[..nv].iter().map(|row| row[nu]));
    rim.extend(ids[nv][1..].iter().rev());
    rim.extend(ids[1..].iter().rev().map(|row| row[0]));
    // Behind where a bent piece's edge is.
    let behind = inward.normalize_or_zero();
    let bent_m =
        [0.0, 1.0].map(|u| [0.0, 1.0].map(|v| (at(u, v) - middle).dot(behind))).into_iter().flatten();
    let apex = middle + inward + behind * bent_m.fold(0.0, f32::max);
    close(b, index, &rim, apex, turned);
}

/// A round piece: `at` takes places of the unit disc to the skin.
pub(crate) fn disc(
    b: &mut MeshBuilder,
    part: MeshPart,
    sides: usize,
    inward: Vec3,
    at: &dyn Fn(f32, f32) -> Vec3,
) {
    let centre = at(0.0, 0.0);
    let turned = (at(1.0, 0.0) - centre).cross(at(0.0, 1.0) - centre).dot(inward) > 0.0;
    let index = b.part_index(part);
    let middle = b.vertex(centre);
    let rim: Vec<u32> = circle(sides).map(|(c, s)| b.vertex(at(c, s))).collect();
    for (i, from) in rim.iter().enumerate() {
        let to = rim[(i + 1) % sides];
        b.triangle(index, if turned { [middle, to, *from] } else { [middle, *from, to] });
    }
    close(b, index, &rim, centre + inward, turned);
}

/// Runs a rim to a point behind it.
fn close(b: &mut MeshBuilder, index: u8, rim: &[u32], apex: Vec3, turned: bool) {
    let apex = b.vertex(apex);
    for (i, from) in rim.iter().enumerate() {
        let to = rim[(i + 1) % rim.len()];
        b.triangle(index, if turned { [*from, to, apex] } else { [to, *from, apex] });
    }
}
