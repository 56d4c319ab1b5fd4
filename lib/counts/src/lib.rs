//! Partial statistics: counts that add up over frames, agents and scenes.
//!
//! Each stage counts what it has in hand and writes the rows beside its shards; `stats` adds them up and never opens the
//! shards themselves. Measures, classes and bins are those of [`schema::measures`].

use std::collections::BTreeMap;

use schema::tables::PartialRow;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    agent: String,
    measure: String,
    class: String,
    bin: i32,
}

/// Counts as they grow.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartialCounts {
    counts: BTreeMap<Key, u64>,
}

impl PartialCounts {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds to one count. Measures, classes and bins are those of [`schema::measures`]; the agent is empty for counts
    /// that are not one agent's.
    pub fn add(&mut self, agent: &str, measure: &str, class: &str, bin: i32, count: u64) {
        let key = Key { agent: agent.to_owned(), measure: measure.to_owned(), class: class.to_owned(), bin };
        *self.counts.entry(key).or_default() += count;
    }

    /// Adds another's counts.
    pub fn merge(&mut self, other: Self) {
        for (key, count) in other.counts {
            *self.counts.entry(key).or_default() += count;
        }
    }

    /// The counts as rows, by agent, measure, class, bin.
    #[must_use]
    pub fn rows(&self) -> Vec<PartialRow> {
        self.counts
            .iter()
            .map(|(key, &count)| PartialRow {
                agent: key.agent.clone(),
                measure: key.measure.clone(),
                class: key.class.clone(),
                bin: key.bin,
                count,
            })
            .collect()
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
}
