//! A column of cells as a mask of `64 * W` bits; bit 0 is the lowest cell.

use std::ops::{BitAnd, BitOr, Not, Range};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bits<const W: usize>(pub(super) [u64; W]);

impl<const W: usize> Bits<W> {
    pub(super) const ZERO: Self = Self([0; W]);

    /// Bits `start..end`.
    pub(super) fn range(start: usize, end: usize) -> Self {
        Self::range_below(end) & !Self::range_below(start)
    }

    /// The lowest `count` bits.
    pub(super) fn range_below(count: usize) -> Self {
        Self(std::array::from_fn(|word| match count.saturating_sub(64 * word) {
            0 => 0,
            left @ 1..64 => (1 << left) - 1,
            _ => u64::MAX,
        }))
    }

    pub(super) fn is_zero(self) -> bool {
        self.0.iter().fold(0, |any, word| any | word) == 0
    }

    /// Runs of bits that are set, ascending; those that go from word to word in pieces.
    pub(super) fn runs(self) -> impl Iterator<Item = Range<usize>> {
        self.0.into_iter().enumerate().flat_map(|(word, mut bits)| {
            std::iter::from_fn(move || {
                (bits != 0).then(|| {
                    let start = bits.trailing_zeros();
                    let end = start + (bits >> start).trailing_ones();
                    bits = if end < 64 { bits >> end << end } else { 0 };
                    64 * word + start as usize..64 * word + end as usize
                })
            })
        })
    }

    /// Positions of the bits that are set, ascending.
    fn ones(self) -> impl Iterator<Item = usize> {
        self.runs().flatten()
    }

    /// Where the run of bits begins that ends right below a place.
    fn start_of_run(self, end: usize) -> usize {
        let unset = !self & Self::range_below(end);
        let last = (0..W).rev().find(|&word| unset.0[word] != 0);
        last.map_or(0, |word| 64 * (word + 1) - unset.0[word].leading_zeros() as usize)
    }

    /// One place up.
    fn up(self) -> Self {
        let mut out = [0; W];
        let mut carry = 0;
        for (to, from) in out.iter_mut().zip(self.0) {
            *to = from << 1 | carry;
            carry = from >> 63;
        }
        Self(out)
    }

    fn plus(self, other: Self) -> Self {
        let mut out = [0; W];
        let mut carry = false;
        for (at, to) in out.iter_mut().enumerate() {
            let (sum, over) = self.0[at].overflowing_add(other.0[at]);
            let (sum, over_again) = sum.overflowing_add(u64::from(carry));
            (*to, carry) = (sum, over | over_again);
        }
        Self(out)
    }

    /// The free cells whose next occupied cell below is one of `wanted` (occupied cells).
    ///
    /// A run of free cells right above a wanted cell is a run of ones that gets a one added at its lowest
    /// place: the carry turns the whole run to zeros. All other runs stay ones.
    fn above(self, wanted: Self) -> Self {
        let free = self;
        let starts = wanted.up() & free;
        free & !free.plus(starts)
    }

    /// The free cells whose next occupied cells below and above are both of `wanted`.
    pub(super) fn enclosed(free: Self, wanted: Self) -> Self {
        let mut found = free.above(wanted);
        if found.is_zero() {
            return found;
        }
        // Whole runs of free cells, of which few end below something else, or at the top.
        let elsewhere = found.up() & !free & !wanted;
        let top = (found.0[W - 1] >> 63 != 0).then_some(64 * W);
        for end in elsewhere.ones().chain(top) {
            found = found & !Self::range(found.start_of_run(end), end);
        }
        found
    }
}

impl<const W: usize> Default for Bits<W> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const W: usize> BitAnd for Bits<W> {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(std::array::from_fn(|at| self.0[at] & other.0[at]))
    }
}

impl<const W: usize> BitOr for Bits<W> {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(std::array::from_fn(|at| self.0[at] | other.0[at]))
    }
}

impl<const W: usize> Not for Bits<W> {
    type Output = Self;
    fn not(self) -> Self {
        Self(self.0.map(|word| !word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn enclosed_is_what_a_walk_finds(cells in proptest::collection::vec(0..4_u8, 128)) {
            // 0 and 1: free; 2: wanted; 3: something else.
            let mask = |f: fn(u8) -> bool| {
                let mut bits = Bits::<2>::ZERO;
                for (at, _) in cells.iter().enumerate().filter(|(_, c)| f(**c)) {
                    bits.0[at / 64] |= 1 << (at % 64);
                }
                bits
            };
            let got = Bits::enclosed(mask(|c| c < 2), mask(|c| c == 2));
            for at in 0..128 {
                let below = cells[..at].iter().rev().find(|c| **c >= 2) == Some(&2);
                let above = cells[at..].iter().find(|c| **c >= 2) == Some(&2);
                let want = cells[at] < 2 && below && above;
                prop_assert_eq!(got.ones().any(|one| one == at), want, "cell {}", at);
            }
        }
    }

    #[test]
    fn bits_beyond_the_column_never_count() {
        // A column of 70 layers: everything above is neither free nor wanted.
        let free = Bits::<2>::range(1, 70);
        let wanted = Bits::<2>::range(0, 1);
        assert!(Bits::enclosed(free, wanted).is_zero());
    }
}
