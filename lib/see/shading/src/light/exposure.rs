//! How a film is exposed, and what white is on it: by a rule on the light around an agent, never by the
//! picture itself.

use frames::math::f32::pow;
use glam::Vec3;

use super::math::luminance;

/// Light that film is made for where neither sky nor lamps give any, kilolux.
const DARK_KLX: f32 = 0.002;
/// Daylight, and what a lit street has at most, kilolux: by which power of the light things are darker on
/// film below each.
const DARKENS: [(f32, f32); 2] = [(100.0, 0.04), (0.1, 0.35)];
/// Electrons in a full pixel, as chips of 3 micrometres have.
const FULL_WELL: f32 = 9000.0;
/// Above this exposure, that of a dull day, pixels are not full any more.
const FULL_WELL_EXPOSURE: f32 = 0.5;
/// As few electrons are white by night.
const LEAST_ELECTRONS: f32 = 1200.0;
/// Light farther from white than this, as a factor, is taken for part of the view: twilight stays red.
const MOST_TINTED: f32 = 1.8;

/// The exposure of an agent's pictures at a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposure {
    /// Film value per radiance (kcd/m2) at f/1.8.
    per_radiance: f32,
    /// The light that things stand in, kilolux.
    illuminant: Vec3,
}

impl Exposure {
    /// For things in the sky's light (the sun's on upright surfaces included) and in that of lamps,
    /// kilolux. A grey of 18 % in it comes out as middle grey; the dark stays a little darker than the day.
    pub(super) fn new(sky_klx: Vec3, lamps_klx: Vec3) -> Self {
        let illuminant = sky_klx + lamps_klx;
        let adapted = luminance(illuminant) + DARK_KLX;
        let darkness = DARKENS.map(|(klx, power)| pow((adapted / klx).min(1.0), power));
        Self { per_radiance: 3.7 * darkness[0] * darkness[1] / adapted, illuminant }
    }

    /// Film value per radiance through an aperture.
    pub(crate) fn per_radiance(&self, f_stop: f64) -> f32 {
        let opening = 1.8 / f_stop.clamp(0.5, 64.0);
        self.per_radiance * (opening * opening) as f32
    }

    /// Electrons that a pixel of film value 1 gathers: all that it has room for by day; in little light, what
    /// a long exposure gives.
    pub(crate) fn electrons(&self) -> u32 {
        (FULL_WELL * FULL_WELL_EXPOSURE / self.per_radiance).clamp(LEAST_ELECTRONS, FULL_WELL) as u32
    }

    /// What red, green and blue are multiplied by: at strength 1 a white thing is white, at 0 it has the
    /// light's own colour. Its luminance stays.
    pub(crate) fn balance(&self, strength: f64) -> Vec3 {
        let level = luminance(self.illuminant);
        if level <= 0.0 {
            return Vec3::ONE;
        }
        let gain = |v: f32| pow((level / v.max(1e-9)).clamp(1.0 / MOST_TINTED, MOST_TINTED), strength as f32);
        let gains = Vec3::from_array(self.illuminant.to_array().map(gain));
        gains * (level / luminance(self.illuminant * gains))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_comes_out_alike_in_any_light() {
        for klx in [0.2f32, 1.0, 20.0, 100.0] {
            let exposure = Exposure::new(Vec3::splat(klx), Vec3::ZERO);
            let grey = 0.18 * klx / std::f32::consts::PI * exposure.per_radiance(1.8);
            assert!((0.10..0.22).contains(&grey), "{klx}: {grey}");
            assert!((exposure.per_radiance(3.6) * 4.0 / exposure.per_radiance(1.8) - 1.0).abs() < 1e-5);
        }
        let lit = Exposure::new(Vec3::splat(0.001), Vec3::splat(0.02));
        assert!(
            lit.per_radiance(1.8) < 0.3 * Exposure::new(Vec3::splat(0.001), Vec3::ZERO).per_radiance(1.8)
        );
    }

    #[test]
    fn white_is_as_white_as_asked_for() {
        let evening = Vec3::new(26.0, 20.0, 13.0);
        let exposure = Exposure::new(evening, Vec3::ZERO);
        let seen = |strength| evening * exposure.balance(strength);
        let spread = |v: Vec3| v.max_element() / v.min_element();
        assert!((spread(seen(1.0)) - 1.0).abs() < 1e-4 && (spread(seen(0.0)) - 2.0).abs() < 1e-4);
        assert!((spread(seen(0.5)) - frames::math::f32::pow(2.0, 0.5)).abs() < 1e-3);
        for strength in [0.0, 0.3, 1.0] {
            assert!((luminance(seen(strength)) / luminance(evening) - 1.0).abs() < 1e-5);
        }
    }
}
