//! The colour picture: light times surface, span by span.

use glam::Vec3;
use rayon::prelude::*;
use render::{Bend, RenderError, SKY, SurfacePoints, SurfaceTriangle, Surfaces, VisibilityBuffer};
use simd::{F32x8, LANES, STEPS, Vec3x8, exp_neg, smoothstep};

use super::bloom::gather;
use super::leaves::{LeafPixels, WholeRow};
use super::mirror::{Mirror, WetSpan};
use super::shader::Shader;
use crate::light::{CornerGradient, Facing, Lit};
use crate::materials::{Points, ShadedTriangle, Specular, gets_wet, is_leaf, sample};
use render::panes::{PASSES, PaneRays, Panes, TransmittedHit};

/// What wet ground mirrors at eight pixels, and whether that is known.
#[inline]
fn mirrored(
    mirror: &Mirror,
    pixels: (&[u32; LANES], u32),
    specular: &Specular,
    lean: Option<[F32x8; 2]>,
    toward: &Vec3x8,
) -> (Vec3x8, F32x8) {
    // The axes of the texture of all ground are those of the world.
    let [east, north] = lean.unwrap_or_default();
    let level = (toward.x * toward.x + toward.y * toward.y).sqrt().fast_max(F32x8::splat(1e-3));
    let away = (east * toward.x + north * toward.y) * -1.0 / level;
    let right = (north * toward.x - east * toward.y) / level;
    let rough = smoothstep(0.08, 0.24, specular.roughness);
    mirror.at(pixels, [away, right], toward.z, rough)
}

/// A row of the picture.
pub(super) struct Row<'p> {
    pub(super) y: u32,
    pub(super) rgb: &'p mut [u8],
    /// What is brighter than white in its blocks.
    pub(super) bright: &'p mut [Vec3],
}

/// What is behind the pixels of a picture that show panes, row by row, from left to right.
#[derive(Debug, Default)]
pub(super) struct BehindPanes {
    found: Vec<TransmittedHit>,
    /// By row, where those of it begin; and the end.
    starts: Vec<usize>,
}

impl BehindPanes {
    /// Of several pictures of a scene, asked for at once; nothing where there are no panes.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn of(
        panes: Option<&Panes<'_>>,
        pictures: &[&VisibilityBuffer],
    ) -> Result<Vec<Self>, RenderError> {
        let Some(panes) = panes else { return Ok(pictures.iter().map(|_| Self::default()).collect()) };
        let of_picture = |buffer: &&VisibilityBuffer| {
            let rows: Vec<PaneRays> =
                (0..buffer.height).into_par_iter().map(|y| pane_rays(panes, buffer, y)).collect();
            let (mut all, mut starts) = (pane_rays_of(buffer), vec![0]);
            for row in rows {
                all.append(row);
                starts.push(all.len());
            }
            (all, starts)
        };
        let (rays, starts): (Vec<_>, Vec<_>) = pictures.par_iter().map(of_picture).unzip();
        let found = panes.behind(rays)?;
        Ok(found.into_iter().zip(starts).map(|(found, starts)| Self { found, starts }).collect())
    }

    fn row(&self, y: u32) -> &[TransmittedHit] {
        let bounds = self.starts.get(y as usize).zip(self.starts.get(y as usize + 1));
        bounds.map_or(&[], |(start, end)| &self.found[*start..*end])
    }
}

/// Rays through a picture's pixels.
fn pane_rays_of(buffer: &VisibilityBuffer) -> PaneRays {
    PaneRays::new(buffer.camera.local_from_optical.translation.into(), 0.0, f32::INFINITY)
}

/// Rays through the pixels of a row that show panes.
fn pane_rays(panes: &Panes<'_>, buffer: &VisibilityBuffer, y: u32) -> PaneRays {
    let turn = glam::Mat3::from(buffer.camera.local_from_optical.matrix3);
    let mut rays = pane_rays_of(buffer);
    for x in 0..buffer.width {
        let at = buffer.index(x, y);
        if panes.is_pane(buffer.instance[at], buffer.triangle[at]) {
            let direction = turn * buffer.direction_optical(x, y);
            let length = direction.length();
            let distance_m = buffer.depth_m[at] * length;
            rays.push(direction / length, buffer.instance[at], buffer.triangle[at], distance_m);
        }
    }
    rays
}

/// Neighbours in a row that show one triangle, or the sky.
struct Span<'p> {
    first: u32,
    y: u32,
    pixels: &'p mut [[u8; 3]],
    /// What is brighter than white in the blocks of the row.
    bright: &'p mut [Vec3],
}

impl Span<'_> {
    /// Columns of eight of its pixels, `apart` from one another; none beyond the last.
    #[inline]
    fn columns(&self, from: usize, apart: usize) -> [u32; LANES] {
        let last = self.first + self.pixels.len() as u32 - 1;
        std::array::from_fn(|i| (self.first + (from + i * apart) as u32).min(last))
    }
}

/// What is the same for a triangle.
struct Run<'a> {
    facet: ShadedTriangle<'a>,
    /// How the normal runs where the triangle stands for a curved surface.
    bend: Option<Bend>,
    /// Whether any of it is turned to the sun.
    is_lit: bool,
    /// The light on its plane.
    turned: Turned,
    relief: Relief,
    /// What of sky and ground is seen past its own body; all of it without one.
    shelter: Option<CornerGradient>,
    /// How it is turned to what houses leave of the sky.
    facing: Facing,
    /// Whether it mirrors what is around it.
    gets_wet: bool,
}

/// How much more light falls on a surface whose normal leans.
struct Relief {
    /// Axes of its texture.
    tangents: [Vec3; 2],
    /// More of the cosine between normal and sun for each.
    facing: [f32; 2],
    /// More light of the whole sky for each.
    ambient: [Vec3; 2],
}

/// Light on surfaces by the way they are turned, as film value of a white surface.
#[derive(Clone, Copy)]
struct Turned {
    /// Cosine between normal and sun, 0 when turned away.
    facing: F32x8,
    /// Light of the whole sky.
    ambient: Vec3x8,
}

/// What decides the light at eight places, before the surface's colour; all but the sun's share is smooth
/// enough to be interpolated.
#[derive(Clone, Copy)]
struct Light {
    /// Share of the sun that is seen.
    sunlit: F32x8,
    /// Share of the sky that is seen past what is above.
    open: F32x8,
    /// Share of what is left that houses around leave.
    between_houses: F32x8,
    /// Film value of a white surface by lamps.
    lamps: Vec3x8,
    /// Share of light that passes the fog.
    passes: F32x8,
    /// Width of a pixel a metre away on surfaces as slanted as here, metres.
    footprint_at_1_m: F32x8,
}

/// Light at places of one span that stand [`LANES`] pixels apart.
struct Knots {
    light: Light,
    sun: Lit,
}

/// How far apart places are whose light is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Spread {
    /// Neighbours: houses leave all of them the same of the sky.
    Near,
    Far,
}

/// Shade from above may differ by this at the ends of an even stretch.
const ALIKE: f32 = 0.06;

/// Share of the light of the sky that reaches what is in a cabin, at least: its roof is close above, but
/// panes are all around.
const OPEN_IN_CABINS: f32 = 0.55;

impl<'a> Shader<'a> {
    /// Paints a row but for wet ground, which mirrors the rest: the spans that are left for it.
    pub(super) fn paint_dry(
        &self,
        surfaces: &Surfaces<'_>,
        (panes, behind): (Option<&Panes<'_>>, &BehindPanes),
        row: Row<'_>,
    ) -> Vec<WetSpan> {
        let Row { y, rgb, bright } = row;
        let pixels = rgb.as_chunks_mut::<3>().0;
        let is_wet = self.lighting.around.are_wet();
        let mut wet = Vec::new();
        let mut behind = behind.row(y);
        let mut leaves = LeafPixels::default();
        surfaces.for_each_span(y, |columns, triangle| {
            if let Some(triangle) = triangle.filter(|t| is_leaf(t.part)) {
                let row = &mut WholeRow { y, pixels: &mut *pixels, bright: &mut *bright };
                self.take_leaf(&mut leaves, triangle, columns, row);
                return;
            }
            let pixels = &mut pixels[columns.start as usize..columns.end as usize];
            let span = Span { first: columns.start, y, pixels, bright };
            let is_pane =
                |t: &SurfaceTriangle<'_, '_>| panes.is_some_and(|p| p.is_pane(t.instance, t.triangle));
            match triangle {
                Some(triangle) if is_pane(triangle) => {
                    let (here, others) = behind.split_at(columns.len());
                    behind = others;
                    self.paint_pane(span, triangle, surfaces, here);
                }
                Some(triangle) if is_wet && gets_wet(triangle.part, triangle.normal_local) => {
                    let (instance, triangle) = (triangle.instance, triangle.triangle);
                    wet.push(WetSpan { first: columns.start, end: columns.end, instance, triangle });
                }
                Some(triangle) => self.paint(span, triangle),
                None => self.paint_sky(span),
            }
        });
        self.paint_leaves(&mut leaves, &mut WholeRow { y, pixels, bright });
        wet
    }

    /// Paints the wet ground of a row.
    pub(super) fn paint_wet(&self, surfaces: &Surfaces<'_>, wet: &[WetSpan], row: Row<'_>) {
        let Row { y, rgb, bright } = row;
        let pixels = rgb.as_chunks_mut::<3>().0;
        for span in wet {
            let Some(triangle) = surfaces.facet(span.instance, span.triangle) else { continue };
            let pixels = &mut pixels[span.first as usize..span.end as usize];
            self.paint(Span { first: span.first, y, pixels, bright: &mut *bright }, &triangle);
        }
    }

    /// Paints what shows the sky.
    fn paint_sky(&self, mut span: Span<'_>) {
        for from in (0..span.pixels.len()).step_by(LANES) {
            let seen = self.sky(&span.columns(from, 1), span.y, F32x8::ONE);
            self.develop(seen, &mut span, from);
        }
    }

    /// Film values of pixels that show the sky, from behind fog that so much light passes.
    fn sky(&self, columns: &[u32; LANES], y: u32, before: F32x8) -> Vec3x8 {
        let turn = glam::Mat3::from(self.buffer.camera.local_from_optical.matrix3);
        let optical = Vec3x8::from_fn(|i| self.buffer.direction_optical(columns[i], y));
        let direction = optical.turned(&turn);
        let direction = direction * (1.0 / direction.length_squared().sqrt());
        let seen = self.lighting.sky.seen(&direction) * F32x8::splat(self.exposure);
        if !self.hazy {
            return seen;
        }
        let passes = self.lighting.fog.passes_sky(self.camera.z, direction.z) / before;
        Vec3x8::splat(self.veil).lerp(seen, passes.fast_min(F32x8::ONE))
    }

    /// Paints a pane and what is behind each of its pixels.
    fn paint_pane(
        &self,
        mut span: Span<'_>,
        triangle: &SurfaceTriangle<'_, '_>,
        surfaces: &Surfaces<'_>,
        behind: &[TransmittedHit],
    ) {
        let run = self.begin(triangle);
        for (group, behind) in behind.chunks(LANES).enumerate() {
            let from = group * LANES;
            let columns = span.columns(from, 1);
            let here = triangle.points(self.buffer, &columns, span.y);
            let light = self.light(&run, &here, Spread::Near).light;
            let seen = self.behind(surfaces, &columns, span.y, behind, light.passes);
            self.develop(self.surface(&run, (&columns, span.y), &here, &light, Some(seen)), &mut span, from);
        }
    }

    /// Film values of what is behind up to eight pixels of a pane, as bright as it shows through it; so much
    /// light passes the fog before the pane.
    fn behind(
        &self,
        surfaces: &Surfaces<'_>,
        columns: &[u32; LANES],
        y: u32,
        behind: &[TransmittedHit],
        passes: F32x8,
    ) -> Vec3x8 {
        let passes = passes.fast_max(F32x8::splat(1e-6));
        let mut seen = Vec3x8::default();
        let mut shares = [0.0; LANES];
        for (share, behind) in shares.iter_mut().zip(behind) {
            *share = (0..behind.panes).fold(1.0, |share, _| share * PASSES);
        }
        for (lane, first) in behind.iter().enumerate() {
            let seen_of =
                |behind: &TransmittedHit| behind.hit.map_or((SKY, SKY), |hit| (hit.instance, hit.triangle));
            let (instance, triangle) = seen_of(first);
            let same = |other: &TransmittedHit| seen_of(other) == (instance, triangle);
            if behind[..lane].iter().any(same) {
                continue;
            }
            let value = match surfaces.facet(instance, triangle) {
                None => self.sky(columns, y, passes),
                Some(leaf) if is_leaf(leaf.part) => {
                    self.leaf_behind(&leaf, &leaf.points(self.buffer, columns, y), passes)
                }
                Some(facet) => {
                    let run = self.begin(&facet);
                    let there = facet.points(self.buffer, columns, y);
                    let mut light = self.light(&run, &there, Spread::Near).light;
                    light.passes = (light.passes / passes).fast_min(F32x8::ONE);
                    if surfaces.is_behind_panes(instance) {
                        light.open = light.open.fast_max(F32x8::splat(OPEN_IN_CABINS));
                    }
                    self.surface(&run, (columns, y), &there, &light, None)
                }
            };
            let mask = std::array::from_fn(|i| if behind.get(i).is_some_and(same) { 1.0 } else { 0.0 });
            seen = value.or(F32x8::new(mask).simd_gt(0.5), seen);
        }
        seen * F32x8::new(shares)
    }

    /// Paints what shows a triangle. Of long spans the light is worked out at every eighth pixel, and between
    /// these only what is not even.
    fn paint(&self, mut span: Span<'_>, triangle: &SurfaceTriangle<'_, '_>) {
        let run = self.begin(triangle);
        let points = |columns: &[u32; LANES], y| triangle.points(self.buffer, columns, y);
        let length = span.pixels.len();
        if length <= LANES {
            let columns = span.columns(0, 1);
            let here = points(&columns, span.y);
            let light = self.light(&run, &here, Spread::Near).light;
            self.develop(self.surface(&run, (&columns, span.y), &here, &light, None), &mut span, 0);
            return;
        }
        for stretch in (0..length).step_by(LANES * (LANES - 1)) {
            let places = points(&span.columns(stretch, LANES), span.y);
            let knots = self.light(&run, &places, Spread::Far);
            for knot in 0..LANES - 1 {
                let from = stretch + knot * LANES;
                if from >= length {
                    break;
                }
                let columns = span.columns(from, 1);
                let here = points(&columns, span.y);
                let light = self.between(&run, &knots, knot, (length - 1 - from).min(LANES), &here);
                self.develop(self.surface(&run, (&columns, span.y), &here, &light, None), &mut span, from);
            }
        }
    }

    /// Puts eight pixels of a span on film, behind the lens.
    #[inline]
    fn develop(&self, value: Vec3x8, span: &mut Span<'_>, from: usize) {
        let passes = self.vignette.passes(&span.columns(from, 1), span.y);
        let seen = value * Vec3x8::splat(self.balance) * passes;
        gather(&seen, span.first as usize + from, span.pixels.len() - from, span.bright);
        self.film.develop(&seen, &mut span.pixels[from..]);
    }

    /// The light at some places.
    #[inline]
    fn light(&self, run: &Run<'_>, points: &SurfacePoints, spread: Spread) -> Knots {
        let light = self.lighting;
        let positions = &points.position_local;
        let normal = run.facet.normal_local;
        let to_camera = Vec3x8::splat(self.camera) - *positions;
        let distance_m = to_camera.length_squared().sqrt().fast_max(F32x8::splat(1e-6));
        let slant =
            (to_camera.dot(Vec3x8::splat(normal)) / distance_m).fast_clamp(F32x8::splat(0.04), F32x8::ONE);
        let sun = self.sun(run, positions);
        let lamps = if light.lamps.is_empty() {
            Vec3x8::default()
        } else {
            let normals = match &run.bend {
                Some(bend) => bend.normals(points.position_object),
                None => Vec3x8::splat(normal),
            };
            let klx = if run.facet.is_sheeting() {
                light.lamps.returned(positions, &normals, self.camera)
            } else {
                light.lamps.illuminance(positions, &normals)
            };
            klx * F32x8::splat(self.exposure / std::f32::consts::PI)
        };
        let light = Light {
            sunlit: sun.share,
            open: light.overhead.open(positions, &Vec3x8::splat(normal)),
            between_houses: match spread {
                Spread::Near => F32x8::splat(light.walls.open(positions.lane(0), &run.facing)),
                Spread::Far => light.walls.open_all(positions, &run.facing),
            },
            lamps,
            passes: light.fog.passes(self.camera.z, positions.z, distance_m),
            // A pixel on a slanted surface is longer than wide; the geometric mean blurs neither way too
            // much.
            footprint_at_1_m: self.per_focal / slant.sqrt(),
        };
        Knots { light, sun }
    }

    #[inline]
    fn sun(&self, run: &Run<'_>, positions: &Vec3x8) -> Lit {
        if run.is_lit { self.lighting.shadows.lit(positions, run.facet.normal_local) } else { Lit::none() }
    }

    /// The light at eight pixels between two neighbouring knots that are so many pixels apart.
    #[inline]
    fn between(
        &self,
        run: &Run<'_>,
        knots: &Knots,
        knot: usize,
        pixels: usize,
        here: &SurfacePoints,
    ) -> Light {
        let Knots { light, sun } = knots;
        let ends = |v: F32x8| (v.as_array()[knot], v.as_array()[knot + 1]);
        let share = STEPS * (1.0 / pixels.max(1) as f32);
        let mix = |v: F32x8| {
            let (a, b) = ends(v);
            share * (b - a) + a
        };
        let both = 0b11 << knot;
        let (first, last) = ends(sun.share);
        let even = sun.all_around & both == both
            && first == last
            && self.lighting.shadows.adjoin(sun.block[knot], sun.block[knot + 1]);
        let open = ends(light.open);
        let lamps = if self.lighting.lamps.is_empty() {
            light.lamps
        } else {
            Vec3x8::new(mix(light.lamps.x), mix(light.lamps.y), mix(light.lamps.z))
        };
        Light {
            sunlit: if even { F32x8::splat(first) } else { self.sun(run, &here.position_local).share },
            open: if (open.0 - open.1).abs() < ALIKE {
                mix(light.open)
            } else {
                self.lighting.overhead.open(&here.position_local, &Vec3x8::splat(run.facet.normal_local))
            },
            between_houses: mix(light.between_houses),
            lamps,
            passes: mix(light.passes),
            footprint_at_1_m: mix(light.footprint_at_1_m),
        }
    }

    /// Film values of pixels that show a surface; of a pane, with what is to be seen through it.
    #[inline]
    fn surface(
        &self,
        run: &Run<'_>,
        pixels: (&[u32; LANES], u32),
        here: &SurfacePoints,
        light: &Light,
        behind: Option<Vec3x8>,
    ) -> Vec3x8 {
        let around = &self.lighting.around;
        let points = Points {
            object_m: here.position_object,
            world_m: here.position_local + Vec3x8::splat(around.world_from_local_m),
            footprint_m: here.depth_m * light.footprint_at_1_m,
        };
        let sample = sample(self.patterns, around, &run.facet, &points);
        let bent = run.bend.as_ref().map(|bend| bend.normals(here.position_object));
        let Turned { mut facing, mut ambient } = match &bent {
            Some(normals) => self.turned(normals),
            None => run.turned,
        };
        if let Some([a, b]) = sample.lean {
            let Relief { facing: [fa, fb], ambient: [sa, sb], .. } = run.relief;
            facing = (facing + a * fa + b * fb).fast_max(F32x8::ZERO);
            ambient += Vec3x8::splat(sa) * a + Vec3x8::splat(sb) * b;
        }
        let mut light = *light;
        if let Some(shelter) = &run.shelter {
            light.open *= shelter.at(&here.position_object);
        }
        let ambient = self.between_houses(ambient, light.between_houses);
        let received = Vec3x8::splat(self.key) * (facing * light.sunlit) + ambient * light.open + light.lamps;
        let mut out = behind.unwrap_or(sample.albedo * received);
        if let Some(emission) = sample.emission {
            out += emission;
        }
        if let Some(specular) = &sample.specular {
            let toward = Vec3x8::splat(self.camera) - here.position_local;
            let toward = toward * (1.0 / toward.length_squared().sqrt().fast_max(F32x8::splat(1e-6)));
            let mut normals = bent.unwrap_or(Vec3x8::splat(run.facet.normal_local));
            if let Some([a, b]) = sample.lean {
                let [ta, tb] = run.relief.tangents.map(Vec3x8::splat);
                normals += ta * a + tb * b;
                normals = normals * (1.0 / normals.length_squared().sqrt());
            }
            let mirrored = match &self.mirror {
                Some(mirror) if run.gets_wet => {
                    Some(mirrored(mirror, pixels, specular, sample.lean, &toward))
                }
                _ => None,
            };
            out = self.specular(out, specular, normals, toward, &light, mirrored);
        }
        Vec3x8::splat(self.veil).lerp(out, light.passes)
    }

    fn begin<'p>(&self, triangle: &SurfaceTriangle<'_, 'p>) -> Run<'p> {
        let n = triangle.normal_local;
        let to_key = self.lighting.sky.key_direction;
        let facet = ShadedTriangle::new(triangle.placed(), triangle);
        let gets_wet = self.mirror.is_some() && gets_wet(triangle.part, n);
        let relief = self.relief(&facet);
        let shelter = triangle.open().map(|open| CornerGradient::new(triangle.corners_object_m(), open));
        let towards = Facing::new(n);
        let bend = triangle.bend();
        let turned = self.turned(&Vec3x8::splat(n));
        let corners = bend.as_ref().map_or([n; 3], Bend::corner_normals);
        let is_lit = corners.iter().any(|normal| normal.dot(to_key) > 0.0);
        Run { facet, bend, is_lit, turned, relief, shelter, facing: towards, gets_wet }
    }

    fn relief(&self, facet: &ShadedTriangle<'_>) -> Relief {
        let tangents = facet.tangents_local();
        let [_, x, y, z] = self.ambient;
        Relief {
            tangents,
            facing: tangents.map(|t| t.dot(self.lighting.sky.key_direction)),
            ambient: tangents.map(|t| x * t.x + y * t.y + z * t.z),
        }
    }

    /// The light on surfaces that are turned as their normals say.
    #[inline]
    fn turned(&self, normals: &Vec3x8) -> Turned {
        let [a, x, y, z] = self.ambient;
        let ambient =
            |i: usize| (normals.x * x[i] + normals.y * y[i] + normals.z * z[i] + a[i]).fast_max(F32x8::ZERO);
        let ambient = Vec3x8::new(ambient(0), ambient(1), ambient(2));
        let to_key = Vec3x8::splat(self.lighting.sky.key_direction);
        Turned { facing: normals.dot(to_key).fast_max(F32x8::ZERO), ambient }
    }

    /// Adds what a glossy surface mirrors: the sky, or what else is known to be `around` it, and a highlight
    /// of the sun.
    #[inline]
    fn specular(
        &self,
        out: Vec3x8,
        specular: &Specular,
        n: Vec3x8,
        toward: Vec3x8,
        light: &Light,
        around: Option<(Vec3x8, F32x8)>,
    ) -> Vec3x8 {
        let cos = toward.dot(n);
        // Schlick's form of Fresnel's reflectance; rough surfaces gain less at grazing angles.
        let grazing = 1.0 - cos.fast_clamp(F32x8::ZERO, F32x8::ONE);
        let g2 = grazing * grazing;
        let gain = (1.0 - specular.roughness - specular.mirror).fast_max(F32x8::ZERO);
        let fresnel = specular.mirror + gain * (g2 * g2 * grazing);
        // Dull neighbours in a group of eight stay dull at any angle.
        let fresnel = specular.mirror.simd_gt(0.0).select(fresnel, F32x8::ZERO);
        let mirrored = n * (cos * 2.0) - toward;
        // Rough surfaces see a wide piece of sky: the mean light stands for it.
        let sky = self.lighting.sky.radiance(&mirrored);
        let sharp = self.lighting.environment_map.before(&sky, &mirrored) * F32x8::splat(self.exposure);
        let [level, .., rise] = self.ambient;
        let level = level + self.bounced;
        let wide = |level: f32, rise: f32| (mirrored.z * rise + level).fast_max(F32x8::ZERO);
        let wide = Vec3x8::new(wide(level.x, rise.x), wide(level.y, rise.y), wide(level.z, rise.z));
        let blur = (specular.roughness * 2.0).fast_min(F32x8::ONE);
        let mut reflected = sharp.lerp(wide, blur) * light.open;
        if let Some((seen, known)) = around {
            reflected = reflected.lerp(seen, known);
        }
        if light.sunlit.simd_gt(0.0).any() && self.lighting.sky.key_klx != Vec3::ZERO {
            let key = self.lighting.sky.key_direction;
            let off = (1.0 - mirrored.dot(Vec3x8::splat(key))).fast_max(F32x8::ZERO);
            let spread = specular.roughness * specular.roughness * 0.5 + 0.0012;
            let highlight = exp_neg(off / spread) * (0.08 / spread).fast_min(F32x8::splat(14.0));
            reflected += Vec3x8::splat(self.key) * (highlight * light.sunlit);
        }
        out.lerp(reflected, fresnel.fast_clamp(F32x8::ZERO, F32x8::ONE))
    }
}
