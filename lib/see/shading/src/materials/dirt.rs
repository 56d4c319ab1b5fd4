//! Road dirt on the paint of vehicles: splashed up the flanks and over the tail, a film of dust on what lies
//! level.

use crate::textures::{Noise, hash2, unit};
use glam::Vec3;
use schema::{ObjectId, Tag};
use simd::{F32x8, Vec3x8, smoothstep};

use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle, Specular};

/// What dries on paint: dust of roads, linear RGB.
const DUST: Vec3 = Vec3::new(0.115, 0.098, 0.080);
/// Splashes reach from the sill up to here, metres above the road; those at the tail farther.
const SPLASHED_M: [f32; 2] = [0.18, 0.95];
/// See [`SPLASHED_M`].
const TAIL_M: f32 = 1.5;
/// So many vehicles have been washed lately.
const WASHED: f32 = 0.3;

/// How dirty a vehicle is, 0 to 1: 0 for those that were washed lately, a third on average for the others.
pub(super) fn amount(object: ObjectId) -> f32 {
    let drawn = (unit(hash2(i32::from(object), 0x2545, 0x9e37_79b9)) - WASHED) / (1.0 - WASHED);
    drawn.max(0.0) * drawn.max(0.0)
}

/// The look of paint on which dirt may lie.
#[inline]
pub(super) fn painted(noise: &Noise, facet: &ShadedTriangle<'_>, p: &Points) -> BrdfSample {
    let clean = BrdfSample::glossy(Vec3x8::splat(facet.paint), MIRROR, SMOOTH);
    let amount = match facet.part.tag {
        Tag::Car | Tag::Truck | Tag::Bus => amount(facet.object),
        _ => 0.0,
    };
    if amount == 0.0 {
        return clean;
    }
    let (o, n) = (&p.object_m, facet.normal_object);
    // Each vehicle has patterns of its own.
    let shift = f32::from(facet.object) * 3.7;
    let along = o.x * n.y.abs() + o.y * n.x.abs() + shift;
    let clouds = noise.at_all(along * 2.6, o.z * 3.1, p.footprint_m * 3.0);
    let specks = noise.at_all(along * 31.0, o.z * 27.0, p.footprint_m * 31.0);
    let top_m = if n.x < -0.5 { TAIL_M } else { SPLASHED_M[1] };
    let low = 1.0 - smoothstep(SPLASHED_M[0], top_m, o.z + (clouds - 0.5) * 0.35);
    let splashed = low * (clouds * 0.5 + specks * 0.5 + 0.35);
    let film = 0.22 * n.z.max(0.0) + 0.06;
    let cover = ((splashed + film * (clouds + 0.5)) * amount).fast_clamp(F32x8::ZERO, F32x8::splat(0.85));
    let albedo = Vec3x8::splat(facet.paint).lerp(Vec3x8::splat(DUST), cover);
    let specular = Specular { mirror: (1.0 - cover) * MIRROR, roughness: cover * 0.5 + SMOOTH };
    BrdfSample { albedo, specular: Some(specular), ..BrdfSample::default() }
}

/// How clear coat mirrors.
const MIRROR: f32 = 0.045;
/// See [`MIRROR`].
const SMOOTH: f32 = 0.06;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_are_clean_and_most_a_little_dirty() {
        let amounts: Vec<f32> = (1..4000).map(amount).collect();
        let clean = amounts.iter().filter(|a| **a == 0.0).count() as f32 / 3999.0;
        let mean = amounts.iter().sum::<f32>() / (1.0 - clean) / 3999.0;
        assert!((clean - WASHED).abs() < 0.03, "{clean}");
        // The mean of a square of what is drawn evenly.
        assert!((mean - 1.0 / 3.0).abs() < 0.02, "{mean}");
        assert!(amounts.iter().all(|a| (0.0..=1.0).contains(a)));
    }
}
