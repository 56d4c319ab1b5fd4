//! Texts of configurations: what they say where, and what is wrong with them.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A fault of a configuration file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file.
    pub file: String,
    /// The line, from 1, where there is one.
    pub line: Option<usize>,
    /// What is wrong and what was expected.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.message),
            None => write!(f, "{}: {}", self.file, self.message),
        }
    }
}

/// A file with keys of a configuration: the configuration itself, or one that it names.
pub(crate) struct Source {
    /// As the configuration writes it; empty for the configuration itself.
    pub(crate) written: String,
    /// Its path, for messages.
    pub(crate) file: String,
    /// What is in it, or why it cannot be read.
    pub(crate) text: Result<String, String>,
    /// It was translated from a language in which all keys are written down, used or not.
    pub(crate) names_all: bool,
}

/// A source that was read and parsed.
pub(crate) struct Document<'a> {
    pub(crate) source: &'a Source,
    pub(crate) table: Spanned<DeTable<'a>>,
}

impl Document<'_> {
    /// The line where a span begins, from 1.
    pub(crate) fn line_of(&self, span: &Range<usize>) -> usize {
        line_at(self.source.text.as_deref().unwrap_or_default(), span.start)
    }
}

/// The line, from 1, of a byte of a text.
fn line_at(text: &str, at: usize) -> usize {
    text[..at.min(text.len())].matches('\n').count() + 1
}

/// The line of the longest part of a key's path (`rigs[0].agents`) that a text has.
pub(crate) fn line_of(text: &str, path: &str) -> Option<usize> {
    let (document, _) = DeTable::parse_recoverable(text);
    let (mut table, mut line) = (document.get_ref(), None);
    for part in path.split('.') {
        let (name, number) = match part.strip_suffix(']').and_then(|part| part.split_once('[')) {
            Some((name, number)) => (name, number.parse::<usize>().ok()),
            None => (part, None),
        };
        let Some(mut value) = table.get(name) else { break };
        if let Some(item) = number.and_then(|number| value.get_ref().as_array()?.get(number)) {
            value = item;
        }
        line = Some(line_at(text, value.span().start));
        let Some(below) = value.get_ref().as_table() else { break };
        table = below;
    }
    line
}

/// The texts that a key has anywhere in a configuration: the files that it names.
pub(crate) fn texts_of(text: &str, key: &str) -> BTreeSet<String> {
    let (document, _) = DeTable::parse_recoverable(text);
    let mut found = BTreeSet::new();
    let mut tables = vec![document.get_ref()];
    while let Some(table) = tables.pop() {
        found.extend(table.get(key).and_then(|value| value.get_ref().as_str()).map(str::to_owned));
        for (_, value) in table.iter() {
            tables.extend(value.get_ref().as_table());
            let items = value.get_ref().as_array().into_iter().flatten();
            tables.extend(items.filter_map(|item| item.get_ref().as_table()));
        }
    }
    found
}

/// An integer, however it is written.
pub(crate) fn as_integer(value: &DeValue<'_>) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// A finite number.
pub(crate) fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok().filter(|f: &f64| f.is_finite()),
        other => as_integer(other).map(|n| n as f64),
    }
}
