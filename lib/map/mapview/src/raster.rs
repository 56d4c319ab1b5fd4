//! Pictures as pixels.

use codecs::images::{ImageError, Pixels, PngStyle, encode_png};
use tiny_skia::{FillRule, LineCap, LineJoin, PathBuilder, Pixmap, StrokeDash, Transform};

use crate::letters;
use crate::picture::{Colour, Item, Picture, Shape};
use crate::style::PAPER;

/// Why a picture could not be turned into pixels.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// It is too large.
    #[error("a picture of {0:.0} x {1:.0} pixels does not fit into memory")]
    TooLarge(f64, f64),
    /// The PNG could not be encoded.
    #[error("the picture {0}")]
    Encode(ImageError),
}

impl Picture {
    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`RasterError`] where there is no memory for the pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, RasterError> {
        let pixels = pixels(self)?;
        encode(pixels.data(), [pixels.width(), pixels.height()])
    }
}

/// The pixels of a picture.
pub(crate) fn pixels(picture: &Picture) -> Result<Pixmap, RasterError> {
    let [width, height] = [picture.width_px, picture.height_px].map(|v| v.ceil().max(1.0) as u32);
    let mut pixels =
        Pixmap::new(width, height).ok_or(RasterError::TooLarge(picture.width_px, picture.height_px))?;
    pixels.fill(colour(PAPER));
    paint_all(&mut pixels, picture);
    Ok(pixels)
}

/// Paints a picture over pixels.
pub(crate) fn paint_all(pixels: &mut Pixmap, picture: &Picture) {
    for item in &picture.items {
        match item {
            Item::Shape(shape) => paint(pixels, shape),
            Item::Text(text) => paint(pixels, &letters::outlines(text)),
        }
    }
}

/// Opaque pixels (red, green, blue, opacity) as a PNG file.
pub(crate) fn encode(rgba: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, RasterError> {
    // The sheet is opaque: three channels say it all.
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    encode_png([width, height], &Pixels::Rgb(&rgb), PngStyle::SMALL).map_err(RasterError::Encode)
}

fn colour([r, g, b, a]: Colour) -> tiny_skia::Color {
    tiny_skia::Color::from_rgba8(r, g, b, a)
}

fn paint(pixels: &mut Pixmap, shape: &Shape) {
    let mut builder = PathBuilder::new();
    for chain in &shape.chains {
        let mut points = chain.iter().map(|p| p.map(|v| v.clamp(-1e6, 1e6) as f32));
        let Some([x, y]) = points.next() else { continue };
        builder.move_to(x, y);
        for [x, y] in points {
            builder.line_to(x, y);
        }
        if shape.closed {
            builder.close();
        }
    }
    let Some(path) = builder.finish() else { return };
    let brush = |c: Colour| {
        let mut brush = tiny_skia::Paint { anti_alias: true, ..tiny_skia::Paint::default() };
        brush.set_color(colour(c));
        brush
    };
    if let Some(fill) = shape.paint.fill {
        pixels.fill_path(&path, &brush(fill), FillRule::Winding, Transform::identity(), None);
    }
    if let Some(stroke) = shape.paint.stroke {
        let line = tiny_skia::Stroke {
            width: stroke.width_px as f32,
            line_cap: if stroke.round { LineCap::Round } else { LineCap::Butt },
            line_join: if stroke.round { LineJoin::Round } else { LineJoin::Miter },
            dash: stroke.dash_px.and_then(|[on, off]| StrokeDash::new(vec![on as f32, off as f32], 0.0)),
            ..tiny_skia::Stroke::default()
        };
        pixels.stroke_path(&path, &brush(stroke.colour), &line, Transform::identity(), None);
    }
}
