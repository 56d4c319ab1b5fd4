//! Partial counts added up.

use std::collections::BTreeMap;

use schema::tables::PartialRow;

/// Sums of partial counts, by measure and class. Order of the rows makes no difference.
///
/// ```
/// use schema::measures::tracks::BOXES;
/// use schema::tables::PartialRow;
///
/// let row = |class: &str, count| PartialRow {
///     measure: BOXES.into(),
///     class: class.into(),
///     count,
///     ..PartialRow::default()
/// };
/// let mut totals = analysis::MeasureTotals::default();
/// totals.add(&[row("car", 3), row("bus", 1), row("car", 2)]);
/// assert_eq!((totals.of(BOXES, "car"), totals.total(BOXES)), (5, 6));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasureTotals {
    measures: BTreeMap<String, BTreeMap<String, Sum>>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Sum {
    bins: BTreeMap<i32, u64>,
    agents: BTreeMap<String, u64>,
}

/// The value of a key, which is copied only when it is new.
fn slot<'a, V: Default>(map: &'a mut BTreeMap<String, V>, key: &str) -> &'a mut V {
    if !map.contains_key(key) {
        map.insert(key.to_owned(), V::default());
    }
    map.get_mut(key).unwrap_or_else(|| unreachable!("the key was just inserted"))
}

impl MeasureTotals {
    /// Adds rows. Sums stop at the largest number rather than wrap.
    pub fn add(&mut self, rows: &[PartialRow]) {
        for row in rows {
            let sum = slot(slot(&mut self.measures, &row.measure), &row.class);
            let bin = sum.bins.entry(row.bin).or_default();
            *bin = bin.saturating_add(row.count);
            if !row.agent.is_empty() {
                let agent = slot(&mut sum.agents, &row.agent);
                *agent = agent.saturating_add(row.count);
            }
        }
    }

    /// Adds other sums.
    pub fn merge(&mut self, other: &Self) {
        for (measure, classes) in &other.measures {
            for (class, from) in classes {
                let sum = slot(slot(&mut self.measures, measure), class);
                for (bin, count) in &from.bins {
                    let bin = sum.bins.entry(*bin).or_default();
                    *bin = bin.saturating_add(*count);
                }
                for (agent, count) in &from.agents {
                    let agent = slot(&mut sum.agents, agent);
                    *agent = agent.saturating_add(*count);
                }
            }
        }
    }

    fn sum(&self, measure: &str, class: &str) -> Option<&Sum> {
        self.measures.get(measure)?.get(class)
    }

    /// Sum over all classes and bins of a measure.
    #[must_use]
    pub fn total(&self, measure: &str) -> u64 {
        self.classes(measure).map(|class| self.of(measure, class)).fold(0, u64::saturating_add)
    }

    /// Sum over all bins of a class.
    #[must_use]
    pub fn of(&self, measure: &str, class: &str) -> u64 {
        self.sum(measure, class).map_or(0, |sum| sum.bins.values().fold(0, |a, &b| a.saturating_add(b)))
    }

    /// Whether anything was counted of a measure, be it 0.
    #[must_use]
    pub fn has(&self, measure: &str) -> bool {
        self.measures.contains_key(measure)
    }

    /// Classes that were counted, in alphabetical order.
    pub fn classes(&self, measure: &str) -> impl Iterator<Item = &str> {
        self.measures.get(measure).into_iter().flatten().map(|(class, _)| class.as_str())
    }

    /// The known classes in their order, then the unknown ones that were counted of any of some measures, in
    /// alphabetical order.
    #[must_use]
    pub fn classes_in_order<'a>(&'a self, measures: &[&str], known: &[&'a str]) -> Vec<&'a str> {
        let mut unknown: Vec<&str> = measures.iter().flat_map(|measure| self.classes(measure)).collect();
        unknown.sort_unstable();
        unknown.dedup();
        unknown.retain(|class| !known.contains(class));
        [known, &unknown].concat()
    }

    /// Bins of a class: lower edge and count, in order.
    pub fn bins(&self, measure: &str, class: &str) -> impl Iterator<Item = (i32, u64)> {
        self.sum(measure, class)
            .into_iter()
            .flat_map(|sum| sum.bins.iter().map(|(&bin, &count)| (bin, count)))
    }

    /// Sums per agent of a class.
    pub fn agents(&self, measure: &str, class: &str) -> impl Iterator<Item = (&str, u64)> {
        self.sum(measure, class)
            .into_iter()
            .flat_map(|sum| sum.agents.iter().map(|(agent, &count)| (agent.as_str(), count)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(agent: &str, class: &str, bin: i32, count: u64) -> PartialRow {
        PartialRow { agent: agent.into(), measure: "m".into(), class: class.into(), bin, count }
    }

    #[test]
    fn rows_of_one_key_add_up_in_any_order() {
        let rows =
            [row("a", "car", 0, 1), row("b", "car", 0, 2), row("a", "car", 5, 4), row("", "bus", 0, 8)];
        let mut counts = MeasureTotals::default();
        counts.add(&rows);
        assert_eq!(counts.total("m"), 15);
        assert_eq!(counts.of("m", "car"), 7);
        assert_eq!(counts.bins("m", "car").collect::<Vec<_>>(), [(0, 3), (5, 4)]);
        assert_eq!(counts.agents("m", "car").collect::<Vec<_>>(), [("a", 5), ("b", 2)]);
        assert_eq!(counts.classes("m").collect::<Vec<_>>(), ["bus", "car"]);
        assert_eq!((counts.total("other"), counts.has("other")), (0, false));

        let mut reversed = MeasureTotals::default();
        for row in rows.iter().rev() {
            reversed.add(std::slice::from_ref(row));
        }
        assert_eq!(reversed, counts);

        // Parts that were added up apart come to the same.
        let mut merged = MeasureTotals::default();
        for part in rows.chunks(3) {
            let mut totals = MeasureTotals::default();
            totals.add(part);
            merged.merge(&totals);
        }
        assert_eq!(merged, counts);
    }

    #[test]
    fn sums_do_not_wrap() {
        let mut counts = MeasureTotals::default();
        counts.add(&[row("", "car", 0, u64::MAX), row("", "car", 1, 2)]);
        assert_eq!(counts.of("m", "car"), u64::MAX);
    }
}
