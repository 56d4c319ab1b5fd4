//! DEFLATE (RFC 1951) of records of equal length: fast, because it knows where bytes come back.
//!
//! General compressors look for repeats everywhere. In a list of points or a field of vectors they find them
//! in few places: a record before, or a row of the picture before. The rest is digits of measurements, which
//! only a code of their frequencies shortens. Looking nowhere else takes a quarter of the time of zlib-rs at
//! its fastest two levels, and what comes out is smaller than those make of it.

mod code;

use self::code::{Code, lengths};

/// Where bytes of an array come back, and where that is looked for.
#[derive(Clone, Copy, Debug)]
pub struct Repeats<'a> {
    /// How far before, bytes: the length of a record, of a row. Those beyond 32 KiB are passed over.
    pub distances: &'a [usize],
    /// Repeats begin at multiples of this, bytes: 1 finds most, more is faster.
    pub step: usize,
}

impl Repeats<'_> {
    /// Nowhere: noise.
    pub const NONE: Self = Self { distances: &[], step: 1 };
}

/// Bytes of input whose symbols have codes of their own.
const BLOCK: usize = 64 << 10;
/// Repeats are at most this long, and go back at most so far.
const MAX_LENGTH: usize = 258;
const MAX_DISTANCE: usize = 32 << 10;
/// Shorter ones are not worth their code.
const MIN_LENGTH: usize = 3;
/// The first bytes of a word, that many: where they differ, no repeat is worth it.
const TOO_SHORT: u64 = (1 << (8 * MIN_LENGTH)) - 1;

/// Codes have at most so many bits.
const LONGEST_CODE: u8 = 15;

const END_OF_BLOCK: usize = 256;
const LITERALS: usize = 286;
const DISTANCES: usize = 30;

/// Compresses `bytes` with these repeats alone, after `head`, which is left as it is.
pub(crate) fn deflate(head: &[u8], bytes: &[u8], repeats: Repeats<'_>) -> Vec<u8> {
    let mut out = Bits { bytes: Vec::with_capacity(head.len() + bytes.len() / 2 + 256), held: 0, count: 0 };
    for part in head.chunks(usize::from(u16::MAX)) {
        out.stored(part);
    }
    let near = repeats.distances.iter().filter(|bytes| (1..=MAX_DISTANCE).contains(*bytes));
    let distances: Vec<usize> = near.copied().collect();
    let step = repeats.step.max(1);
    let mut block = Block { bytes, distances: &distances, step, start: 0, steps: Vec::new() };
    for start in (0..bytes.len()).step_by(BLOCK) {
        block.read(start, (start + BLOCK).min(bytes.len()));
        block.write(&mut out);
    }
    // The last block: fixed codes, and nothing in it but its end.
    out.put(0b011, 10);
    out.finish()
}

/// Bytes as they are, then a repeat (the last one of a block has none).
#[derive(Clone, Copy, Debug)]
struct Step {
    literals: u32,
    length: u16,
    distance: u16,
}

/// A block: what is to be written.
struct Block<'a> {
    bytes: &'a [u8],
    distances: &'a [usize],
    step: usize,
    start: usize,
    steps: Vec<Step>,
}

impl<'a> Block<'a> {
    /// Finds the repeats in a piece of the bytes.
    fn read(&mut self, start: usize, end: usize) {
        self.start = start;
        self.steps.clear();
        let (mut from, mut at) = (start, start);
        while !self.distances.is_empty() && at + 8 <= end {
            let (length, distance) = self.longest(at, end);
            if length < MIN_LENGTH {
                at = (at / self.step + 1) * self.step;
                continue;
            }
            self.steps.push(Step {
                literals: (at - from) as u32,
                length: length as u16,
                distance: distance as u16,
            });
            at += length;
            from = at;
        }
        self.steps.push(Step { literals: (end - from) as u32, length: 0, distance: 0 });
    }

    /// The longest repeat at a place, and which distance it has; of equal ones the first distance's.
    #[inline]
    fn longest(&self, at: usize, end: usize) -> (usize, usize) {
        let mut best = (0, 0);
        for (i, distance) in self.distances.iter().enumerate() {
            let Some(before) = at.checked_sub(*distance) else { continue };
            let differ = word(self.bytes, at) ^ word(self.bytes, before);
            if differ & TOO_SHORT != 0 {
                continue;
            }
            let length = match differ {
                0 => self.common(at, before, end),
                differ => (differ.trailing_zeros() / 8) as usize,
            };
            if length > best.0 {
                best = (length, i);
            }
        }
        best
    }

    /// How many bytes are equal from two places on, of which eight are.
    fn common(&self, at: usize, before: usize, end: usize) -> usize {
        let most = (end - at).min(MAX_LENGTH);
        let mut length = 8;
        while length + 8 <= most {
            let differ = word(self.bytes, at + length) ^ word(self.bytes, before + length);
            if differ != 0 {
                return length + (differ.trailing_zeros() / 8) as usize;
            }
            length += 8;
        }
        let rest = self.bytes[at + length..at + most].iter().zip(&self.bytes[before + length..]);
        length + rest.take_while(|(a, b)| a == b).count()
    }

    /// Writes the block with codes of its own.
    fn write(&self, out: &mut Bits) {
        let (literals, backs) = self.counted();
        let (literals, backs) = (lengths(&literals, LONGEST_CODE), lengths(&backs, LONGEST_CODE));
        out.put(0b100, 3);
        write_lengths(out, &literals, &backs);
        let (literal, back) = (Code::new(&literals), Code::new(&backs));
        let mut at = self.start;
        for step in &self.steps {
            let bytes = &self.bytes[at..at + step.literals as usize];
            let mut threes = bytes.chunks_exact(3);
            for three in threes.by_ref() {
                let [(a, n), (b, m), (c, k)] =
                    [three[0], three[1], three[2]].map(|byte| literal.of(usize::from(byte)));
                out.put(a | b << n | c << (n + m), n + m + k);
            }
            for byte in threes.remainder() {
                let (bits, count) = literal.of(usize::from(*byte));
                out.put(bits, count);
            }
            at += bytes.len() + usize::from(step.length);
            if step.length > 0 {
                let (symbol, extra, extra_bits) = length_symbol(usize::from(step.length));
                let (code, count) = literal.of(symbol);
                let length = (code | u64::from(extra) << count, count + extra_bits);
                let (symbol, extra, extra_bits) = back_symbol(self.distances[usize::from(step.distance)]);
                let (code, count) = back.of(symbol);
                let distance = (code | u64::from(extra) << count, count + extra_bits);
                out.put(length.0 | distance.0 << length.1, length.1 + distance.1);
            }
        }
        let (bits, count) = literal.of(END_OF_BLOCK);
        out.put(bits, count);
    }

    /// How often each symbol occurs.
    fn counted(&self) -> ([u32; LITERALS], [u32; DISTANCES]) {
        // Two tables, as equal bytes after one another would wait for each other's count.
        let (mut even, mut odd, mut backs) = ([0; LITERALS], [0; 256], [0; DISTANCES]);
        let mut at = self.start;
        for step in &self.steps {
            let bytes = &self.bytes[at..at + step.literals as usize];
            let mut pairs = bytes.chunks_exact(2);
            for pair in pairs.by_ref() {
                even[usize::from(pair[0])] += 1;
                odd[usize::from(pair[1])] += 1;
            }
            pairs.remainder().iter().for_each(|byte| even[usize::from(*byte)] += 1);
            at += bytes.len() + usize::from(step.length);
            if step.length > 0 {
                even[length_symbol(usize::from(step.length)).0] += 1;
                backs[back_symbol(self.distances[usize::from(step.distance)]).0] += 1;
            }
        }
        even.iter_mut().zip(&odd).for_each(|(count, more)| *count += more);
        even[END_OF_BLOCK] = 1;
        (even, backs)
    }
}

/// The symbol of a distance with its extra bits. RFC 1951, 3.2.5: symbols 2 k and 2 k + 1 share their number
/// of extra bits, k - 1.
fn back_symbol(distance: usize) -> (usize, u32, u32) {
    let zero_based = (distance - 1) as u32;
    if zero_based < 4 {
        return (zero_based as usize, 0, 0);
    }
    let top = 31 - zero_based.leading_zeros();
    let extra_bits = top - 1;
    ((2 * top + (zero_based >> extra_bits & 1)) as usize, zero_based & ((1 << extra_bits) - 1), extra_bits)
}

/// The symbol of a repeat's length with its extra bits: likewise, four symbols of each number of them.
fn length_symbol(length: usize) -> (usize, u32, u32) {
    let zero_based = (length - 3) as u32;
    if length == MAX_LENGTH {
        return (285, 0, 0);
    }
    if zero_based < 8 {
        return (257 + zero_based as usize, 0, 0);
    }
    let extra_bits = 31 - zero_based.leading_zeros() - 2;
    let symbol = 257 + (4 * extra_bits + (zero_based >> extra_bits)) as usize;
    (symbol, zero_based & ((1 << extra_bits) - 1), extra_bits)
}

fn word(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(word)
}

/// The lengths of both codes, themselves in a code (RFC 1951, 3.2.7); of repeated lengths no use is made.
fn write_lengths(out: &mut Bits, literals: &[u8; LITERALS], distances: &[u8; DISTANCES]) {
    const ORDER: [usize; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
    let mut counts = [0; 19];
    literals.iter().chain(distances).for_each(|length| counts[usize::from(*length)] += 1);
    let own = lengths::<19>(&counts, 7);
    out.put((LITERALS - 257) as u64, 5);
    out.put((DISTANCES - 1) as u64, 5);
    out.put((ORDER.len() - 4) as u64, 4);
    ORDER.iter().for_each(|symbol| out.put(u64::from(own[*symbol]), 3));
    let code = Code::new(&own);
    for length in literals.iter().chain(distances) {
        let (bits, count) = code.of(usize::from(*length));
        out.put(bits, count);
    }
}

/// Bits, the lowest first, to bytes.
struct Bits {
    bytes: Vec<u8>,
    held: u64,
    count: u32,
}

impl Bits {
    /// Appends up to 56 bits.
    #[inline(always)]
    fn put(&mut self, bits: u64, count: u32) {
        self.held |= bits << self.count;
        self.count += count;
        let whole = self.count / 8;
        // One store of fixed length, of which the last bytes are taken back: faster than one of as many as
        // there are.
        self.bytes.extend_from_slice(&self.held.to_le_bytes());
        self.bytes.truncate(self.bytes.len() - 8 + whole as usize);
        self.held >>= 8 * whole;
        self.count -= 8 * whole;
    }

    /// Appends a block of bytes as they are.
    fn stored(&mut self, bytes: &[u8]) {
        self.put(0, 3);
        self.put(0, (8 - self.count) % 8);
        let length = bytes.len() as u16;
        self.bytes.extend_from_slice(&length.to_le_bytes());
        self.bytes.extend_from_slice(&(!length).to_le_bytes());
        self.bytes.extend_from_slice(bytes);
    }

    fn finish(mut self) -> Vec<u8> {
        self.put(0, (8 - self.count) % 8);
        self.bytes
    }
}
