//! Procedural looks of the kinds of surface, eight points of one triangle at a time.
//!
//! Patterns are anchored to the world (ground) or to the object (everything else), never to the camera.

use crate::textures::{Noise, Texture, Textures};
use glam::Vec3;
use schema::geometry::{Paving, Surface};
use schema::mesh_textures::PbrFactors;
use schema::{Tag, lights};
use simd::{F32x8, Vec3x8};

use super::cloth::clothes;
use super::dirt;
use super::facade::facade;
use super::foliage::foliage;
use super::ground;
use super::pattern::{PatternSet, Width, bars};
use super::paving;
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle, Specular, Surroundings, shades};
use super::uv_surface::UvSurface;

/// Film value of lenses that shine white: brighter than any paint, whatever the exposure.
const WHITE_LENS: f32 = 6.0;

/// The look of eight points.
#[inline]
pub(crate) fn sample(
    patterns: PatternSet,
    around: &Surroundings,
    facet: &ShadedTriangle<'_>,
    p: &Points,
) -> BrdfSample {
    let rgb = Vec3::from_array(facet.part.rgb);
    let PatternSet { noise, textures } = patterns;
    let both = (noise, textures);
    match facet.part.surface {
        Surface::Plain => BrdfSample::dull(shades(rgb, speckle(noise, p, 0.08))),
        Surface::Cloth => BrdfSample::dull(shades(rgb, speckle(noise, p, 0.2))),
        Surface::Clothes(weave) => clothes(noise, weave, facet, rgb, p),
        // By day it is smooth plastic; what it sends back to a lamp is light of lamps.
        Surface::Reflector => {
            let painted = facet.uv_surface.as_ref().and_then(|uv_surface| uv_surface.colour(p));
            BrdfSample::glossy(painted.unwrap_or(Vec3x8::splat(rgb)), 0.04, 0.3)
        }
        Surface::Rubber => BrdfSample::glossy(Vec3x8::splat(rgb), 0.03, 0.7),
        Surface::Paint => dirt::painted(noise, facet, p),
        Surface::Glass | Surface::Window => {
            BrdfSample::glossy(Vec3x8::splat(rgb.min(Vec3::splat(0.06))), 0.06, 0.02)
        }
        Surface::Opening => BrdfSample::dull(Vec3x8::splat(rgb)),
        Surface::Metal if facet.part.tag == Tag::Building => sheeting(noise, facet, rgb, p),
        Surface::Metal => BrdfSample::glossy(shades(rgb * 0.75, speckle(noise, p, 0.1)), 0.15, 0.45),
        Surface::Textured(factors) => textured(factors, rgb, facet.uv_surface.as_ref(), p),
        Surface::Asphalt | Surface::KerbedAsphalt(_) => ground::asphalt(both, around, facet, p),
        Surface::RoadMarking => ground::marking(both, around, rgb, p),
        Surface::Paving(paving) => paving::paving(both, around, facet, paving, p),
        Surface::Concrete if facet.is_ground() && facet.part.tag != Tag::Building => {
            paving::paving(both, around, facet, Paving::Slabs, p)
        }
        Surface::Concrete => cast(both, facet, rgb, p),
        Surface::Grass => ground::grass(both, rgb, p),
        Surface::Gravel => upright(&textures.gravel, facet, rgb, p),
        Surface::RoofTiles => upright(&textures.roof, facet, rgb, p),
        Surface::Foliage => foliage(patterns, &Vec3x8::splat(facet.normal_object), &Vec3x8::splat(rgb), p),
        Surface::Wood if facet.part.tag == Tag::Vegetation => bark(&textures.bark, facet, rgb, p),
        Surface::Wood => {
            let o = &p.object_m;
            let grain = noise.at_all((o.x + o.y) * 120.0, o.z * 18.0, p.footprint_m * 120.0);
            BrdfSample::dull(shades(rgb, grain * 0.7 + 0.65))
        }
        Surface::Facade(_) => match &facet.front {
            Some(front) => facade(both, facet, front, p),
            // Its flat top.
            None => upright(&textures.gravel, facet, rgb * 0.4, p),
        },
        Surface::Lamp(bits) => {
            if facet.lights & bits != 0 {
                let has_glow = bits == lights::STREET_LAMP || bits == lights::WORK_LAMP;
                let is_white = has_glow || bits & (lights::LOW_BEAM | lights::HIGH_BEAM) != 0;
                let emission = if has_glow { rgb * facet.glow } else { rgb };
                let emission = emission * if is_white { WHITE_LENS } else { 1.6 };
                BrdfSample {
                    emission: Some(Vec3x8::splat(emission)),
                    ..BrdfSample::dull(Vec3x8::splat(rgb * 0.3))
                }
            } else {
                // A lens that does not burn: its colour, deep and glossy.
                BrdfSample::glossy(Vec3x8::splat(rgb * 0.35), 0.05, 0.1)
            }
        }
    }
}

/// How a finish sends light back, as pictures say where it has some: plastic mirrors a twenty-fifth, metal
/// more and scatters less (as `Surface::Metal` does).
fn textured(factors: PbrFactors, rgb: Vec3, uv_surface: Option<&UvSurface<'_>>, p: &Points) -> BrdfSample {
    let rgb = uv_surface.and_then(|uv_surface| uv_surface.colour(p)).unwrap_or(Vec3x8::splat(rgb));
    let even = [factors.roughness, factors.metallic].map(F32x8::splat);
    let [roughness, metallic] = uv_surface.and_then(|uv_surface| uv_surface.specular(p)).unwrap_or(even);
    // What is as rough as can be mirrors nothing that would be seen.
    let shows = roughness.simd_lt(0.95) | metallic.simd_gt(0.0);
    let mirror = shows.select(metallic * 0.16 + 0.04, F32x8::ZERO);
    let specular = Specular { mirror, roughness: roughness.fast_max(F32x8::splat(0.02)) };
    BrdfSample {
        albedo: rgb * (1.0 - metallic * 0.25),
        lean: uv_surface.and_then(|uv_surface| uv_surface.lean(p)),
        emission: uv_surface.and_then(|uv_surface| uv_surface.glow(p)),
        specular: shows.any().then_some(specular),
    }
}

/// Slight unevenness: 1 on average, `strength` from end to end.
#[inline]
fn speckle(noise: &Noise, p: &Points, strength: f32) -> F32x8 {
    let o = &p.object_m;
    let value = noise.at_all((o.x + o.z * 0.37) * 40.0, (o.y + o.z * 0.61) * 40.0, p.footprint_m * 40.0);
    (value - 0.5) * strength + 1.0
}

/// Places on an upright or sloping surface: to the right and up along it, metres.
#[inline]
fn unrolled(facet: &ShadedTriangle<'_>, p: &Points) -> [F32x8; 2] {
    let o = &p.object_m;
    facet.tangents_object.map(|axis| o.x * axis.x + o.y * axis.y + o.z * axis.z)
}

/// Sheets with upright ribs, four a metre, stained by rain.
#[inline]
fn sheeting(noise: &Noise, facet: &ShadedTriangle<'_>, rgb: Vec3, p: &Points) -> BrdfSample {
    let [x, y] = unrolled(facet, p);
    let stains = noise.at_all(x * 8.0, y * 1.6, p.footprint_m * 8.0);
    // Up one flank of a rib and down the other, even between them.
    let turn = x * 4.0 - (x * 4.0).floor() - 0.5;
    let flank = turn.abs().simd_gt(0.1) & turn.abs().simd_lt(0.25);
    let slope = turn.simd_gt(0.0).select(F32x8::splat(0.6), F32x8::splat(-0.6));
    let w = p.footprint_m * 12.0;
    let lean = flank.select(slope, F32x8::ZERO) / (w * w + 1.0);
    let even = BrdfSample::glossy(shades(rgb * 0.75, stains * 0.3 + 0.85), 0.1, 0.5);
    BrdfSample { lean: Some([lean, F32x8::ZERO]), ..even }
}

/// A texture that lies on an object's faces.
#[inline]
fn upright(texture: &Texture, facet: &ShadedTriangle<'_>, rgb: Vec3, p: &Points) -> BrdfSample {
    let [x, y] = unrolled(facet, p);
    let seen = texture.at(x, y, p.footprint_m);
    BrdfSample::leaning(shades(rgb, seen.shade), seen.lean)
}

/// Bark. All sides of a stem lie around the same axis: each shows another strip of the texture, so that none
/// repeats beside itself.
#[inline]
fn bark(texture: &Texture, facet: &ShadedTriangle<'_>, rgb: Vec3, p: &Points) -> BrdfSample {
    let [x, y] = unrolled(facet, p);
    // Pieces of a side that bends a little are still one side.
    let side = (facet.normal_object * 3.0).round();
    let seen = texture.at(x + (0.37 * side.x + 0.23 * side.y), y, p.footprint_m);
    BrdfSample::leaning(shades(rgb, seen.shade), seen.lean)
}

/// Cast concrete: walls, kerbs, decks.
#[inline]
fn cast(
    (noise, textures): (&Noise, &Textures),
    facet: &ShadedTriangle<'_>,
    rgb: Vec3,
    p: &Points,
) -> BrdfSample {
    // Pieces of the ground go on from block to block of the world.
    let is_kerb = matches!(facet.part.tag, Tag::Sidewalk | Tag::Ground);
    let [x, y] = if let Some(laid) = &facet.laid {
        // Kerbs go on from piece to piece of a bend.
        [laid.places(&p.object_m)[0], p.world_m.z]
    } else if is_kerb {
        // Along the axis that it runs along most: so no piece of a bend begins anew, and what repeats meets
        // itself.
        let right = facet.tangents_local()[0].abs();
        [if right.x > right.y { p.world_m.x } else { p.world_m.y }, p.world_m.z]
    } else {
        unrolled(facet, p)
    };
    let seen = textures.concrete.at(x, y, p.footprint_m);
    let stains = noise.at_all(x * 6.0, y * 2.0, p.footprint_m * 6.0);
    let mut shade = seen.shade * (stains * 0.3 + 0.85);
    if is_kerb {
        // Stones of a metre.
        shade *= 1.0 - bars(x, 0.012, Width::new(p.footprint_m)) * 0.5;
    }
    BrdfSample::leaning(shades(rgb, shade), seen.lean)
}
