//! Partial statistics: counts that add up over frames, agents and scenes.
//!
//! Each stage counts what it has in hand and writes the rows beside its shards; `stats` adds them up and
//! never opens the shards themselves. Measures, classes and bins are those of [`crate::measures`].

use std::collections::BTreeMap;

use crate::tables::PartialRow;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    agent: String,
    measure: String,
    class: String,
    bin: i32,
}

/// Agent, measure and class of counts that have a bin for each place of a grid.
type GridKey = (String, String, String);

/// Counts as they grow.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartialCounts {
    counts: BTreeMap<Key, u64>,
    /// By bin from 0.
    grids: BTreeMap<GridKey, Vec<u64>>,
}

impl PartialCounts {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds to one count. Measures, classes and bins are those of [`crate::measures`]; the agent is empty for
    /// counts that are not one agent's.
    pub fn add(&mut self, agent: &str, measure: &str, class: &str, bin: i32, count: u64) {
        let key = Key { agent: agent.to_owned(), measure: measure.to_owned(), class: class.to_owned(), bin };
        *self.counts.entry(key).or_default() += count;
    }

    /// Adds to the counts of bins 0, 1, 2, ... of one class: thousands of them without a look-up for each. A
    /// measure is counted this way or by [`PartialCounts::add`], not both.
    pub fn add_bins(&mut self, agent: &str, measure: &str, class: &str, counts: &[u32]) {
        let key = (agent.to_owned(), measure.to_owned(), class.to_owned());
        let bins = self.grids.entry(key).or_default();
        bins.resize(bins.len().max(counts.len()), 0);
        bins.iter_mut().zip(counts).for_each(|(bin, count)| *bin += u64::from(*count));
    }

    /// Adds another's counts.
    pub fn merge(&mut self, other: Self) {
        for (key, count) in other.counts {
            *self.counts.entry(key).or_default() += count;
        }
        for (key, mut counts) in other.grids {
            let bins = self.grids.entry(key).or_default();
            if bins.len() < counts.len() {
                std::mem::swap(bins, &mut counts);
            }
            bins.iter_mut().zip(counts).for_each(|(bin, count)| *bin += count);
        }
    }

    /// The counts as rows, by agent, measure, class, bin; of those in many bins only what is not 0.
    #[must_use]
    pub fn rows(&self) -> Vec<PartialRow> {
        let row = |(agent, measure, class): (&str, &str, &str), bin, count| PartialRow {
            agent: agent.to_owned(),
            measure: measure.to_owned(),
            class: class.to_owned(),
            bin,
            count,
        };
        let single = self.counts.iter();
        let single = single.map(|(key, &count)| row((&key.agent, &key.measure, &key.class), key.bin, count));
        let many = self.grids.iter().flat_map(|((agent, measure, class), bins)| {
            let counted = (0..).zip(bins).filter(|(_, count)| **count > 0);
            counted.map(move |(bin, &count)| row((agent, measure, class), bin, count))
        });
        let mut rows: Vec<PartialRow> = single.chain(many).collect();
        let key = |row: &PartialRow| (row.agent.clone(), row.measure.clone(), row.class.clone(), row.bin);
        if !self.grids.is_empty() {
            rows.sort_by_cached_key(key);
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up_and_come_sorted() {
        let mut counts = PartialCounts::new();
        counts.add("vehicle_0", "images", "RGB", 0, 2);
        counts.add("", "frames", "", 0, 1);
        let mut more = PartialCounts::new();
        more.add("vehicle_0", "images", "RGB", 0, 5);
        more.add("vehicle_0", "images", "IST", 0, 1);
        counts.merge(more);
        let row = |agent: &str, measure: &str, class: &str, count| PartialRow {
            agent: agent.into(),
            measure: measure.into(),
            class: class.into(),
            bin: 0,
            count,
        };
        let expected = [
            row("", "frames", "", 1),
            row("vehicle_0", "images", "IST", 1),
            row("vehicle_0", "images", "RGB", 7),
        ];
        assert_eq!(counts.rows(), expected);
    }

    #[test]
    fn bins_of_a_grid_add_up_place_by_place() {
        let mut counts = PartialCounts::new();
        counts.add("", "m", "", 0, 9);
        counts.add_bins("", "heat", "road", &[1, 0, 2]);
        let mut more = PartialCounts::new();
        more.add_bins("", "heat", "road", &[0, 0, 5, 0, 7]);
        more.add_bins("", "heat", "car", &[0, 3]);
        counts.merge(more);
        counts.add_bins("", "heat", "road", &[1]);
        let rows = counts.rows();
        let found: Vec<_> =
            rows.iter().map(|r| (r.measure.as_str(), r.class.as_str(), r.bin, r.count)).collect();
        let wanted = [
            ("heat", "car", 1, 3),
            ("heat", "road", 0, 2),
            ("heat", "road", 2, 7),
            ("heat", "road", 4, 7),
            ("m", "", 0, 9),
        ];
        assert_eq!(found, wanted);
    }
}
