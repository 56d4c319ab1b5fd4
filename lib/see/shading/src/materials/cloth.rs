//! Clothes: how they are woven, and their folds.

use crate::textures::Noise;
use glam::Vec3;
use schema::geometry::Weave;
use simd::{F32x8, Vec3x8};

use super::pattern::{Width, bars};
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle};

/// Folds a metre, where there are some.
const FOLDS_PER_M: f32 = 12.0;
/// One goes from fold to fold along this.
const ALONG_OBJECT: Vec3 = Vec3::new(0.3, 0.3, 1.0);
/// How steep the flanks of the deepest folds are.
const STEEPNESS: f32 = 0.6;
/// Pixels as wide as this see no folds, metres.
const GONE_M: f32 = 0.03;
/// The second colour of what is striped is this, seven tenths: light on dark clothes, dark on light ones.
const LIGHT: Vec3 = Vec3::new(0.62, 0.60, 0.56);
/// See [`LIGHT`].
const DARK: Vec3 = Vec3::new(0.03, 0.035, 0.05);

/// The look of clothes. What is woven lies along the axes of the limb.
#[inline]
pub(super) fn clothes(
    noise: &Noise,
    weave: Weave,
    facet: &ShadedTriangle<'_>,
    rgb: Vec3,
    p: &Points,
) -> BrdfSample {
    let (o, w) = (&p.object_m, p.footprint_m);
    let grain = noise.at_all((o.x + o.z * 0.37) * 90.0, (o.y + o.z * 0.61) * 90.0, w * 90.0) - 0.5;
    let even = Vec3x8::splat(rgb);
    let albedo = match weave {
        Weave::Plain => even * (grain * 0.2 + 1.0),
        // Worn lighter where it is rubbed.
        Weave::Denim => {
            let worn = noise.at_all((o.x + o.y) * 22.0, o.z * 14.0, w * 22.0) - 0.5;
            even * (grain * 0.45 + worn * 0.5 + 1.0)
        }
        Weave::Knit => {
            let rib = bars(o.z * 90.0, 0.5, Width::new(w * 90.0));
            even * (grain * 0.25 + rib * 0.22 + 0.89)
        }
        Weave::Stripes => {
            let light = bars(o.z * 14.0, 0.42, Width::new(w * 14.0));
            even.lerp(Vec3x8::splat(second(rgb)), light) * (grain * 0.2 + 1.0)
        }
        // Darker where bands cross. Upright ones go along what the cloth runs along most.
        Weave::Checks => {
            let n = facet.normal_object.abs();
            let across = if n.x > n.y { o.y } else { o.x };
            let [upright, around] = [across, o.z].map(|v| bars(v * 11.0, 0.38, Width::new(w * 11.0)));
            even.lerp(Vec3x8::splat(second(rgb)), (upright + around) * 0.5) * (grain * 0.2 + 1.0)
        }
    };
    let widths = w.as_array();
    if widths[0].min(widths[7]) >= GONE_M {
        return BrdfSample::dull(albedo);
    }
    let slope = folds(noise, p);
    BrdfSample::leaning(albedo, facet.tangents_object.map(|axis| slope * ALONG_OBJECT.dot(axis)))
}

/// The other colour of two.
fn second(rgb: Vec3) -> Vec3 {
    let is_light = rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722)) > 0.25;
    rgb.lerp(if is_light { DARK } else { LIGHT }, 0.7)
}

/// How much clothes lean along [`ALONG_OBJECT`]: folds that run around limbs, askew, and come and go;
/// they fade to nothing where a pixel is wide.
#[inline]
fn folds(noise: &Noise, p: &Points) -> F32x8 {
    let (o, w) = (&p.object_m, p.footprint_m);
    let bend = noise.at_all((o.x - o.y) * 17.0, o.z * 13.0, w * 17.0);
    let depth = noise.at_all((o.x + o.y) * 34.0 + 91.0, o.z * 30.0, w * 34.0);
    let along = o.x * ALONG_OBJECT.x + o.y * ALONG_OBJECT.y + o.z * ALONG_OBJECT.z;
    let turn = along * FOLDS_PER_M + bend * 5.0;
    // The slope of a wave of parabolas: up to 1 on one flank, down to -1 on the other.
    let within = turn - turn.floor();
    let slope = (within - 0.5).abs() * 4.0 - 1.0;
    let deep = (depth - 0.42).fast_clamp(F32x8::ZERO, F32x8::splat(0.35)) * (STEEPNESS / 0.35);
    let blur = w * (1.0 / GONE_M);
    slope * deep * (1.0 - blur * blur).fast_max(F32x8::ZERO)
}

#[cfg(test)]
mod tests {
    use simd::STEPS;

    use super::*;

    fn along_limb(footprint_m: f32) -> impl Iterator<Item = Points> {
        (0..200).map(move |i| {
            let z = (STEPS + (8 * i) as f32) * 0.002;
            let object_m = Vec3x8::new(F32x8::splat(0.07), F32x8::splat(0.02), z);
            Points { object_m, world_m: object_m, footprint_m: F32x8::splat(footprint_m) }
        })
    }

    #[test]
    fn folds_lean_both_ways_and_fade_from_afar() {
        let noise = Noise::get();
        let leans =
            |w: f32| -> Vec<f32> { along_limb(w).flat_map(|p| folds(noise, &p).to_array()).collect() };
        let near = leans(0.001);
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        let most = near.iter().fold(0.0_f32, |m, v| m.max(v.abs()));
        assert!(mean.abs() < 0.06 && most > 0.2 && most <= STEEPNESS, "{mean} {most}");
        assert!(leans(GONE_M).iter().all(|v| *v == 0.0));
    }

    #[test]
    fn the_second_colour_stands_out() {
        for rgb in [Vec3::splat(0.02), Vec3::splat(0.6), Vec3::new(0.3, 0.06, 0.06)] {
            assert!((second(rgb) - rgb).length() > 0.2, "{rgb}");
        }
    }
}
