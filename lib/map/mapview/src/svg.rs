//! Pictures as SVG.

use std::fmt::Write;

use svg::node::element::{Path, Style, Text as Label, Title};
use svg::{Document, Node};

use crate::picture::{Anchor, Colour, Item, Paint, Picture, Shape, Text};

/// Units of the document in a pixel: whole numbers make short files.
const UNITS: f64 = 10.0;

impl Picture {
    /// The picture as an SVG document, with its typeface in it: programs that pass over that take the
    /// reader's.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let [w, h] = [self.width_px, self.height_px];
        let mut document = Document::new()
            .set("width", format!("{w:.0}"))
            .set("height", format!("{h:.0}"))
            .set("viewBox", format!("0 0 {:.0} {:.0}", w * UNITS, h * UNITS))
            .set("font-family", format!("{}, Helvetica, Arial, sans-serif", typeface::FAMILY))
            .add(Title::new(&*self.title))
            .add(Style::new(typeface::css()));
        for item in &self.items {
            match item {
                Item::Shape(shape) => add_shape(&mut document, shape),
                Item::Text(text) => document.append(label(text)),
            }
        }
        format!("{document}\n")
    }
}

fn add_shape(document: &mut Document, shape: &Shape) {
    let mut data = String::new();
    for chain in &shape.chains {
        write_chain(&mut data, chain, shape.closed);
    }
    if !data.is_empty() {
        document.append(painted(Path::new(), &shape.paint).set("d", data));
    }
}

/// One chain: its start absolute, then steps; points that fall together are left out. By hand, because the
/// svg crate's path data puts separators where a minus sign separates already.
fn write_chain(data: &mut String, chain: &[[f64; 2]], closed: bool) {
    let whole = |p: &[f64; 2]| p.map(|v| (v * UNITS).round().clamp(-1e7, 1e7) as i64);
    let mut points: Vec<[i64; 2]> = chain.iter().map(whole).collect();
    points.dedup();
    if closed && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let [first, rest @ ..] = &points[..] else { return };
    if rest.is_empty() {
        return;
    }
    let _ = write!(data, "M{} {}l", first[0], first[1]);
    let mut last = first;
    for (i, point) in rest.iter().enumerate() {
        let step = [point[0] - last[0], point[1] - last[1]];
        // A minus sign separates numbers by itself.
        let lead = if i > 0 && step[0] >= 0 { " " } else { "" };
        let gap = if step[1] >= 0 { " " } else { "" };
        let _ = write!(data, "{lead}{}{gap}{}", step[0], step[1]);
        last = point;
    }
    if closed {
        data.push('z');
    }
}

fn painted(path: Path, paint: &Paint) -> Path {
    let path = match paint.fill {
        Some(colour) => with_colour(path, "fill", colour),
        None => path.set("fill", "none"),
    };
    let Some(stroke) = paint.stroke else { return path };
    let mut path =
        with_colour(path, "stroke", stroke.colour).set("stroke-width", short(stroke.width_px * UNITS));
    if let Some([on, off]) = stroke.dash_px {
        path = path.set("stroke-dasharray", format!("{} {}", short(on * UNITS), short(off * UNITS)));
    }
    if stroke.round {
        path = path.set("stroke-linecap", "round").set("stroke-linejoin", "round");
    }
    path
}

fn with_colour(path: Path, what: &str, colour: Colour) -> Path {
    let path = path.set(what, hex(colour));
    match colour[3] {
        255 => path,
        alpha => path.set(format!("{what}-opacity"), format!("{:.2}", f64::from(alpha) / 255.0)),
    }
}

fn label(text: &Text) -> Label {
    let mut label = Label::new(&*text.text)
        .set("x", format!("{:.0}", text.at[0] * UNITS))
        .set("y", format!("{:.0}", text.at[1] * UNITS))
        .set("font-size", short(text.size_px * UNITS))
        .set("fill", hex(text.colour));
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => label = label.set("text-anchor", "middle"),
        Anchor::End => label = label.set("text-anchor", "end"),
    }
    if text.bold { label.set("font-weight", "600") } else { label }
}

fn hex([r, g, b, _]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A number with at most one decimal.
fn short(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_are_short_and_exact() {
        let mut data = String::new();
        write_chain(&mut data, &[[1.0, 2.0], [3.5, 1.0], [3.51, 1.01], [-4.0, 6.0], [1.0, 2.0]], true);
        assert_eq!(data, "M10 20l25-10-75 50z");
        data.clear();
        write_chain(&mut data, &[[1.0, 2.0], [1.01, 2.02]], false);
        assert_eq!(data, "", "a chain without extent is left out");
    }
}
