//! Roads, paint, grass.

use crate::textures::{Noise, Texels, Textures};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};
use simd::{F32x8, U32x8, Vec3x8, floor_words, hash2, smoothstep, unit};

use super::cells::in_cell;
use super::gutter;
use super::pattern::{Width, bars};
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle, Specular, Surroundings, is_level, shades};

/// Manholes: one in a square of this side (a power of two, so that the wrapped world has no seam), metres.
const MANHOLE_CELL_M: f32 = 32.0;
/// Share of the squares that have one.
const MANHOLE_SHARE: f32 = 0.6;
/// Rings of drops: one in a square of this side (a power of two again), metres.
const RING_CELL_M: f32 = 0.125;
/// Radius of its lid, and of the frame around it, metres.
const LID_M: f32 = 0.3;
const FRAME_M: f32 = 0.36;

/// Noise over the ground: `per_m` texels a metre (a power of two, so that the wrapped world has no seam).
#[inline]
pub(super) fn ground_noise(noise: &Noise, p: &Points, per_m: f32) -> F32x8 {
    noise.at_all(p.world_m.x * per_m, p.world_m.y * per_m, p.footprint_m * per_m)
}

#[inline]
fn laid(texture: &crate::textures::Texture, p: &Points) -> Texels {
    texture.at(p.world_m.x, p.world_m.y, p.footprint_m)
}

/// Whether a part with such a normal is ground that mirrors when it is wet.
pub(crate) fn gets_wet(part: &MeshPart, normal_local: Vec3) -> bool {
    is_level(normal_local)
        && match part.surface {
            Surface::Asphalt | Surface::KerbedAsphalt(_) | Surface::Paving(_) | Surface::RoadMarking => true,
            Surface::Concrete => part.tag != Tag::Building,
            _ => false,
        }
}

/// Darkens and glosses a porous surface that is wet; `flat` is 1 where puddles can stand.
#[inline]
pub(super) fn wet(
    noise: &Noise,
    around: &Surroundings,
    mut sample: BrdfSample,
    p: &Points,
    flat: f32,
) -> BrdfSample {
    if !around.are_wet() {
        return sample;
    }
    let hollow = ground_noise(noise, p, 16.0);
    let threshold = 1.0 - 0.75 * around.puddles;
    let puddle = smoothstep(threshold, threshold + 0.12, hollow) * (flat * around.puddles.min(1.0));
    let wetness = puddle.fast_max(F32x8::splat(around.wetness));
    sample.albedo *= 1.0 - wetness * 0.5;
    // Water lies level, but where drops fall.
    sample.lean = sample.lean.map(|lean| lean.map(|v| v * (1.0 - puddle)));
    let mut roughness = 0.6 - wetness * 0.28 - puddle * 0.3;
    if around.rain > 0.0 && puddle.simd_gt(0.0).any() {
        // Far rings are finer than pixels: there they are roughness.
        let near = 1.0 / (p.footprint_m * p.footprint_m * 4000.0 + 1.0);
        roughness += puddle * (1.0 - near) * (0.1 * around.rain);
        let rings = rings(around, p);
        let [east, north] = sample.lean.unwrap_or_default();
        sample.lean = Some([east + rings[0] * puddle * near, north + rings[1] * puddle * near]);
    }
    sample.specular = Some(Specular { mirror: wetness * 0.02, roughness });
    sample
}

/// Slopes of the rings that drops of rain make on water, along x and y of the world.
#[inline]
fn rings(around: &Surroundings, p: &Points) -> [F32x8; 2] {
    const WRAPPED: u32 = (Surroundings::WRAP_M / RING_CELL_M as f64) as u32 - 1;
    let (x, y) = (p.world_m.x * (1.0 / RING_CELL_M), p.world_m.y * (1.0 / RING_CELL_M));
    let frame = U32x8::splat(around.frame.wrapping_mul(0x9e37_79b9));
    let word = hash2(floor_words(x) & WRAPPED, floor_words(y) & WRAPPED, frame);
    // One in a cell, which it does not leave.
    let radius_m = unit(word) * 0.04 + 0.012;
    let place = |v: F32x8, bits: U32x8| {
        let free = 1.0 - radius_m * (2.0 / RING_CELL_M) - 0.2;
        (v - v.floor() - 0.5 - (unit(bits) - 0.5) * free.fast_max(F32x8::ZERO)) * RING_CELL_M
    };
    let (dx, dy) = (place(x, word * 0x85eb_ca6bu32), place(y, word * 0xc2b2_ae35u32));
    let away = (dx * dx + dy * dy).sqrt().fast_max(F32x8::splat(1e-4));
    let off = (away - radius_m) * (1.0 / 0.006);
    let falls = unit(word * 0x27d4_eb2fu32).simd_lt(around.rain);
    let damped = 1.0 / (off * off + 1.0);
    let slope = falls.select(off * damped * damped * 0.4, F32x8::ZERO) / away;
    [slope * dx, slope * dy]
}

#[inline]
pub(super) fn asphalt(
    (noise, textures): (&Noise, &Textures),
    around: &Surroundings,
    facet: &ShadedTriangle<'_>,
    p: &Points,
) -> BrdfSample {
    let rgb = Vec3::from_array(facet.part.rgb);
    let (stones, wear) = (laid(&textures.asphalt, p), laid(&textures.wear, p));
    // Some stretches are older than others.
    let age = ground_noise(noise, p, 2.0);
    let worn = (wear.shade - 1.0) * (age * 1.6 + 0.2) + 1.0;
    let mut shade = stones.shade * worn * (age * 0.24 + 0.88);
    if let Some(lane) = &facet.lane {
        // Tyres polish two tracks; oil drips between them.
        let off_m = lane.off_middle_m(&p.object_m);
        let bump = |middle: f32, half: f32| {
            let t = ((off_m - middle) * (1.0 / half)).abs().fast_min(F32x8::ONE);
            1.0 - t * t * (3.0 - 2.0 * t)
        };
        shade *= bump(0.82, 0.45) * 0.13 - bump(0.0, 0.5) * (age * 0.3 + 0.02) + 0.99;
    }
    let mut albedo = shades(rgb, shade);
    let mut lean = stones.lean;
    if facet.part.tag == Tag::Road
        && let Some((iron, frame)) = manhole(p)
    {
        albedo = albedo.lerp(shades(Vec3::new(0.062, 0.058, 0.054), stones.shade * frame), iron);
        lean = lean.map(|v| v * (1.0 - iron));
    }
    if let Some(kerbed) = &facet.kerbed {
        albedo = gutter::soiled(kerbed, noise, p, albedo, &stones.shade);
    }
    wet(noise, around, BrdfSample::leaning(albedo, lean), p, 1.0)
}

/// Shares that are iron and its brightness; none where there is no manhole near.
#[inline]
fn manhole(p: &Points) -> Option<(F32x8, F32x8)> {
    // Not at the edges of its square.
    let (word, [dx, dy]) = in_cell(p, MANHOLE_CELL_M, 77, 0.1 * MANHOLE_CELL_M);
    let away = (dx * dx + dy * dy).sqrt();
    let w = p.footprint_m;
    let near = away.simd_lt(w * 0.5 + FRAME_M) & unit(word * 0xc2b2_ae35u32).simd_lt(MANHOLE_SHARE);
    if near.none() {
        return None;
    }
    let disc = |radius: f32| {
        ((radius - away) / w.fast_max(F32x8::splat(0.004)) + 0.5).fast_clamp(F32x8::ZERO, F32x8::ONE)
    };
    let iron = near.select(disc(FRAME_M), F32x8::ZERO);
    let gap = disc(LID_M + 0.012) - disc(LID_M - 0.006);
    let width = Width::new(w * 12.0);
    let studs = bars(dx * 12.0, 0.5, width) + bars(dy * 12.0, 0.5, width);
    Some((iron, (studs * 0.35 + 0.75) * (1.0 - gap * 0.7)))
}

#[inline]
pub(super) fn marking(
    (noise, textures): (&Noise, &Textures),
    around: &Surroundings,
    rgb: Vec3,
    p: &Points,
) -> BrdfSample {
    let (stones, wear) = (laid(&textures.asphalt, p), laid(&textures.wear, p));
    let rubbed = ground_noise(noise, p, 32.0);
    // Paint goes first where stones stand out, and where tar was poured over it.
    // Some stretches were painted lately, others long ago.
    let old = smoothstep(0.45, 0.8, ground_noise(noise, p, 0.5)) * 0.28;
    let kept = smoothstep(0.1, 0.45, rubbed - (stones.shade - 1.0) * 0.15 - old) * 0.7 + 0.3;
    let kept = kept * (1.0 - wear.tint.fast_max(F32x8::ZERO) * 0.8);
    let dirt = wear.shade * 0.5 + 0.5;
    let albedo = shades(rgb, kept * dirt) + shades(Vec3::splat(0.07), (1.0 - kept) * stones.shade);
    wet(noise, around, BrdfSample::leaning(albedo, stones.lean.map(|v| v * 0.6)), p, 0.6)
}

#[inline]
pub(super) fn grass((noise, textures): (&Noise, &Textures), rgb: Vec3, p: &Points) -> BrdfSample {
    let blades = laid(&textures.grass, p);
    let (tufts, meadow) = (ground_noise(noise, p, 4.0), ground_noise(noise, p, 2.0));
    // Over tens of metres one lawn is lush and the next one dry; over some metres it is mown and worn
    // unevenly.
    let (broad, worn) = (ground_noise(noise, p, 0.06), ground_noise(noise, p, 0.35));
    // Dry patches are yellower; where it is driest, soil shows.
    let dry = meadow * 0.5 + tufts * 0.22 + worn * 0.28;
    let tint = Vec3x8::new(
        dry * 0.6 + 0.68 + blades.tint * 0.5 + broad * 0.7,
        dry * 0.12 + 0.80 + blades.tint * 0.12 + broad * 0.16,
        dry * 0.35 + 1.02 + broad * 0.55,
    ) * (worn * 0.56 + 0.68);
    let green = shades(rgb, blades.shade * (tufts * 0.5 + 0.75)) * tint;
    let bare = smoothstep(0.70, 0.84, dry) * 0.7;
    let soil = shades(Vec3::new(0.15, 0.11, 0.07), blades.shade * 0.4 + 0.6);
    BrdfSample::leaning(green.lerp(soil, bare), blades.lean)
}
