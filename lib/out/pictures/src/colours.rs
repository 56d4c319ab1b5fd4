//! Colours of values.

use frames::math;
use schema::{DetectionClass, Difficulty};

use crate::Rgb;

/// Distances that have colours of their own, metres.
const DISTANCES_M: [f64; 2] = [2.0, 120.0];
/// Heights over the agent's ground that have colours of their own, metres.
const HEIGHTS_M: [f64; 2] = [-2.0, 10.0];
/// Radial velocities from here on are all red, or all blue, metres a second.
const FAST_MPS: f64 = 12.0;
/// The golden ratio's fraction: hues of neighbouring numbers lie far apart.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Of objects with no id.
const NOBODY: Rgb = [170, 170, 170];
/// Of agents, in their order: far apart on white.
const AGENTS: [Rgb; 8] = [
    [31, 99, 200],
    [214, 66, 34],
    [22, 140, 72],
    [140, 60, 180],
    [196, 138, 0],
    [0, 140, 160],
    [200, 40, 120],
    [110, 90, 60],
];

/// Violet to red for 0 to 1, as gnuplot's formulae 33, 13, 10 have it.
fn rainbow(share: f64) -> Rgb {
    let x = share.clamp(0.0, 1.0);
    let pi = std::f64::consts::PI;
    byte_rgb([(2.0 * x - 0.5).abs(), math::sin(pi * x), math::cos(0.5 * pi * x)])
}

fn byte_rgb(rgb: [f64; 3]) -> Rgb {
    rgb.map(|v| (255.0 * v.clamp(0.0, 1.0)).round() as u8)
}

/// Of a distance: violet from 2 m, red from 120 m, by its logarithm.
#[must_use]
pub fn distance_rgb(distance_m: f64) -> Rgb {
    let [near, far] = DISTANCES_M.map(math::ln);
    rainbow((math::ln(distance_m.max(1e-3)) - near) / (far - near))
}

/// Of a height over the agent's ground: violet up to -2 m, red from 10 m.
#[must_use]
pub fn height_rgb(height_m: f64) -> Rgb {
    let [low, high] = HEIGHTS_M;
    rainbow((height_m - low) / (high - low))
}

/// Of an object: the same for the same id; grey for none.
#[must_use]
pub fn id_rgb(id: u16) -> Rgb {
    if id == 0 {
        return NOBODY;
    }
    let number = f64::from(id);
    let hue = (number * GOLDEN).fract();
    let value = 0.6 + 0.35 * (number * 0.37).fract();
    hsv([hue, 0.85, value])
}

/// Of a lidar's intensity, 0 to 1: pale to dark blue.
#[must_use]
pub fn intensity_rgb(intensity: f64) -> Rgb {
    let t = intensity.clamp(0.0, 1.0).sqrt();
    let (pale, dark) = ([200.0, 214.0, 232.0], [10.0, 24.0, 96.0]);
    [0, 1, 2].map(|k| (pale[k] + (dark[k] - pale[k]) * t).round() as u8)
}

/// Of a radial velocity: blue approaching, red receding, grey at rest.
#[must_use]
pub fn velocity_rgb(receding_mps: f64) -> Rgb {
    let t = (receding_mps / FAST_MPS).clamp(-1.0, 1.0);
    let still = [120.0, 120.0, 120.0];
    let end = if t > 0.0 { [230.0, 20.0, 20.0] } else { [20.0, 60.0, 240.0] };
    [0, 1, 2].map(|k| (still[k] + (end[k] - still[k]) * t.abs()).round() as u8)
}

/// Of an agent, by its place in the scene's list.
#[must_use]
pub fn agent_rgb(position: usize) -> Rgb {
    AGENTS[position % AGENTS.len()]
}

/// Of a box: its class's, less bright the harder it is to detect (medium 0.8, hard 0.6).
#[must_use]
pub fn box_rgb(class: DetectionClass, difficulty: Difficulty) -> Rgb {
    let brightness = match difficulty {
        Difficulty::Easy => 1.0,
        Difficulty::Medium => 0.8,
        Difficulty::Hard => 0.6,
    };
    class.rgb().map(|v| (f64::from(v) * brightness).round() as u8)
}

/// From hue (0 to 1, red at 0), saturation and value.
pub(crate) fn hsv([hue, saturation, value]: [f64; 3]) -> Rgb {
    let channel = |shift: f64| {
        let k = (shift + 6.0 * hue.rem_euclid(1.0)) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    };
    byte_rgb([channel(5.0), channel(3.0), channel(1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_are_those_of_the_wheel() {
        let at = |degrees: f64| hsv([degrees / 360.0, 1.0, 1.0]);
        assert_eq!([at(0.0), at(120.0), at(240.0)], [[255, 0, 0], [0, 255, 0], [0, 0, 255]]);
        assert_eq!([at(60.0), at(180.0), at(300.0)], [[255, 255, 0], [0, 255, 255], [255, 0, 255]]);
        assert_eq!(hsv([0.3, 0.0, 0.5]), [128; 3]);
    }

    #[test]
    fn values_run_from_violet_to_red() {
        assert_eq!(rainbow(0.0), [128, 0, 255]);
        assert_eq!(rainbow(1.0), [255, 0, 0]);
        assert_eq!(rainbow(0.25), [0, 180, 236]);
        assert_eq!([distance_rgb(2.0), distance_rgb(500.0)], [rainbow(0.0), rainbow(1.0)]);
        // Half of the way between the logarithms.
        let middle = distance_rgb((2.0_f64 * 120.0).sqrt());
        assert!((0..3).all(|k| middle[k].abs_diff(rainbow(0.5)[k]) <= 1), "{middle:?}");
        assert_eq!(height_rgb(4.0), rainbow(0.5));
    }

    #[test]
    fn harder_boxes_are_darker() {
        let of = |difficulty| box_rgb(DetectionClass::Car, difficulty);
        assert_eq!(of(Difficulty::Easy), [0, 128, 240]);
        assert_eq!(of(Difficulty::Medium), [0, 102, 192]);
        assert_eq!(of(Difficulty::Hard), [0, 77, 144]);
    }

    #[test]
    fn standing_things_are_grey_to_radar() {
        assert_eq!(velocity_rgb(0.0), [120; 3]);
        assert_eq!([velocity_rgb(50.0), velocity_rgb(-50.0)], [[230, 20, 20], [20, 60, 240]]);
        assert_eq!(id_rgb(0), NOBODY);
        assert_ne!(id_rgb(7), id_rgb(8));
    }
}
