//! Pixels that show leaves, eight at once of whatever triangles.
//!
//! A leaf fills a pixel or two. Worked out triangle by triangle, as walls are, each would cost as much as
//! eight pixels of a wall. The colour of a pixel follows from its own triangle and place alone.

use glam::Vec3;
use render::{SurfacePoints, SurfaceTriangle};
use simd::{F32x8, LANES, Vec3x8};

use super::bloom::gather_one;
use super::shader::Shader;
use crate::light::{CornerGradient, Facing};
use crate::materials::{Points, foliage};

/// How far leaves' normals are bent upwards for light that comes from one side: they stand every way.
const LEAN: f32 = 0.6;
/// Share of the light of sky and ground that leaves send back or let through.
const OF_AMBIENT: f32 = 0.8;
/// Share of the sun's light that gets through leaves above to those deep in a crown.
const THROUGH: f32 = 0.1;
/// Texels of the map of shadows by which leaves are moved to the sun before they are looked up, so that those
/// of one twig do not shade one another.
const TO_SUN_TEXELS: f32 = 4.0;

/// Where a pixel shows a leaf, and what that looks like there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeafPixel {
    position_local: Vec3,
    position_object: Vec3,
    depth_m: f32,
    /// Of the triangle's plane, on the camera's side.
    normal_local: Vec3,
    normal_object: Vec3,
    /// For light.
    bent_local: Vec3,
    /// Colour, linear RGB.
    rgb: Vec3,
    /// What of sky and ground is seen past its own plant, 0 to 1.
    sheltered: f32,
    /// What houses leave of the sky, 0 to 1.
    between_houses: f32,
}

/// What is the same for some points of a triangle of leaves, and what runs over these.
struct Leaf {
    normal_local: Vec3,
    normal_object: Vec3,
    bent_local: Vec3x8,
    rgb: Vec3,
    sheltered: F32x8,
    between_houses: f32,
}

impl Leaf {
    /// One of the points.
    fn pixel(&self, points: &SurfacePoints, i: usize) -> LeafPixel {
        LeafPixel {
            position_local: points.position_local.lane(i),
            position_object: points.position_object.lane(i),
            depth_m: points.depth_m.as_array()[i],
            normal_local: self.normal_local,
            normal_object: self.normal_object,
            bent_local: self.bent_local.lane(i),
            rgb: self.rgb,
            sheltered: self.sheltered.as_array()[i],
            between_houses: self.between_houses,
        }
    }
}

/// Pixels of a row that wait until there are eight.
#[derive(Debug, Default)]
pub(super) struct LeafPixels {
    count: usize,
    columns: [u32; LANES],
    pixels: [LeafPixel; LANES],
}

/// Triangles that are longer than so many pixels are lit as their corners say, smaller ones evenly.
const LARGE_PX: f32 = 6.0;

/// A row of the picture, of all columns.
pub(super) struct WholeRow<'p> {
    pub(super) y: u32,
    pub(super) pixels: &'p mut [[u8; 3]],
    /// What is brighter than white in its blocks.
    pub(super) bright: &'p mut [Vec3],
}

impl Shader<'_> {
    /// Takes the pixels of a span of columns that shows a leaf, and paints each time there are eight.
    pub(super) fn take_leaf(
        &self,
        waiting: &mut LeafPixels,
        triangle: &SurfaceTriangle<'_, '_>,
        columns: std::ops::Range<u32>,
        row: &mut WholeRow<'_>,
    ) {
        for first in columns.clone().step_by(LANES) {
            let count = (columns.end - first).min(LANES as u32);
            let here: [u32; LANES] = std::array::from_fn(|i| first + (i as u32).min(count - 1));
            let points = triangle.points(self.buffer, &here, row.y);
            let leaf = self.leaf(triangle, &points);
            for (i, column) in here.into_iter().enumerate().take(count as usize) {
                waiting.columns[waiting.count] = column;
                waiting.pixels[waiting.count] = leaf.pixel(&points, i);
                waiting.count += 1;
                if waiting.count == LANES {
                    self.paint_leaves(waiting, row);
                }
            }
        }
    }

    /// Paints those that wait.
    pub(super) fn paint_leaves(&self, waiting: &mut LeafPixels, row: &mut WholeRow<'_>) {
        let Some(last) = waiting.count.checked_sub(1) else { return };
        let (pixel, column) = (waiting.pixels[last], waiting.columns[last]);
        waiting.pixels[last..].fill(pixel);
        waiting.columns[last..].fill(column);
        let value = self.leaves(&waiting.pixels, F32x8::ONE);
        let passes = self.vignette.passes(&waiting.columns, row.y);
        let seen = value * Vec3x8::splat(self.balance) * passes;
        let mut rgb = [[0; 3]; LANES];
        self.film.develop(&seen, &mut rgb);
        for (i, column) in waiting.columns[..=last].iter().map(|c| *c as usize).enumerate() {
            row.pixels[column] = rgb[i];
            gather_one(seen.lane(i), column, row.bright);
        }
        waiting.count = 0;
    }

    /// Film values of what eight pixels show of one triangle of leaves, from behind fog that so much light
    /// passes.
    pub(super) fn leaf_behind(
        &self,
        triangle: &SurfaceTriangle<'_, '_>,
        points: &SurfacePoints,
        before: F32x8,
    ) -> Vec3x8 {
        let leaf = self.leaf(triangle, points);
        self.leaves(&std::array::from_fn(|i| leaf.pixel(points, i)), before)
    }

    /// What is the same for eight points of a triangle of leaves.
    fn leaf(&self, triangle: &SurfaceTriangle<'_, '_>, points: &SurfacePoints) -> Leaf {
        let normal_local = triangle.normal_local;
        let to_local = &triangle.placed().local_from_object.matrix3;
        let corners_m = triangle.corners_object_m();
        let [along, across] = [corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]];
        let large_m = LARGE_PX * self.per_focal * points.depth_m.as_array()[0];
        let is_large = along.length_squared().max(across.length_squared()) > large_m * large_m;
        let bent = match is_large.then(|| triangle.bend()).flatten() {
            Some(bend) => bend.normals(points.position_object),
            None => Vec3x8::splat(triangle.mean_normal_local()),
        };
        let sheltered = match triangle.open() {
            Some(open) if open != [open[0]; 3] => {
                CornerGradient::new(corners_m, open).at(&points.position_object)
            }
            Some([open, ..]) => F32x8::splat(open),
            None => F32x8::ONE,
        };
        Leaf {
            normal_local,
            normal_object: to_local.transpose() * normal_local,
            bent_local: bent,
            rgb: Vec3::from_array(triangle.part.rgb),
            sheltered,
            between_houses: self
                .lighting
                .walls
                .open(points.position_local.lane(0), &Facing::new(normal_local)),
        }
    }

    /// Film values of eight pixels that show leaves, from behind fog that so much light passes.
    pub(super) fn leaves(&self, pixels: &[LeafPixel; LANES], before: F32x8) -> Vec3x8 {
        let light = self.lighting;
        let vectors = |of: fn(&LeafPixel) -> Vec3| Vec3x8::from_fn(|i| of(&pixels[i]));
        let numbers = |of: fn(&LeafPixel) -> f32| F32x8::from(pixels.each_ref().map(of));
        let positions = vectors(|p| p.position_local);
        let normals = vectors(|p| p.normal_local);
        let to_camera = Vec3x8::splat(self.camera) - positions;
        let distance_m = to_camera.length_squared().sqrt().fast_max(F32x8::splat(1e-6));
        let slant = (to_camera.dot(normals) / distance_m).fast_clamp(F32x8::splat(0.04), F32x8::ONE);
        let to_key = light.sky.key_direction;
        let sunlit = light.shadows.lit(&positions, to_key * TO_SUN_TEXELS).share;
        // A crown hides the sky from its own leaves once: the map from above shows it, too.
        let sheltered = numbers(|p| p.sheltered);
        let open = light.overhead.open(&positions, &normals).fast_min(sheltered);
        let lamps = if light.lamps.is_empty() {
            Vec3x8::default()
        } else {
            let klx = light.lamps.illuminance(&positions, &leaning(&normals));
            klx * F32x8::splat(self.exposure / std::f32::consts::PI)
        };
        let points = Points {
            object_m: vectors(|p| p.position_object),
            world_m: positions + Vec3x8::splat(light.around.world_from_local_m),
            footprint_m: numbers(|p| p.depth_m) * (self.per_focal / slant.sqrt()),
        };
        let look = foliage(self.patterns, &vectors(|p| p.normal_object), &vectors(|p| p.rgb), &points);
        let [a, b] = look.lean.unwrap_or_default();
        let tangents = tangents(&normals);
        let along = |v: Vec3| tangents.map(|tangent| tangent.dot(Vec3x8::splat(v)));
        let leans = |v: Vec3| {
            let [right, up] = along(v);
            right * a + up * b
        };
        let bent = vectors(|p| p.bent_local);
        // Leaves let light through, and those turned away are looked at on their lit side.
        let side = leaning(&bent).dot(Vec3x8::splat(to_key));
        let facing = side.fast_max(F32x8::ZERO) * 0.55 + (side * 0.5 + 0.5) * 0.15 + 0.2;
        let facing = (facing + leans(to_key)).fast_max(F32x8::ZERO);
        let [mean, x, y, z] = self.ambient;
        let ambient = |i: usize| {
            let smooth = (bent.x * x[i] + bent.y * y[i] + bent.z * z[i] + mean[i]).fast_max(F32x8::ZERO);
            smooth * OF_AMBIENT + leans(Vec3::new(x[i], y[i], z[i]))
        };
        let ambient = self
            .between_houses(Vec3x8::new(ambient(0), ambient(1), ambient(2)), numbers(|p| p.between_houses));
        let through = (1.0 - sunlit) * (1.0 - sheltered) * THROUGH;
        let received = Vec3x8::splat(self.key) * (facing * sunlit + through) + ambient * open + lamps;
        let passes = light.fog.passes(self.camera.z, positions.z, distance_m);
        let passes = (passes / before).fast_min(F32x8::ONE);
        Vec3x8::splat(self.veil).lerp(look.albedo * received, passes)
    }
}

/// Normals of leaves, for light that comes from one side.
#[inline]
fn leaning(normals: &Vec3x8) -> Vec3x8 {
    let upward = *normals + Vec3x8::splat(Vec3::Z * LEAN);
    upward * (1.0 / upward.length_squared().sqrt())
}

/// The axes of leaves' texture, as [`ShadedTriangle::tangents_local`](crate::materials::ShadedTriangle) has
/// those of one triangle.
#[inline]
fn tangents(normals: &Vec3x8) -> [Vec3x8; 2] {
    let Vec3x8 { x, y, z } = *normals;
    let level = (x * x + y * y).sqrt();
    let is_level = z.simd_gt(0.8);
    // What looks straight down has no side that is up.
    let has_none = is_level | level.simd_lt(1e-6);
    let (right_x, right_y) = (y * -1.0 / level, x / level);
    let right =
        Vec3x8::new(has_none.select(F32x8::ONE, right_x), has_none.select(F32x8::ZERO, right_y), F32x8::ZERO);
    // The normal times what is to the right.
    let up = Vec3x8::new(z * right.y * -1.0, z * right.x, x * right.y - y * right.x);
    [right, Vec3x8::splat(Vec3::Y).or(is_level, up)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_lie_in_the_leaf_one_of_them_level() {
        let mut stream = random::Stream::new(3, 0, "leaves", 0);
        for _ in 0..500 {
            let mut unit = || stream.uniform(-1.0, 1.0) as f32;
            let normals: [Vec3; LANES] =
                std::array::from_fn(|_| Vec3::new(unit(), unit(), unit()).normalize_or(Vec3::X));
            let [right, up] = tangents(&Vec3x8::from_fn(|i| normals[i]));
            for (i, normal) in normals.into_iter().enumerate() {
                let (right, up) = (right.lane(i), up.lane(i));
                if normal.z > 0.8 {
                    assert_eq!([right, up], [Vec3::X, Vec3::Y]);
                    continue;
                }
                assert!(right.z == 0.0 && (right.length() - 1.0).abs() < 1e-4 && up.z > -1e-4, "{normal}");
                assert!((normal.cross(right) - up).length() < 1e-4 && right.dot(normal).abs() < 1e-4);
            }
        }
        let [right, up] = tangents(&Vec3x8::splat(-Vec3::Z));
        assert_eq!([right.lane(0), up.lane(0)], [Vec3::X, -Vec3::Y]);
    }
}
