//! Texts as outlines, for pictures of pixels.

use typeface::Weight;

use crate::picture::{Anchor, Paint, Shape, Text};

/// A text as an area.
pub(crate) fn outlines(text: &Text) -> Shape {
    let weight = if text.bold { Weight::Bold } else { Weight::Regular };
    let line = typeface::write(&text.text, text.size_px, weight);
    let shift = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5 * line.length_px,
        Anchor::End => line.length_px,
    };
    let mut chains = line.rings;
    for point in chains.iter_mut().flatten() {
        *point = [text.at[0] + point[0] - shift, text.at[1] + point[1]];
    }
    Shape { chains, closed: true, paint: Paint::fill(text.colour) }
}
