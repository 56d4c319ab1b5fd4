//! Clothes: how they are woven, and their folds.

use crate::textures::Noise;
use glam::Vec3;
use schema::geometry::Weave;
use simd::{F32x8, Vec3x8};

use super::pattern::{Width, bars};
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle};

/// Folds are this fine: texels of noise a metre, whose largest features are a hand wide.
const TEXELS_PER_M: f32 = 330.0;
/// They are told by how much the noise rises over so many texels, times this.
const OVER_TEXELS: f32 = 9.0;
/// See [`OVER_TEXELS`].
const STEEPNESS: f32 = 0.75;
/// How far the noise is slanted down a limb: folds hang, and run askew; they never go around like hoops.
const SLANT: f32 = 0.38;
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
            let rib = bars((o.x + o.y) * 110.0, 0.5, Width::new(w * 110.0));
            even * (grain * 0.25 + rib * 0.14 + 0.93)
        }
        Weave::Stripes => {
            let light = bars(o.z * 34.0, 0.30, Width::new(w * 34.0)) * 0.8;
            even.lerp(Vec3x8::splat(second(rgb)), light) * (grain * 0.2 + 1.0)
        }
        // Darker where bands cross. Upright ones go along what the cloth runs along most.
        Weave::Checks => {
            let n = facet.normal_object.abs();
            let across = if n.x > n.y { o.y } else { o.x };
            let [upright, around] = [across, o.z].map(|v| bars(v * 17.0, 0.30, Width::new(w * 17.0)));
            even.lerp(Vec3x8::splat(second(rgb)), (upright + around) * 0.34) * (grain * 0.2 + 1.0)
        }
    };
    let widths = w.as_array();
    if widths[0].min(widths[7]) >= GONE_M {
        return BrdfSample::dull(albedo);
    }
    let [x, y, z] = folds(noise, p);
    BrdfSample::leaning(albedo, facet.tangents_object.map(|axis| x * axis.x + y * axis.y + z * axis.z))
}

/// The other colour of two.
fn second(rgb: Vec3) -> Vec3 {
    let is_light = rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722)) > 0.25;
    rgb.lerp(if is_light { DARK } else { LIGHT }, 0.7)
}

/// How much clothes lean along the axes of the limb: the slope of noise that is drawn out down the limb and
/// askew, so that it shades softly and has no line in common with its neighbour; it fades to nothing where a
/// pixel is wide.
#[inline]
fn folds(noise: &Noise, p: &Points) -> [F32x8; 3] {
    let (o, w) = (&p.object_m, p.footprint_m);
    let blur = w * (1.0 / GONE_M);
    let near = (1.0 - blur * blur).fast_max(F32x8::ZERO);
    let (u, v) = ((o.x + o.z * SLANT) * TEXELS_PER_M, (o.y - o.z * SLANT) * TEXELS_PER_M + 91.0);
    let at = |du: f32, dv: f32| noise.at_all(u + du, v + dv, F32x8::ZERO);
    let here = at(0.0, 0.0);
    let along_x = (at(OVER_TEXELS, 0.0) - here) * near * STEEPNESS;
    let along_y = (at(0.0, OVER_TEXELS) - here) * near * STEEPNESS;
    [along_x, along_y, (along_x - along_y) * SLANT]
}

#[cfg(test)]
mod tests {
    use simd::STEPS;

    use super::*;

    /// How much clothes lean downward, over a cylinder as thick as a leg: by height, and around it.
    fn leans(footprint_m: f32) -> Vec<Vec<f32>> {
        let noise = Noise::get();
        let around = |z: f32| {
            let ring = (0..8).flat_map(|i| {
                let angle = (STEPS + (8 * i) as f32) * (std::f32::consts::TAU / 64.0);
                let (s, c) = simd_sin_cos(angle);
                let object_m = Vec3x8::new(c * 0.07, s * 0.07, F32x8::splat(z));
                let p = Points { object_m, world_m: object_m, footprint_m: F32x8::splat(footprint_m) };
                folds(noise, &p)[2].to_array()
            });
            ring.collect()
        };
        (0..160).map(|k| around(k as f32 * 0.005)).collect()
    }

    fn simd_sin_cos(angle: F32x8) -> (F32x8, F32x8) {
        let both = angle.to_array().map(frames::math::f32::sin_cos);
        (both.map(|b| b.0).into(), both.map(|b| b.1).into())
    }

    #[test]
    fn folds_lean_both_ways_and_fade_from_afar() {
        let near: Vec<f32> = leans(0.001).into_iter().flatten().collect();
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        let most = near.iter().fold(0.0_f32, |m, v| m.max(v.abs()));
        assert!(mean.abs() < 0.06 && most > 0.1 && most <= 0.6, "{mean} {most}");
        assert!(leans(GONE_M).iter().flatten().all(|v| *v == 0.0));
    }

    #[test]
    fn folds_are_no_hoops() {
        // Were they, all places of one height would lean the same way: the means of rings would differ as
        // much as single places do.
        let rings = leans(0.001);
        let spread = |values: &[f32]| {
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>() / values.len() as f32).sqrt()
        };
        let all: Vec<f32> = rings.iter().flatten().copied().collect();
        let means: Vec<f32> = rings.iter().map(|ring| ring.iter().sum::<f32>() / ring.len() as f32).collect();
        assert!(spread(&means) < 0.7 * spread(&all), "{} of {}", spread(&means), spread(&all));
    }

    #[test]
    fn the_second_colour_stands_out() {
        for rgb in [Vec3::splat(0.02), Vec3::splat(0.6), Vec3::new(0.3, 0.06, 0.06)] {
            assert!((second(rgb) - rgb).length() > 0.2, "{rgb}");
        }
    }
}
