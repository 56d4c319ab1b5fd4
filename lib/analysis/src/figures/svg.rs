//! A small SVG writer. Coordinates are pixels, y down, with two decimals.

use std::fmt::Write;

use crate::text::escaped;

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
pub(super) struct Svg {
    width: f64,
    height: f64,
    body: String,
}

impl Svg {
    /// Starts a picture with its title at the top left.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Self { width, height, body: String::new() };
        let _ = writeln!(svg.body, "<title>{}</title>", escaped(title));
        svg.styled_text([0.0, 14.0], Anchor::Start, 13.0, title, " font-weight=\"600\"");
        svg
    }

    pub(super) fn rect(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], opacity: f64) {
        let _ = writeln!(
            self.body,
            r#"<rect x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}" fill="{ACCENT}" fill-opacity="{opacity:.3}"/>"#
        );
    }

    /// A thin line: strong for axes, else faint.
    pub(super) fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], strong: bool) {
        let opacity = if strong { "0.6" } else { "0.15" };
        let _ = writeln!(
            self.body,
            r#"<line x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}" stroke="currentColor" stroke-opacity="{opacity}"/>"#
        );
    }

    /// Text with its baseline at a point.
    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, size: f64, text: &str) {
        self.styled_text(at, anchor, size, text, "");
    }

    /// Text that runs upwards.
    pub(super) fn text_up(&mut self, [x, y]: [f64; 2], anchor: Anchor, size: f64, text: &str) {
        let turn = format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"");
        self.styled_text([x, y], anchor, size, text, &turn);
    }

    fn styled_text(&mut self, [x, y]: [f64; 2], anchor: Anchor, size: f64, text: &str, style: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escaped(text);
        let _ = writeln!(
            self.body,
            r#"<text x="{x:.2}" y="{y:.2}" font-size="{size}" text-anchor="{anchor}"{style}>{text}</text>"#
        );
    }

    pub(super) fn finish(self) -> String {
        let Self { width, height, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" fill=\"currentColor\" \
             font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\n{body}</svg>\n"
        )
    }
}
