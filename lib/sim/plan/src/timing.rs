//! Durations and the radii that follow from them.

use random::Stream;
use schema::FRAME_PERIOD_S;
use settings::TimingSettings;

/// Recorded time of a scene: whole seconds, uniform before rounding (so the two end values are half as likely
/// as the others), at least 1.
pub fn draw_duration_s(timing: &TimingSettings, stream: &mut Stream) -> f64 {
    stream.uniform(timing.min_duration_s, timing.max_duration_s).round_ties_even().max(1.0)
}

/// Frames of a recorded time.
#[must_use]
pub fn frame_count(duration_s: f64) -> u32 {
    (duration_s / FRAME_PERIOD_S).round_ties_even().max(0.0) as u32
}

/// Distance from a vehicle agent within which background actors start, metres: far enough that an agent meets
/// them within the scene. 30, 25 or 20 metres per simulated second, fewer in longer scenes.
#[must_use]
pub fn background_radius_m(duration_s: f64, warmup_s: f64) -> f64 {
    let metres_per_second = if duration_s <= 12.0 {
        30.0
    } else if duration_s <= 16.0 {
        25.0
    } else {
        20.0
    };
    metres_per_second * (duration_s + warmup_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_the_published_ones() {
        for (duration, radius) in
            [(8.0, 300.0), (12.0, 420.0), (13.0, 375.0), (16.0, 450.0), (17.0, 380.0), (32.0, 680.0)]
        {
            assert_eq!(background_radius_m(duration, 2.0), radius);
        }
    }

    #[test]
    fn durations_are_whole_seconds_with_half_weight_at_the_ends() {
        let timing = TimingSettings::default();
        let mut counts = [0u32; 41];
        for scene in 0..48_000 {
            let duration = draw_duration_s(&timing, &mut Stream::new(27, scene, "plan/duration", 0));
            assert_eq!(duration.fract(), 0.0);
            assert_eq!(frame_count(duration), 20 * duration as u32);
            counts[duration as usize] += 1;
        }
        // 48,000 draws over a span of 24 s: 2000 for inner values, 1000 for the two ends.
        assert!(counts[..8].iter().chain(&counts[33..]).all(|&c| c == 0));
        assert!([counts[8], counts[32]].iter().all(|&c| (880..1120).contains(&c)), "{counts:?}");
        assert!(counts[9..32].iter().all(|&c| (1830..2170).contains(&c)), "{counts:?}");
    }

    #[test]
    fn a_scene_lasts_at_least_a_second() {
        let timing = TimingSettings { min_duration_s: 0.1, max_duration_s: 0.3, ..TimingSettings::default() };
        assert_eq!(draw_duration_s(&timing, &mut Stream::new(1, 0, "plan/duration", 0)), 1.0);
        // Half seconds go to the even one.
        for (fixed, rounded) in [(12.5, 12.0), (13.5, 14.0)] {
            let timing =
                TimingSettings { min_duration_s: fixed, max_duration_s: fixed, ..TimingSettings::default() };
            assert_eq!(draw_duration_s(&timing, &mut Stream::new(1, 0, "plan/duration", 0)), rounded);
        }
    }
}
