//! Shadows of the sun or moon, and the shade under things, from maps of what the light sees.
//!
//! A light far away sees the same triangles as the cameras, through the same renderer with a very long lens. A place is in shadow when the light saw something nearer there.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayon::prelude::*;
use renderer::{PinholeCamera, RenderError, Scene, VisibilityBuffer};

/// Distance of the stand-in for the sun, metres: far enough that its rays are within a degree of parallel, near
/// enough that depths keep a millimetre in `f32`.
const LIGHT_M: f32 = 10_000.0;
/// Heights around the place that cast and receive shadows, metres.
const REACH_M: f32 = 900.0;
/// Half widths of the maps, metres, and their sides, texels: fine near by, coarse far away.
const MAPS: [(f32, u32); 3] = [(12.0, 768), (45.0, 1024), (160.0, 768)];
/// Half width and side of the map from above.
const ABOVE: (f32, u32) = (56.0, 448);
/// Texels a side of the blocks whose depths are summed up, and how far around a block its readers reach.
const BLOCK: usize = 8;
const AROUND: usize = 3;
/// Where nothing around is higher than this above a place, all of it is lit; where everything is higher than the
/// other, none is. Metres.
const LEVEL_M: f32 = 0.06;
const COVER_M: f32 = 0.5;
/// Lowest light that casts shadows: the sine of 2 degrees.
const LOWEST_UP: f32 = 0.035;

/// How a light looks at a place.
#[derive(Clone, Copy, Debug)]
struct Lens {
    right: Vec3,
    down: Vec3,
    forward: Vec3,
    texel_m: f32,
    camera: PinholeCamera,
}

impl Lens {
    fn new(world_m: [f64; 3], to_light: Vec3, centre: Vec3, half_m: f32, side: u32) -> Self {
        let forward = -to_light;
        let right = forward.cross(if forward.z.abs() < 0.99 { Vec3::Z } else { Vec3::Y }).normalize();
        let down = forward.cross(right);
        let texel_m = 2.0 * half_m / side as f32;
        // Whole texels from the world's origin, so that edges of shadows do not swim when the agent moves.
        let snap = |axis: Vec3| {
            let along = axis.as_dvec3().dot(glam::DVec3::from_array(world_m) + centre.as_dvec3());
            let texel = f64::from(texel_m);
            axis * ((along / texel).round() * texel - along) as f32
        };
        let centre = centre + snap(right) + snap(down);
        let local_from_optical = Affine3A {
            matrix3: Mat3A::from_cols(right.into(), down.into(), forward.into()),
            translation: Vec3A::from(centre - forward * LIGHT_M),
        };
        let half = 0.5 * side as f32;
        let focal = half * LIGHT_M / half_m;
        let camera = PinholeCamera {
            local_from_optical,
            width: side,
            height: side,
            fx: focal,
            fy: focal,
            cx: half,
            cy: half,
            near_m: LIGHT_M - REACH_M,
            far_m: LIGHT_M + REACH_M,
        };
        Self { right, down, forward, texel_m, camera }
    }
}

/// What the light sees through one lens.
#[derive(Clone, Debug)]
struct Map {
    /// Rows of the rotation from local to light axes, scaled to texels across and metres along.
    right: Vec3,
    down: Vec3,
    forward: Vec3,
    origin: Vec3,
    focal: f32,
    half: f32,
    side: usize,
    texel_m: f32,
    depth_m: Vec<f32>,
    /// Least and greatest height of what the light sees in and around each block: most of the ground is wholly lit
    /// or wholly in shadow, and one look here tells.
    blocks: Vec<[f32; 2]>,
}

impl Map {
    /// Works out `blocks`.
    fn sum_up(&self) -> Vec<[f32; 2]> {
        let per_side = self.side.div_ceil(BLOCK);
        let span = |block: usize| {
            (block * BLOCK).saturating_sub(AROUND)..((block + 1) * BLOCK + AROUND).min(self.side)
        };
        let empty = [f32::INFINITY, f32::NEG_INFINITY];
        let join = |a: [f32; 2], b: [f32; 2]| {
            [if b[0] < a[0] { b[0] } else { a[0] }, if b[1] > a[1] { b[1] } else { a[1] }]
        };
        // Columns first, row by row; then rows.
        let across: Vec<[f32; 2]> = self
            .depth_m
            .par_chunks(self.side)
            .enumerate()
            .flat_map_iter(|(y, row)| {
                let slope = self.forward.z + self.down.z * (y as f32 + 0.5 - self.half) / self.focal;
                let per_column = self.right.z / self.focal;
                (0..per_side).map(move |block| {
                    span(block).fold(empty, |all, x| {
                        let height =
                            self.origin.z + row[x] * (slope + per_column * (x as f32 + 0.5 - self.half));
                        join(all, [height, height])
                    })
                })
            })
            .collect();
        (0..per_side * per_side)
            .map(|i| {
                span(i / per_side).fold(empty, |all, row| join(all, across[row * per_side + i % per_side]))
            })
            .collect()
    }

    /// Reads the map out of what was seen through its lens.
    fn new(lens: &Lens, seen: VisibilityBuffer) -> Self {
        let Lens { right, down, forward, texel_m, camera } = *lens;
        let mut map = Self {
            right,
            down,
            forward,
            origin: camera.local_from_optical.translation.into(),
            focal: camera.fx,
            half: camera.cx,
            side: camera.width as usize,
            texel_m,
            depth_m: seen.depth_m,
            blocks: Vec::new(),
        };
        map.blocks = map.sum_up();
        map
    }

    /// Column, row (texel centres at whole numbers) and depth of a place.
    #[inline]
    fn project(&self, p: Vec3) -> Vec3 {
        let d = p - self.origin;
        let z = self.forward.dot(d);
        let scale = self.focal / z;
        Vec3::new(self.right.dot(d) * scale + self.half - 0.5, self.down.dot(d) * scale + self.half - 0.5, z)
    }

    #[inline]
    fn holds(&self, q: Vec3) -> bool {
        let limit = (self.side - 2) as f32;
        q.x >= 2.0 && q.y >= 2.0 && q.x < limit && q.y < limit
    }

    #[inline]
    fn at(&self, column: usize, row: usize) -> f32 {
        self.depth_m.get(row * self.side + column).copied().unwrap_or(f32::INFINITY)
    }

    /// Least and greatest height around a texel.
    #[inline]
    fn block(&self, column: usize, row: usize) -> [f32; 2] {
        let index = row / BLOCK * self.side.div_ceil(BLOCK) + column / BLOCK;
        self.blocks.get(index).copied().unwrap_or([f32::NEG_INFINITY, f32::INFINITY])
    }

    /// Share of the texels around that see the place, each weighted by its overlap with a square two texels wide:
    /// edges of shadows are soft, as wide as three texels. `height` is that of the place.
    #[inline]
    fn lit(&self, q: Vec3, height: f32, bias_m: f32) -> Lit {
        let (x0, y0) = (q.x as usize, q.y as usize);
        let z = q.z - bias_m;
        let [least, greatest] = self.block(x0, y0);
        if greatest <= height + LEVEL_M || least > height + COVER_M {
            return Lit { share: f32::from(u8::from(greatest <= height + LEVEL_M)), all_around: true };
        }
        let first = (y0 - 1) * self.side + x0 - 1;
        let row = |r: usize| -> [f32; 4] {
            let start = first + r * self.side;
            let Some(&[a, b, c, d]) = self.depth_m.get(start..start + 4).and_then(|s| s.first_chunk()) else {
                return [1.0; 4];
            };
            let lit = |depth: f32| f32::from(u8::from(depth >= z));
            [lit(a), lit(b), lit(c), lit(d)]
        };
        let rows = [row(0), row(1), row(2), row(3)];
        let (fx, fy) = (q.x - x0 as f32, q.y - y0 as f32);
        let weigh = |v: [f32; 4], f: f32| (1.0 - f) * v[0] + v[1] + v[2] + f * v[3];
        // Each way the weights sum to 3.
        let [a, b, c, d] = rows;
        let share = weigh([weigh(a, fx), weigh(b, fx), weigh(c, fx), weigh(d, fx)], fy) * (1.0 / 9.0);
        Lit { share, all_around: false }
    }
}

/// How much of a light reaches a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lit {
    /// Share of the light's disc that is seen, 0 to 1.
    pub(crate) share: f32,
    /// Whether it is the same in the whole neighbourhood.
    pub(crate) all_around: bool,
}

/// Looks from the light (when its shadows are wanted) and from above at a place, all in one batch.
///
/// # Errors
/// The renderer failed.
pub(crate) fn shadows_at(
    scene: &dyn Scene,
    to_light: Vec3,
    wanted: bool,
    centre: Vec3,
) -> Result<(Shadows, Overhead), RenderError> {
    let world_m = scene.snapshot().origin.world_xyz();
    let raised = Vec3::new(to_light.x, to_light.y, to_light.z.max(LOWEST_UP)).normalize();
    let lens =
        |to_light: Vec3, (half_m, side): (f32, u32)| Lens::new(world_m, to_light, centre, half_m, side);
    let above = std::iter::once(lens(Vec3::Z, ABOVE));
    let lenses: Vec<Lens> =
        above.chain(MAPS.iter().filter(|_| wanted).map(|&size| lens(raised, size))).collect();
    let cameras: Vec<PinholeCamera> = lenses.iter().map(|lens| lens.camera).collect();
    let seen = scene.look(&cameras)?;
    let mut maps: Vec<Map> = lenses.par_iter().zip(seen).map(|(lens, seen)| Map::new(lens, seen)).collect();
    let above = maps.remove(0);
    Ok((Shadows { to_light: raised, maps }, Overhead { map: above }))
}

/// Shadows of the sun or moon around a place.
#[derive(Clone, Debug)]
pub(crate) struct Shadows {
    to_light: Vec3,
    maps: Vec<Map>,
}

impl Shadows {
    /// How much of the light reaches a surface; all of it beyond the maps.
    #[inline]
    pub(crate) fn lit(&self, position: Vec3, normal: Vec3) -> Lit {
        for map in &self.maps {
            // Off the surface by a texel, so that it does not shade itself; more where light grazes it.
            let facing = normal.dot(self.to_light).clamp(0.05, 1.0);
            let lift_m = map.texel_m * (1.0 + 1.5 * (1.0 - facing));
            let q = map.project(position + normal * lift_m);
            if map.holds(q) {
                return map.lit(q, position.z, 0.015 + 0.8 * map.texel_m);
            }
        }
        Lit { share: 1.0, all_around: true }
    }
}

/// How much of the sky is hidden by what is straight above and close: the shade under cars, trees and bridges.
#[derive(Clone, Debug)]
pub(crate) struct Overhead {
    map: Map,
}

impl Overhead {
    /// Share of the light of the sky that reaches a surface, 0 to 1; 1 beyond the map.
    #[inline]
    pub(crate) fn open(&self, position: Vec3, normal: Vec3) -> f32 {
        const SPREAD_M: f32 = 0.4;
        /// What is nearer above is the surface itself.
        const LEAST_ABOVE_M: f32 = 0.25;
        let map = &self.map;
        // Looked at from a little off the surface: a wall is not under its own roof.
        let q = map.project(position + normal * (1.5 * SPREAD_M));
        let spread = SPREAD_M / map.texel_m;
        if !map.holds(q - Vec3::new(spread, spread, 0.0)) || !map.holds(q + Vec3::new(spread, spread, 0.0)) {
            return 1.0;
        }
        let [_, highest] = map.block(q.x as usize, q.y as usize);
        if highest <= position.z + LEAST_ABOVE_M {
            return 1.0;
        }
        // A roof close above hides nearly everything; a bridge lets light in from the sides.
        let hides = |column, row| {
            let above_m = q.z - map.at(column, row);
            if above_m > LEAST_ABOVE_M { 1.0 / (1.0 + 0.12 * above_m) } else { 0.0 }
        };
        let mut hidden = 0.0;
        for (dx, dy) in [(-1.0, -0.4), (0.4, -1.0), (1.0, 0.4), (-0.4, 1.0)] {
            let (x, y) = (q.x + spread * dx, q.y + spread * dy);
            let (x0, y0) = (x as usize, y as usize);
            let (fx, fy) = (x - x0 as f32, y - y0 as f32);
            let mix = |a: f32, b: f32, f: f32| a + (b - a) * f;
            let upper = mix(hides(x0, y0), hides(x0 + 1, y0), fx);
            let lower = mix(hides(x0, y0 + 1), hides(x0 + 1, y0 + 1), fx);
            hidden += mix(upper, lower, fy);
        }
        1.0 - 0.2 * hidden
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use frames::LocalOrigin;
    use renderer::{RayBatch, Renderer};
    use schema::Tag;
    use schema::geometry::{Instance, Part, Snapshot, Surface, TriMesh};
    use visibility::CpuRenderer;

    use super::*;

    /// A level rectangle at a height.
    fn slab(half: Vec3, z: f32) -> Arc<TriMesh> {
        let corner = |x: f32, y: f32| Vec3::new(x * half.x, y * half.y, z);
        Arc::new(TriMesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_part: vec![0, 0],
            parts: vec![Part { tag: Tag::Road, surface: Surface::Plain, rgb: [0.5; 3] }],
        })
    }

    fn scene_of(origin: [f64; 3]) -> Snapshot {
        let place = |mesh, x, y| Instance {
            mesh,
            object: 1,
            local_from_object: Affine3A::from_translation(Vec3::new(x, y, 0.0)),
            previous_local_from_object: Affine3A::IDENTITY,
            paint: [0.5; 3],
            lights: 0,
            glow: [1.0; 3],
        };
        let ground = slab(Vec3::splat(200.0), 0.0);
        let roof = slab(Vec3::new(2.0, 1.0, 0.0), 1.5);
        let high = slab(Vec3::new(10.0, 6.0, 0.0), 20.0);
        Snapshot {
            origin: LocalOrigin::near(origin),
            meshes: vec![ground, roof, high].into(),
            instances: vec![
                place(0, 0.0, 0.0),
                place(1, 3.0, 2.0),
                place(1, -30.0, 8.0),
                place(2, 60.0, -40.0),
            ],
        }
    }

    /// Places a snapshot before a renderer and calls with the shadows around its origin.
    fn with_shadows(snapshot: &Snapshot, to_light: Vec3, each: impl FnOnce(&dyn Scene, &Shadows, &Overhead)) {
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(snapshot).expect("all meshes are prepared");
        let (shadows, overhead) = shadows_at(&*scene, to_light, true, Vec3::ZERO).expect("has no device");
        each(&*scene, &shadows, &overhead);
    }

    #[test]
    fn shadows_are_where_rays_to_the_light_are_stopped() {
        let to_light = Vec3::new(0.5, -0.3, 0.8).normalize();
        with_shadows(&scene_of([1234.0, -77.0, 12.0]), to_light, |scene, shadows, _| {
            let n = 120;
            let places: Vec<Vec3> = (0..n * n)
                .map(|i| Vec3::new((i % n) as f32 * 1.3 - 78.0, (i / n) as f32 * 1.3 - 78.0, 0.0))
                .collect();
            let directions = [to_light];
            let batch = |&origin| RayBatch {
                origin,
                directions: &directions,
                range_m: [1e-3, 500.0],
                nearest_m: &[],
            };
            let batches: Vec<_> = places.iter().map(batch).collect();
            let hits = scene.trace(&batches).expect("has no device");
            let (mut wrong, mut shaded) = (0, 0);
            for (p, hit) in places.iter().zip(hits) {
                let want = if hit.get(0).is_some() { 0.0 } else { 1.0 };
                let got = shadows.lit(*p, Vec3::Z).share;
                shaded += i32::from(want == 0.0);
                wrong += i32::from((got - want).abs() > 0.5);
            }
            assert!(shaded > 100, "{shaded}");
            // Texels of up to 0.4 m, and rays that are parallel to a degree: only edges may differ.
            assert!(wrong * 20 < shaded, "{wrong} of {shaded}");
        });
    }

    #[test]
    fn it_is_dark_under_a_low_roof_only() {
        with_shadows(&scene_of([0.0; 3]), Vec3::Z, |_, _, overhead| {
            assert!(overhead.open(Vec3::new(3.0, 2.0, 0.0), Vec3::Z) < 0.4);
            assert_eq!(overhead.open(Vec3::new(-8.0, 0.0, 0.0), Vec3::Z), 1.0);
            assert_eq!(overhead.open(Vec3::new(3.0, 2.0, 1.5), Vec3::Z), 1.0);
        });
    }
}
