//! Cut-outs as geometry: triangles whose picture is clear in places are cut along its edges, so that every
//! sense sees the same.

use meshes::people::Bone;

use crate::stencil::Stencil;
use crate::triangle_soup::Triangle;

/// Triangles that cutting may add to a level of detail.
pub(crate) const ADDED: usize = 16_384;
/// Triangles are halved so often at most; fewer times where that would add too many.
const HALVINGS: [u32; 7] = [12, 10, 8, 6, 4, 2, 0];
/// Places looked at until cuts are made coarser.
const LOOKS: usize = 20_000_000;

/// What is left of the triangles of a level, by what they hang on.
pub(crate) fn cut<'s>(
    level: &[Vec<Triangle>],
    stencil_of: impl Fn(&Triangle) -> Option<&'s Stencil>,
) -> Vec<Vec<Triangle>> {
    let all: Vec<(usize, &Triangle)> = level
        .iter()
        .enumerate()
        .flat_map(|(hung, triangles)| triangles.iter().map(move |t| (hung, t)))
        .collect();
    let most = all.len() + ADDED;
    let mut left = Vec::new();
    for halvings in HALVINGS {
        let mut cutter = Cutter { looks: 0, kept: 0 };
        left = vec![Vec::new(); level.len()];
        for (hung, triangle) in &all {
            match stencil_of(triangle) {
                None => {
                    left[*hung].push(**triangle);
                    cutter.kept += 1;
                }
                Some(stencil) => cutter.cut(triangle, stencil, halvings, &mut left[*hung]),
            }
            if halvings > 0 && (cutter.looks > LOOKS || cutter.kept > most) {
                break;
            }
        }
        if cutter.looks <= LOOKS && cutter.kept <= most {
            break;
        }
    }
    left
}

/// Cuts, and counts what it takes.
struct Cutter {
    looks: usize,
    kept: usize,
}

impl Cutter {
    fn cut(&mut self, triangle: &Triangle, stencil: &Stencil, halvings: u32, left: &mut Vec<Triangle>) {
        let [shown, of] = stencil.shown(triangle.uv);
        self.looks += of;
        let sides = stencil.sides(triangle.uv);
        let longest = (1..3).fold(0, |longest, k| if sides[k] > sides[longest] { k } else { longest });
        let is_even = shown == 0 || shown == of;
        if is_even || halvings == 0 || sides[longest] < 1.0 {
            if 2 * shown >= of {
                left.push(*triangle);
                self.kept += 1;
            }
        } else {
            for half in halves(triangle, longest) {
                self.cut(&half, stencil, halvings - 1, left);
            }
        }
    }
}

/// The two halves of a triangle, cut through the middle of the side from a corner to the next.
fn halves(triangle: &Triangle, from: usize) -> [Triangle; 2] {
    let to = (from + 1) % 3;
    let corner_m = (triangle.corners_m[from] + triangle.corners_m[to]) * 0.5;
    let uv = (triangle.uv[from] + triangle.uv[to]) * 0.5;
    let normal = triangle.normals.map(|normals| (normals[from] + normals[to]).normalize_or_zero());
    // The same from either side of the edge.
    let of: [Bone; 2] = [triangle.bones[from], triangle.bones[to]];
    let bone = of[usize::from((of[0] as u32) > of[1] as u32)];
    [to, from].map(|corner| {
        let mut half = *triangle;
        half.corners_m[corner] = corner_m;
        half.uv[corner] = uv;
        half.bones[corner] = bone;
        if let (Some(normals), Some(normal)) = (&mut half.normals, normal) {
            normals[corner] = normal;
        }
        half
    })
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2, Vec3};
    use schema::mesh_textures::Wrap;

    use super::*;

    fn quad() -> [Triangle; 2] {
        let corners = [Vec2::ZERO, Vec2::new(1.0, 0.0), Vec2::ONE, Vec2::new(0.0, 1.0)];
        [[0, 1, 2], [0, 2, 3]].map(|order| {
            let uv = order.map(|k: usize| corners[k]);
            Triangle {
                corners_m: uv.map(|at| DVec3::new(f64::from(at.x), f64::from(at.y), 0.0)),
                normals: Some([Vec3::Z; 3]),
                uv,
                part: 0,
                bones: [Bone::Pelvis; 3],
            }
        })
    }

    /// A disc of 0.6 of the width is there.
    fn disc(side: u32) -> Stencil {
        let at = |i: u32| (i as f32 + 0.5) / side as f32 - 0.5;
        let is_there = (0..side * side)
            .map(|i| at(i % side) * at(i % side) + at(i / side) * at(i / side) < 0.09)
            .collect();
        Stencil::new(side, [Wrap::Clamp; 2], is_there)
    }

    fn area(triangles: &[Triangle]) -> f64 {
        triangles
            .iter()
            .map(|t| 0.5 * (t.corners_m[1] - t.corners_m[0]).cross(t.corners_m[2] - t.corners_m[0]).z)
            .sum()
    }

    #[test]
    fn what_is_left_covers_what_the_picture_shows() {
        let stencil = disc(256);
        let left = cut(&[quad().to_vec()], |_| Some(&stencil)).remove(0);
        let disc_m2 = std::f64::consts::PI * 0.09;
        assert!((area(&left) - disc_m2).abs() < 0.02 * disc_m2, "{}", area(&left));
        assert!(left.len() > 100 && left.len() < ADDED, "{}", left.len());
        for triangle in &left {
            // Pieces lie where they lay in the picture, and as they faced.
            let [shown, of] = stencil.shown(triangle.uv);
            assert!(2 * shown >= of);
            for (corner, uv) in triangle.corners_m.iter().zip(triangle.uv) {
                assert!((corner.truncate().as_vec2() - uv).length() < 1e-6);
            }
        }
        assert!(left.iter().all(|t| t.normals == Some([Vec3::Z; 3]) && area(&[*t]) > 0.0));
    }

    #[test]
    fn whole_and_clear_triangles_are_not_cut() {
        let [all, none] = [true, false].map(|there| Stencil::new(2, [Wrap::Repeat; 2], vec![there; 4]));
        let level = [quad().to_vec(), Vec::new()];
        let left =
            |stencil: Option<&Stencil>| cut(&level, |_| stencil).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(left(Some(&all)), [2, 0]);
        assert_eq!(left(Some(&none)), [0, 0]);
        assert_eq!(left(None), [2, 0]);
    }

    #[test]
    fn what_would_be_too_many_is_cut_coarsely() {
        // A chequerboard of texels on each of 2,000 triangles.
        let stencil = Stencil::new(64, [Wrap::Repeat; 2], (0..4096).map(|i| (i + i / 64) % 2 == 0).collect());
        let level = [quad().repeat(1000)];
        let left = cut(&level, |_| Some(&stencil)).remove(0);
        assert!(left.len() <= 2000 + ADDED, "{}", left.len());
    }
}
