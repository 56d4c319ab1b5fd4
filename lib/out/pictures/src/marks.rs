//! Marks on pictures from above: rings of range, a scale bar, the agent that looks.

use frames::math;
use nalgebra::{Isometry3, Point3, Vector3};

use crate::{Anchor, Canvas, Rgb, View};

/// Smaller text is not drawn, nor what it belongs to, pixels.
pub(crate) const LEAST_TEXT_PX: f64 = 5.0;
const INK: Rgb = [28, 32, 38];
const RING: Rgb = [84, 92, 106];
/// Of 255.
const RING_OPACITY: u8 = 120;
const PANEL_OPACITY: u8 = 216;
/// Corners of rings.
const CORNERS: u32 = 180;
/// Rings within half a picture.
const RINGS: f64 = 4.0;

/// Light panels on bright pictures, dark ones on pictures of all colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Dark ink on white.
    Light,
    /// White ink on black.
    Dark,
}

impl Tone {
    pub(crate) fn ink(self) -> Rgb {
        match self {
            Self::Light => INK,
            Self::Dark => [242, 244, 247],
        }
    }

    fn paper(self) -> Rgb {
        match self {
            Self::Light => [255; 3],
            Self::Dark => [18, 21, 26],
        }
    }

    /// A ground for text, through which a little shows.
    pub(crate) fn panel(self, canvas: &mut Canvas, [x, y]: [f64; 2], [w, h]: [f64; 2]) {
        let ring = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        canvas.area([ring.as_slice()], self.paper(), PANEL_OPACITY);
    }
}

/// Writes a text on a plate, with its baseline at a point.
pub fn draw_plate(canvas: &mut Canvas, [x, y]: [f64; 2], anchor: Anchor, text_px: f64, rgb: Rgb, text: &str) {
    let length = typeface::length_px(text, text_px, typeface::Weight::Bold);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * length,
        Anchor::End => x - length,
    };
    let pad = 0.2 * text_px;
    let size = [length + 2.0 * pad, text_px + pad];
    Tone::Light.panel(canvas, [left - pad, y - 0.88 * text_px], size);
    canvas.bold_text([left, y], Anchor::Start, text_px, rgb, text);
}

/// The next of 1, 2, 5 times a power of ten.
pub(crate) fn round_up(value: f64) -> f64 {
    let power = math::pow(10.0, math::log10(value).floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * power >= value * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// The one before.
fn round_down(value: f64) -> f64 {
    let power = math::pow(10.0, math::log10(value).floor());
    let step = [5.0, 2.0].into_iter().find(|step| step * power <= value * (1.0 + 1e-9));
    step.unwrap_or(1.0) * power
}

/// Radii of the rings of a view, metres, and where they are around; none but from above.
fn rings(view: &View) -> Option<(Vec<f64>, [f64; 2], f64)> {
    let View::Above { size, px_per_m, .. } = view else { return None };
    let (middle, _) = view.project(Point3::origin())?;
    let half_m = 0.5 * f64::from(size[0].min(size[1])) / px_per_m;
    let step_m = round_up(half_m / RINGS);
    let radii = (1..).map(|i| f64::from(i) * step_m).take_while(|radius| *radius < 0.99 * half_m);
    Some((radii.collect(), middle, *px_per_m))
}

/// Draws rings around the origin of a view from above: below what is seen, which they must not hide.
pub fn draw_rings(canvas: &mut Canvas, view: &View, text_px: f64) {
    let Some((radii_m, middle, px_per_m)) = rings(view).filter(|_| text_px >= LEAST_TEXT_PX) else { return };
    for radius_m in radii_m {
        let corner = |i: u32| {
            let turn = f64::from(i) * 2.0 * std::f64::consts::PI / f64::from(CORNERS);
            let (sin, cos) = math::sin_cos(turn);
            [middle[0] + radius_m * px_per_m * cos, middle[1] + radius_m * px_per_m * sin]
        };
        let ring: Vec<[f64; 2]> = (0..=CORNERS).map(corner).collect();
        canvas.faint_lines([ring.as_slice()], text_px / 18.0, RING, RING_OPACITY);
    }
}

/// Writes their radii, ahead to the right, and draws a scale bar: above what is seen.
pub fn label_rings(canvas: &mut Canvas, view: &View, text_px: f64) {
    let Some((radii_m, middle, px_per_m)) = rings(view).filter(|_| text_px >= LEAST_TEXT_PX) else { return };
    for radius_m in radii_m {
        let off = radius_m * px_per_m * std::f64::consts::FRAC_1_SQRT_2;
        let at = [middle[0] + off, middle[1] - off + 0.3 * text_px];
        draw_plate(canvas, at, Anchor::Middle, 0.85 * text_px, RING, &format!("{radius_m} m"));
    }
    draw_scale_bar(canvas, px_per_m, text_px, false);
}

/// Draws how long some metres are, at the bottom left, and where north is where that is up.
pub fn draw_scale_bar(canvas: &mut Canvas, px_per_m: f64, text_px: f64, is_north_up: bool) {
    if text_px < LEAST_TEXT_PX {
        return;
    }
    let [width, height] = canvas.size().map(f64::from);
    let length_m = round_down(0.2 * width / px_per_m);
    let length = length_m * px_per_m;
    let pad = 0.7 * text_px;
    let arrow = if is_north_up { 2.4 * text_px } else { 0.0 };
    let size = [length + 2.0 * pad + arrow, 1.9 * text_px + 2.0 * pad];
    let corner = [pad, height - pad - size[1]];
    Tone::Light.panel(canvas, corner, size);
    let (left, base) = (corner[0] + pad, corner[1] + size[1] - pad - 0.35 * text_px);
    let tick = 0.35 * text_px;
    let bar = [
        vec![[left, base], [left + length, base]],
        vec![[left, base - tick], [left, base + tick]],
        vec![[left + length, base - tick], [left + length, base + tick]],
    ];
    let thick = text_px / 8.0;
    canvas.lines(bar.iter().map(Vec::as_slice), thick, INK);
    let at = [left + 0.5 * length, base - 0.75 * text_px];
    canvas.text(at, Anchor::Middle, text_px, INK, &format!("{length_m} m"));
    if is_north_up {
        let x = left + length + 0.5 * arrow + 0.2 * text_px;
        let tip = base - 0.9 * text_px;
        let wing = 0.28 * text_px;
        let lines = [
            vec![[x, base + tick], [x, tip]],
            vec![[x - wing, tip + wing], [x, tip], [x + wing, tip + wing]],
        ];
        canvas.lines(lines.iter().map(Vec::as_slice), thick, INK);
        canvas.bold_text([x, tip - 0.25 * text_px], Anchor::Middle, 0.8 * text_px, INK, "N");
    }
}

/// Draws the agent that looks, from above: the outline of its body (eight corners in the space of the view)
/// with a mark that points ahead, or the mark alone.
pub fn draw_ego(
    canvas: &mut Canvas,
    view: &View,
    space_from_agent: &Isometry3<f64>,
    body: Option<&[Point3<f64>; 8]>,
    text_px: f64,
) {
    let View::Above { px_per_m, .. } = view else { return };
    let (ahead, left) = (space_from_agent.rotation * Vector3::x(), space_from_agent.rotation * Vector3::y());
    let place = |point: Point3<f64>| view.project(point).map(|(at, _)| at);
    let thick = (text_px / 10.0).max(1.0);
    // Half its length and width, and its middle; without a body the mark is as large as a letter.
    let (middle, half) = match body {
        Some(corners) => {
            let middle = Point3::from(corners.iter().map(|corner| corner.coords).sum::<Vector3<f64>>() / 8.0);
            let reach = |along: &Vector3<f64>| {
                corners.iter().map(|corner| (corner - middle).dot(along).abs()).fold(0.0, f64::max)
            };
            let ring: Vec<[f64; 2]> =
                [0, 2, 6, 4, 0].into_iter().filter_map(|i: usize| place(corners[i])).collect();
            canvas.area([ring.as_slice()], [255; 3], PANEL_OPACITY);
            canvas.lines([ring.as_slice()], thick, INK);
            (middle, [reach(&ahead), reach(&left)])
        }
        None => (Point3::from(space_from_agent.translation.vector), [0.8 * text_px / px_per_m; 2]),
    };
    let at = |along: f64, aside: f64| middle + ahead * (along * half[0]) + left * (aside * half[1]);
    let mark: Vec<[f64; 2]> =
        [at(0.1, 0.6), at(0.7, 0.0), at(0.1, -0.6)].into_iter().filter_map(place).collect();
    canvas.lines([mark.as_slice()], thick, INK);
}

#[cfg(test)]
mod tests {
    use frames::{OrientedBox, Pose};

    use super::*;
    use crate::Reach;

    #[test]
    fn lengths_are_round() {
        for (value, up, down) in [
            (1.0, 1.0, 1.0),
            (1.1, 2.0, 1.0),
            (20.0, 20.0, 20.0),
            (32.0, 50.0, 20.0),
            (0.7, 1.0, 0.5),
            (99.0, 100.0, 50.0),
        ] {
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * b;
            assert!(near(round_up(value), up) && near(round_down(value), down), "{value}");
        }
    }

    #[test]
    fn rings_are_as_far_as_they_say() {
        for (reach, radii_m) in [(Reach::Near, vec![5.0, 10.0, 15.0]), (Reach::Far, vec![20.0, 40.0, 60.0])] {
            let view = View::above(reach);
            let mut canvas = Canvas::new(view.size(), [255; 3]).expect("fits");
            draw_rings(&mut canvas, &view, 36.0);
            let (_, px_per_m) = reach.scale();
            // Along the axis ahead: lines two pixels wide around each radius.
            let ahead: Vec<f64> = (0..1280)
                .filter(|y| canvas.pixel([1280, *y]).is_some_and(|rgb| rgb[0] < 200))
                .map(|y| (1280.0 - f64::from(y) - 0.5) / px_per_m)
                .collect();
            for radius in &radii_m {
                assert!(ahead.iter().any(|r| (r - radius).abs() < 1.0 / px_per_m), "{radius}: {ahead:?}");
            }
            let is_ring = |r: &f64| radii_m.iter().any(|radius| (r - radius).abs() < 1.6 / px_per_m);
            assert!(ahead.iter().all(is_ring), "{ahead:?}");
        }
        let mut solid = Canvas::new([1600, 900], [255; 3]).expect("fits");
        label_rings(&mut solid, &View::behind(Reach::Near), 22.0);
        assert!(solid.to_rgb().iter().all(|v| *v == 255), "from behind there are none");
    }

    #[test]
    fn the_scale_bar_is_as_long_as_it_says() {
        let mut canvas = Canvas::new([1000, 400], [255; 3]).expect("fits");
        // 16 pixels a metre: a fifth of the width is 12.5 m, so the bar is 10 m long.
        draw_scale_bar(&mut canvas, 16.0, 20.0, false);
        let dark = |row: u32| {
            let dark = |x: &u32| canvas.pixel([*x, row]).is_some_and(|rgb| rgb[0] < 60);
            (0..1000).filter(dark).count()
        };
        let longest = (0..400).map(dark).max().unwrap_or_default();
        assert!((160..=164).contains(&longest), "{longest}");
    }

    #[test]
    fn the_ego_is_as_large_as_its_body() {
        let view = View::above(Reach::Near);
        let mut canvas = Canvas::new(view.size(), [0, 200, 0]).expect("fits");
        let pose = Pose::from_xyz_rpy([0.0, 0.0, 0.0], [0.0; 3]);
        let body = OrientedBox::standing(pose, 4.0, 2.0, 1.5).corners();
        draw_ego(&mut canvas, &view, &Isometry3::identity(), Some(&body), 30.0);
        // 64 pixels a metre, 3 pixels wide: 4 m along columns, 2 m along rows.
        let changed = |at: [u32; 2]| canvas.pixel(at) != Some([0, 200, 0]);
        let rows: Vec<u32> = (0..2560).filter(|y| changed([1280, *y])).collect();
        let columns: Vec<u32> = (0..2560).filter(|x| changed([*x, 1280])).collect();
        for (found, half) in [(rows, 128), (columns, 64)] {
            let ends = [found[0], found[found.len() - 1]];
            assert!(
                ends[0].abs_diff(1280 - half - 2) <= 1 && ends[1].abs_diff(1280 + half + 1) <= 1,
                "{ends:?}"
            );
        }
        // The mark ahead of the middle is dark, behind it nothing is.
        let is_dark = |y: u32| canvas.pixel([1280, y]).is_some_and(|rgb| rgb[0] < 120);
        assert!((1280 - 110..1280 - 64).any(is_dark) && !(1290..1400).any(is_dark));
    }
}
