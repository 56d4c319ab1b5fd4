//! PNG files.

use std::io::{Cursor, Write};

use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter, Transformations};

use super::error::ImageError;
use super::jpeg::decode_jpeg;
use super::rgb::{Limits, RgbImage};

/// The pixels of a PNG that is written, row by row from the top.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Red, green and blue, a byte each.
    Rgb(&'a [u8]),
    /// A byte of grey.
    Grey(&'a [u8]),
    /// A byte that names a colour of the palette (red, green, blue); colour 0 is not drawn.
    Indexed(&'a [u8], &'a [u8]),
}

/// How a PNG is compressed.
#[derive(Clone, Copy, Debug)]
pub struct PngStyle {
    compression: Option<Compression>,
    filter: Option<Filter>,
}

impl PngStyle {
    /// As the encoder itself chooses.
    pub const SMALL: Self = Self { compression: None, filter: None };
    /// Fast, for areas of one colour: each byte less the one to its left.
    pub const FLAT: Self = Self { compression: Some(Compression::Fast), filter: Some(Filter::Sub) };
    /// Fast, for gradients and photographs: Paeth's predictor.
    pub const SMOOTH: Self = Self { compression: Some(Compression::Fast), filter: Some(Filter::Paeth) };
    /// Fast, each row filtered as the encoder chooses.
    pub const FAST: Self = Self { compression: Some(Compression::Fast), filter: None };
    /// As small as can be, for names of colours.
    pub const INDEXED: Self = Self { compression: Some(Compression::High), filter: Some(Filter::NoFilter) };
}

fn encoder<W: Write>(
    out: W,
    [width, height]: [u32; 2],
    color: ColorType,
    style: PngStyle,
) -> Encoder<'static, W> {
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    if let Some(compression) = style.compression {
        encoder.set_compression(compression);
    }
    if let Some(filter) = style.filter {
        encoder.set_filter(filter);
    }
    encoder
}

/// A PNG of 8 bits a channel.
///
/// # Errors
/// There are not as many pixels as the size says.
pub fn encode_png(size: [u32; 2], pixels: &Pixels<'_>, style: PngStyle) -> Result<Vec<u8>, ImageError> {
    let (color, data) = match pixels {
        Pixels::Rgb(data) => (ColorType::Rgb, data),
        Pixels::Grey(data) => (ColorType::Grayscale, data),
        Pixels::Indexed(data, _) => (ColorType::Indexed, data),
    };
    let mut bytes = Vec::with_capacity(data.len() / 16);
    let mut encoder = encoder(&mut bytes, size, color, style);
    if let Pixels::Indexed(_, palette) = pixels {
        encoder.set_palette(palette.to_vec());
        encoder.set_trns(vec![0_u8]);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

/// Writes a PNG of grey, row by row: `fill` gets each row's number from the top and its bytes, all 0.
///
/// # Errors
/// The stream cannot be written.
pub fn write_grey_rows<W: Write>(
    out: W,
    size: [u32; 2],
    style: PngStyle,
    mut fill: impl FnMut(u32, &mut [u8]),
) -> Result<(), ImageError> {
    let mut writer = encoder(out, size, ColorType::Grayscale, style).write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut line = vec![0; size[0] as usize];
    for row in 0..size[1] {
        line.fill(0);
        fill(row, &mut line);
        stream.write_all(&line).map_err(png::EncodingError::IoError)?;
    }
    stream.finish()?;
    Ok(writer.finish()?)
}

/// A PNG of red, green and blue that is read row by row.
pub struct PngRows<'a> {
    reader: png::Reader<Cursor<&'a [u8]>>,
}

impl<'a> PngRows<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// It is no PNG, too large, or has other pixels than red, green and blue of 8 bits.
    pub fn open(bytes: &'a [u8], limits: Limits) -> Result<Self, ImageError> {
        let decoder = Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: limits.bytes });
        let reader = decoder.read_info().map_err(ImageError::Png)?;
        let info = reader.info();
        limits.check(info.width as usize, info.height as usize)?;
        let (color, depth) = (info.color_type, info.bit_depth);
        if (color, depth) != (ColorType::Rgb, BitDepth::Eight) {
            return Err(ImageError::Kind { color, depth });
        }
        Ok(Self { reader })
    }

    /// Width and height, pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.reader.info().width, self.reader.info().height]
    }

    /// The next row, three bytes a pixel; none after the last.
    ///
    /// # Errors
    /// The file is broken.
    pub fn next_row(&mut self) -> Result<Option<&[u8]>, ImageError> {
        Ok(self.reader.next_row().map_err(ImageError::Png)?.map(|row| row.data()))
    }
}

/// Width and height of a PNG of red, green and blue with 8 bits each.
///
/// # Errors
/// It is none, or too large.
pub fn png_size(bytes: &[u8], limits: Limits) -> Result<[u32; 2], ImageError> {
    Ok(PngRows::open(bytes, limits)?.size())
}

/// The pixels of a PNG of red, green and blue with 8 bits each.
///
/// # Errors
/// It is none, broken, or too large.
pub fn decode_png(bytes: &[u8], limits: Limits) -> Result<RgbImage, ImageError> {
    let PngRows { mut reader } = PngRows::open(bytes, limits)?;
    let size = [reader.info().width, reader.info().height];
    let len = reader.output_buffer_size().filter(|len| *len <= limits.bytes).ok_or(ImageError::TooLarge)?;
    let mut rgb = vec![0; len];
    reader.next_frame(&mut rgb).map_err(ImageError::Png)?;
    RgbImage::of(size, rgb)
}

/// An image of any kind: its colours, and how much of each pixel is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnyImage {
    /// Colours, grey as equal red, green and blue.
    pub image: RgbImage,
    /// Opacity of each pixel, of 255; empty: all are opaque.
    pub alpha: Vec<u8>,
}

/// The pixels of a PNG or JPEG of any kind. Its size is looked at before anything is decoded.
///
/// # Errors
/// It is neither, broken, or too large.
pub fn decode_any(bytes: &[u8], limits: Limits) -> Result<AnyImage, ImageError> {
    if bytes.starts_with(b"\x89PNG") {
        decode_any_png(bytes, limits)
    } else if bytes.starts_with(&[0xff, 0xd8]) {
        Ok(AnyImage { image: decode_jpeg(bytes, limits)?, alpha: Vec::new() })
    } else {
        Err(ImageError::Unknown)
    }
}

fn decode_any_png(bytes: &[u8], limits: Limits) -> Result<AnyImage, ImageError> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: limits.bytes });
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let header = decoder.read_header_info().map_err(ImageError::Png)?;
    let size = limits.check(header.width as usize, header.height as usize)?;
    let mut reader = decoder.read_info().map_err(ImageError::Png)?;
    let mut data = vec![0; reader.output_buffer_size().ok_or(ImageError::TooLarge)?];
    let info = reader.next_frame(&mut data).map_err(ImageError::Png)?;
    let pixels = &data[..info.buffer_size()];
    let rgb: Vec<u8> = match info.color_type {
        ColorType::Rgb => pixels.to_vec(),
        ColorType::Rgba => pixels.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        ColorType::Grayscale => pixels.iter().flat_map(|v| [*v; 3]).collect(),
        ColorType::GrayscaleAlpha => pixels.as_chunks::<2>().0.iter().flat_map(|[v, _]| [*v; 3]).collect(),
        // The decoder was told to replace names of colours by the colours.
        color @ ColorType::Indexed => return Err(ImageError::Kind { color, depth: info.bit_depth }),
    };
    let alpha = match info.color_type {
        ColorType::Rgba => pixels.as_chunks::<4>().0.iter().map(|[.., a]| *a).collect(),
        ColorType::GrayscaleAlpha => pixels.as_chunks::<2>().0.iter().map(|[_, a]| *a).collect(),
        _ => Vec::new(),
    };
    Ok(AnyImage { image: RgbImage::of(size, rgb)?, alpha })
}
