//! Light that a lens loses towards the corners of its picture.

use simd::{F32x8, LANES};

/// The share of light that passes, falling by the square of the distance from the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vignette {
    middle: [f32; 2],
    /// Share that is lost a square pixel away.
    falls: f32,
}

impl Vignette {
    /// Of a picture of so many pixels that loses such a share in its very corners.
    pub(super) fn new(width: u32, height: u32, lost: f32) -> Self {
        let middle = [0.5 * width as f32, 0.5 * height as f32];
        let corner = (middle[0] * middle[0] + middle[1] * middle[1]).max(1.0);
        Self { middle, falls: lost / corner }
    }

    /// What passes at the middles of eight pixels of a row.
    #[inline]
    pub(super) fn passes(&self, columns: &[u32; LANES], row: u32) -> F32x8 {
        let x = F32x8::from(columns.map(|c| c as f32)) - (self.middle[0] - 0.5);
        let y = row as f32 + 0.5 - self.middle[1];
        1.0 - (x * x + y * y) * self.falls
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_lose_their_share_and_the_middle_nothing() {
        let lens = Vignette::new(1600, 900, 0.3);
        let at = |x: u32, y: u32| lens.passes(&[x; LANES], y).to_array()[0];
        assert!((at(0, 0) - 0.7).abs() < 1e-3 && (at(1599, 899) - 0.7).abs() < 1e-3);
        assert!((at(800, 450) - 1.0).abs() < 1e-5);
        // Half as far from the middle, a quarter as much.
        assert!((at(400, 225) - (1.0 - 0.3 / 4.0)).abs() < 1e-3);
    }
}
