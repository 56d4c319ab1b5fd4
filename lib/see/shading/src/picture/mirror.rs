//! What wet ground mirrors: other parts of the same picture.
//!
//! Where a mirrored ray ends is looked up in the picture's own depths. The ray runs nearly in the upright
//! plane through the camera, and most things stand: a search that follows it to the depth of the pixel
//! found there, and looks again, ends in a few steps and passes nothing that stands in the way. Of what the
//! picture does not show (undersides, what is beyond its edges) there is what the agent sees around it in
//! that direction.

use glam::{Affine3A, Mat3, Vec3};
use rayon::prelude::*;
use render::{Surfaces, VisibilityBuffer};
use schema::geometry::Surface;
use simd::{F32x8, LANES, Vec3x8, floor_words};

use super::film::Film;
use super::vignette::Vignette;
use crate::light::{EnvironmentMap, Sky};
use render::CameraView;

/// Mirrored rays stand so many columns apart, and as many rows as are this far apart as slopes, but within
/// these limits.
const COLUMNS_APART: usize = 2;
const ROWS_APART: f32 = 0.0042;
const ROWS_LIMITS: [usize; 2] = [2, 4];
/// Ends of rays that move by less than this share are found.
const FOUND: f32 = 0.02;
/// Looks at the picture along a ray.
const LOOKS: usize = 7;
/// The first look, as a share of the distance from the camera.
const FIRST: f32 = 0.08;
/// What the picture shows hides what is farther away by more than this share, or as many metres.
const HIDDEN: f32 = 0.15;
/// What is farther than this is at the end of the world, metres.
const FAR_M: f32 = 4000.0;
/// Water on rough ground blurs pictures by so much up and down, and to the sides, as slopes: rays that graze
/// it are turned upwards more than aside.
const BLUR: [f32; 2] = [0.035, 0.004];
/// Lamps are so much brighter than what the film shows of them: by day and when they light the ground.
const LAMP: [f32; 2] = [1.5, 12.0];
/// Least code of a lamp that shines.
const SHINING: u8 = 200;
/// Ripples move what is mirrored by no more than this, pixels.
const MOST_MOVED: f32 = 40.0;

/// Red, green and blue times a weight, and that weight: 0 where no ray was followed.
type Texel = wide::f32x4;

/// Neighbours in a row that show one triangle of wet ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct WetSpan {
    pub(super) first: u32,
    pub(super) end: u32,
    pub(super) instance: u32,
    pub(super) triangle: u32,
}

/// The picture without what is wet.
#[derive(Clone, Copy)]
pub(super) struct Dry<'a> {
    pub(super) view: &'a CameraView,
    pub(super) buffer: &'a VisibilityBuffer,
    pub(super) rgb: &'a [[u8; 3]],
    /// By row, from left to right: their pixels are not painted yet.
    pub(super) wet: &'a [Vec<WetSpan>],
    pub(super) film: &'a Film,
    pub(super) vignette: Vignette,
    /// What white things were balanced by.
    pub(super) balance: Vec3,
    pub(super) sky: &'a Sky,
    pub(super) environment_map: &'a EnvironmentMap,
    /// Film value per radiance.
    pub(super) exposure: f32,
}

/// What the wet ground of a picture mirrors, as film values before balance and vignette.
#[derive(Clone, Debug)]
pub(super) struct Mirror {
    columns: usize,
    rows: usize,
    rows_apart: usize,
    /// As level water does.
    sharp: Vec<Texel>,
    /// As a film of water on rough ground does.
    dull: Vec<Texel>,
    /// Pixels that what is mirrored moves to the right and down, by slopes of the water.
    focal: [f32; 2],
}

impl Mirror {
    /// Follows the rays that wet ground mirrors; `surfaces` are those of the picture.
    pub(super) fn new(dry: &Dry<'_>, surfaces: &Surfaces<'_>) -> Self {
        let (width, height) = (dry.buffer.width as usize, dry.buffer.height as usize);
        let camera = &dry.buffer.camera;
        let rows_apart = ((ROWS_APART * camera.fy).round() as usize).clamp(ROWS_LIMITS[0], ROWS_LIMITS[1]);
        let (columns, rows) = (width.div_ceil(COLUMNS_APART), height.div_ceil(rows_apart));
        let mut sharp = vec![Texel::ZERO; columns * rows];
        let tracer = Tracer::new(dry);
        sharp.par_chunks_mut(columns).zip(dry.wet.par_iter().step_by(rows_apart)).enumerate().for_each(
            |(row, (texels, wet))| {
                let y = (row * rows_apart) as u32;
                for span in wet {
                    tracer.follow(surfaces, span, y, texels);
                }
            },
        );
        let reach = |slope: f32, focal: f32, apart: usize| (slope * focal / apart as f32).round() as usize;
        let mut dull = sharp.clone();
        for _ in 0..2 {
            dull = blurred_down(&dull, columns, reach(BLUR[0], camera.fy, rows_apart));
        }
        blur_across(&mut dull, columns, reach(BLUR[1], camera.fx, COLUMNS_APART));
        Self { columns, rows, rows_apart, sharp, dull, focal: [camera.fx, camera.fy] }
    }

    /// What is mirrored at eight pixels of a row whose water leans by slopes away from the camera and to its
    /// right, `rough` (0 to 1) as it is, and whether that is known: 0 or 1. The ground is seen at an angle of
    /// such a sine.
    #[inline]
    pub(super) fn at(
        &self,
        (columns, y): (&[u32; LANES], u32),
        [away, right]: [F32x8; 2],
        sine: F32x8,
        rough: F32x8,
    ) -> (Vec3x8, F32x8) {
        let still = (1.0 - rough) * 2.0;
        let moved = |pixels: F32x8| pixels.fast_clamp(F32x8::splat(-MOST_MOVED), F32x8::splat(MOST_MOVED));
        let x = F32x8::from(columns.map(|c| c as f32)) + moved(still * right * sine * self.focal[0]);
        let y = F32x8::splat(y as f32) - moved(still * away * self.focal[1]);
        let place = |v: F32x8, apart: usize, count: usize| {
            (v * (1.0 / apart as f32)).fast_clamp(F32x8::ZERO, F32x8::splat((count - 1) as f32 - 1e-3))
        };
        let (x, y) = (place(x, COLUMNS_APART, self.columns), place(y, self.rows_apart, self.rows));
        let (x0, y0) = (x.floor(), y.floor());
        let first = (floor_words(y0) * self.columns as u32 + floor_words(x0)).to_array();
        let (fx, fy, rough) = ((x - x0).to_array(), (y - y0).to_array(), rough.to_array());
        let mut known = [0.0; LANES];
        let seen = Vec3x8::from_fn(|i| {
            let first = first[i] as usize;
            let texel = |of: &[Texel]| {
                let at = |k: usize| of.get(k).copied().unwrap_or(Texel::ZERO);
                let mix = |a: Texel, b: Texel, share: f32| a + (b - a) * share;
                let below = first + self.columns;
                mix(mix(at(first), at(first + 1), fx[i]), mix(at(below), at(below + 1), fx[i]), fy[i])
            };
            let texel = match rough[i] {
                r if r >= 1.0 => texel(&self.dull),
                r if r <= 0.0 => texel(&self.sharp),
                r => texel(&self.sharp) * (1.0 - r) + texel(&self.dull) * r,
            };
            let [red, green, blue, weight] = texel.to_array();
            if weight < 1e-3 {
                return Vec3::ZERO;
            }
            known[i] = 1.0;
            Vec3::new(red, green, blue) / weight
        });
        (seen, known.into())
    }
}

/// Follows mirrored rays through a picture.
struct Tracer<'a> {
    dry: &'a Dry<'a>,
    eye: Vec3,
    optical_from_local: Mat3,
    /// Film values by code, without balance.
    values: Vec<Vec3>,
}

impl<'a> Tracer<'a> {
    fn new(dry: &'a Dry<'a>) -> Self {
        let local_from_optical: &Affine3A = &dry.buffer.camera.local_from_optical;
        let balance = dry.balance.max(Vec3::splat(1e-3));
        Self {
            dry,
            eye: local_from_optical.translation.into(),
            optical_from_local: Mat3::from(local_from_optical.matrix3).transpose(),
            values: dry.film.values().into_iter().map(|value| Vec3::splat(value) / balance).collect(),
        }
    }

    /// Fills the texels of a row that a span is in.
    fn follow(&self, surfaces: &Surfaces<'_>, span: &WetSpan, y: u32, texels: &mut [Texel]) {
        let Some(facet) = surfaces.facet(span.instance, span.triangle) else { return };
        let first = (span.first as usize).div_ceil(COLUMNS_APART);
        let end = (span.end as usize).div_ceil(COLUMNS_APART);
        for from in (first..end).step_by(LANES) {
            let last = end.min(from + LANES) - 1;
            let columns: [u32; LANES] =
                std::array::from_fn(|i| ((from + i).min(last) * COLUMNS_APART) as u32);
            let here = facet.points(self.dry.buffer, &columns, y).position_local;
            let seen = self.seen(surfaces, &here, facet.normal_local);
            for (i, texel) in texels[from..=last].iter_mut().enumerate() {
                let [red, green, blue] = seen.lane(i).to_array();
                *texel = Texel::new([red, green, blue, 1.0]);
            }
        }
    }

    /// Film values of what eight places of a level surface mirror.
    fn seen(&self, surfaces: &Surfaces<'_>, places: &Vec3x8, normal: Vec3) -> Vec3x8 {
        let from_eye = *places - Vec3x8::splat(self.eye);
        let way = from_eye * (1.0 / from_eye.length_squared().sqrt().fast_max(F32x8::splat(1e-6)));
        let way = way - Vec3x8::splat(normal) * (way.dot(Vec3x8::splat(normal)) * 2.0);
        let (pixels, is_shown) = self.end(&from_eye, &way);
        let sky = if is_shown.all() {
            Vec3x8::default()
        } else {
            let sky = self.dry.sky.radiance(&way);
            self.dry.environment_map.before(&sky, &way) * F32x8::splat(self.dry.exposure)
        };
        let shown = is_shown.to_bitmask();
        let width = self.dry.buffer.width;
        Vec3x8::from_fn(|i| {
            let [column, row] = [pixels[i] % width, pixels[i] / width];
            if shown >> i & 1 == 0 || is_wet(&self.dry.wet[row as usize], column) {
                return sky.lane(i);
            }
            let at = pixels[i] as usize;
            let codes = self.dry.rgb[at];
            let [red, green, blue] = codes.map(usize::from);
            let mut value = Vec3::new(self.values[red].x, self.values[green].y, self.values[blue].z);
            if codes.iter().any(|code| *code >= SHINING) {
                let buffer = self.dry.buffer;
                let facet = surfaces.facet(buffer.instance[at], buffer.triangle[at]);
                if facet.is_some_and(|facet| matches!(facet.part.surface, Surface::Lamp(_))) {
                    value *= LAMP[usize::from(self.dry.sky.lamps_matter())];
                }
            }
            value / self.dry.vignette.passes(&[column; LANES], row).as_array()[0].max(0.05)
        })
    }

    /// The pixels in which eight rays end, and whether the picture shows them; places and ways are from the
    /// camera.
    fn end(&self, places: &Vec3x8, ways: &Vec3x8) -> ([u32; LANES], F32x8) {
        let Dry { view, buffer, .. } = self.dry;
        let level = (ways.x * ways.x + ways.y * ways.y).sqrt().fast_max(F32x8::splat(1e-3));
        let ahead = Vec3x8::new(ways.x / level, ways.y / level, F32x8::ZERO);
        let away_m = places.dot(ahead);
        let [places, ways, ahead] = [places, ways, &ahead].map(|v| v.turned(&self.optical_from_local));
        let (width, height) = (buffer.width as f32, buffer.height as f32);
        // How far ahead what pixels show is, in the rays' planes.
        let seen_m = |pixels: &[u32; LANES]| {
            let depth_m = F32x8::from(pixels.map(|p| buffer.depth_m[p as usize]));
            (self.directions(pixels) * depth_m.fast_min(F32x8::splat(FAR_M))).dot(ahead)
        };
        let least_m = away_m.abs() * 1e-3 + 1e-3;
        let mut along_m = away_m.abs() * FIRST / level;
        let look = |along_m: F32x8| {
            let at = places + ways * along_m;
            let [column, row] = view.model.project_all(&at);
            let is_shown = at.z.simd_gt(buffer.camera.near_m)
                & column.simd_ge(0.0)
                & row.simd_ge(0.0)
                & column.simd_lt(width)
                & row.simd_lt(height);
            let within = |v: F32x8, end: f32| {
                floor_words(v.fast_clamp(F32x8::ZERO, F32x8::splat(end - 1.0))).to_array()
            };
            let (columns, rows) = (within(column, width), within(row, height));
            let pixels: [u32; LANES] = std::array::from_fn(|i| rows[i] * buffer.width + columns[i]);
            (pixels, is_shown)
        };
        for _ in 0..LOOKS {
            let (pixels, is_shown) = look(along_m);
            if is_shown.none() {
                return (pixels, is_shown);
            }
            let next_m = ((seen_m(&pixels) - away_m) / level).fast_clamp(least_m, F32x8::splat(FAR_M));
            let is_found = !is_shown | (next_m - along_m).abs().simd_lt(along_m * FOUND);
            along_m = is_shown.select(next_m, along_m);
            if is_found.all() {
                break;
            }
        }
        let (pixels, is_shown) = look(along_m);
        // What is nearer than the end of the ray hides it.
        let end_m = (away_m + along_m * level).fast_min(F32x8::splat(0.5 * FAR_M));
        let is_hidden = seen_m(&pixels).simd_lt(end_m * (1.0 - HIDDEN) - HIDDEN);
        (pixels, is_shown & !is_hidden)
    }

    /// Optical directions of eight pixels.
    fn directions(&self, pixels: &[u32; LANES]) -> Vec3x8 {
        let buffer = self.dry.buffer;
        if let Some(rays) = &buffer.rays {
            return Vec3x8::from_fn(|i| rays[pixels[i] as usize]);
        }
        let camera = &buffer.camera;
        let column = F32x8::from(pixels.map(|p| (p % buffer.width) as f32 + 0.5));
        let row = F32x8::from(pixels.map(|p| (p / buffer.width) as f32 + 0.5));
        Vec3x8::new((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, F32x8::ONE)
    }
}

/// Whether a column is in a span of a row.
fn is_wet(wet: &[WetSpan], column: u32) -> bool {
    let next = wet.partition_point(|span| span.first <= column);
    next > 0 && column < wet[next - 1].end
}

/// Means over the texels up to `reach` to the left and right.
fn blur_across(texels: &mut [Texel], columns: usize, reach: usize) {
    let per = 1.0 / (2 * reach + 1) as f32;
    texels.par_chunks_mut(columns).for_each_init(Vec::new, |before, row| {
        before.clear();
        before.extend_from_slice(row);
        let mut sum = before.iter().take(reach).fold(Texel::ZERO, |sum, texel| sum + *texel);
        for (x, texel) in row.iter_mut().enumerate() {
            sum += before.get(x + reach).copied().unwrap_or(Texel::ZERO);
            *texel = sum * per;
            sum -= x.checked_sub(reach).map_or(Texel::ZERO, |x| before[x]);
        }
    });
}

/// Means over the texels up to `reach` above and below.
fn blurred_down(texels: &[Texel], columns: usize, reach: usize) -> Vec<Texel> {
    let rows = texels.len() / columns;
    let per = 1.0 / (2 * reach + 1) as f32;
    let mut out = vec![Texel::ZERO; texels.len()];
    // All columns side by side, from the top.
    let row = |y: usize| &texels[y * columns..(y + 1) * columns];
    let mut sums = vec![Texel::ZERO; columns];
    let add = |sums: &mut [Texel], y: usize, sign: f32| {
        sums.iter_mut().zip(row(y)).for_each(|(sum, texel)| *sum += *texel * sign);
    };
    for y in 0..reach.min(rows) {
        add(&mut sums, y, 1.0);
    }
    for y in 0..rows {
        if y + reach < rows {
            add(&mut sums, y + reach, 1.0);
        }
        if y > reach {
            add(&mut sums, y - reach - 1, -1.0);
        }
        out[y * columns..(y + 1) * columns].iter_mut().zip(&sums).for_each(|(out, sum)| *out = *sum * per);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurs_are_means() {
        let (columns, rows) = (9, 13);
        let texels: Vec<Texel> = (0..columns * rows)
            .map(|i| Texel::new([i as f32, (i * i % 31) as f32, 0.5, f32::from(u8::from(i % 4 != 0))]))
            .collect();
        for reach in [0, 1, 4, 20] {
            let at = |x: i64, y: i64| {
                let inside = (0..columns as i64).contains(&x) && (0..rows as i64).contains(&y);
                if inside { texels[y as usize * columns + x as usize] } else { Texel::ZERO }
            };
            let down = blurred_down(&texels, columns, reach);
            let mut across = texels.clone();
            blur_across(&mut across, columns, reach);
            let around = -(reach as i64)..=reach as i64;
            let per = 1.0 / (2 * reach + 1) as f32;
            for i in 0..texels.len() {
                let (x, y) = ((i % columns) as i64, (i / columns) as i64);
                let mean =
                    |of: &dyn Fn(i64) -> Texel| around.clone().fold(Texel::ZERO, |sum, d| sum + of(d)) * per;
                for (got, want) in [(down[i], mean(&|d| at(x, y + d))), (across[i], mean(&|d| at(x + d, y)))]
                {
                    let off = (got - want).abs().to_array();
                    assert!(off.iter().all(|off| *off < 1e-3), "{reach} {i}: {got} {want}");
                }
            }
        }
    }
}
