//! What colours mean, in a corner of a picture.

use frames::math;

use crate::colours::{
    DEPTHS_M, DISTANCES_M, FAST_MPS, HEIGHTS_M, agent_rgb, depth_rgb, distance_rgb, flow_rgb, height_rgb,
    intensity_rgb, velocity_rgb,
};
use crate::marks::{LEAST_TEXT_PX, Tone};
use crate::{Anchor, Canvas, ColourBy, Rgb};

/// Length of a bar of colours, in heights of its text, and how thick it is.
const BAR: [f64; 2] = [15.0, 0.8];
/// Free space around, in heights of the text.
const MARGIN: f64 = 0.7;
/// Radius of the wheel of flow, in heights of its text.
const WHEEL: f64 = 2.6;

/// A scale of colours with its numbers.
#[derive(Clone, Debug)]
pub struct ColourBar {
    title: &'static str,
    /// Values at both ends, and those that are named.
    ends: [f64; 2],
    ticks: &'static [f64],
    is_logarithmic: bool,
    rgb: fn(f64) -> Rgb,
}

impl ColourBar {
    /// Of depth images.
    pub const DEPTH: Self = Self {
        title: "Depth, m",
        ends: DEPTHS_M,
        ticks: &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0],
        is_logarithmic: true,
        rgb: depth_rgb,
    };

    /// Of what points are coloured by; none where colours are names.
    #[must_use]
    pub fn of(by: ColourBy) -> Option<Self> {
        let (title, ends, ticks, is_logarithmic, rgb): (_, _, &[f64], _, fn(f64) -> Rgb) = match by {
            ColourBy::Distance => (
                "Distance from the sensor, m",
                DISTANCES_M,
                &[2.0, 5.0, 10.0, 20.0, 50.0, 120.0],
                true,
                distance_rgb,
            ),
            ColourBy::Height => (
                "Height over the ground, m",
                HEIGHTS_M,
                &[-2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0],
                false,
                height_rgb,
            ),
            ColourBy::Intensity => {
                ("Strength of the return", [0.0, 1.0], &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0], false, intensity_rgb)
            }
            ColourBy::Velocity => (
                "Radial velocity, m/s (negative: approaching)",
                [-FAST_MPS, FAST_MPS],
                &[-12.0, -6.0, 0.0, 6.0, 12.0],
                false,
                velocity_rgb,
            ),
            ColourBy::Tag | ColourBy::Id | ColourBy::Agent => return None,
        };
        Some(Self { title, ends, ticks, is_logarithmic, rgb })
    }

    /// Where between the ends a value is.
    fn share(&self, value: f64) -> f64 {
        let on_scale = |value: f64| if self.is_logarithmic { math::ln(value) } else { value };
        let [low, high] = self.ends.map(on_scale);
        (on_scale(value) - low) / (high - low)
    }

    /// The value there.
    fn value(&self, share: f64) -> f64 {
        let [low, high] = self.ends;
        if self.is_logarithmic { low * math::pow(high / low, share) } else { low + (high - low) * share }
    }

    /// Draws it at the bottom right; nothing where its text could not be read.
    pub fn draw(&self, canvas: &mut Canvas, tone: Tone, text_px: f64) {
        if text_px < LEAST_TEXT_PX {
            return;
        }
        let [bar_w, bar_h] = BAR.map(|heights| (heights * text_px).round());
        let pad = MARGIN * text_px;
        // Numbers stand on both sides of the ends.
        let size = [bar_w + 2.0 * (pad + 0.8 * text_px), 2.0 * pad + 2.9 * text_px + bar_h];
        let [width, height] = canvas.size().map(f64::from);
        let corner = [width - size[0] - pad, height - size[1] - pad];
        tone.panel(canvas, corner, size);
        let left = (corner[0] + pad + 0.8 * text_px).round();
        let top = (corner[1] + pad + 1.35 * text_px).round();
        canvas.text([left, corner[1] + pad + 0.75 * text_px], Anchor::Start, text_px, tone.ink(), self.title);
        for x in 0..bar_w as u32 {
            let rgb = (self.rgb)(self.value((f64::from(x) + 0.5) / bar_w));
            canvas.rectangle([left + f64::from(x), top], [1.0, bar_h], rgb);
        }
        for &tick in self.ticks {
            let x = left + bar_w * self.share(tick);
            let line = [[x, top + bar_h], [x, top + bar_h + 0.3 * text_px]];
            canvas.lines([line.as_slice()], text_px / 14.0, tone.ink());
            let at = [x, top + bar_h + 1.3 * text_px];
            canvas.text(at, Anchor::Middle, text_px, tone.ink(), &number(tick));
        }
    }
}

/// A number, with a sign that is as wide as a digit.
fn number(value: f64) -> String {
    format!("{value}").replace('-', "\u{2212}")
}

/// Draws the wheel of flow at the bottom right: the colour of a motion stands where it leads to from the
/// middle; on the rim it is `full_px` pixels a frame long. Nothing where its text could not be read.
pub fn draw_wheel(canvas: &mut Canvas, full_px: f64, text_px: f64) {
    if text_px < LEAST_TEXT_PX {
        return;
    }
    let (pad, radius) = (MARGIN * text_px, WHEEL * text_px);
    let lines = [
        "Motion on the picture".to_owned(),
        "since the frame before,".to_owned(),
        format!("at the rim {full_px} px"),
    ];
    let length = |line: &String| typeface::length_px(line, text_px, typeface::Weight::Regular);
    let longest = lines.iter().map(length).fold(0.0, f64::max);
    let size = [2.0 * radius + 3.0 * pad + longest, 2.0 * (radius + pad)];
    let [width, height] = canvas.size().map(f64::from);
    let corner = [width - size[0] - pad, height - size[1] - pad];
    Tone::Dark.panel(canvas, corner, size);
    let middle = [corner[0] + pad + radius, corner[1] + pad + radius];
    disc(canvas, middle, radius);
    for (i, line) in lines.iter().enumerate() {
        let y = middle[1] + 1.4 * text_px * (i as f64 - 1.0) + 0.36 * text_px;
        canvas.text([middle[0] + radius + pad, y], Anchor::Start, text_px, Tone::Dark.ink(), line);
    }
}

/// The wheel itself, with an edge as smooth as those of letters.
fn disc(canvas: &mut Canvas, middle: [f64; 2], radius: f64) {
    for (y, row) in canvas.rows_mut().enumerate() {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let off = [x as f64 + 0.5 - middle[0], y as f64 + 0.5 - middle[1]];
            let length = math::hypot(off[0], off[1]);
            let cover = (radius + 0.5 - length).clamp(0.0, 1.0);
            if cover > 0.0 {
                let rgb = flow_rgb(off.map(|v| v / radius.max(length)));
                for k in 0..3 {
                    let below = f64::from(pixel[k]);
                    pixel[k] = (below + (f64::from(rgb[k]) - below) * cover).round() as u8;
                }
            }
        }
    }
}

/// Draws names with their colours at the bottom right, one below another.
pub fn draw_names(canvas: &mut Canvas, names: &[(String, Rgb)], text_px: f64) {
    if text_px < LEAST_TEXT_PX || names.is_empty() {
        return;
    }
    let pad = MARGIN * text_px;
    let length = |(name, _): &(String, Rgb)| typeface::length_px(name, text_px, typeface::Weight::Regular);
    let longest = names.iter().map(length).fold(0.0, f64::max);
    let size = [
        longest + 1.5 * text_px + 2.0 * pad,
        1.45 * text_px * names.len() as f64 + 2.0 * pad - 0.45 * text_px,
    ];
    let [width, height] = canvas.size().map(f64::from);
    let corner = [width - size[0] - pad, height - size[1] - pad];
    Tone::Light.panel(canvas, corner, size);
    for (i, (name, rgb)) in names.iter().enumerate() {
        let top = corner[1] + pad + 1.45 * text_px * i as f64;
        canvas.rectangle([corner[0] + pad, top], [text_px; 2], *rgb);
        let at = [corner[0] + pad + 1.5 * text_px, top + 0.86 * text_px];
        canvas.text(at, Anchor::Start, text_px, Tone::Light.ink(), name);
    }
}

/// The names and colours of agents, by their places in the scene's list.
#[must_use]
pub fn agent_names(agents: &[(usize, String)]) -> Vec<(String, Rgb)> {
    agents.iter().map(|(position, name)| (name.clone(), agent_rgb(*position))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colours(canvas: &Canvas) -> std::collections::BTreeSet<Rgb> {
        let [w, h] = canvas.size();
        (0..h).flat_map(|y| (0..w).map(move |x| [x, y])).filter_map(|at| canvas.pixel(at)).collect()
    }

    #[test]
    fn a_bar_shows_the_colours_of_its_numbers() {
        let bars = [ColourBar::DEPTH].into_iter().chain(ColourBy::ALL.into_iter().filter_map(ColourBar::of));
        for bar in bars {
            let mut canvas = Canvas::new([600, 300], [255; 3]).expect("fits");
            bar.draw(&mut canvas, Tone::Light, 16.0);
            let shown = colours(&canvas);
            for &tick in bar.ticks {
                assert!((bar.value(bar.share(tick)) - tick).abs() < 1e-9 * tick.abs().max(1.0));
                // No farther from it than the pixels beside it: where a scale is steep these differ much.
                let pixel = 1.0 / (BAR[0] * 16.0);
                let around = [-pixel, 0.0, pixel]
                    .map(|off| (bar.rgb)(bar.value((bar.share(tick) + off).clamp(0.0, 1.0))));
                let is_near = |rgb: &Rgb| {
                    (0..3).all(|k| {
                        let [a, b, c] = around.map(|rgb| rgb[k]);
                        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                        (low.saturating_sub(2)..=high.saturating_add(2)).contains(&rgb[k])
                    })
                };
                assert!(shown.iter().any(is_near), "{}: {tick} is {:?}", bar.title, around[1]);
            }
            assert_eq!([bar.share(bar.ends[0]), bar.share(bar.ends[1])], [0.0, 1.0]);
            // Nothing reaches the left half.
            let is_white = |x: u32| (0..300).all(|y| canvas.pixel([x, y]) == Some([255; 3]));
            assert!((0..200).all(is_white), "{}", bar.title);
        }
    }

    #[test]
    fn wheels_have_the_colours_of_motions_where_they_lead() {
        let mut canvas = Canvas::new([800, 300], [255; 3]).expect("fits");
        draw_wheel(&mut canvas, 20.0, 20.0);
        let has = |rgb: Rgb| {
            let near = |got: &Rgb| (0..3).all(|k| got[k].abs_diff(rgb[k]) <= 8);
            colours(&canvas).iter().any(near)
        };
        for step in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.5, 0.0], [0.0, 0.0]] {
            assert!(has(flow_rgb(step)), "{step:?}");
        }
        let mut small = Canvas::new([64, 36], [9; 3]).expect("fits");
        draw_wheel(&mut small, 20.0, 0.9);
        ColourBar::DEPTH.draw(&mut small, Tone::Dark, 0.9);
        assert_eq!(colours(&small).len(), 1, "nothing that nobody could read");
    }
}
