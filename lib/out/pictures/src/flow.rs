//! Optical flow.

use frames::math;

use crate::colours::flow_rgb;
use crate::marks::round_up;
use crate::{Canvas, PictureError};

/// The longest motion of full colour is longer than this share of a picture's motions: a few pixels of what
/// passes close by would make all else pale.
const SHARE: f64 = 0.98;

/// Draws the motion of what each pixel shows by [`flow_rgb`]: white at rest, its direction as hue. The motion
/// of full colour, pixels a frame, is returned, too: a round number that suits the picture. What is no number
/// is black. `dx` and `dy` as [`schema::tables::FlowRow`] has them.
///
/// # Errors
/// There are not as many values as pixels.
pub fn draw_flow([width, height]: [u32; 2], dx: &[f32], dy: &[f32]) -> Result<(Canvas, f64), PictureError> {
    let expected = width as usize * height as usize;
    for found in [dx.len(), dy.len()] {
        if found != expected {
            return Err(PictureError::Shape { what: "flow", found, expected });
        }
    }
    // Both sides are two units long; up is positive.
    let scale = [0.5 * f64::from(width), -0.5 * f64::from(height)];
    let motion = |i: usize| [f64::from(dx[i]) * scale[0], f64::from(dy[i]) * scale[1]];
    let lengths = (0..expected).map(motion).map(|[x, y]| math::hypot(x, y));
    let mut lengths: Vec<f64> = lengths.filter(|length| length.is_finite()).collect();
    let place = (SHARE * lengths.len() as f64) as usize;
    let long = match lengths.len() {
        0 => 0.0,
        n => *lengths.select_nth_unstable_by(place.min(n - 1), f64::total_cmp).1,
    };
    let full_px = round_up(long.max(1.0));
    let mut canvas = Canvas::new([width, height], [0; 3])?;
    for (y, row) in canvas.rows_mut().enumerate() {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let step = motion(y * width as usize + x).map(|v| v / full_px);
            if step.iter().all(|v| v.is_finite()) {
                pixel[..3].copy_from_slice(&flow_rgb(step));
            }
        }
    }
    Ok((canvas, full_px))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_hues_and_lengths_strength() {
        // Right by 5 pixels; left by 2.5; up by 1; no number; else at rest (2 pixels high, 4 wide).
        let dx = [2.5, -1.25, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0];
        let dy = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let (canvas, full_px) = draw_flow([4, 2], &dx, &dy).expect("draws");
        let at = |x: u32| canvas.pixel([x, 0]).expect("is inside");
        assert_eq!(full_px, 5.0);
        assert_eq!([at(0), at(3)], [[255, 0, 0], [0; 3]]);
        assert_eq!(at(1), flow_rgb([-0.5, 0.0]));
        assert_eq!(at(2), flow_rgb([0.0, -0.2]), "up");
        assert_eq!(canvas.pixel([0, 1]), Some([255; 3]));
        assert!(draw_flow([4, 2], &dx[1..], &dy).is_err());
    }

    #[test]
    fn the_scale_suits_the_picture_and_not_its_fastest_pixels() {
        // 1000 pixels at 3 px a frame, 10 at 400: full colour at the next round number, 5.
        let mut dx = vec![6.0 / 1010.0; 1010];
        dx[..10].fill(800.0 / 1010.0);
        let (canvas, full_px) = draw_flow([1010, 1], &dx, &[0.0; 1010]).expect("draws");
        assert_eq!(full_px, 5.0);
        assert_eq!(canvas.pixel([0, 0]), Some(flow_rgb([2.0, 0.0])));
        assert_eq!(canvas.pixel([500, 0]), Some(flow_rgb([0.6, 0.0])));
        let (still, full_px) = draw_flow([2, 1], &[0.0; 2], &[0.0; 2]).expect("draws");
        assert_eq!((still.to_rgb(), full_px), (vec![255; 6], 1.0));
    }
}
