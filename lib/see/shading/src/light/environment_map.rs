//! The surroundings of a place, as glossy things near it mirror them.
//!
//! Four coarse pictures to the sides of the world, from a little above the place. Whatever mirrors near by is
//! shown what the place sees in that direction: distances are left out of account.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use render::{
    PinholeCamera, RayBatch, RayQuery, RenderError, Scene, SurfaceTriangle, Surfaces, VisibilityBuffer,
};
use schema::geometry::Surface;
use simd::{F32x8, LANES, Vec3x8, floor_words};

use super::fog::Fog;
use super::lamps::Lamps;
use super::shadow::Shadows;
use super::sky::Sky;

/// Columns and rows of a picture.
const SIDE: usize = 48;
/// Highest and lowest slope that is seen.
const HIGHEST: f32 = 1.7;
const LOWEST: f32 = HIGHEST - 2.0;
/// Height over the place, metres: over the agent's roof.
const HEIGHT_M: f32 = 4.2;
const NEAREST_M: f32 = 0.5;
const FARTHEST_M: f32 = 400.0;
/// The ways that the pictures look.
const WAYS: [Vec3; 4] = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
/// Share of a house front that is dark windows, and what these send back.
const WINDOWS: f32 = 0.3;
const DARK: f32 = 0.05;

/// Red, green and blue (radiance) times how much of the sky is hidden, and that share.
type Texel = wide::f32x4;

/// What hides the sky around a place.
#[derive(Clone, Debug, Default)]
pub(crate) struct EnvironmentMap {
    /// Picture by picture, from the top.
    texels: Vec<Texel>,
}

/// The light on the surroundings.
#[derive(Clone, Copy)]
pub(super) struct LitSurroundings<'a> {
    pub(super) sky: &'a Sky,
    pub(super) shadows: &'a Shadows,
    pub(super) lamps: &'a Lamps,
    pub(super) fog: &'a Fog,
}

impl EnvironmentMap {
    /// Looks around a place of a scene's local frame.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn new(
        scene: &dyn Scene,
        light: LitSurroundings<'_>,
        centre: Vec3,
    ) -> Result<Self, RenderError> {
        let eye = centre + Vec3::Z * HEIGHT_M;
        let focal = 0.5 * SIDE as f32;
        let cameras = WAYS.map(|way| PinholeCamera {
            local_from_optical: Affine3A {
                matrix3: Mat3A::from_cols(way.cross(Vec3::Z).into(), Vec3A::NEG_Z, way.into()),
                translation: eye.into(),
            },
            width: SIDE as u32,
            height: SIDE as u32,
            fx: focal,
            fy: focal,
            cx: focal,
            cy: HIGHEST * focal,
            near_m: NEAREST_M,
            far_m: FARTHEST_M,
        });
        let mut texels = vec![Texel::ZERO; WAYS.len() * SIDE * SIDE];
        let pictures = looked(scene, &cameras)?;
        for (buffer, texels) in pictures.iter().zip(texels.chunks_exact_mut(SIDE * SIDE)) {
            let surfaces = Surfaces::new(buffer, scene.snapshot());
            for (y, row) in texels.chunks_exact_mut(SIDE).enumerate() {
                surfaces.for_each_span(y as u32, |columns, facet| {
                    let Some(facet) = facet else { return };
                    for first in columns.clone().step_by(LANES) {
                        let last = columns.end.min(first + LANES as u32) - 1;
                        let places: [u32; LANES] = std::array::from_fn(|i| (first + i as u32).min(last));
                        let radiance = light.radiance(buffer, facet, &places, y as u32);
                        for (i, column) in (first..=last).enumerate() {
                            let [red, green, blue] = radiance.lane(i).to_array();
                            row[column as usize] = Texel::new([red, green, blue, 1.0]);
                        }
                    }
                });
            }
        }
        Ok(Self { texels })
    }

    /// Radiance from directions (world axes) in which the sky would have such a one.
    #[inline]
    pub(crate) fn before(&self, sky: &Vec3x8, directions: &Vec3x8) -> Vec3x8 {
        let Vec3x8 { x, y, z } = *directions;
        let along_x = x.abs().simd_ge(y.abs());
        let ahead = along_x.select(x, y);
        let forward = ahead.simd_ge(0.0);
        let depth = ahead.abs().fast_max(F32x8::splat(1e-6));
        let slope = z / depth;
        let is_seen = slope.simd_lt(HIGHEST) & slope.simd_gt(LOWEST);
        if is_seen.none() {
            return *sky;
        }
        // Right of the view along x is -y, right of the view along y is x.
        let aside = along_x.select(y * -1.0, x);
        let right = forward.select(aside, aside * -1.0) / depth;
        let scale = 0.5 * SIDE as f32;
        let place = |v: F32x8| (v * scale - 0.5).fast_clamp(F32x8::ZERO, F32x8::splat(SIDE as f32 - 1.001));
        let (column, row) = (place(right + 1.0), place(HIGHEST - slope));
        let (column0, row0) = (column.floor(), row.floor());
        let picture =
            along_x.select(F32x8::ZERO, F32x8::ONE) + forward.select(F32x8::ZERO, F32x8::splat(2.0));
        let index = (floor_words(picture) * (SIDE * SIDE) as u32
            + floor_words(row0) * SIDE as u32
            + floor_words(column0))
        .to_array();
        let (fx, fy) = ((column - column0).to_array(), (row - row0).to_array());
        let seen = is_seen.to_bitmask();
        Vec3x8::from_fn(|i| {
            if seen >> i & 1 == 0 {
                return sky.lane(i);
            }
            let at = |k: usize| self.texels.get(index[i] as usize + k).copied().unwrap_or(Texel::ZERO);
            let mix = |a: Texel, b: Texel, share: f32| a + (b - a) * share;
            let [red, green, blue, hidden] =
                mix(mix(at(0), at(1), fx[i]), mix(at(SIDE), at(SIDE + 1), fx[i]), fy[i]).to_array();
            sky.lane(i) * (1.0 - hidden) + Vec3::new(red, green, blue)
        })
    }
}

impl LitSurroundings<'_> {
    /// Radiance of what eight pixels of a row show, in plain colours.
    fn radiance(
        &self,
        buffer: &VisibilityBuffer,
        facet: &SurfaceTriangle<'_, '_>,
        columns: &[u32; LANES],
        y: u32,
    ) -> Vec3x8 {
        let (sky, normal) = (self.sky, facet.normal_local);
        let places = facet.points(buffer, columns, y).position_local;
        let [level, along_x, along_y, along_z] = sky.ambient;
        let ambient =
            level + along_x * normal.x + along_y * normal.y + along_z * normal.z + sky.bounced_klx();
        let facing = normal.dot(sky.key_direction).max(0.0);
        let mut klx = Vec3x8::splat(ambient.max(Vec3::ZERO));
        if facing > 0.0 {
            klx += Vec3x8::splat(sky.key_klx * facing) * self.shadows.lit(&places, normal).share;
        }
        if !self.lamps.is_empty() {
            klx += self.lamps.illuminance(&places, &Vec3x8::splat(normal));
        }
        let out = klx * Vec3x8::splat(albedo(facet) / std::f32::consts::PI);
        let eye = Vec3::from(buffer.camera.local_from_optical.translation);
        let away_m = (places - Vec3x8::splat(eye)).length_squared().sqrt();
        Vec3x8::splat(self.fog.rgb).lerp(out, self.fog.passes(eye.z, places.z, away_m))
    }
}

/// What the cameras see, by a ray for each pixel: so few of them cost less than the triangles of all that is
/// around.
fn looked(scene: &dyn Scene, cameras: &[PinholeCamera]) -> Result<Vec<VisibilityBuffer>, RenderError> {
    let pixels = in_blocks();
    let seen_from = |camera: &PinholeCamera| -> Vec<Vec3> {
        let look = |&(x, y): &(u32, u32)| camera.direction_optical(x as f32 + 0.5, y as f32 + 0.5);
        pixels.iter().map(|at| camera.local_from_optical.transform_vector3(look(at)).normalize()).collect()
    };
    let directions: Vec<Vec<Vec3>> = cameras.iter().map(seen_from).collect();
    let query = |(camera, directions): (&PinholeCamera, _)| {
        RayQuery::of(RayBatch {
            origin: camera.local_from_optical.translation.into(),
            directions,
            range_m: [camera.near_m, camera.far_m],
            nearest_m: &[],
        })
    };
    let queries: Vec<RayQuery<'_>> =
        cameras.iter().zip(directions.iter().map(Vec::as_slice)).map(query).collect();
    let mut buffers: Vec<VisibilityBuffer> = cameras.iter().map(VisibilityBuffer::empty).collect();
    for (buffer, (hits, directions)) in buffers.iter_mut().zip(scene.trace(&queries)?.iter().zip(&directions))
    {
        let ahead = Vec3::from(buffer.camera.local_from_optical.matrix3.z_axis);
        for ((hit, direction), &(x, y)) in hits.iter().zip(directions).zip(&pixels) {
            let Some(hit) = hit else { continue };
            let at = buffer.index(x, y);
            (buffer.instance[at], buffer.triangle[at]) = (hit.instance, hit.triangle);
            buffer.depth_m[at] = hit.t * direction.dot(ahead);
        }
    }
    Ok(buffers)
}

/// The pixels of a picture, neighbours together: rays are the faster for it.
fn in_blocks() -> Vec<(u32, u32)> {
    const BLOCK: usize = 4;
    let corners = (0..SIDE).step_by(BLOCK).flat_map(|y| (0..SIDE).step_by(BLOCK).map(move |x| (x, y)));
    let block = |(x, y)| (0..BLOCK * BLOCK).map(move |i| (x + i % BLOCK, y + i / BLOCK));
    corners.flat_map(block).map(|(x, y)| (x as u32, y as u32)).collect()
}

/// The mean colour of what a triangle is of.
fn albedo(facet: &SurfaceTriangle<'_, '_>) -> Vec3 {
    let rgb = Vec3::from_array(facet.part.rgb);
    match facet.part.surface {
        Surface::Paint => Vec3::from_array(facet.placed().paint),
        Surface::Glass | Surface::Window => Vec3::splat(DARK),
        Surface::Facade(_) => rgb.lerp(Vec3::splat(DARK), WINDOWS),
        _ => rgb,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use frames::LocalOrigin;
    use render::Renderer;
    use render::cpu::CpuRenderer;
    use schema::Tag;
    use schema::geometry::{Instance, MeshPart, Snapshot, TriMesh};
    use schema::tables::Weather;

    use super::super::lighting::Lighting;
    use super::*;

    /// A wall 20 m along x, as wide, and 14.2 m high; red.
    fn wall() -> Snapshot {
        let corner = |y: f32, z: f32| Vec3::new(20.0, y, z);
        let mesh = TriMesh {
            positions: vec![corner(-20.0, -5.0), corner(20.0, -5.0), corner(20.0, 14.2), corner(-20.0, 14.2)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_part: vec![0, 0],
            parts: vec![MeshPart { tag: Tag::Building, surface: Surface::Plain, rgb: [0.5, 0.0, 0.0] }],
            ..TriMesh::default()
        };
        let instance = Instance {
            mesh: 0,
            object: 1,
            local_from_object: Affine3A::IDENTITY,
            previous_local_from_object: Affine3A::IDENTITY,
            paint: [0.5; 3],
            lights: 0,
            glow: [0.0; 3],
        };
        Snapshot {
            origin: LocalOrigin::near([0.0; 3]),
            meshes: vec![Arc::new(mesh)].into(),
            instances: vec![instance],
            cabins: Vec::new(),
            motions: Vec::new(),
        }
    }

    #[test]
    fn walls_hide_the_sky_as_far_as_they_reach() {
        let snapshot = wall();
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(&snapshot).expect("all meshes are prepared");
        let weather = Weather { cloudiness: 100.0, fog_density: 0.0, ..Weather::default() };
        let light = Lighting::new(&*scene, Arc::new(Sky::new(&weather, 0.0)), &weather, Vec3::ZERO)
            .expect("has no device");
        // Light of the sky on a wall that looks along -x; clear air takes next to nothing of it.
        let [level, along_x, ..] = light.sky.ambient;
        let klx = level - along_x + light.sky.bounced_klx();
        let facing = light.sky.key_klx.x * (-light.sky.key_direction.x).max(0.0);
        let want = (klx.x + facing) * 0.5 / std::f32::consts::PI;
        let sky = Vec3::new(0.0, 0.0, 7.0);
        let seen = |way: Vec3| {
            light.environment_map.before(&Vec3x8::splat(sky), &Vec3x8::splat(way.normalize())).lane(3)
        };
        // The wall's upper edge is 10 m over the place that looks: a slope of 0.5, and it ends at 45 degrees
        // to both sides.
        for way in [Vec3::X, Vec3::new(1.0, 0.6, 0.3), Vec3::new(1.0, -0.9, 0.4), Vec3::new(1.0, 0.9, -0.2)] {
            let got = seen(way);
            assert!(
                (got.x - want).abs() < 0.03 * want && got.y < 0.02 && got.z < 0.02,
                "{way}: {got} {want}"
            );
        }
        for way in [
            Vec3::new(1.0, 0.0, 0.6),
            Vec3::new(1.0, 0.5, 3.0),
            Vec3::new(0.8, 1.0, 0.1),
            Vec3::new(0.8, -1.0, 0.1),
            Vec3::NEG_X,
            Vec3::NEG_Z,
        ] {
            assert_eq!(seen(way), sky, "{way}");
        }
        // The upper edge is between the middles of two rows.
        let [low, high] = [0.46, 0.54].map(|slope| seen(Vec3::new(1.0, 0.1, slope)).x);
        assert!(high == 0.0 && low > 0.9 * want, "{low} {high} {want}");
    }
}
