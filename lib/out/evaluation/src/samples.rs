//! Which frames of which egos are evaluated.

use std::collections::{BTreeMap, BTreeSet};

use schema::AgentId;

use crate::predictions::PredictionRow;

/// The samples of a scene.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Samples {
    frames: BTreeMap<AgentId, BTreeSet<u32>>,
    /// How many of them a file names without a box.
    pub(crate) without_boxes: u64,
    /// How many lie between those that a file names and are not named.
    pub(crate) between: u64,
}

impl Samples {
    /// Frames 0, n, 2 n, ... of some egos.
    pub(crate) fn every(n: u32, frames: u32, egos: &[AgentId]) -> Self {
        let due: BTreeSet<u32> = schema::rate::due(frames, n).collect();
        Self { frames: egos.iter().map(|ego| (*ego, due.clone())).collect(), ..Self::default() }
    }

    /// Those that the rows of a file name, of any mode.
    pub(crate) fn named(rows: &[PredictionRow]) -> Self {
        let (mut frames, mut found) = (BTreeMap::<AgentId, BTreeSet<u32>>::new(), BTreeSet::new());
        for row in rows {
            frames.entry(row.agent).or_default().insert(row.frame);
            if row.found.is_some() {
                found.insert((row.agent, row.frame));
            }
        }
        let named: usize = frames.values().map(BTreeSet::len).sum();
        let between = frames.values().map(|own| between(own, &frames)).sum();
        Self { frames, without_boxes: (named - found.len()) as u64, between }
    }

    /// Frames by ego.
    pub(crate) fn frames(&self) -> impl Iterator<Item = (AgentId, &BTreeSet<u32>)> {
        self.frames.iter().map(|(ego, frames)| (*ego, frames))
    }

    /// Whether a frame is one of somebody's.
    pub(crate) fn has_frame(&self, frame: u32) -> bool {
        self.frames.values().any(|frames| frames.contains(&frame))
    }
}

/// How many frames are not among an ego's, though they lie among those of the scene at the rate that these
/// have.
fn between(own: &BTreeSet<u32>, all: &BTreeMap<AgentId, BTreeSet<u32>>) -> u64 {
    let every: BTreeSet<u32> = all.values().flatten().copied().collect();
    let (Some(first), Some(last)) = (every.first(), every.last()) else { return 0 };
    let step = every.iter().fold(0, |step, frame| greatest_common_divisor(step, frame - first));
    if step == 0 {
        return 0;
    }
    u64::from((last - first) / step) + 1 - own.len() as u64
}

/// Of two numbers; 0 divides none.
pub(crate) fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::Mode;

    #[test]
    fn a_file_names_its_samples_and_gaps_are_counted() {
        let row = |agent, frame| PredictionRow { row: 0, frame, agent, mode: Mode::Unsaid, found: None };
        let (one, other) = (AgentId::vehicle(0), AgentId::vehicle(1));
        // Every tenth frame; the one lacks frame 20, the other 0.
        let rows = [row(one, 0), row(one, 10), row(one, 30), row(other, 10), row(other, 20), row(other, 30)];
        let samples = Samples::named(&rows);
        assert_eq!((samples.without_boxes, samples.between), (6, 2));
        assert!(samples.has_frame(20) && !samples.has_frame(5));
        assert_eq!(
            samples.frames().map(|(ego, own)| (ego, own.len())).collect::<Vec<_>>(),
            [(one, 3), (other, 3)]
        );
        assert_eq!(Samples::named(&rows[..1]).between, 0);
        let due = Samples::every(5, 11, &[one]);
        assert_eq!(due.frames().next().map(|(_, own)| own.iter().copied().collect()), Some(vec![0, 5, 10]));
    }
}
