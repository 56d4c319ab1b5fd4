//! Optical flow.

use frames::math;

use crate::colours::hsv;
use crate::{Canvas, PictureError};

/// Draws the motion of what each pixel shows: its direction as hue (right red, up yellow-green, left cyan,
/// down violet), its length as brightness, from the least of the picture to the greatest, by square roots so
/// that slow things are seen. `dx` and `dy` as [`schema::tables::FlowRow`] has them.
///
/// # Errors
/// There are not as many values as pixels.
pub fn draw_flow([width, height]: [u32; 2], dx: &[f32], dy: &[f32]) -> Result<Canvas, PictureError> {
    let expected = width as usize * height as usize;
    for found in [dx.len(), dy.len()] {
        if found != expected {
            return Err(PictureError::Shape { what: "flow", found, expected });
        }
    }
    // Both sides are two units long: in pixels angles are those that are seen.
    let scale = [width, height].map(|side| 0.5 * f64::from(side));
    let motion = |i: usize| [f64::from(dx[i]) * scale[0], f64::from(dy[i]) * scale[1]];
    let length = |[x, y]: [f64; 2]| math::hypot(x, y);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for i in 0..expected {
        let length = length(motion(i));
        if length.is_finite() {
            least = least.min(length);
            most = most.max(length);
        }
    }
    let mut canvas = Canvas::new([width, height], [0; 3])?;
    for (y, row) in canvas.rows_mut().enumerate() {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let step = motion(y * width as usize + x);
            let share = (length(step) - least) / (most - least);
            // A picture in which all moves alike, or nothing, is black, and so is what is no number.
            if share > 0.0 {
                let hue = math::atan2(step[1], step[0]) / (2.0 * std::f64::consts::PI);
                pixel[..3].copy_from_slice(&hsv([hue, 1.0, share.min(1.0).sqrt()]));
            }
        }
    }
    Ok(canvas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_hues_and_lengths_brightness() {
        // Right by 4 pixels; left by 4; up by 1; not at all (the picture is 2 pixels high, 4 wide).
        let dx = [2.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let dy = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let canvas = draw_flow([4, 2], &dx, &dy).expect("draws");
        let at = |x: u32| canvas.pixel([x, 0]).expect("is inside");
        assert_eq!([at(0), at(1), at(3)], [[255, 0, 0], [0, 255, 255], [0, 0, 0]]);
        // A quarter as far: half as bright; up is a quarter of the wheel: between yellow and green.
        assert_eq!(at(2), [64, 128, 0]);
        assert!(draw_flow([4, 2], &dx[1..], &dy).is_err());
        assert_eq!(draw_flow([2, 1], &[1.0; 2], &[1.0; 2]).expect("draws").to_rgb(), [0; 6]);
    }
}
