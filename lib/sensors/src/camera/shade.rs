//! The colour picture: light times surface, row by row.

use glam::Vec3;
use rayon::prelude::*;
use renderer::{SurfacePoint, Surfaces, VisibilityBuffer};
use schema::geometry::{Snapshot, Surface};

use super::antialias::smooth_edges;
use super::picture::Picture;
use super::rain::draw_rain;
use super::view::CameraView;
use crate::light::{Lighting, Lit, exp_neg};
use crate::look::{Facet, Look, Noise, look};

impl Picture {
    /// Lights and colours what was seen.
    #[must_use]
    pub fn new(
        snapshot: &Snapshot,
        view: &CameraView,
        buffer: &VisibilityBuffer,
        lighting: &Lighting,
    ) -> Self {
        let width = buffer.width as usize;
        let mut rgb = vec![0u8; 3 * buffer.instance.len()];
        let exposure = lighting.sky.exposure(view.settings.f_stop);
        let mut ambient = lighting.sky.ambient;
        ambient[0] += lighting.sky.bounced_klx();
        let shader = Shader {
            snapshot,
            buffer,
            lighting,
            noise: Noise::get(),
            exposure,
            per_focal: 1.0 / buffer.camera.fx,
            camera: Vec3::from(buffer.camera.local_from_optical.translation),
            film: film_table(),
            hazy: !lighting.fog.is_clear(),
            veil: lighting.fog.rgb * exposure,
            ambient: ambient.map(|a| a * (exposure / std::f32::consts::PI)),
            key: lighting.sky.key_klx * (exposure / std::f32::consts::PI),
        };
        let surfaces = Surfaces::new(buffer, snapshot);
        rgb.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
            let mut painter =
                Painter { shader: &shader, row: row.as_chunks_mut::<3>().0, run: None, strip: Vec::new() };
            surfaces.for_each_in_row(y as u32, |x, point| painter.add(x as usize, y as u32, point));
            painter.flush(width);
        });
        let mut picture = Self { width: buffer.width, height: buffer.height, rgb };
        smooth_edges(&mut picture);
        if lighting.rain > 0.0 {
            draw_rain(&mut picture, (&view.model, buffer), lighting.rain, lighting.around.world_from_local_m);
        }
        picture
    }
}

/// The triangle that the last pixel was on.
struct Run<'a> {
    instance: u32,
    triangle: u32,
    facet: Facet<'a>,
    /// Normal for the light: that of the triangle, bent upwards for leaves, which stand every way.
    normal: Vec3,
    /// From which side shadows are looked up, times the distance in texels.
    outward: Vec3,
    /// Cosine between normal and light, 0 when turned away.
    facing: f32,
    /// Light of the sky on this normal, as film value of a white surface.
    ambient: Vec3,
}

/// The light at a place, before the surface's colour; smooth enough to be interpolated.
#[derive(Clone, Copy)]
struct Light {
    /// Film value of a white surface.
    received: Vec3,
    /// Share of the sun that is seen, and whether all around.
    lit: Lit,
    /// Share of the sky that is seen.
    open: f32,
    /// Share of light that passes the fog.
    passes: f32,
    /// Width of a pixel, metres.
    footprint_m: f32,
}

impl Light {
    fn lerp(&self, other: &Self, share: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * share;
        Self {
            received: self.received.lerp(other.received, share),
            lit: self.lit,
            open: mix(self.open, other.open),
            passes: mix(self.passes, other.passes),
            footprint_m: mix(self.footprint_m, other.footprint_m),
        }
    }
}

/// Most pixels between two places where the light is worked out.
const STRIP: usize = 8;
/// Shade from above may differ by this at the ends of a strip.
const ALIKE: f32 = 0.06;

/// Paints one row: pixels of one triangle are collected into strips; where no edge of a shadow crosses a strip, the
/// light is worked out at its ends alone.
struct Painter<'a, 'b> {
    shader: &'b Shader<'b>,
    row: &'b mut [[u8; 3]],
    run: Option<Run<'a>>,
    strip: Vec<SurfacePoint<'a>>,
}

impl<'a> Painter<'a, '_> {
    #[inline]
    fn add(&mut self, x: usize, y: u32, point: Option<&SurfacePoint<'a>>) {
        let Some(point) = point else {
            self.flush(x);
            self.run = None;
            self.row[x] = self.shader.develop(self.shader.sky(x as u32, y));
            return;
        };
        let same =
            self.run.as_ref().is_some_and(|r| r.instance == point.instance && r.triangle == point.triangle);
        if !same || self.strip.len() == STRIP {
            self.flush(x);
        }
        if !same {
            self.run = Some(self.shader.begin(point));
        }
        self.strip.push(*point);
    }

    /// Paints the strip that ends before column `end`.
    fn flush(&mut self, end: usize) {
        let (Some(run), [first, rest @ ..]) = (&self.run, self.strip.as_slice()) else { return };
        let row = &mut self.row[end - 1 - rest.len()..end];
        let at_first = self.shader.light(run, first);
        let at_last = rest.last().map(|last| self.shader.light(run, last));
        let smooth = at_last.filter(|last| {
            at_first.lit == last.lit && last.lit.all_around && (at_first.open - last.open).abs() < ALIKE
        });
        let step = 1.0 / rest.len().max(1) as f32;
        for (i, (point, pixel)) in self.strip.iter().zip(row).enumerate() {
            let light = match &smooth {
                Some(last) => at_first.lerp(last, i as f32 * step),
                None => self.shader.light(run, point),
            };
            *pixel = self.shader.develop(self.shader.surface(run, point, &light));
        }
        self.strip.clear();
    }
}

struct Shader<'a> {
    snapshot: &'a Snapshot,
    buffer: &'a VisibilityBuffer,
    lighting: &'a Lighting,
    noise: &'a Noise,
    /// Film value per radiance.
    exposure: f32,
    /// Width of a pixel at a depth of a metre.
    per_focal: f32,
    camera: Vec3,
    film: Vec<u8>,
    hazy: bool,
    /// Film value of fog.
    veil: Vec3,
    /// Film value of a white surface, by the sky's ambient terms.
    ambient: [Vec3; 4],
    /// Film value of a white surface that faces the sun.
    key: Vec3,
}

impl Shader<'_> {
    /// Film value of a pixel that shows the sky.
    fn sky(&self, x: u32, y: u32) -> Vec3 {
        let camera = &self.buffer.camera;
        let direction =
            camera.local_from_optical.transform_vector3(self.buffer.direction_optical(x, y)).normalize();
        let seen = self.lighting.sky.seen(direction);
        let fog = &self.lighting.fog;
        if !self.hazy {
            return seen * self.exposure;
        }
        let passes = fog.passes_sky(self.camera.z, direction.z).min(1.0);
        self.veil.lerp(seen * self.exposure, passes)
    }

    /// The light at a place.
    #[inline]
    fn light(&self, run: &Run<'_>, point: &SurfacePoint<'_>) -> Light {
        let light = self.lighting;
        let normal = run.facet.normal_local;
        let to_camera = self.camera - point.position_local;
        let distance_m = to_camera.length().max(1e-6);
        let slant = (normal.dot(to_camera) / distance_m).clamp(0.04, 1.0);
        let lit = if run.facing > 0.0 {
            light.shadows.lit(point.position_local, run.outward)
        } else {
            Lit { share: 0.0, all_around: true }
        };
        let open = light.overhead.open(point.position_local, normal);
        let mut received = self.key * (run.facing * lit.share) + run.ambient * open;
        if !light.lamps.is_empty() {
            let lamps = light.lamps.illuminance(point.position_local, run.normal);
            received += lamps * (self.exposure / std::f32::consts::PI);
        }
        Light {
            received,
            lit,
            open,
            passes: light.fog.passes(self.camera.z, point.position_local.z, distance_m),
            // A pixel on a slanted surface is longer than wide; the geometric mean blurs neither way too much.
            footprint_m: point.depth_m * self.per_focal / slant.sqrt(),
        }
    }

    /// Film value of a pixel that shows a surface.
    #[inline]
    fn surface(&self, run: &Run<'_>, point: &SurfacePoint<'_>, light: &Light) -> Vec3 {
        let look = look(
            self.noise,
            &self.lighting.around,
            &run.facet,
            point.position_object,
            point.position_local,
            light.footprint_m,
        );
        let mut out = look.albedo * light.received + look.emission;
        if look.mirror > 0.0 {
            let toward = (self.camera - point.position_local).normalize_or(run.normal);
            out = self.gloss(out, &look, run.facet.normal_local, toward, light);
        }
        self.veil.lerp(out, light.passes)
    }

    /// What is the same for a triangle.
    fn begin<'p>(&self, point: &SurfacePoint<'p>) -> Run<'p> {
        let instance = &self.snapshot.instances[point.instance as usize];
        let n = point.normal_local;
        let [a, x, y, z] = self.ambient;
        let ambient = (a + x * n.x + y * n.y + z * n.z).max(Vec3::ZERO);
        let to_key = self.lighting.sky.key_direction;
        let facet = Facet::new(instance, point.part, n);
        let (instance, triangle) = (point.instance, point.triangle);
        if point.part.surface == Surface::Foliage {
            // Leaves let light through, and those turned away are looked at on their lit side.
            let normal = (n + Vec3::Z * 0.6).normalize_or(n);
            let side = normal.dot(to_key);
            let facing = 0.55 * side.max(0.0) + 0.2 + 0.15 * (side * 0.5 + 0.5);
            return Run {
                instance,
                triangle,
                facet,
                normal,
                outward: to_key * 4.0,
                facing,
                ambient: ambient * 0.8,
            };
        }
        Run { instance, triangle, facet, normal: n, outward: n, facing: n.dot(to_key).max(0.0), ambient }
    }

    /// Adds what a glossy surface mirrors: the sky, and a highlight of the sun.
    fn gloss(&self, out: Vec3, look: &Look, n: Vec3, toward: Vec3, light: &Light) -> Vec3 {
        let slant = n.dot(toward).clamp(0.0, 1.0);
        // Schlick's form of Fresnel's reflectance; rough surfaces gain less at grazing angles.
        let grazing = 1.0 - slant;
        let g2 = grazing * grazing;
        let fresnel = look.mirror + (1.0 - look.roughness - look.mirror).max(0.0) * g2 * g2 * grazing;
        let mirrored = 2.0 * n.dot(toward) * n - toward;
        // Rough surfaces see a wide piece of sky: the mean light stands for it.
        let sharp = self.lighting.sky.radiance(mirrored) * self.exposure;
        let wide = (self.ambient[0] + self.ambient[3] * mirrored.z).max(Vec3::ZERO);
        let blur = (2.0 * look.roughness).min(1.0);
        let mut reflected = sharp.lerp(wide, blur) * light.open;
        if light.lit.share > 0.0 && self.lighting.sky.key_klx != Vec3::ZERO {
            let off = (1.0 - mirrored.dot(self.lighting.sky.key_direction)).max(0.0);
            let spread = 0.0012 + 0.5 * look.roughness * look.roughness;
            let highlight = exp_neg(off / spread) * (0.08 / spread).min(14.0);
            reflected += self.key * (highlight * light.lit.share);
        }
        out.lerp(reflected, fresnel.clamp(0.0, 1.0))
    }

    /// Film value to 8-bit sRGB.
    #[inline]
    fn develop(&self, light: Vec3) -> [u8; 3] {
        [self.tone(light.x), self.tone(light.y), self.tone(light.z)]
    }

    #[inline]
    fn tone(&self, value: f32) -> u8 {
        // Clamped to the table's range; NaN goes to its start.
        let v = if value > FILM_LEAST { value } else { FILM_LEAST };
        let bits = if v < FILM_MOST { v.to_bits() } else { FILM_MOST.to_bits() - 1 };
        self.film.get(((bits - FILM_LEAST.to_bits()) >> FILM_SHIFT) as usize).copied().unwrap_or(255)
    }
}

/// Range of the film table: powers of two, with 256 steps to each doubling.
const FILM_LEAST: f32 = 1.0 / 8192.0;
const FILM_MOST: f32 = 32.0;
const FILM_SHIFT: u32 = 23 - 8;

/// 8-bit sRGB of film values, indexed by the leading bits of the number: a filmic curve (Narkowicz, "ACES filmic
/// tone mapping curve", 2015) and the sRGB code.
fn film_table() -> Vec<u8> {
    let entries = (FILM_MOST.to_bits() - FILM_LEAST.to_bits()) >> FILM_SHIFT;
    (0..entries)
        .map(|i| {
            let half = 1 << (FILM_SHIFT - 1);
            let v =
                if i == 0 { 0.0 } else { f32::from_bits(FILM_LEAST.to_bits() + (i << FILM_SHIFT) + half) };
            let linear = (v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14)).min(1.0);
            let coded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * frames::math::f32::pow(linear, 1.0 / 2.4) - 0.055
            };
            (coded * 255.0 + 0.5) as u8
        })
        .collect()
}
