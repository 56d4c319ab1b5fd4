//! Voxels by separating axes.

use frames::{Agent, Pose, World};
use nalgebra::Vector3;
use schema::Tag;
use settings::OccupancySettings;

use super::soup::Piece;

/// Nearer to touching or parting than this, rounding decides, cells.
const TIE: f64 = 2e-3;

/// How far a triangle and a cube of side 1 with its lowest corner at `cell` are apart along the axis that
/// parts them most; negative where no axis does. The axes are those of Akenine-Moeller, "Fast 3D triangle-box
/// overlap testing" (2001).
fn gap(corners: &[Vector3<f64>; 3], cell: [usize; 3]) -> f64 {
    let middle = Vector3::from(cell.map(|c| c as f64 + 0.5));
    let at = corners.map(|corner| corner - middle);
    let edges = [at[1] - at[0], at[2] - at[1], at[0] - at[2]];
    let sides = [Vector3::x(), Vector3::y(), Vector3::z()];
    let along = |axis: Vector3<f64>| {
        let length = axis.norm();
        if length < 1e-9 {
            return f64::NEG_INFINITY;
        }
        let axis = axis / length;
        let reach = 0.5 * (axis.x.abs() + axis.y.abs() + axis.z.abs());
        let places = at.map(|corner| corner.dot(&axis));
        let low = places[0].min(places[1]).min(places[2]);
        let high = places[0].max(places[1]).max(places[2]);
        (low - reach).max(-reach - high)
    };
    let mut gap = along(edges[0].cross(&edges[1]));
    for side in sides {
        if gap > TIE {
            return gap;
        }
        gap = gap.max(along(side));
        for edge in edges {
            gap = gap.max(along(side.cross(&edge)));
        }
    }
    gap
}

/// The label that a cell takes of those whose bits are set: the highest priority, then the smallest number.
fn winner(tags: u32) -> u8 {
    let there = Tag::ALL.into_iter().filter(|&tag| tags >> tag as u32 & 1 != 0 && tag.voxel_priority() > 0);
    there.max_by_key(|&tag| (tag.voxel_priority(), u8::MAX - tag as u8)).map_or(0, |tag| tag as u8)
}

/// Holds a grid against all triangles.
pub(super) fn check(
    pieces: &[Piece],
    world_from_agent: &Pose<World, Agent>,
    settings: &OccupancySettings,
    got: &[u8],
    place: &str,
) {
    let shape = settings.shape();
    assert_eq!(got.len(), shape.iter().product::<usize>(), "{place}");
    let corner = Vector3::new(-settings.range_m, -settings.range_m, settings.lower_m + settings.mount_z_m);
    let turn = world_from_agent.isometry().rotation.inverse();
    let origin = world_from_agent.translation();
    // Tags that surely touch each cell, and those that may.
    let (mut sure, mut perhaps) = (vec![0_u32; got.len()], vec![0_u32; got.len()]);
    for piece in pieces {
        let corners = piece.corners.map(|p| (turn * (p - origin) - corner) / settings.voxel_m);
        let range = |axis: usize| {
            let values = corners.map(|p| p[axis]);
            let low = values[0].min(values[1]).min(values[2]) - TIE;
            let high = values[0].max(values[1]).max(values[2]) + TIE;
            let last = (high.floor() + 1.0).clamp(0.0, shape[axis] as f64) as usize;
            (low.floor().max(0.0) as usize)..last
        };
        let bit = 1 << piece.tag as u32;
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    let cell = (i * shape[1] + j) * shape[2] + k;
                    let gap = gap(&corners, [i, j, k]);
                    sure[cell] |= if gap < -TIE { bit } else { 0 };
                    perhaps[cell] |= if gap < TIE { bit } else { 0 };
                }
            }
        }
    }
    let (mut occupied, mut ties) = (0, 0);
    for (cell, &got) in got.iter().enumerate() {
        let (least, most) = (winner(sure[cell]), winner(perhaps[cell]));
        let at = || {
            let (column, k) = (cell / shape[2], cell % shape[2]);
            format!("{place}: voxel {:?} is {got}", [column / shape[1], column % shape[1], k])
        };
        if least == most {
            assert_eq!(got, least, "{}", at());
        } else {
            let may = got == 0 || perhaps[cell] >> got & 1 != 0;
            assert!(may && winner(sure[cell] | 1 << got) == got, "{}, not {least} or {most}", at());
            ties += 1;
        }
        occupied += usize::from(got != 0);
    }
    assert!(occupied > 2000 && ties * 20 < occupied, "{place}: {ties} ties of {occupied} voxels");
}
