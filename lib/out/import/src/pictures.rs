//! Pictures: they are copied as they are; their size is looked at, and whose pixels instance images show.

use std::collections::BTreeMap;
use std::io::Cursor;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;

/// Most pixels of a picture along a side.
const MAX_SIDE: usize = 1 << 14;
/// Most bytes that a decoded picture may take.
const MAX_DECODED: usize = 1 << 29;

/// Width and height of a JPEG.
///
/// # Errors
/// It is none.
pub(crate) fn jpeg_size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let mut decoder = JpegDecoder::new(ZCursor::new(bytes));
    decoder.decode_headers().map_err(|e| format!("is no JPEG: {e}"))?;
    let (width, height) = decoder.dimensions().ok_or("is no JPEG: it has no size")?;
    sized(width, height)
}

fn sized(width: usize, height: usize) -> Result<(u32, u32), String> {
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("has {width} x {height} pixels, at most {MAX_SIDE} along a side are possible"));
    }
    Ok((width as u32, height as u32))
}

fn png(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_limits(png::Limits { bytes: MAX_DECODED });
    let reader = decoder.read_info().map_err(|e| format!("is no PNG: {e}"))?;
    let info = reader.info();
    sized(info.width as usize, info.height as usize)?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err(format!(
            "is a PNG of {:?} with {:?} bits, expected red, green, blue of 8",
            info.color_type, info.bit_depth
        ));
    }
    Ok(reader)
}

/// Width and height of a PNG of red, green and blue with 8 bits each.
///
/// # Errors
/// It is none.
pub(crate) fn png_size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let reader = png(bytes)?;
    Ok((reader.info().width, reader.info().height))
}

/// Pixels of each object and tag in an instance image: red is the tag, green and blue the id's low and high byte.
///
/// # Errors
/// It is no such PNG, or broken.
pub(crate) fn count_instances(
    bytes: &[u8],
    counts: &mut BTreeMap<(u16, u8), u32>,
) -> Result<(u32, u32), String> {
    let mut reader = png(bytes)?;
    let size = (reader.info().width, reader.info().height);
    let mut last = ([0; 3], 0_u32);
    let mut settle = |([tag, low, high], pixels): ([u8; 3], u32)| {
        let id = u16::from_le_bytes([low, high]);
        if id != 0 && pixels > 0 {
            *counts.entry((id, tag)).or_default() += pixels;
        }
    };
    while let Some(row) = reader.next_row().map_err(|e| format!("is a broken PNG: {e}"))? {
        for pixel in row.data().chunks_exact(3) {
            if pixel == last.0 {
                last.1 += 1;
            } else {
                settle(std::mem::replace(&mut last, ([pixel[0], pixel[1], pixel[2]], 1)));
            }
        }
    }
    settle(last);
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(color: png::ColorType, data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 3, 2);
        encoder.set_color(color);
        encoder.write_header().expect("fits").write_image_data(data).expect("fits");
        file
    }

    #[test]
    fn pixels_are_counted_by_object_and_tag() {
        // Object 513 = 2 x 256 + 1 as a car and as a rider; sky.
        let data = [[14, 1, 2], [14, 1, 2], [13, 1, 2], [11, 0, 0], [14, 1, 2], [14, 9, 0]].concat();
        let file = encoded(png::ColorType::Rgb, &data);
        let mut counts = BTreeMap::new();
        assert_eq!(count_instances(&file, &mut counts), Ok((3, 2)));
        assert_eq!(counts, BTreeMap::from([((513, 14), 3), ((513, 13), 1), ((9, 14), 1)]));
        assert_eq!(png_size(&file), Ok((3, 2)));
        assert!(count_instances(&file[..file.len() - 20], &mut counts).is_err());
    }

    #[test]
    fn other_files_are_refused() {
        assert!(
            png_size(&encoded(png::ColorType::Grayscale, &[0; 6]))
                .expect_err("grey")
                .contains("expected red")
        );
        assert!(
            png_size(b"\x89PNG").is_err() && jpeg_size(b"\xff\xd8\xff").is_err() && jpeg_size(b"").is_err()
        );
    }
}
