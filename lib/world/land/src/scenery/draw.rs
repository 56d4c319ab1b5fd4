//! Draws among kinds.

use random::Stream;

/// An index drawn with the given shares.
pub(crate) fn draw(random: &mut Stream, shares: &[f64]) -> usize {
    let mut rest = random.unit();
    for (i, share) in shares.iter().enumerate() {
        rest -= share;
        if rest < 0.0 {
            return i;
        }
    }
    shares.len() - 1
}
