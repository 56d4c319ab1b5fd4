//! Counter-based random streams named by (dataset seed, scene, topic, entity).
//!
//! A stream is a key; its numbers are Philox4x32-10 blocks of a counter. Two streams never share draws, so a
//! new draw in one topic moves no other, and draw `n` can be computed without the `n - 1` before it, on any
//! thread.
//!
//! ```
//! use random::Stream;
//!
//! let mut duration = Stream::new(27, 3, "plan/duration", 0);
//! let seconds = duration.uniform(8.0, 32.0);
//! assert_eq!(seconds, Stream::new(27, 3, "plan/duration", 0).uniform(8.0, 32.0));
//! assert_ne!(seconds, Stream::new(27, 4, "plan/duration", 0).uniform(8.0, 32.0));
//! ```

mod distributions;
mod philox;

use philox::philox4x32_10;

/// A source of random numbers; see the crate docs.
#[derive(Clone, Debug)]
pub struct Stream {
    key: [u32; 2],
    high: [u32; 2],
    block: u64,
    buffer: [u32; 4],
    used: usize,
    spare_normal: Option<f64>,
}

impl Stream {
    /// The stream of one topic and entity in one scene of one dataset.
    ///
    /// `topic` is a path such as `"plan/weather"`; `entity` tells apart several of a kind (a vehicle's
    /// number, an object's id). Equal names give equal streams.
    #[must_use]
    pub fn new(dataset_seed: u64, scene: u64, topic: &str, entity: u64) -> Self {
        let mut hash = mix(dataset_seed ^ 0x9e37_79b9_7f4a_7c15);
        hash = mix(hash ^ scene.wrapping_add(0x6a09_e667_f3bc_c908));
        for chunk in topic.as_bytes().chunks(8) {
            let mut word = [0u8; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            hash = mix(hash ^ u64::from_le_bytes(word));
        }
        hash = mix(hash ^ (topic.len() as u64).wrapping_add(0xbb67_ae85_84ca_a73b));
        let high = mix(hash ^ entity.wrapping_add(0x3c6e_f372_fe94_f82b));
        Self { key: split(hash), high: split(high), block: 0, buffer: [0; 4], used: 4, spare_normal: None }
    }

    /// Four random words that depend on `index` alone: random access for parallel loops.
    #[must_use]
    pub fn at(&self, index: u64) -> [u32; 4] {
        self.run_at::<1>(index).map(|[word]| word)
    }

    /// The words of [`Stream::at`] at `N` indices from `first` on, by word and index: faster than one by one.
    #[must_use]
    pub fn run_at<const N: usize>(&self, first: u64) -> [[u32; N]; 4] {
        let indices: [[u32; 2]; N] = std::array::from_fn(|i| split(first.wrapping_add(i as u64)));
        let counters = [
            indices.map(|[low, _]| low),
            indices.map(|[_, next]| next),
            [self.high[0]; N],
            // The top bit keeps random access apart from the sequential draws below.
            [self.high[1] | 0x8000_0000; N],
        ];
        philox4x32_10(counters, self.key)
    }

    /// The next random word.
    pub fn next_u32(&mut self) -> u32 {
        if self.used == 4 {
            let [low, next] = split(self.block);
            let counter = [low, next, self.high[0], self.high[1] & 0x7fff_ffff];
            self.buffer = philox4x32_10(counter.map(|word| [word]), self.key).map(|[word]| word);
            self.block += 1;
            self.used = 0;
        }
        let word = self.buffer[self.used];
        self.used += 1;
        word
    }

    /// The next 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        let low = u64::from(self.next_u32());
        low | u64::from(self.next_u32()) << 32
    }
}

/// A word as a number in `[0, 1)`, 24 bits.
#[must_use]
pub fn unit_f32(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Two words as two independent standard normal numbers (Box and Muller, 1958).
#[must_use]
pub fn normal_pair_f32(a: u32, b: u32) -> (f32, f32) {
    // 1 - u is in (0, 1], so the logarithm is finite.
    let radius = (-2.0 * libm::logf(1.0 - unit_f32(a))).sqrt();
    let (sin, cos) = libm::sincosf(std::f32::consts::TAU * unit_f32(b));
    (radius * cos, radius * sin)
}

fn split(word: u64) -> [u32; 2] {
    [word as u32, (word >> 32) as u32]
}

/// SplitMix64's finaliser (Steele, Lea, Flood, 2014): every input bit reaches every output bit.
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_tell_streams_apart() {
        let mut firsts = BTreeSet::new();
        for scene in 0..20 {
            for topic in ["a", "b", "ab", "plan/weather", "plan/weather/final"] {
                for entity in 0..20 {
                    firsts.insert(Stream::new(27, scene, topic, entity).next_u64());
                }
            }
        }
        assert_eq!(firsts.len(), 20 * 5 * 20);
    }

    #[test]
    fn a_run_is_what_its_places_are() {
        let stream = Stream::new(1, 2, "x", 3);
        for first in [0, 7, 5 << 32, u64::from(u32::MAX) - 2] {
            let words = stream.run_at::<8>(first);
            for i in 0..8 {
                assert_eq!(words.map(|word| word[i]), stream.at(first + i as u64), "{first} + {i}");
            }
        }
    }

    #[test]
    fn random_access_is_apart_from_the_sequence() {
        let mut stream = Stream::new(1, 2, "x", 3);
        let words = |stream: &Stream| -> Vec<u32> { (0..100).flat_map(|i| stream.at(i)).collect() };
        let first = words(&stream);
        let by_turn: BTreeSet<u32> = (0..400).map(|_| stream.next_u32()).collect();
        // Neither moves the other: what was drawn in between makes no difference to either.
        assert_eq!(words(&stream), first);
        let mut undisturbed = Stream::new(1, 2, "x", 3);
        assert!((0..400).all(|_| by_turn.contains(&undisturbed.next_u32())));
        assert_eq!(stream.next_u32(), undisturbed.next_u32());
        let by_index: BTreeSet<u32> = first.into_iter().collect();
        assert!(by_index.len() > 397 && by_turn.len() > 397);
        assert!(by_index.intersection(&by_turn).count() < 3);
    }
}
