//! Pictures on meshes: what models of packs bring along.

use std::sync::OnceLock;

use frames::math;
use glam::{Vec2, Vec3};
use lanes::{LANES, Lanes, Vec3s};
use schema::geometry::Surface;
use schema::skin::{Finish, Image, Level, Skin};

/// A picture that lies on a triangle: its places follow evenly from those on the triangle's plane.
pub(super) struct Draped<'a> {
    image: &'a Image,
    /// Place in the picture, in texels of its finest copy, at the first corner.
    at: Vec2,
    corner: Vec3,
    /// Texels for a metre along each axis of the object, to the right and downwards in the picture.
    right: Vec3,
    down: Vec3,
    /// Texels in a metre, where they are densest.
    per_m: f32,
}

impl<'a> Draped<'a> {
    /// The picture of a part on a triangle of its mesh; none where it has none, or the triangle no area.
    pub(super) fn new(
        surface: Surface,
        skin: Option<(&'a Skin, [Vec2; 3])>,
        corners_m: [Vec3; 3],
    ) -> Option<Self> {
        let Surface::Skin(Finish { image: Some(image), .. }) = surface else { return None };
        let (skin, uv) = skin?;
        let image = skin.images.get(usize::from(image))?;
        let finest = image.levels.first()?;
        let size = Vec2::new(finest.width as f32, finest.height as f32);
        let [a, b, c] = corners_m;
        let [ua, ub, uc] = uv.map(|place| place * size);
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
        let per_m = right.length().max(down.length());
        (per_m.is_finite()).then_some(Self { image, at: ua, corner: a, right, down, per_m })
    }

    /// The colours of eight points, linear RGB: between the middles of four texels of the copy that is about as coarse as the nearest
    /// of them wants.
    pub(super) fn at(&self, object_m: &Vec3s, footprint_m: Lanes) -> Vec3s {
        let widths = footprint_m.as_array();
        let texels = self.per_m * widths[0].min(widths[LANES - 1]);
        let top = self.image.levels.len() - 1;
        // The exponent of a floating-point number is the floor of its base-2 logarithm.
        let wanted = if texels < 1.0 { 0 } else { (texels.to_bits() >> 23) as usize - 127 };
        let level = wanted.min(top);
        let finest = &self.image.levels[0];
        let copy = &self.image.levels[level];
        let scale =
            Vec2::new(copy.width as f32 / finest.width as f32, copy.height as f32 / finest.height as f32);
        Vec3s::from_fn(|i| {
            let from_corner = object_m.lane(i) - self.corner;
            let place = self.at + Vec2::new(self.right.dot(from_corner), self.down.dot(from_corner));
            self.between(copy, place * scale - Vec2::splat(0.5))
        })
    }

    /// The colour between four texels of a copy.
    fn between(&self, copy: &Level, place: Vec2) -> Vec3 {
        let low = place.floor();
        let share = place - low;
        let [x, y] = [low.x as i32, low.y as i32];
        let texel = |dx: i32, dy: i32| {
            let x = self.image.wrap[0].texel(x.saturating_add(dx), copy.width);
            let y = self.image.wrap[1].texel(y.saturating_add(dy), copy.height);
            let bytes = copy.texels.get((y * copy.width + x) as usize).copied().unwrap_or_default();
            Vec3::from_array(bytes.map(|byte| linear()[usize::from(byte)]))
        };
        let upper = texel(0, 0).lerp(texel(1, 0), share.x);
        let lower = texel(0, 1).lerp(texel(1, 1), share.x);
        upper.lerp(lower, share.y)
    }
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

    use lanes::STEPS;
    use schema::skin::Wrap;

    use super::*;

    /// Four texels: red, green over blue, white.
    fn skin() -> Skin {
        let texels = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        let levels = vec![
            Level { width: 2, height: 2, texels },
            Level { width: 1, height: 1, texels: vec![[128, 128, 128]] },
        ];
        let corners = vec![[Vec2::ZERO, Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)]];
        Skin { corners, images: vec![Arc::new(Image { levels, wrap: [Wrap::Clamp; 2] })] }
    }

    #[test]
    fn places_on_a_triangle_are_places_in_its_picture() {
        let skin = skin();
        let surface = Surface::Skin(Finish { image: Some(0), roughness: 1.0, metallic: 0.0 });
        // Two metres wide and high, in the plane x = 3: to the right is y, downwards is -z.
        let corners = [Vec3::new(3.0, 0.0, 2.0), Vec3::new(3.0, 2.0, 2.0), Vec3::new(3.0, 0.0, 0.0)];
        let draped = Draped::new(surface, Some((&skin, skin.corners[0])), corners).expect("a picture");
        assert!((draped.per_m - 1.0).abs() < 1e-6);
        let at = |y: Lanes, z: f32, footprint: f32| {
            let object_m = Vec3s::new(Lanes::splat(3.0), y, Lanes::splat(z));
            draped.at(&object_m, Lanes::splat(footprint))
        };
        // From the middle of the left texel to that of the right one, beside the upper edge.
        let seen = at(STEPS * (1.0 / 7.0) + 0.5, 1.5, 0.01);
        assert_eq!([seen.lane(0), seen.lane(7)], [Vec3::X, Vec3::Y]);
        assert!((seen.lane(4) - Vec3::new(3.0 / 7.0, 4.0 / 7.0, 0.0)).length() < 1e-5);
        assert_eq!(at(Lanes::splat(0.5), 0.5, 0.01).lane(0), Vec3::Z);
        // From far away the mean is seen.
        let far = at(Lanes::splat(0.5), 0.5, 5.0).lane(3);
        assert!((far - Vec3::splat(0.2158)).length() < 1e-3, "{far}");
        assert!(Draped::new(Surface::Plain, Some((&skin, skin.corners[0])), corners).is_none());
    }
}
