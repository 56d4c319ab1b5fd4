//! Pixels to draw on.

use codecs::images::{Chroma, Pixels, PngStyle, encode_jpeg, encode_png};
use tiny_skia::{
    FillRule, FilterQuality, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Stroke,
    Transform,
};
use typeface::{Line, Weight};

use crate::PictureError;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Largest width and height of a picture, pixels.
const MOST_PX: u32 = 16_384;
/// Coordinates beyond this are pulled back: lines that long are cut before.
const FAR_PX: f64 = 1e6;

/// An opaque picture. Pixel (0, 0) reaches from 0 to 1, x to the right, y down.
#[derive(Clone, Debug)]
pub struct Canvas {
    pixels: Pixmap,
}

impl Canvas {
    /// A picture of one colour.
    ///
    /// # Errors
    /// [`PictureError::Size`].
    pub fn new([width, height]: [u32; 2], rgb: Rgb) -> Result<Self, PictureError> {
        let size = PictureError::Size(width, height);
        if width > MOST_PX || height > MOST_PX {
            return Err(size);
        }
        let mut pixels = Pixmap::new(width, height).ok_or(size)?;
        pixels.fill(tiny_skia::Color::from_rgba8(rgb[0], rgb[1], rgb[2], 255));
        Ok(Self { pixels })
    }

    /// A picture of given pixels: red, green, blue, row by row from the top.
    ///
    /// # Errors
    /// [`PictureError::Size`], or there are not as many pixels as that.
    pub fn from_rgb(size: [u32; 2], rgb: &[u8]) -> Result<Self, PictureError> {
        let mut canvas = Self::new(size, [0; 3])?;
        let expected = 3 * size[0] as usize * size[1] as usize;
        if rgb.len() != expected {
            return Err(PictureError::Shape { what: "pixels", found: rgb.len(), expected });
        }
        for (to, from) in canvas.pixels.data_mut().chunks_exact_mut(4).zip(rgb.chunks_exact(3)) {
            to[..3].copy_from_slice(from);
        }
        Ok(canvas)
    }

    /// Width and height, pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.pixels.width(), self.pixels.height()]
    }

    /// The pixels: red, green, blue, row by row from the top.
    #[must_use]
    pub fn to_rgb(&self) -> Vec<u8> {
        self.pixels.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect()
    }

    /// The pixels: red, green, blue, opacity, row by row from the top.
    #[must_use]
    pub fn into_rgba(self) -> Vec<u8> {
        self.pixels.take()
    }

    /// A pixel's colour; none outside.
    #[must_use]
    pub fn pixel(&self, [x, y]: [u32; 2]) -> Option<Rgb> {
        let p = self.pixels.pixel(x, y)?;
        Some([p.red(), p.green(), p.blue()])
    }

    /// Rows of pixels to be written: red, green, blue, opacity (which must stay 255).
    pub(crate) fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, u8> {
        let row = 4 * self.pixels.width() as usize;
        self.pixels.data_mut().chunks_exact_mut(row)
    }

    /// Draws lines through chains of points, with round ends.
    pub fn lines<'c>(&mut self, chains: impl IntoIterator<Item = &'c [[f64; 2]]>, width_px: f64, rgb: Rgb) {
        self.faint_lines(chains, width_px, rgb, 255);
    }

    /// Draws lines through which what is below shows, `opacity` of 255.
    pub fn faint_lines<'c>(
        &mut self,
        chains: impl IntoIterator<Item = &'c [[f64; 2]]>,
        width_px: f64,
        rgb: Rgb,
        opacity: u8,
    ) {
        let Some(path) = path_of(chains, false) else { return };
        let stroke = Stroke {
            width: width_px as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        self.pixels.stroke_path(&path, &brush(rgb, opacity), &stroke, Transform::identity(), None);
    }

    /// Fills rings of points (as one area with holes), `opacity` of 255.
    pub fn area<'c>(&mut self, rings: impl IntoIterator<Item = &'c [[f64; 2]]>, rgb: Rgb, opacity: u8) {
        self.fill(rings, FillRule::EvenOdd, rgb, opacity);
    }

    fn fill<'c>(
        &mut self,
        rings: impl IntoIterator<Item = &'c [[f64; 2]]>,
        rule: FillRule,
        rgb: Rgb,
        opacity: u8,
    ) {
        let Some(path) = path_of(rings, true) else { return };
        self.pixels.fill_path(&path, &brush(rgb, opacity), rule, Transform::identity(), None);
    }

    /// Fills a rectangle.
    pub fn rectangle(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], rgb: Rgb) {
        let ring = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        self.area([ring.as_slice()], rgb, 255);
    }

    /// Writes a line of text with its baseline at a point; its length, pixels.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, size_px: f64, rgb: Rgb, text: &str) -> f64 {
        self.write(at, anchor, (size_px, Weight::Regular), rgb, text)
    }

    /// Writes a line of bold text; its length, pixels.
    pub fn bold_text(&mut self, at: [f64; 2], anchor: Anchor, size_px: f64, rgb: Rgb, text: &str) -> f64 {
        self.write(at, anchor, (size_px, Weight::Bold), rgb, text)
    }

    fn write(
        &mut self,
        at: [f64; 2],
        anchor: Anchor,
        (size_px, weight): (f64, Weight),
        rgb: Rgb,
        text: &str,
    ) -> f64 {
        let Line { mut rings, length_px } = typeface::write(text, size_px, weight);
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * length_px,
            Anchor::End => length_px,
        };
        for point in rings.iter_mut().flatten() {
            *point = [at[0] - shift + point[0], at[1] + point[1]];
        }
        self.fill(rings.iter().map(Vec::as_slice), FillRule::Winding, rgb, 255);
        length_px
    }

    /// Puts a picture into a rectangle of this one, as large as fits, in its middle.
    pub fn paste(&mut self, picture: &Self, [x, y]: [f64; 2], [w, h]: [f64; 2]) {
        let [from_w, from_h] = picture.size().map(f64::from);
        let scale = (w / from_w).min(h / from_h);
        // Filters look at four pixels: what is shrunk more is shrunk by means of blocks first.
        let blocks = (1.0 / scale).floor().max(1.0) as u32;
        let smaller = picture.shrunk(blocks);
        let picture = smaller.as_ref().unwrap_or(picture);
        let [from_w, from_h] = picture.size().map(f64::from);
        let scale = (w / from_w).min(h / from_h);
        let at = [x + 0.5 * (w - scale * from_w), y + 0.5 * (h - scale * from_h)].map(|v| v.round() as f32);
        let paint = PixmapPaint { quality: FilterQuality::Bilinear, ..PixmapPaint::default() };
        let place = Transform::from_row(scale as f32, 0.0, 0.0, scale as f32, at[0], at[1]);
        self.pixels.draw_pixmap(0, 0, picture.pixels.as_ref(), &paint, place, None);
    }

    /// The picture with each block of so many pixels as one, their mean; none where nothing would change.
    fn shrunk(&self, block: u32) -> Option<Self> {
        let [w, h] = self.size().map(|side| side / block);
        if block < 2 || w == 0 || h == 0 {
            return None;
        }
        let mut small = Self::new([w, h], [0; 3]).ok()?;
        let (data, row) = (self.pixels.data(), 4 * self.size()[0] as usize);
        let n = block as usize;
        for (y, to_row) in small.rows_mut().enumerate() {
            for (x, to) in to_row.chunks_exact_mut(4).enumerate() {
                let mut sum = [0_u32; 3];
                for dy in 0..n {
                    let start = (y * n + dy) * row + 4 * x * n;
                    for pixel in data[start..start + 4 * n].chunks_exact(4) {
                        (0..3).for_each(|k| sum[k] += u32::from(pixel[k]));
                    }
                }
                let pixels = block * block;
                (0..3).for_each(|k| to[k] = ((sum[k] + pixels / 2) / pixels) as u8);
            }
        }
        Some(small)
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// [`PictureError::Image`].
    pub fn to_png(&self) -> Result<Vec<u8>, PictureError> {
        Ok(encode_png(self.size(), &Pixels::Rgb(&self.to_rgb()), PngStyle::SMALL)?)
    }

    /// As a JPEG file of a quality, 1 to 100.
    ///
    /// # Errors
    /// [`PictureError::Image`].
    pub fn to_jpeg(&self, quality: u8) -> Result<Vec<u8>, PictureError> {
        Ok(encode_jpeg(self.size(), &self.to_rgb(), quality, Chroma::ByQuality)?)
    }
}

fn brush([r, g, b]: Rgb, opacity: u8) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, opacity);
    paint
}

fn path_of<'c>(chains: impl IntoIterator<Item = &'c [[f64; 2]]>, closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for chain in chains {
        let mut points = chain.iter().map(|p| p.map(|v| v.clamp(-FAR_PX, FAR_PX) as f32));
        let Some([x, y]) = points.next() else { continue };
        builder.move_to(x, y);
        for [x, y] in points {
            builder.line_to(x, y);
        }
        if closed {
            builder.close();
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_go_in_and_come_out() {
        let rgb: Vec<u8> = (0..3 * 4 * 2).collect();
        let canvas = Canvas::from_rgb([4, 2], &rgb).expect("fits");
        assert_eq!(canvas.to_rgb(), rgb);
        assert_eq!(canvas.pixel([3, 1]), Some([21, 22, 23]));
        assert_eq!(canvas.pixel([4, 1]), None);
        let (size, back) = crate::decode_png(&canvas.to_png().expect("encodes")).expect("is a PNG");
        assert_eq!((size, back), ([4, 2], rgb.clone()));
        assert!(Canvas::from_rgb([4, 2], &rgb[1..]).is_err());
        assert!(Canvas::new([0, 2], [0; 3]).is_err() && Canvas::new([99_999, 2], [0; 3]).is_err());
    }

    #[test]
    fn lines_areas_and_pasted_pictures_stand_where_they_should() {
        let mut canvas = Canvas::new([40, 40], [255; 3]).expect("fits");
        canvas.lines([[[5.0, 10.0], [35.0, 10.0]].as_slice()], 2.0, [200, 0, 0]);
        assert_eq!(canvas.pixel([20, 9]), Some([200, 0, 0]));
        assert_eq!([canvas.pixel([20, 12]), canvas.pixel([2, 9])], [Some([255; 3]); 2]);
        canvas.rectangle([10.0, 20.0], [4.0, 4.0], [0, 9, 0]);
        assert_eq!([canvas.pixel([10, 20]), canvas.pixel([13, 23])], [Some([0, 9, 0]); 2]);
        assert_eq!(canvas.pixel([14, 20]), Some([255; 3]));
        // 20 x 10 into 10 x 10: half as large, in the middle of the height.
        let blue = Canvas::new([20, 10], [0, 0, 99]).expect("fits");
        canvas.paste(&blue, [30.0, 30.0], [10.0, 10.0]);
        assert_eq!([canvas.pixel([31, 33]), canvas.pixel([38, 36])], [Some([0, 0, 99]); 2]);
        assert_eq!([canvas.pixel([31, 31]), canvas.pixel([38, 39])], [Some([255; 3]); 2]);
    }

    #[test]
    fn shrinking_takes_means() {
        let canvas = Canvas::from_rgb([2, 2], &[0, 0, 0, 10, 20, 30, 20, 40, 60, 30, 60, 90]).expect("fits");
        assert_eq!(canvas.shrunk(2).and_then(|c| c.pixel([0, 0])), Some([15, 30, 45]));
        assert!(canvas.shrunk(1).is_none() && canvas.shrunk(3).is_none());
    }
}
