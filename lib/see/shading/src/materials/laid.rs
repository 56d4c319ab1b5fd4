//! How a piece of a sidewalk lies along it.

use glam::{Vec2, Vec3};
use schema::Tag;
use schema::mesh_textures::MeshTextures;
use simd::{F32x8, Vec3x8};

/// The places of a triangle: metres along the sidewalk and away from its kerb follow evenly from those on its
/// plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laid {
    at: Vec2,
    corner: Vec3,
    /// Metres along and away for a metre along each axis of the object.
    along: Vec3,
    away: Vec3,
}

impl Laid {
    /// Of a triangle of a sidewalk; none where its mesh does not tell, or it has no area.
    pub(super) fn new(
        tag: Tag,
        textures: Option<(&MeshTextures, [Vec2; 3])>,
        corners_m: [Vec3; 3],
    ) -> Option<Self> {
        let (_, [ua, ub, uc]) = textures.filter(|_| tag == Tag::Sidewalk)?;
        let [a, b, c] = corners_m;
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let double = normal.length_squared();
        // The dual basis of the sides: how far along each a place is.
        let (along_b, along_c) = (ac.cross(normal) / double, normal.cross(ab) / double);
        let gradient = |k: usize| along_b * (ub[k] - ua[k]) + along_c * (uc[k] - ua[k]);
        let (along, away) = (gradient(0), gradient(1));
        (double > 1e-12 && along.is_finite() && away.is_finite()).then_some(Self {
            at: ua,
            corner: a,
            along,
            away,
        })
    }

    /// Metres along the sidewalk, and away from its kerb.
    #[inline]
    pub(super) fn places(&self, object_m: &Vec3x8) -> [F32x8; 2] {
        let off = *object_m - Vec3x8::splat(self.corner);
        [off.dot(Vec3x8::splat(self.along)) + self.at.x, off.dot(Vec3x8::splat(self.away)) + self.at.y]
    }

    /// A lean along and away, as one along the axes of the world.
    #[inline]
    pub(super) fn lean(&self, [along, away]: [F32x8; 2]) -> [F32x8; 2] {
        let (a, b) = (self.along.truncate().normalize_or_zero(), self.away.truncate().normalize_or_zero());
        [along * a.x + away * b.x, along * a.y + away * b.y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bend: both triangles of a piece, and the next piece, tell the same of what they share.
    #[test]
    fn pieces_of_a_bend_go_on_without_a_jump() {
        let ring = |angle: f32, radius: f32| {
            let (sin, cos) = frames::math::f32::sin_cos(angle);
            Vec3::new(radius * sin, -radius * cos, 0.0)
        };
        let corner = |angle: f32, outer: bool| {
            let (radius, away) = if outer { (12.0, 2.0) } else { (10.0, 0.0) };
            (ring(angle, radius), Vec2::new(11.0 * angle, away))
        };
        let textures = MeshTextures::default();
        let laid = |corners: [(Vec3, Vec2); 3]| {
            Laid::new(Tag::Sidewalk, Some((&textures, corners.map(|c| c.1))), corners.map(|c| c.0))
                .expect("has an area")
        };
        let at = |piece: &Laid, p: Vec3| piece.places(&Vec3x8::splat(p)).map(|v| v.to_array()[3]);
        let angles = [0.0, 0.3, 0.6];
        let mut pieces = Vec::new();
        for pair in angles.windows(2) {
            let [a, b, c, d] = [
                corner(pair[0], false),
                corner(pair[1], false),
                corner(pair[1], true),
                corner(pair[0], true),
            ];
            pieces.push((laid([a, b, c]), [a, b, c]));
            pieces.push((laid([a, c, d]), [a, c, d]));
        }
        for [first, second] in [[0, 1], [2, 3], [0, 3]] {
            let ((one, corners), (two, others)) = (&pieces[first], &pieces[second]);
            // Everything on the side that both have.
            let shared: Vec<_> = corners.iter().filter(|c| others.contains(c)).collect();
            assert_eq!(shared.len(), 2);
            for share in [0.0, 0.25, 0.7, 1.0] {
                let p = shared[0].0.lerp(shared[1].0, share);
                let want = shared[0].1.lerp(shared[1].1, share);
                for piece in [one, two] {
                    let [along, away] = at(piece, p);
                    assert!(
                        (along - want.x).abs() < 1e-4 && (away - want.y).abs() < 1e-4,
                        "{along} {away} {want}"
                    );
                }
            }
        }
        // Along is along: a lean of the one axis runs with the first piece, to the east.
        let [east, north] = pieces[0].0.lean([F32x8::ONE, F32x8::ZERO]).map(|v| v.to_array()[0]);
        assert!(east > 0.95 && north.abs() < 0.3, "{east} {north}");
        let road = Laid::new(Tag::Road, Some((&textures, [Vec2::ZERO; 3])), [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert!(road.is_none());
    }
}
