//! Several pictures on one sheet.

use crate::{Anchor, Canvas, PictureError, Rgb};

const PAPER: Rgb = [252, 252, 250];
const INK: Rgb = [28, 32, 38];
const FAINT: Rgb = [96, 102, 112];
/// Sizes as shares of the sheet's width.
const MARGIN: f64 = 0.012;
const GAP: f64 = 0.006;
const HEADING: f64 = 0.017;
const TEXT: f64 = 0.0105;
const LABEL: f64 = 0.0085;

/// A picture with its name.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The name.
    pub name: String,
    /// The picture.
    pub picture: Canvas,
}

/// A picture on a sheet.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// The heading.
    pub heading: String,
    /// Lines of text below it.
    pub lines: Vec<String>,
    /// Pictures, row by row. Those of a row are of the same height and fill the width together.
    pub rows: Vec<Vec<Panel>>,
    /// What colours mean, below the pictures.
    pub legend: Vec<(String, Rgb)>,
}

/// Puts pictures on a sheet of a width, pixels. Its height follows from the pictures, and is even.
///
/// # Errors
/// It would be too large.
pub fn draw_sheet(sheet: &Sheet, width_px: u32) -> Result<Canvas, PictureError> {
    let width = f64::from(width_px);
    let [margin, gap, heading, text, label] = [MARGIN, GAP, HEADING, TEXT, LABEL].map(|share| share * width);
    let inner = width - 2.0 * margin;
    let named = 2.0 * label;
    let heights: Vec<f64> = sheet.rows.iter().map(|row| row_height(row, inner, gap)).collect();
    let head = margin + 1.3 * heading + 1.7 * text * sheet.lines.len() as f64;
    let places = legend_places(&sheet.legend, [margin, width - margin], text);
    let legend_rows = places.last().map_or(0.0, |(_, row)| *row as f64 + 1.0);
    let body: f64 = heights.iter().map(|height| height + named + gap).sum();
    let height = head + body + 1.9 * text * legend_rows + margin;
    let even = (height / 2.0).ceil().clamp(1.0, f64::from(u32::MAX / 2)) as u32 * 2;
    let mut canvas = Canvas::new([width_px, even], PAPER)?;

    canvas.bold_text([margin, margin + heading], Anchor::Start, heading, INK, &sheet.heading);
    for (i, line) in sheet.lines.iter().enumerate() {
        let y = margin + 1.3 * heading + 1.7 * text * (i as f64 + 0.75);
        canvas.text([margin, y], Anchor::Start, text, FAINT, line);
    }
    let mut y = head;
    for (row, height) in sheet.rows.iter().zip(&heights) {
        let mut x = margin;
        for panel in row {
            let [w, h] = panel.picture.size().map(f64::from);
            let wide = height * w / h;
            canvas.text([x, y + 0.72 * named], Anchor::Start, label, INK, &panel.name);
            canvas.paste(&panel.picture, [x, y + named], [wide, *height]);
            x += wide + gap;
        }
        y += height + named + gap;
    }
    for ((name, rgb), (x, row)) in sheet.legend.iter().zip(&places) {
        let top = y + 1.9 * text * *row as f64 + 0.4 * text;
        canvas.rectangle([*x, top], [text, text], *rgb);
        canvas.text([x + 1.6 * text, top + 0.85 * text], Anchor::Start, text, INK, name);
    }
    Ok(canvas)
}

/// Height at which the pictures of a row fill a width.
fn row_height(row: &[Panel], width: f64, gap: f64) -> f64 {
    let shapes = row.iter().map(|panel| {
        let [w, h] = panel.picture.size().map(f64::from);
        w / h
    });
    let free = width - gap * row.len().saturating_sub(1) as f64;
    let filled = free / shapes.sum::<f64>().max(1e-6);
    // Few pictures are no larger than a third of the sheet is wide.
    filled.min(width / 3.0)
}

/// Where the entries of a legend begin, and in which row, so that none leaves the sheet.
fn legend_places(legend: &[(String, Rgb)], [left, right]: [f64; 2], text: f64) -> Vec<(f64, usize)> {
    let (mut x, mut row) = (left, 0);
    let place = |(name, _): &(String, Rgb)| {
        let wide = 1.6 * text + typeface::length_px(name, text, typeface::Weight::Regular);
        if x > left && x + wide > right {
            (x, row) = (left, row + 1);
        }
        let at = (x, row);
        x += wide + 1.8 * text;
        at
    };
    legend.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_a_row_fill_the_width() {
        let panel = |size: [u32; 2], rgb: Rgb| Panel {
            name: "A".into(),
            picture: Canvas::new(size, rgb).expect("fits"),
        };
        let rows = vec![
            vec![panel([160, 90], [200, 0, 0]), panel([90, 90], [0, 200, 0]), panel([160, 90], [0, 0, 200])],
            vec![panel([100, 50], [9, 9, 9])],
        ];
        let legend = (0..40).map(|i| (format!("class {i}"), [i as u8, 120, 240])).collect();
        let sheet = Sheet { heading: "Scene".into(), lines: vec!["One".into()], rows, legend };
        let canvas = draw_sheet(&sheet, 1000).expect("fits");
        assert_eq!(canvas.size()[0], 1000);
        assert_eq!(canvas.size()[1] % 2, 0);
        let columns = |rgb: Rgb| {
            let has = |x: &u32| (0..canvas.size()[1]).any(|y| canvas.pixel([*x, y]) == Some(rgb));
            let found: Vec<u32> = (0..1000).filter(has).collect();
            [found.first().copied(), found.last().copied()]
        };
        // Margins of 12, gaps of 6: 964 pixels for shapes of 16 : 9, 1 : 1, 16 : 9, a height of 211.6.
        assert_eq!(columns([200, 0, 0])[0], Some(12));
        assert!(columns([0, 0, 200])[1].is_some_and(|x| x.abs_diff(987) <= 1));
        assert!(columns([0, 200, 0])[0].is_some_and(|x| x.abs_diff(394) <= 1));
        // The last entry of the legend is inside.
        assert!(columns([39, 120, 240])[0].is_some());
    }
}
