//! Colours of values.

use frames::math;
use schema::{DetectionClass, Difficulty};

use crate::Rgb;

/// Distances that have colours of their own, metres.
pub(crate) const DISTANCES_M: [f64; 2] = [2.0, 120.0];
/// Heights over the agent's ground that have colours of their own, metres.
pub(crate) const HEIGHTS_M: [f64; 2] = [-2.0, 10.0];
/// Radial velocities from here on are all red, or all blue, metres a second.
pub(crate) const FAST_MPS: f64 = 12.0;
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

/// Depths that have colours of their own, metres.
pub(crate) const DEPTHS_M: [f64; 2] = [1.0, 1000.0];
/// Coefficients of the colour map viridis (Stéfan van der Walt and Nathaniel Smith, CC0) as polynomials by
/// Matt Zucker (CC0), constants first: red, green, blue. They are within 2 % of its table.
const VIRIDIS: [[f64; 3]; 7] = [
    [0.277_727_327_2, 0.005_407_344_5, 0.334_099_805_3],
    [0.105_093_043_1, 1.404_613_529_8, 1.384_590_162_5],
    [-0.330_861_828_7, 0.214_847_559_4, 0.095_095_163_0],
    [-4.634_230_498_9, -5.799_100_973_3, -19.332_440_956_2],
    [6.228_269_936_3, 14.179_933_366_8, 56.690_552_600_6],
    [4.776_384_997_6, -13.745_145_377_7, -65.353_032_633_3],
    [-5.435_455_855_9, 4.645_852_612_1, 26.312_435_249_5],
];

/// Dark violet to yellow for 0 to 1: as bright as they are large, to eyes that see no red, too.
fn viridis(share: f64) -> Rgb {
    let x = share.clamp(0.0, 1.0);
    byte_rgb(VIRIDIS.into_iter().rev().fold([0.0; 3], |sum, c| [0, 1, 2].map(|k| sum[k] * x + c[k])))
}

/// Of a depth: yellow up to 1 m, dark violet from 1000 m, by its logarithm.
#[must_use]
pub fn depth_rgb(depth_m: f64) -> Rgb {
    let [near, far] = DEPTHS_M.map(math::ln);
    viridis(1.0 - (math::ln(depth_m.max(1e-3)) - near) / (far - near))
}

/// Corners of the wheel of optical flow, each with its steps to the next one: as many as eyes tell apart
/// (Baker et al., "A database and evaluation methodology for optical flow", 2011).
const WHEEL: [(u32, Rgb); 6] = [
    (15, [255, 0, 0]),
    (6, [255, 255, 0]),
    (4, [0, 255, 0]),
    (11, [0, 255, 255]),
    (13, [0, 0, 255]),
    (6, [255, 0, 255]),
];

/// Of a motion on a picture, x to the right and y down, as a share of the longest that has a colour of its
/// own: white at rest, red to the right, yellow down, cyan to the left, violet up; darker beyond.
#[must_use]
pub fn flow_rgb([x, y]: [f64; 2]) -> Rgb {
    let length = math::hypot(x, y);
    let all: u32 = WHEEL.iter().map(|(steps, _)| steps).sum();
    let turn = (math::atan2(y, x) / (2.0 * std::f64::consts::PI)).rem_euclid(1.0);
    let mut at = turn * f64::from(all - 1);
    let mut corner = 0;
    while at >= f64::from(WHEEL[corner].0) && corner + 1 < WHEEL.len() {
        at -= f64::from(WHEEL[corner].0);
        corner += 1;
    }
    let share = at / f64::from(WHEEL[corner].0);
    let (from, to) = (WHEEL[corner].1, WHEEL[(corner + 1) % WHEEL.len()].1);
    byte_rgb([0, 1, 2].map(|k| {
        let [from, to] = [from, to].map(|rgb| f64::from(rgb[k]) / 255.0);
        let full = from + (to - from) * share;
        if length <= 1.0 { 1.0 - length * (1.0 - full) } else { 0.75 * full }
    }))
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
    fn viridis_is_the_published_table() {
        // matplotlib's, at 0, 32, 64, ... 255 of its 256 entries.
        let table = [
            [68, 1, 84],
            [71, 44, 122],
            [59, 81, 139],
            [44, 113, 142],
            [33, 144, 141],
            [39, 173, 129],
            [92, 200, 99],
            [170, 220, 50],
            [253, 231, 37],
        ];
        for (i, want) in (0_u8..).zip(table) {
            let got = viridis(f64::from(i) / 8.0);
            assert!((0..3).all(|k| got[k].abs_diff(want[k]) <= 6), "{i}: {got:?} {want:?}");
        }
        // Evenly brighter from the far to the near end, by the luminance of sRGB's primaries.
        let light = |depth_m: f64| {
            let [r, g, b] = depth_rgb(depth_m).map(|v| math::pow(f64::from(v) / 255.0, 2.2));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let lights: Vec<f64> = (0..=30).map(|i| light(math::pow(10.0, f64::from(i) / 10.0))).collect();
        assert!(lights.windows(2).all(|pair| pair[0] > pair[1]), "{lights:?}");
        assert_eq!([depth_rgb(0.1), depth_rgb(5e3)], [depth_rgb(1.0), depth_rgb(1000.0)]);
    }

    #[test]
    fn the_wheel_is_middleburys() {
        // colorcode.cpp of the Middlebury evaluation: column k of 55 is at k / 54 of a turn from the right,
        // clockwise.
        assert_eq!(flow_rgb([1.0, 0.0]), [255, 0, 0]);
        assert_eq!(flow_rgb([0.0, 1.0]), [255, 230, 0], "column 13.5 of 15 from red to yellow");
        assert_eq!(flow_rgb([-1.0, 0.0]), [0, 209, 255], "column 27: 2 of 11 from cyan to blue");
        assert_eq!(flow_rgb([0.0, -1.0]), [88, 0, 255], "column 40.5: 4.5 of 13 from blue to magenta");
        assert_eq!([flow_rgb([0.0; 2]), flow_rgb([0.5, 0.0])], [[255; 3], [255, 128, 128]]);
        assert_eq!(flow_rgb([1.5, 0.0]), [191, 0, 0], "out of range");
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
