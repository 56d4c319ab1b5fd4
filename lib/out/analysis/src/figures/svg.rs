//! What figures are drawn with. Coordinates are pixels, y down, with two decimals.

use svg::node::element::{Circle, Image, Line, Path, Rectangle, Text, Title};
use svg::{Document, Node};

use crate::text::printable;

/// Colour of bars: of middle lightness, so that it stands on white and on dark pages.
pub(super) const ACCENT: &str = "#4584b6";

/// Widest a text can be, pixels: fonts differ, so this errs on the large side.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let wide = |c: &char| c.is_ascii_uppercase() || *c == '%' || !c.is_ascii();
    let wide_chars = text.chars().filter(wide).count();
    (0.6 * text.chars().count() as f64 + 0.2 * wide_chars as f64) * size
}

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// An SVG document in the making.
pub(super) struct Svg(Document);

fn px(value: f64) -> String {
    format!("{value:.2}")
}

impl Svg {
    /// Starts a picture with its title at the top left.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let document = Document::new()
            .set("width", format!("{width:.0}"))
            .set("height", format!("{height:.0}"))
            .set("viewBox", format!("0 0 {width:.0} {height:.0}"))
            .set("role", "img")
            // For the page, which gives figures room by it.
            .set("style", format!("--width: {width:.0}px"))
            .set("fill", "currentColor")
            .set("font-family", format!("{}, system-ui, 'Segoe UI', sans-serif", typeface::FAMILY))
            .add(Title::new(title));
        let mut svg = Self(document);
        svg.0.append(label([0.0, 14.0], Anchor::Start, 13.0, title).set("font-weight", "600"));
        svg
    }

    pub(super) fn rect(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], opacity: f64) {
        let rectangle = Rectangle::new()
            .set("x", px(x))
            .set("y", px(y))
            .set("width", px(w))
            .set("height", px(h))
            .set("fill", ACCENT)
            .set("fill-opacity", format!("{opacity:.3}"));
        self.0.append(rectangle);
    }

    /// A thin line: strong for axes, else faint.
    pub(super) fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], strong: bool) {
        let line = Line::new()
            .set("x1", px(x1))
            .set("y1", px(y1))
            .set("x2", px(x2))
            .set("y2", px(y2))
            .set("stroke", "currentColor")
            .set("stroke-opacity", if strong { "0.6" } else { "0.15" });
        self.0.append(line);
    }

    /// A line through points, in the ink of the page.
    pub(super) fn outline(&mut self, points: &[[f64; 2]]) {
        let path = Path::new()
            .set("d", steps(points))
            .set("fill", "none")
            .set("stroke", "currentColor")
            .set("stroke-width", "1.5");
        self.0.append(path);
    }

    /// A line through points, in a colour of its own.
    pub(super) fn curve(&mut self, points: &[[f64; 2]], [r, g, b]: [u8; 3]) {
        let path = Path::new()
            .set("d", steps(points))
            .set("fill", "none")
            .set("stroke", format!("#{r:02x}{g:02x}{b:02x}"))
            .set("stroke-width", "2")
            .set("stroke-linejoin", "round");
        self.0.append(path);
    }

    /// A picture within the document, its pixels drawn as rectangles.
    pub(super) fn image(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], address: &str) {
        let image = Image::new()
            .set("x", px(x))
            .set("y", px(y))
            .set("width", px(w))
            .set("height", px(h))
            .set("preserveAspectRatio", "none")
            .set("style", "image-rendering: pixelated")
            .set("href", address);
        self.0.append(image);
    }

    /// A faint circle.
    pub(super) fn circle(&mut self, [x, y]: [f64; 2], radius: f64) {
        let circle = Circle::new()
            .set("cx", px(x))
            .set("cy", px(y))
            .set("r", px(radius))
            .set("fill", "none")
            .set("stroke", "currentColor")
            .set("stroke-opacity", "0.35");
        self.0.append(circle);
    }

    /// Text with its baseline at a point.
    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, size: f64, text: &str) {
        self.0.append(label(at, anchor, size, text));
    }

    /// Text that runs upwards.
    pub(super) fn text_up(&mut self, [x, y]: [f64; 2], anchor: Anchor, size: f64, text: &str) {
        let turn = format!("rotate(-90 {x:.2} {y:.2})");
        self.0.append(label([x, y], anchor, size, text).set("transform", turn));
    }

    pub(super) fn finish(self) -> String {
        printable(&format!("{}\n", self.0))
    }
}

/// A path from point to point.
fn steps(points: &[[f64; 2]]) -> String {
    let step = |(i, [x, y]): (usize, &[f64; 2])| format!("{}{x:.2} {y:.2}", if i == 0 { 'M' } else { 'L' });
    points.iter().enumerate().map(step).collect()
}

fn label([x, y]: [f64; 2], anchor: Anchor, size: f64, text: &str) -> Text {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    Text::new(text).set("x", px(x)).set("y", px(y)).set("font-size", size).set("text-anchor", anchor)
}
