//! What was looked at and what was found, added up over tasks.

use std::collections::{BTreeMap, BTreeSet};

use crate::files::Unreadable;
use crate::rules::Rule;
use crate::shares::Shares;

/// Findings of a check that are told one by one; the others are counted.
pub(crate) const TOLD: usize = 8;

/// What one check found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Things looked at.
    pub(crate) looked: u64,
    /// Things that break the rule.
    pub(crate) off: u64,
    /// The first of them.
    pub(crate) told: Vec<Finding>,
}

/// A finding in words, and how many things of its kind there are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Finding {
    /// Findings of one kind are told once; those without a kind each.
    kind: String,
    pub(crate) words: String,
    pub(crate) things: u64,
}

impl Tally {
    fn tell(&mut self, told: Finding) {
        let same = self.told.iter_mut().find(|t| !told.kind.is_empty() && t.kind == told.kind);
        if let Some(same) = same {
            same.things += told.things;
        } else if self.told.len() < TOLD {
            self.told.push(told);
        }
    }
}

/// What all checks found in a part of a store.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    tallies: BTreeMap<Rule, Tally>,
    /// What was not checked, and why.
    unchecked: BTreeSet<(Rule, String)>,
    /// What is compared with the published dataset.
    pub(crate) shares: Shares,
    /// Where this part is: begins each finding.
    place: String,
}

impl Ledger {
    /// Of a part of the store, whose name begins each finding.
    pub(crate) fn at(place: impl Into<String>) -> Self {
        Self { place: place.into(), ..Self::default() }
    }

    /// Things that were looked at and are as they should be.
    pub(crate) fn fine(&mut self, rule: Rule, things: u64) {
        self.tallies.entry(rule).or_default().looked += things;
    }

    /// Something that breaks a rule.
    pub(crate) fn off(&mut self, rule: Rule, words: impl FnOnce() -> String) {
        self.all_off(rule, 1, "", words);
    }

    /// Several things that break a rule in the same way; further ones of their kind are added to them.
    pub(crate) fn all_off(&mut self, rule: Rule, things: u64, kind: &str, words: impl FnOnce() -> String) {
        if things == 0 {
            return;
        }
        let tally = self.tallies.entry(rule).or_default();
        tally.looked += things;
        tally.off += things;
        let words = format!("{}: {}", self.place, words());
        tally.tell(Finding { kind: kind.to_owned(), words, things });
    }

    /// Looks at one thing.
    pub(crate) fn expect(&mut self, rule: Rule, holds: bool, words: impl FnOnce() -> String) {
        if holds { self.fine(rule, 1) } else { self.off(rule, words) }
    }

    /// Something that was not checked, and why.
    pub(crate) fn skip(&mut self, rule: Rule, why: impl Into<String>) {
        self.unchecked.insert((rule, why.into()));
    }

    /// A value, if its file could be read; otherwise the file breaks a rule.
    pub(crate) fn read<T>(&mut self, read: Result<T, Unreadable>) -> Option<T> {
        match read {
            Ok(value) => {
                self.fine(Rule::Files, 1);
                Some(value)
            }
            Err(fault) => {
                self.off(Rule::Files, || fault.to_string());
                None
            }
        }
    }

    /// Forgets what was found of a rule that cannot be held against this part, and says why.
    pub(crate) fn exempt(&mut self, rule: Rule, why: impl Into<String>) {
        self.tallies.remove(&rule);
        self.skip(rule, why);
    }

    /// Takes in what another part found.
    pub(crate) fn take(&mut self, other: Self) {
        for (rule, tally) in other.tallies {
            let mine = self.tallies.entry(rule).or_default();
            mine.looked += tally.looked;
            mine.off += tally.off;
            tally.told.into_iter().for_each(|told| mine.tell(told));
        }
        self.unchecked.extend(other.unchecked);
        self.shares.take(other.shares);
    }

    pub(crate) fn tally(&self, rule: Rule) -> Tally {
        self.tallies.get(&rule).cloned().unwrap_or_default()
    }

    pub(crate) fn unchecked(&self) -> impl Iterator<Item = &(Rule, String)> {
        self.unchecked.iter()
    }

    /// Whether every rule holds.
    pub(crate) fn is_clean(&self) -> bool {
        self.tallies.values().all(|tally| tally.off == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_of_a_kind_are_told_once_over_all_parts() {
        let mut whole = Ledger::default();
        for part in 0..2 {
            let mut ledger = Ledger::at(format!("part {part}"));
            ledger.all_off(Rule::PointIds, 3, "lamp", || "a lamp".into());
            ledger.all_off(Rule::PointIds, 0, "tree", || "no tree".into());
            whole.take(ledger);
        }
        let tally = whole.tally(Rule::PointIds);
        assert_eq!((tally.off, tally.told.len(), tally.told[0].things), (6, 1, 6));
        assert_eq!(tally.told[0].words, "part 0: a lamp");
    }

    #[test]
    fn what_cannot_be_held_is_said_and_not_found() {
        let mut ledger = Ledger::default();
        ledger.off(Rule::Gnss, || "far".into());
        ledger.fine(Rule::Times, 1);
        ledger.exempt(Rule::Gnss, "no map");
        assert!(ledger.is_clean());
        assert_eq!((ledger.tally(Rule::Gnss).looked, ledger.tally(Rule::Times).looked), (0, 1));
        assert_eq!(ledger.unchecked().cloned().collect::<Vec<_>>(), [(Rule::Gnss, "no map".to_owned())]);
    }

    #[test]
    fn parts_add_up_and_only_the_first_findings_are_told() {
        let mut whole = Ledger::default();
        for part in 0..3 {
            let mut ledger = Ledger::at(format!("part {part}"));
            ledger.fine(Rule::Times, 10);
            for k in 0..5 {
                ledger.off(Rule::Units, || format!("fault {k}"));
            }
            ledger.skip(Rule::Gnss, "there is none");
            whole.take(ledger);
        }
        assert_eq!((whole.tally(Rule::Times).looked, whole.tally(Rule::Times).off), (30, 0));
        let units = whole.tally(Rule::Units);
        assert_eq!((units.looked, units.off, units.told.len()), (15, 15, TOLD));
        assert_eq!(units.told[5].words, "part 1: fault 0");
        assert_eq!(whole.unchecked().count(), 1);
        assert!(!whole.is_clean());
    }
}
