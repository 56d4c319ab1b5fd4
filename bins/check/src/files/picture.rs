//! Images.

use std::io::Cursor;

/// An image of three bytes a pixel.
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Red, green, blue, row by row.
    pub(crate) rgb: Vec<u8>,
}

impl Picture {
    /// Of a PNG with 8-bit red, green and blue.
    pub(crate) fn of_png(bytes: &[u8]) -> Result<Self, String> {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|e| e.to_string())?;
        let size = reader.output_buffer_size().ok_or("is too large")?;
        let mut rgb = vec![0; size];
        let info = reader.next_frame(&mut rgb).map_err(|e| e.to_string())?;
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err(format!("has {:?} of {:?} bits", info.color_type, info.bit_depth));
        }
        Ok(Self { width: info.width as usize, height: info.height as usize, rgb })
    }

    /// Three bytes of each pixel, row by row.
    pub(crate) fn pixels(&self) -> &[[u8; 3]] {
        self.rgb.as_chunks::<3>().0
    }

    /// The pixel of a column and row.
    pub(crate) fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels()[y * self.width + x]
    }
}

/// Width and height that a JPEG states in its frame header.
pub(crate) fn jpeg_size(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8])?;
    loop {
        let [0xff, marker, high, low, ..] = *rest else { return None };
        let len = usize::from(u16::from_be_bytes([high, low]));
        // Start of frame of any process; c4, c8 and cc are tables.
        if (0xc0..=0xcf).contains(&marker) && ![0xc4, 0xc8, 0xcc].contains(&marker) {
            let side =
                |at: usize| Some(usize::from(u16::from_be_bytes([*rest.get(at)?, *rest.get(at + 1)?])));
            return Some((side(7)?, side(5)?));
        }
        rest = rest.get(2 + len..)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jpeg_tells_its_size_in_its_frame_header() {
        // Start, a comment of two bytes, a frame of 3 rows and 258 columns.
        let bytes = [
            [0xff, 0xd8].as_slice(),
            &[0xff, 0xfe, 0, 4, 7, 7],
            &[0xff, 0xc0, 0, 11, 8, 0, 3, 1, 2, 1, 1, 0x11, 0],
        ]
        .concat();
        assert_eq!(jpeg_size(&bytes), Some((258, 3)));
        assert_eq!(jpeg_size(&bytes[..10]), None);
        assert_eq!(jpeg_size(b"\x89PNG"), None);
    }

    #[test]
    fn pixels_are_read_row_by_row() {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("writes");
        writer.write_image_data(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]).expect("writes");
        writer.finish().expect("ends");
        let picture = Picture::of_png(&file).expect("reads");
        assert_eq!((picture.width, picture.height, picture.at(0, 1)), (2, 2, [7, 8, 9]));
        assert!(Picture::of_png(b"no picture").is_err());
    }
}
