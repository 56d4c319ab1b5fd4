//! Pictures: they are copied as they are; their size is looked at, and whose pixels instance images show.

use std::collections::BTreeMap;

use codecs::images::{ImageError, Limits, PngRows};

/// How large a picture may be.
pub(crate) const LIMITS: Limits = Limits { side_px: 1 << 14, bytes: 1 << 29 };

/// Pixels of each object and tag in an instance image: red is the tag, green and blue the id's low and high
/// byte.
///
/// # Errors
/// It is no such PNG, or broken.
pub(crate) fn count_instances(
    bytes: &[u8],
    counts: &mut BTreeMap<(u16, u8), u32>,
) -> Result<[u32; 2], ImageError> {
    let mut rows = PngRows::open(bytes, LIMITS)?;
    let mut last = ([0; 3], 0_u32);
    let mut settle = |([tag, low, high], pixels): ([u8; 3], u32)| {
        let id = u16::from_le_bytes([low, high]);
        if id != 0 && pixels > 0 {
            *counts.entry((id, tag)).or_default() += pixels;
        }
    };
    while let Some(row) = rows.next_row()? {
        for pixel in row.chunks_exact(3) {
            if pixel == last.0 {
                last.1 += 1;
            } else {
                settle(std::mem::replace(&mut last, ([pixel[0], pixel[1], pixel[2]], 1)));
            }
        }
    }
    settle(last);
    Ok(rows.size())
}

#[cfg(test)]
mod tests {
    use codecs::images::{Pixels, PngStyle, encode_png};

    use super::*;

    #[test]
    fn pixels_are_counted_by_object_and_tag() {
        // Object 513 = 2 x 256 + 1 as a car and as a rider; sky.
        let data = [[14, 1, 2], [14, 1, 2], [13, 1, 2], [11, 0, 0], [14, 1, 2], [14, 9, 0]].concat();
        let file = encode_png([3, 2], &Pixels::Rgb(&data), PngStyle::FLAT).expect("fits");
        let mut counts = BTreeMap::new();
        assert_eq!(count_instances(&file, &mut counts).expect("is whole"), [3, 2]);
        assert_eq!(counts, BTreeMap::from([((513, 14), 3), ((513, 13), 1), ((9, 14), 1)]));
        assert!(count_instances(&file[..file.len() - 20], &mut counts).is_err());
    }
}
