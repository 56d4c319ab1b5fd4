//! Pictures as SVG.

use std::fmt::Write;

use crate::picture::{Anchor, Colour, Item, Paint, Picture, Shape, Text};

/// Units of the document in a pixel: whole numbers make short files.
const UNITS: f64 = 10.0;

impl Picture {
    /// The picture as an SVG document. Texts are in the reader's sans-serif font.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let mut out = String::new();
        let [w, h] = [self.width_px, self.height_px];
        let _ = writeln!(
            out,
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w:.0}" height="{h:.0}" viewBox="0 0 {:.0} {:.0}" font-family="Helvetica, Arial, sans-serif">"#,
            w * UNITS,
            h * UNITS
        );
        let _ = writeln!(out, "<title>{}</title>", escaped(&self.title));
        for item in &self.items {
            match item {
                Item::Shape(shape) => write_shape(&mut out, shape),
                Item::Text(text) => write_text(&mut out, text),
            }
        }
        out.push_str("</svg>\n");
        out
    }
}

fn write_shape(out: &mut String, shape: &Shape) {
    let mut data = String::new();
    for chain in &shape.chains {
        write_chain(&mut data, chain, shape.closed);
    }
    if data.is_empty() {
        return;
    }
    let _ = write!(out, "<path");
    write_paint(out, &shape.paint);
    let _ = writeln!(out, " d=\"{data}\"/>");
}

/// One chain: its start absolute, then steps; points that fall together are left out.
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

fn write_paint(out: &mut String, paint: &Paint) {
    match paint.fill {
        Some(colour) => {
            let _ = write!(out, " fill=\"{}\"{}", hex(colour), opacity("fill", colour));
        }
        None => out.push_str(" fill=\"none\""),
    }
    let Some(stroke) = paint.stroke else { return };
    let colour = stroke.colour;
    let _ = write!(
        out,
        " stroke=\"{}\"{} stroke-width=\"{}\"",
        hex(colour),
        opacity("stroke", colour),
        short(stroke.width_px * UNITS)
    );
    if let Some([on, off]) = stroke.dash_px {
        let _ = write!(out, " stroke-dasharray=\"{} {}\"", short(on * UNITS), short(off * UNITS));
    }
    if stroke.round {
        out.push_str(" stroke-linecap=\"round\" stroke-linejoin=\"round\"");
    }
}

fn write_text(out: &mut String, text: &Text) {
    let anchor = match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let weight = if text.bold { " font-weight=\"600\"" } else { "" };
    let _ = writeln!(
        out,
        "<text x=\"{:.0}\" y=\"{:.0}\" font-size=\"{}\"{anchor}{weight} fill=\"{}\">{}</text>",
        text.at[0] * UNITS,
        text.at[1] * UNITS,
        short(text.size_px * UNITS),
        hex(text.colour),
        escaped(&text.text)
    );
}

fn hex([r, g, b, _]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn opacity(what: &str, colour: Colour) -> String {
    if colour[3] == 255 {
        String::new()
    } else {
        format!(" {what}-opacity=\"{:.2}\"", f64::from(colour[3]) / 255.0)
    }
}

/// A number with at most one decimal.
fn short(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Not allowed in XML at all.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
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

    #[test]
    fn names_from_files_cannot_break_the_document() {
        assert_eq!(escaped("a<b> & \"c\"\u{1}"), "a&lt;b&gt; &amp; &quot;c&quot; ");
    }
}
