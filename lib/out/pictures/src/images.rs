//! Images whose pixels are numbers.

use schema::Tag;

use crate::colours::{depth_rgb, id_rgb};
use crate::{Canvas, PictureError};

/// Depth that a pixel of a depth image stands for at most, metres.
const FARTHEST_M: f64 = 1000.0;
/// Largest 24-bit number.
const FULL: f64 = 16_777_215.0;

/// Draws a depth image (24 bits a pixel, red lowest): yellow up to 1 m, dark violet from 1000 m, by
/// logarithms between.
///
/// # Errors
/// There are not as many values as pixels.
pub fn draw_depth(size: [u32; 2], rgb: &[u8]) -> Result<Canvas, PictureError> {
    mapped(size, rgb, |[r, g, b]| {
        let number = u32::from(r) | u32::from(g) << 8 | u32::from(b) << 16;
        depth_rgb(FARTHEST_M * f64::from(number) / FULL)
    })
}

/// Draws an instance image (red the tag, green and blue the object): each object in a colour of its own, what
/// belongs to none in that of its tag.
///
/// # Errors
/// There are not as many values as pixels.
pub fn draw_instances(size: [u32; 2], rgb: &[u8]) -> Result<Canvas, PictureError> {
    mapped(size, rgb, |[tag, low, high]| match u16::from_le_bytes([low, high]) {
        0 => Tag::from_u8(tag).unwrap_or_default().camera_rgb(),
        id => id_rgb(id),
    })
}

fn mapped(size: [u32; 2], rgb: &[u8], colour: impl Fn([u8; 3]) -> [u8; 3]) -> Result<Canvas, PictureError> {
    let drawn: Vec<u8> = rgb.chunks_exact(3).flat_map(|p| colour([p[0], p[1], p[2]])).collect();
    Canvas::from_rgb(size, &drawn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_decoded_red_lowest() {
        // 1 m is 16777; sqrt(1000) m lies in the middle of the logarithms; 1000 m is the end.
        let bytes = |depth_m: f64| {
            let number = (depth_m / FARTHEST_M * FULL).round() as u32;
            let [r, g, b, _] = number.to_le_bytes();
            [r, g, b]
        };
        let rgb = [bytes(0.5), bytes(1.0), bytes(1000.0_f64.sqrt()), bytes(1000.0)].concat();
        let canvas = draw_depth([4, 1], &rgb).expect("draws");
        let got = [0, 1, 2, 3].map(|x| canvas.pixel([x, 0]).expect("is inside"));
        assert_eq!(got, [1.0, 1.0, 1000.0_f64.sqrt(), 1000.0].map(depth_rgb));
        // Halfway between the ends of viridis.
        assert!((0..3).all(|k| got[2][k].abs_diff([33, 144, 141][k]) <= 6), "{got:?}");
    }

    #[test]
    fn objects_have_colours_of_their_own() {
        let rgb = [14, 7, 0, 15, 7, 0, 14, 7, 1, 11, 0, 0];
        let canvas = draw_instances([4, 1], &rgb).expect("draws");
        let at = |x: u32| canvas.pixel([x, 0]).expect("is inside");
        assert_eq!(at(0), at(1), "parts of an object");
        assert_ne!(at(0), at(2), "objects 7 and 263");
        assert_eq!(at(3), Tag::Sky.camera_rgb());
    }
}
