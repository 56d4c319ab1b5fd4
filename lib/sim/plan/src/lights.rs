//! What becomes of the lights of a town in a dark scene.

use random::Stream;
use schema::lights::STREET_LAMP_LM;
use settings::LightSettings;

/// The lights of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lights {
    /// Added to the flux of every street lamp, lumens.
    pub(crate) change_lm: f64,
    /// Each building has windows of a random colour.
    pub(crate) random_colors: bool,
}

/// Draws what happens to the lights; nothing does where it is never dark.
///
/// The common change of all street lamps is uniform within their mean flux, which is the nominal one: every
/// scene starts from it anew. `high_ground`: the map lies high above its zero level; its buildings keep their
/// colour.
pub(crate) fn plan_lights(
    settings: &LightSettings,
    is_ever_dark: bool,
    high_ground: bool,
    stream: &mut Stream,
) -> Lights {
    let drawn = stream.uniform(-STREET_LAMP_LM, STREET_LAMP_LM);
    let change_lm = if is_ever_dark && settings.change_intensity {
        settings.intensity_change_lm.unwrap_or(drawn)
    } else {
        0.0
    };
    Lights { change_lm, random_colors: is_ever_dark && settings.random_building_colors && !high_ground }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_dark_scenes_change_their_lights() {
        let settings = LightSettings::default();
        let at = |is_ever_dark, seed| {
            plan_lights(&settings, is_ever_dark, false, &mut Stream::new(seed, 0, "test", 0))
        };
        let mut sum = 0.0;
        for seed in 0..4000 {
            assert_eq!(at(false, seed), Lights { change_lm: 0.0, random_colors: false });
            let night = at(true, seed);
            assert!(night.random_colors && night.change_lm.abs() <= STREET_LAMP_LM);
            sum += night.change_lm.abs();
        }
        // Uniform in -1..1 of the nominal flux: half of it on the average, 0.29 / sqrt(4000) standard error.
        assert!((sum / 4000.0 / STREET_LAMP_LM - 0.5).abs() < 0.02);
    }

    #[test]
    fn settings_have_the_last_word() {
        let at = |settings: LightSettings, high| {
            plan_lights(&settings, true, high, &mut Stream::new(1, 0, "test", 0))
        };
        let fixed = LightSettings { intensity_change_lm: Some(-2e6), ..LightSettings::default() };
        assert_eq!(at(fixed.clone(), true), Lights { change_lm: -2e6, random_colors: false });
        assert_eq!(at(LightSettings { change_intensity: false, ..fixed }, false).change_lm, 0.0);
        let plain = LightSettings { random_building_colors: false, ..LightSettings::default() };
        assert!(!at(plain, false).random_colors);
    }
}
