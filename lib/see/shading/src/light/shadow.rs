//! Shadows of the sun or moon, and the shade under things, from maps of what the light sees.
//!
//! A light far away sees the same triangles as the cameras, through the same renderer with a very long lens.
//! A place is in shadow when the light saw something nearer there.

use std::borrow::Cow;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use render::{PinholeCamera, RenderError, Scene};
use simd::{F32x8, LANES, Vec3x8, floor_words, lerp};

use super::lens::{ABOVE, BLOCK, Lens, MAPS, Window, depths};
use super::map::{AROUND, Lit, Map, Standing, Still};
use super::still::StillMaps;

/// Lowest light that casts shadows: the sine of 2 degrees.
const LOWEST_UP: f32 = 0.035;

/// Nobody asks a map what a finer one tells. What lies wholly within a finer map is left out of it, if it
/// lies at least so far from that map's edge (beside what readers reach around), metres: directions of two
/// maps differ by 0.014, and shadows of what is 5 m high, and nothing that moves is higher, are 143 m long.
const ASLANT_M: f32 = 2.0;

/// A light that casts shadows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Caster {
    pub(crate) to_light: Vec3,
    /// Whether it stands still enough that maps made for its direction will serve other frames.
    pub(crate) is_steady: bool,
}

/// Looks from the light (when there is one whose shadows are wanted) and from above at a place: at
/// moving objects where there are maps of static ones, at all objects elsewhere.
///
/// # Errors
/// The renderer failed.
pub(crate) fn shadows_at(
    scene: &dyn Scene,
    still: Option<&StillMaps<'_>>,
    caster: Option<Caster>,
    centre: Vec3,
) -> Result<(Shadows, SkyOcclusionMap), RenderError> {
    let origin = scene.snapshot().origin;
    let place_m = DVec3::from_array(origin.world_xyz()) + centre.as_dvec3();
    // The view from above serves all frames.
    let mut lenses = vec![(Lens::at(place_m, Vec3::Z, &ABOVE), true)];
    if let Some(Caster { to_light, is_steady }) = caster {
        let raised = Vec3::new(to_light.x, to_light.y, to_light.z.max(LOWEST_UP)).normalize();
        lenses.extend(MAPS.iter().map(|size| {
            let to_light = if is_steady { size.rounded(raised) } else { raised };
            (Lens::at(place_m, to_light, size), is_steady)
        }));
    }
    // How far, in texels of the next finer map, something has to be within that for this one to do without
    // it; the first map is the one from above.
    let inner_px = |i: usize| {
        let (lens, finer) = (&lenses[i].0.0, &lenses[i.checked_sub(1)?].0.0);
        (i > 1).then(|| (AROUND as f32 * lens.texel_m + ASLANT_M) / finer.texel_m)
    };
    let standing = match still {
        Some(still) => standing(still, &lenses, inner_px)?,
        None => Vec::new(),
    };
    let casters: Vec<u32> = match still {
        Some(still) => still.moving(scene.snapshot()),
        None => (0..scene.snapshot().instances.len() as u32).collect(),
    };
    let cameras: Vec<PinholeCamera> =
        lenses.iter().map(|((lens, window), _)| lens.camera(&origin, *window)).collect();
    let casters = |i: usize| match inner_px(i) {
        None => Cow::Borrowed(&casters[..]),
        Some(inner_px) => Cow::Owned(scene.beyond(&cameras[i - 1], inner_px, &casters)),
    };
    let casters: Vec<Cow<'_, [u32]>> = (0..lenses.len()).into_par_iter().map(casters).collect();
    let asked = lenses.iter().zip(&cameras).zip(&casters);
    let asked = asked.map(|((((lens, _), _), camera), casters)| (camera, Some(&casters[..]), lens.panes()));
    let seen = depths(scene, asked)?;
    let map = |(i, depth_m): (usize, Vec<f32>)| {
        let (lens, window) = &lenses[i].0;
        Map::new(lens, *window, &cameras[i], depth_m, standing.get(i))
    };
    let mut maps: Vec<Map> = seen.into_par_iter().enumerate().map(map).collect();
    let above = maps.remove(0);
    let to_light = lenses.get(1).map_or(Vec3::Z, |((lens, _), _)| -lens.forward);
    Ok((Shadows { to_light, maps }, SkyOcclusionMap { map: above }))
}

/// What stands still in the maps of some lenses, each of which is kept or not, and from which column and
/// row on it is that of the lens's window.
fn standing(
    still: &StillMaps<'_>,
    lenses: &[((Lens, Window), bool)],
    inner_px: impl Fn(usize) -> Option<f32> + Sync,
) -> Result<Vec<Standing>, RenderError> {
    let kept: Vec<Lens> = lenses.iter().filter(|(_, kept)| *kept).map(|((lens, _), _)| *lens).collect();
    let mut kept = still.of(&kept)?.into_iter();
    let made = lenses.par_iter().enumerate().map(|(i, ((lens, window), is_kept))| {
        let finer = inner_px(i).map(|inner_px| (&lenses[i - 1].0.0, lenses[i - 1].0.1, inner_px));
        (!is_kept).then(|| still.once((lens, *window), finer)).transpose()
    });
    let made: Vec<Option<Still>> = made.collect::<Result<_, _>>()?;
    let of = |(made, ((_, window), _)): (Option<Still>, &((Lens, Window), bool))| match made {
        Some(map) => Some(Standing { map: Arc::new(map), corner: [0, 0] }),
        None => Some(Standing { map: kept.next()?, corner: window.corner }),
    };
    Ok(made.into_iter().zip(lenses).filter_map(of).collect())
}

/// Shadows of the sun or moon around a place.
#[derive(Clone, Debug)]
pub(crate) struct Shadows {
    to_light: Vec3,
    maps: Vec<Map>,
}

impl Shadows {
    /// How much of the light reaches places of one surface; all of it beyond the maps.
    #[inline]
    pub(crate) fn lit(&self, positions: &Vec3x8, normal: Vec3) -> Lit {
        // Off the surface by a texel, so that it does not shade itself; more where light grazes it.
        let facing = normal.dot(self.to_light).clamp(0.05, 1.0);
        let lift = 1.0 + 1.5 * (1.0 - facing);
        let mut lit = Lit { share: F32x8::ONE, all_around: u32::from(u8::MAX), block: [u32::MAX; LANES] };
        let mut left = F32x8::ZERO.simd_eq(0.0);
        for (level, map) in self.maps.iter().enumerate() {
            let q = map.project(*positions + Vec3x8::splat(normal * (map.texel_m * lift)));
            let here = left & map.holds(&q, 0.0);
            if here.none() {
                continue;
            }
            let found = map.lit(here, &q, positions.z, 0.015 + 0.8 * map.texel_m);
            let share = if level + 1 == self.maps.len() {
                // Shadows end with the last map: softly.
                1.0 - (1.0 - found.share) * map.within(&q)
            } else {
                found.share
            };
            lit.share = here.select(share, lit.share);
            let bits = here.to_bitmask();
            lit.all_around = (lit.all_around & !bits) | (found.all_around & bits);
            for (i, (to, of)) in lit.block.iter_mut().zip(found.block).enumerate() {
                if bits >> i & 1 != 0 {
                    *to = of * 4 + level as u32;
                }
            }
            left &= !here;
            if left.none() {
                break;
            }
        }
        lit
    }

    /// Whether what lies between two places is in their neighbourhoods, by the blocks that [`Lit`] tells.
    #[inline]
    pub(crate) fn adjoin(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        let Some(map) = self.maps.get((a & 3) as usize) else { return false };
        if a & 3 != b & 3 {
            return false;
        }
        let per_side = map.side.div_ceil(BLOCK) as u32;
        let (a, b) = (a >> 2, b >> 2);
        (a % per_side).abs_diff(b % per_side) <= 1 && (a / per_side).abs_diff(b / per_side) <= 1
    }
}

/// How much of the sky is hidden by what is straight above and close: the shade under cars, trees and
/// bridges.
#[derive(Clone, Debug)]
pub(crate) struct SkyOcclusionMap {
    map: Map,
}

impl SkyOcclusionMap {
    /// Share of the light of the sky that reaches places of surfaces that look along the normals, 0 to 1; 1
    /// beyond the map.
    #[inline]
    pub(crate) fn open(&self, positions: &Vec3x8, normals: &Vec3x8) -> F32x8 {
        let map = &self.map;
        // Looked at from a little off the surface: a wall is not under its own roof.
        let q = map.project(*positions + *normals * F32x8::splat(1.5 * SPREAD_M));
        let spread = SPREAD_M / map.texel_m;
        let here = map.holds(&q, spread);
        if here.none() {
            return F32x8::ONE;
        }
        let q = q.or(here, Vec3x8::splat(Vec3::splat(2.0 + spread)));
        let ([_, highest], _) = map.block(&q);
        let covered = here & highest.simd_gt(positions.z + LEAST_ABOVE_M);
        if covered.none() {
            return F32x8::ONE;
        }
        let mut hidden = F32x8::ZERO;
        for (dx, dy) in [(-1.0, -0.4), (0.4, -1.0), (1.0, 0.4), (-0.4, 1.0)] {
            let (x, y) = (q.x + spread * dx, q.y + spread * dy);
            let (x0, y0) = (x.floor(), y.floor());
            let (columns, rows) = (floor_words(x0).to_array(), floor_words(y0).to_array());
            let texel = |right: usize, down: usize| -> F32x8 {
                let depth: [f32; LANES] =
                    std::array::from_fn(|i| map.at(columns[i] as usize + right, rows[i] as usize + down));
                hides(q.z - F32x8::from(depth))
            };
            let (fx, fy) = (x - x0, y - y0);
            let upper = lerp(texel(0, 0), texel(1, 0), fx);
            let lower = lerp(texel(0, 1), texel(1, 1), fx);
            hidden += lerp(upper, lower, fy);
        }
        covered.select(1.0 - hidden * 0.2, F32x8::ONE)
    }
}

/// Where the sky is looked for around a place, metres.
const SPREAD_M: f32 = 0.4;
/// What is nearer above is the surface itself.
const LEAST_ABOVE_M: f32 = 0.25;

/// How much of the sky something so far above hides: a roof close above nearly everything; a bridge lets
/// light in from the sides.
#[inline]
fn hides(above_m: F32x8) -> F32x8 {
    above_m.simd_gt(LEAST_ABOVE_M).select(1.0 / (above_m * 0.12 + 1.0), F32x8::ZERO)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use frames::LocalOrigin;
    use glam::Affine3A;
    use render::cpu::CpuRenderer;
    use render::{CameraQuery, Hits, RayBatch, RayQuery, Renderer, VisibilityBuffer};
    use schema::Tag;
    use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};

    use super::super::still::StillWorld;
    use super::*;

    /// A level rectangle at a height.
    fn slab(half: Vec3, z: f32) -> Arc<TriMesh> {
        let corner = |x: f32, y: f32| Vec3::new(x * half.x, y * half.y, z);
        Arc::new(TriMesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_part: vec![0, 0],
            parts: vec![MeshPart { tag: Tag::Road, surface: Surface::Plain, rgb: [0.5; 3] }],
            ..TriMesh::default()
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
            cabins: Vec::new(),
            motions: Vec::new(),
        }
    }

    /// Places a snapshot before a renderer and calls with the shadows around its origin.
    fn with_shadows(
        snapshot: &Snapshot,
        to_light: Vec3,
        each: impl FnOnce(&dyn Scene, &Shadows, &SkyOcclusionMap),
    ) {
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(snapshot).expect("all meshes are prepared");
        let (shadows, overhead) =
            shadows_at(&*scene, None, Some(Caster { to_light, is_steady: false }), Vec3::ZERO)
                .expect("has no device");
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
            let query = |&origin| {
                RayQuery::of(RayBatch {
                    origin,
                    directions: &directions,
                    range_m: [1e-3, 500.0],
                    nearest_m: &[],
                })
            };
            let queries: Vec<_> = places.iter().map(query).collect();
            let hits = scene.trace(&queries).expect("has no device");
            let (mut wrong, mut shaded) = (0, 0);
            for (p, hit) in places.iter().zip(hits) {
                let want = if hit.get(0).is_some() { 0.0 } else { 1.0 };
                let got = shadows.lit(&Vec3x8::splat(*p), Vec3::Z).share.to_array()[2];
                shaded += i32::from(want == 0.0);
                wrong += i32::from((got - want).abs() > 0.5);
            }
            assert!(shaded > 100, "{shaded}");
            // Texels of up to 0.4 m, and rays that are parallel to a degree: only edges may differ.
            assert!(wrong * 20 < shaded, "{wrong} of {shaded}");
        });
    }

    #[test]
    fn shadows_end_softly() {
        // Under a roof without an end, 150 m up.
        let mut snapshot = scene_of([0.0; 3]);
        snapshot.meshes = vec![slab(Vec3::splat(900.0), 0.0), slab(Vec3::splat(900.0), 150.0)].into();
        snapshot.instances.truncate(2);
        snapshot.instances[1].local_from_object = Affine3A::IDENTITY;
        with_shadows(&snapshot, Vec3::new(0.3, 0.0, 1.0).normalize(), |_, shadows, _| {
            let at =
                |x: f32| shadows.lit(&Vec3x8::splat(Vec3::new(x, 3.0, 0.0)), Vec3::Z).share.to_array()[1];
            for x in [0.0, 30.0, 80.0, -110.0] {
                assert!(at(x) < 1e-3, "{x}: {}", at(x));
            }
            let shares: Vec<f32> = (120..190).map(|x| at(x as f32)).collect();
            assert!(shares.is_sorted() && shares[69] == 1.0, "{shares:?}");
            assert!(shares.windows(2).all(|pair| pair[1] - pair[0] < 0.1), "{shares:?}");
        });
    }

    /// A scene that cannot tell what is wholly within a picture.
    struct Untold<'a>(&'a dyn Scene);

    impl Scene for Untold<'_> {
        fn snapshot(&self) -> &Snapshot {
            self.0.snapshot()
        }
        fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
            self.0.render(queries)
        }
        fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
            self.0.trace(queries)
        }
    }

    /// A world of the ground alone, object 0.
    struct BareGround;

    impl StillWorld for BareGround {
        fn around(&self, centre_world_m: [f64; 3], _: f64, _: f64) -> Snapshot {
            let mut ground = scene_of(centre_world_m);
            ground.instances.truncate(1);
            ground
        }
        fn moves(&self, object: schema::ObjectId) -> bool {
            object > 0
        }
    }

    #[test]
    fn what_moves_within_a_finer_map_need_not_be_in_a_coarser_one() {
        // A swarm around the place: within each map, across its edges, beyond it.
        let mut snapshot = scene_of([40.0, 8.0, 0.0]);
        let roof = snapshot.instances[1];
        snapshot.instances.truncate(1);
        snapshot.instances[0].object = 0;
        for i in 0..400u16 {
            let (sin, cos) = frames::math::f32::sin_cos(2.4 * f32::from(i));
            let away_m = 0.4 * f32::from(i);
            let at = Vec3::new(away_m * cos, away_m * sin, 1.0);
            snapshot.instances.push(Instance { local_from_object: Affine3A::from_translation(at), ..roof });
        }
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let still = StillMaps::new(&renderer, &BareGround);
        let scene = renderer.place(&snapshot).expect("all meshes are prepared");
        for (to_light, is_steady) in [
            (Vec3::new(0.5, -0.3, 0.6), true),
            (Vec3::new(-0.9, 0.4, 0.05), true),
            (Vec3::new(0.1, 0.2, 0.9), false),
        ] {
            let caster = Some(Caster { to_light: to_light.normalize(), is_steady });
            let [some, all] = [&*scene, &Untold(&*scene) as &dyn Scene]
                .map(|scene| shadows_at(scene, Some(&still), caster, Vec3::ZERO).expect("has no device").0);
            assert!(some.maps[2].depth_m != all.maps[2].depth_m, "nothing was left out");
            let mut shaded = 0;
            for i in 0..40_000u16 {
                let place = Vec3::new(f32::from(i % 200) - 100.0, f32::from(i / 200) - 100.0, 0.0);
                let [some, all] =
                    [&some, &all].map(|maps| maps.lit(&Vec3x8::splat(place), Vec3::Z).share.to_array()[0]);
                assert_eq!(some, all, "{place} {to_light}");
                shaded += i32::from(all < 0.5);
            }
            assert!(shaded > 500, "{shaded}");
        }
    }

    #[test]
    fn it_is_dark_under_a_low_roof_only() {
        with_shadows(&scene_of([0.0; 3]), Vec3::Z, |_, _, overhead| {
            let open = |p: Vec3| overhead.open(&Vec3x8::splat(p), &Vec3x8::splat(Vec3::Z)).to_array()[6];
            assert!(open(Vec3::new(3.0, 2.0, 0.0)) < 0.4);
            assert_eq!(open(Vec3::new(-8.0, 0.0, 0.0)), 1.0);
            assert_eq!(open(Vec3::new(3.0, 2.0, 1.5)), 1.0);
        });
    }
}
