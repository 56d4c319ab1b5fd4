//! What sidewalks are paved with.

use crate::textures::{Noise, Texels, Textures};
use glam::Vec3;
use schema::geometry::Paving;
use simd::{F32x8, Vec3x8};

use super::ground::{ground_noise, wet};
use super::pattern::{Width, bars};
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle, Surroundings, shades};

/// Stones along the kerb are so wide, and a metre long, metres.
const BORDER_M: f32 = 0.18;
/// Half a joint, metres.
const JOINT_M: f32 = 0.006;
/// Border stones, linear RGB.
const BORDER: Vec3 = Vec3::new(0.36, 0.355, 0.34);

/// Paving, along its sidewalk; by the plan of the world where that is not known.
#[inline]
pub(super) fn paving(
    (noise, textures): (&Noise, &Textures),
    around: &Surroundings,
    facet: &ShadedTriangle<'_>,
    paving: Paving,
    p: &Points,
) -> BrdfSample {
    let rgb = Vec3::from_array(facet.part.rgb);
    let w = p.footprint_m;
    let places = facet.laid.as_ref().map(|laid| laid.places(&p.object_m));
    let [along, away] = places.unwrap_or([p.world_m.x, p.world_m.y]);
    let texture = match paving {
        Paving::Slabs => &textures.slabs,
        Paving::Tiles => &textures.tiles,
        Paving::Setts => &textures.setts,
        Paving::Cast => &textures.concrete,
        Paving::Asphalt => &textures.asphalt,
    };
    let mut seen = texture.at(along, away, w);
    if paving == Paving::Cast {
        seen.shade *= 1.0 - bars(along * 0.5 + 0.25, 0.006, Width::new(w * 0.5)) * 0.55;
    }
    let stains = ground_noise(noise, p, 4.0);
    // Dirt in the joints is browner than the stone.
    let dirt = Vec3x8::new(1.0 - seen.tint * 0.05, 1.0 - seen.tint * 0.12, 1.0 - seen.tint * 0.25);
    let mut albedo = shades(rgb, seen.shade * (stains * 0.3 + 0.85)) * dirt;
    if places.is_some() && away.simd_lt(w + BORDER_M).any() {
        let stones = border(textures, [along, away], w);
        let shade = stones.seen.shade * (stains * 0.2 + 0.9);
        albedo = albedo.lerp(shades(BORDER, shade), stones.share);
        for k in 0..2 {
            seen.lean[k] += (stones.seen.lean[k] - seen.lean[k]) * stones.share;
        }
    }
    let lean = facet.laid.as_ref().map_or(seen.lean, |laid| laid.lean(seen.lean));
    wet(noise, around, BrdfSample::leaning(albedo, lean), p, 0.5)
}

/// Border stones: which share of points they are, and what is seen of them.
struct Border {
    share: F32x8,
    seen: Texels,
}

#[inline]
fn border(textures: &Textures, [along, away]: [F32x8; 2], w: F32x8) -> Border {
    let wide = w.fast_max(F32x8::splat(0.004));
    let within = |inside_m: F32x8| (inside_m / wide + 0.5).fast_clamp(F32x8::ZERO, F32x8::ONE);
    let share = within(BORDER_M - away);
    let mut seen = textures.concrete.at(along, away, w);
    let across = bars(along + JOINT_M, 2.0 * JOINT_M, Width::new(w));
    let behind =
        within(JOINT_M - (away - BORDER_M + JOINT_M).abs()) * (2.0 * JOINT_M / wide).fast_min(F32x8::ONE);
    seen.shade *= 1.0 - across.fast_max(behind) * 0.5;
    Border { share, seen }
}
