//! Prefix codes: how many bits each symbol gets, and which.

/// The bits of each symbol.
pub(super) struct Code<const N: usize> {
    /// Bits in the order of writing, and how many.
    symbols: [(u16, u8); N],
}

impl<const N: usize> Code<N> {
    /// The code of some lengths (RFC 1951, 3.2.2): shorter ones first, equal ones by symbol; written from the
    /// highest bit on.
    pub(super) fn new(lengths: &[u8; N]) -> Self {
        let mut next = [0_u32; 17];
        lengths.iter().filter(|length| **length > 0).for_each(|length| next[usize::from(*length) + 1] += 1);
        for length in 1..17 {
            next[length] = (next[length] + next[length - 1]) << 1;
        }
        let mut symbols = [(0, 0); N];
        for (symbol, length) in symbols.iter_mut().zip(lengths).filter(|(_, length)| **length > 0) {
            let bits = next[usize::from(*length)];
            next[usize::from(*length)] += 1;
            *symbol = ((bits as u16).reverse_bits() >> (16 - length), *length);
        }
        Self { symbols }
    }

    /// The bits of a symbol, and how many.
    #[inline]
    pub(super) fn of(&self, symbol: usize) -> (u64, u32) {
        let (bits, count) = self.symbols[symbol];
        (u64::from(bits), u32::from(count))
    }
}

/// How many bits each symbol gets, at most `limit`: by how often it occurs (Huffman), in coarser counts where
/// that makes too long codes. Readers want complete codes: at least two symbols have one.
pub(super) fn lengths<const N: usize>(counts: &[u32; N], limit: u8) -> [u8; N] {
    let mut counts = *counts;
    for symbol in 0..2 {
        if counts.iter().filter(|count| **count > 0).count() < 2 {
            counts[symbol] = counts[symbol].max(1);
        }
    }
    loop {
        let lengths = huffman(&counts);
        if lengths.iter().all(|length| *length <= limit) {
            return lengths;
        }
        counts.iter_mut().filter(|count| **count > 0).for_each(|count| *count = count.div_ceil(2));
    }
}

/// Lengths of a code of the least bits, of at least two symbols that occur.
fn huffman<const N: usize>(counts: &[u32; N]) -> [u8; N] {
    let mut leaves: Vec<(u32, usize)> =
        counts.iter().copied().zip(0..N).filter(|(count, _)| *count > 0).collect();
    leaves.sort_unstable();
    // Nodes: leaves by count, then pairs in the order of making, which is by count, too. Both are queues.
    let mut weights: Vec<u32> = leaves.iter().map(|(count, _)| *count).collect();
    let mut parents = vec![0; 2 * leaves.len() - 1];
    let (mut leaf, mut pair) = (0, leaves.len());
    while weights.len() < parents.len() {
        let made = weights.len();
        let mut weight = 0;
        for _ in 0..2 {
            let takes_leaf = leaf < leaves.len() && (pair >= made || weights[leaf] <= weights[pair]);
            let queue = if takes_leaf { &mut leaf } else { &mut pair };
            weight += weights[*queue];
            parents[*queue] = made;
            *queue += 1;
        }
        weights.push(weight);
    }
    let mut depths = vec![0_u8; parents.len()];
    for node in (0..parents.len() - 1).rev() {
        depths[node] = depths[parents[node]].saturating_add(1);
    }
    let mut lengths = [0; N];
    leaves.iter().zip(&depths).for_each(|((_, symbol), depth)| lengths[*symbol] = *depth);
    lengths
}
