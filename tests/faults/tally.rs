//! What came out, counted.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::{Mutex, PoisonError};

use convoy_tests::Outcome;

/// Says how far things are.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// How a program ended in which something went wrong.
pub(crate) fn ending(outcome: &Outcome) -> &'static str {
    match outcome.code {
        0 => "done",
        1 => "1",
        2 => "2",
        75 => "75",
        -1 | 137 => "killed",
        _ => "other",
    }
}

/// Counts by operation, fault and outcome, and tries that came out wrong.
#[derive(Default)]
pub(crate) struct Tally {
    counts: Mutex<BTreeMap<(String, String, &'static str), u64>>,
    wrong: Mutex<BTreeSet<String>>,
}

fn open<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Tally {
    /// A try that ended so; `problem` if it came out wrong.
    pub(crate) fn add(
        &self,
        name: &str,
        operation: &str,
        fault: &str,
        outcome: &Outcome,
        problem: Option<String>,
    ) {
        let key = (operation.to_owned(), fault.to_owned(), ending(outcome));
        *open(&self.counts).entry(key).or_default() += 1;
        if let Some(problem) = problem {
            let text = format!("{name}: {problem}\n  exit {}: {}", outcome.code, outcome.stderr.trim());
            say(&format!("WRONG {text}"));
            open(&self.wrong).insert(text);
        }
    }

    /// Writes the counts as a table, and expects that nothing was wrong.
    pub(crate) fn end(self, place: &str) {
        let counts = self.counts.into_inner().unwrap_or_else(PoisonError::into_inner);
        let wrong = self.wrong.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut rows: BTreeMap<(String, String), BTreeMap<&str, u64>> = BTreeMap::new();
        for ((operation, fault, ending), count) in counts {
            rows.entry((operation, fault)).or_default().insert(ending, count);
        }
        let endings = ["done", "75", "2", "1", "killed", "other"];
        let mut table = format!("| {place} | fault | {} |\n", endings.join(" | "));
        table.push_str(&format!("|{}\n", " --- |".repeat(2 + endings.len())));
        for ((operation, fault), by_ending) in &rows {
            let cells = endings.map(|ending| by_ending.get(ending).map_or_else(String::new, u64::to_string));
            let _ = writeln!(table, "| {operation} | {fault} | {} |", cells.join(" | "));
        }
        let tries: u64 = rows.values().flat_map(BTreeMap::values).sum();
        let _ = writeln!(table, "\n{tries} tries, {} wrong", wrong.len());
        if let Some(file) = std::env::var_os("CONVOY_FAULTS_TABLE") {
            let file = std::fs::OpenOptions::new().append(true).create(true).open(file);
            file.expect("the table opens").write_all(table.as_bytes()).expect("the table is written");
        }
        assert!(tries > 0, "no fault has this name");
        assert!(wrong.is_empty(), "{} of {tries} tries:\n{}", wrong.len(), Vec::from_iter(wrong).join("\n"));
    }
}

/// What is wrong with the words of a program that ended with an error: it says so in lines that begin with a
/// level, and one at least is an error.
pub(crate) fn ill_told(outcome: &Outcome) -> Option<String> {
    if matches!(outcome.code, 0 | -1 | 137) {
        return None;
    }
    if !matches!(outcome.code, 1 | 2 | 75) {
        return Some(format!("ends with {}", outcome.code));
    }
    let text = &outcome.stderr;
    if text.contains("panicked") || text.contains("a bug in Convoy") {
        return Some("panics".to_owned());
    }
    let says = text.lines().any(|line| line.trim_start().starts_with("ERROR") || line.starts_with("error:"));
    (!says).then(|| "says nothing".to_owned())
}
