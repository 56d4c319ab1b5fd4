//! Pictures on meshes: what models of packs bring along, and the faces of signs.

use std::sync::OnceLock;

use frames::math;
use glam::{Vec2, Vec3};
use schema::geometry::Surface;
use schema::mesh_textures::{Glow, Image, Level, MeshTextures, PbrFactors, Relief, TextureSet, Wrap};
use simd::{F32x8, LANES, Vec3x8};

use super::points::Points;

/// Normals in pictures lean by less than some 73 degrees.
const LEAST_OUTWARD: f32 = 0.3;

/// The pictures that lie on a triangle: their places follow evenly from those on the triangle's plane.
pub(super) struct UvSurface<'a> {
    texture_set: &'a TextureSet,
    /// Place in the pictures at the first corner, in widths and heights.
    at: Vec2,
    corner: Vec3,
    /// Widths and heights for a metre along each axis of the object, to the right and downwards in the
    /// pictures.
    right: Vec3,
    down: Vec3,
    /// To the right and up in the pictures, along the axes that surfaces lean by.
    axes: [Vec2; 2],
}

impl<'a> UvSurface<'a> {
    /// The pictures of a part on a triangle of its mesh, whose looks lean along `tangents_object`; none where
    /// it has none, or the triangle no area.
    pub(super) fn new(
        surface: Surface,
        textures: Option<(&'a MeshTextures, [Vec2; 3])>,
        corners_m: [Vec3; 3],
        tangents_object: impl FnOnce() -> [Vec3; 2],
    ) -> Option<Self> {
        let texture_set = match surface {
            Surface::Textured(PbrFactors { texture_set, .. }) => texture_set?,
            // What is painted on a sign.
            Surface::Reflector => 0,
            _ => return None,
        };
        let (textures, [ua, ub, uc]) = textures?;
        let texture_set = textures.sets.get(usize::from(texture_set))?;
        let [a, b, c] = corners_m;
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let double = normal.length_squared();
        if double < 1e-20 {
            return None;
        }
        // The dual basis of the sides: how far along each a place is.
        let (along_b, along_c) = (ac.cross(normal) / double, normal.cross(ab) / double);
        let gradient = |k: usize| along_b * (ub[k] - ua[k]) + along_c * (uc[k] - ua[k]);
        let (right, down) = (gradient(0), gradient(1));
        if !(right.is_finite() && down.is_finite()) {
            return None;
        }
        let mut axes = [Vec2::ZERO; 2];
        if texture_set.relief.is_some() {
            // Along the one the other stays as it is.
            let sideways = down.cross(normal);
            let sideways = (sideways * sideways.dot(right).signum()).normalize_or_zero();
            let upwards = right.cross(normal);
            let upwards = (upwards * -upwards.dot(down).signum()).normalize_or_zero();
            let tangents = tangents_object();
            axes = [sideways, upwards].map(|axis| Vec2::new(axis.dot(tangents[0]), axis.dot(tangents[1])));
        }
        Some(Self { texture_set, at: ua, corner: a, right, down, axes })
    }

    /// The colours of eight points, linear RGB; none where the part's own is all over.
    pub(super) fn colour(&self, p: &Points) -> Option<Vec3x8> {
        Some(self.light(self.texture_set.colour.as_deref()?, p))
    }

    /// Their own light; none where they have none.
    pub(super) fn glow(&self, p: &Points) -> Option<Vec3x8> {
        Some(match self.texture_set.glow.as_ref()? {
            Glow::Even(rgb) => Vec3x8::splat(Vec3::from_array(*rgb)),
            Glow::Picture(image) => self.light(image, p),
        })
    }

    /// Their roughness and metalness; none where these are even.
    pub(super) fn specular(&self, p: &Points) -> Option<[F32x8; 2]> {
        let seen = self.between(self.texture_set.specular.as_deref()?, p, share);
        Some([seen.y, seen.z])
    }

    /// How they lean; none where they are even.
    pub(super) fn lean(&self, p: &Points) -> Option<[F32x8; 2]> {
        let Relief { image, strength } = self.texture_set.relief.as_ref()?;
        let normals = self.between(image, p, share) * F32x8::splat(2.0) - Vec3x8::splat(Vec3::ONE);
        let steepness = F32x8::splat(*strength) / normals.z.fast_max(F32x8::splat(LEAST_OUTWARD));
        // The middle of the bytes is 127.5: less than half a byte is even.
        let tilt = |v: F32x8| (v.abs().simd_gt(0.004)).select(v, F32x8::ZERO) * steepness;
        let (sideways, upwards) = (tilt(normals.x), tilt(normals.y));
        let [r, u] = self.axes;
        Some([sideways * r.x + upwards * u.x, sideways * r.y + upwards * u.y])
    }

    fn light(&self, image: &Image, p: &Points) -> Vec3x8 {
        self.between(image, p, |bytes| Vec3::from_array(bytes.map(|byte| linear()[usize::from(byte)])))
    }

    /// What a picture shows at eight points: between the middles of four texels of the copy that is about as
    /// coarse as the nearest of them wants.
    fn between(&self, image: &Image, p: &Points, value: impl Fn([u8; 3]) -> Vec3) -> Vec3x8 {
        let finest = &image.levels[0];
        let widths = p.footprint_m.as_array();
        let nearest_m = widths[0].min(widths[LANES - 1]);
        let (width, height) = (finest.width as f32, finest.height as f32);
        let texels = (self.right.length() * width).max(self.down.length() * height) * nearest_m;
        let top = image.levels.len() - 1;
        // The exponent of a floating-point number is the floor of its base-2 logarithm.
        let wanted = if texels < 1.0 { 0 } else { (texels.to_bits() >> 23) as usize - 127 };
        let copy = &image.levels[wanted.min(top)];
        let size = Vec2::new(copy.width as f32, copy.height as f32);
        Vec3x8::from_fn(|i| {
            let from_corner = p.object_m.lane(i) - self.corner;
            let place = self.at + Vec2::new(self.right.dot(from_corner), self.down.dot(from_corner));
            between(image.wrap, copy, place * size - Vec2::splat(0.5), &value)
        })
    }
}

/// The value between four texels of a copy.
fn between(wrap: [Wrap; 2], copy: &Level, place: Vec2, value: impl Fn([u8; 3]) -> Vec3) -> Vec3 {
    let low = place.floor();
    let share = place - low;
    let [x, y] = [low.x as i32, low.y as i32];
    let texel = |dx: i32, dy: i32| {
        let x = wrap[0].texel(x.saturating_add(dx), copy.width);
        let y = wrap[1].texel(y.saturating_add(dy), copy.height);
        value(copy.texels.get((y * copy.width + x) as usize).copied().unwrap_or_default())
    };
    let upper = texel(0, 0).lerp(texel(1, 0), share.x);
    let lower = texel(0, 1).lerp(texel(1, 1), share.x);
    upper.lerp(lower, share.y)
}

/// Bytes as shares.
fn share(bytes: [u8; 3]) -> Vec3 {
    Vec3::from_array(bytes.map(f32::from)) / 255.0
}

/// Linear light of sRGB bytes (IEC 61966-2-1).
fn linear() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|byte| {
            let v = byte as f64 / 255.0;
            (if v <= 0.040_45 { v / 12.92 } else { math::pow((v + 0.055) / 1.055, 2.4) }) as f32
        })
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use simd::STEPS;

    use super::*;

    fn image(width: u32, height: u32, texels: Vec<[u8; 3]>, mean: [u8; 3]) -> Arc<Image> {
        let levels = vec![Level { width, height, texels }, Level { width: 1, height: 1, texels: vec![mean] }];
        Arc::new(Image { levels, wrap: [Wrap::Clamp; 2] })
    }

    fn textures(texture_set: TextureSet) -> MeshTextures {
        MeshTextures {
            corners: vec![[Vec2::ZERO, Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)]],
            sets: vec![texture_set],
        }
    }

    const SURFACE: Surface =
        Surface::Textured(PbrFactors { texture_set: Some(0), roughness: 1.0, metallic: 0.0 });
    /// Two metres wide and high, in the plane x = 3: to the right is y, downwards is -z; it looks along +x
    /// from behind.
    const CORNERS: [Vec3; 3] = [Vec3::new(3.0, 0.0, 2.0), Vec3::new(3.0, 2.0, 2.0), Vec3::new(3.0, 0.0, 0.0)];

    fn points(y: F32x8, z: f32, footprint: f32) -> Points {
        let object_m = Vec3x8::new(F32x8::splat(3.0), y, F32x8::splat(z));
        Points { object_m, world_m: object_m, footprint_m: F32x8::splat(footprint) }
    }

    #[test]
    fn places_on_a_triangle_are_places_in_its_picture() {
        // Red, green over blue, white.
        let texels = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        let colour = Some(image(2, 2, texels, [128, 128, 128]));
        let textures = textures(TextureSet { colour, ..TextureSet::default() });
        let uv_surface =
            UvSurface::new(SURFACE, Some((&textures, textures.corners[0])), CORNERS, || [Vec3::ZERO; 2])
                .expect("a picture");
        assert!(
            (uv_surface.right.length() - 0.5).abs() < 1e-6 && (uv_surface.down.length() - 0.5).abs() < 1e-6
        );
        let at =
            |y: F32x8, z: f32, footprint: f32| uv_surface.colour(&points(y, z, footprint)).expect("a colour");
        // From the middle of the left texel to that of the right one, beside the upper edge.
        let seen = at(STEPS * (1.0 / 7.0) + 0.5, 1.5, 0.01);
        assert_eq!([seen.lane(0), seen.lane(7)], [Vec3::X, Vec3::Y]);
        assert!((seen.lane(4) - Vec3::new(3.0 / 7.0, 4.0 / 7.0, 0.0)).length() < 1e-5);
        assert_eq!(at(F32x8::splat(0.5), 0.5, 0.01).lane(0), Vec3::Z);
        // From far away the mean is seen.
        let far = at(F32x8::splat(0.5), 0.5, 5.0).lane(3);
        assert!((far - Vec3::splat(0.2158)).length() < 1e-3, "{far}");
        let none = || [Vec3::ZERO; 2];
        assert!(
            UvSurface::new(Surface::Plain, Some((&textures, textures.corners[0])), CORNERS, none).is_none()
        );
        // What sends light back has the first coat, if there is one.
        let sheet = UvSurface::new(Surface::Reflector, Some((&textures, textures.corners[0])), CORNERS, none);
        let sheet = sheet.and_then(|sheet| sheet.colour(&points(F32x8::splat(0.5), 0.5, 0.01)));
        assert_eq!(sheet.expect("a colour").lane(0), Vec3::Z);
        assert!(UvSurface::new(Surface::Reflector, None, CORNERS, none).is_none());
        let here = points(STEPS, 0.5, 0.01);
        assert!(
            uv_surface.specular(&here).is_none()
                && uv_surface.lean(&here).is_none()
                && uv_surface.glow(&here).is_none()
        );
    }

    /// Turned by any angle on its plane, mirrored or stretched: red leans to where the picture's columns
    /// grow, green to where its rows fall.
    #[test]
    fn normals_lean_as_their_picture_lies() {
        // 45 degrees to its right, then 45 degrees up: the diagonal of a square is 180.3 of 255.
        let leaning = [[218, 128, 218], [128, 218, 218]];
        for (number, texel) in leaning.into_iter().enumerate() {
            let relief = Relief { image: image(1, 1, vec![texel], texel), strength: 1.0 };
            for [b, c] in [
                [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)],
                [Vec2::new(0.6, 0.8), Vec2::new(-0.8, 0.6)],
                [Vec2::new(-2.0, 0.0), Vec2::new(0.0, 0.5)],
            ] {
                let mut textures =
                    textures(TextureSet { relief: Some(relief.clone()), ..TextureSet::default() });
                textures.corners[0] = [Vec2::ZERO, b, c];
                let uv_surface =
                    UvSurface::new(SURFACE, Some((&textures, textures.corners[0])), CORNERS, || {
                        [Vec3::Y, Vec3::Z]
                    })
                    .expect("a picture");
                let [right, up] = uv_surface.lean(&points(STEPS, 0.5, 0.01)).expect("leans");
                let lean = Vec3::new(0.0, right.as_array()[0], up.as_array()[0]);
                assert!((lean.length() - 1.0).abs() < 0.02, "{lean}");
                // One step along it in the picture, by the places at the corners: y grows to b, z falls to c.
                let step = b * (lean.y / 2.0) - c * (lean.z / 2.0);
                let expected = [Vec2::X, -Vec2::Y][number];
                assert!(step.normalize().dot(expected) > 0.99, "{number} {b} {c}: {step}");
            }
        }
        // Half a byte beside the middle is even.
        let even = Relief { image: image(1, 1, vec![[128, 127, 255]], [0; 3]), strength: 4.0 };
        let textures = textures(TextureSet { relief: Some(even), ..TextureSet::default() });
        let uv_surface =
            UvSurface::new(SURFACE, Some((&textures, textures.corners[0])), CORNERS, || [Vec3::Y, Vec3::Z]);
        let lean =
            uv_surface.and_then(|uv_surface| uv_surface.lean(&points(STEPS, 0.5, 0.01))).expect("is even");
        assert_eq!(lean, [F32x8::ZERO; 2]);
    }

    #[test]
    fn light_and_gloss_are_as_painted() {
        let even = TextureSet { glow: Some(Glow::Even([0.5, 0.25, 0.0])), ..TextureSet::default() };
        let painted = TextureSet {
            glow: Some(Glow::Picture(image(1, 1, vec![[255, 188, 0]], [0; 3]))),
            specular: Some(image(1, 1, vec![[9, 51, 255]], [0; 3])),
            ..TextureSet::default()
        };
        let here = points(STEPS, 0.5, 0.01);
        for (texture_set, green) in [(even, 0.25), (painted.clone(), 0.5029)] {
            let textures = textures(texture_set);
            let uv_surface =
                UvSurface::new(SURFACE, Some((&textures, [Vec2::ZERO; 3])), CORNERS, || [Vec3::ZERO; 2]);
            let glow = uv_surface.and_then(|uv_surface| uv_surface.glow(&here)).expect("shines");
            assert!((glow.lane(5).y - green).abs() < 1e-3, "{glow:?}");
        }
        let textures = textures(painted);
        let uv_surface =
            UvSurface::new(SURFACE, Some((&textures, [Vec2::ZERO; 3])), CORNERS, || [Vec3::ZERO; 2]);
        let specular = uv_surface.and_then(|uv_surface| uv_surface.specular(&here)).expect("is given");
        assert_eq!(specular.map(|v| v.as_array()[2]), [0.2, 1.0]);
    }
}
