//! Values of YAML, and the TOML that they become.

use std::collections::BTreeMap;

use saphyr::{MarkedYaml, Scalar, YamlData};

use super::names::Rule;
use crate::document::Fault;

/// A configuration in our own language.
#[derive(Debug, Default)]
pub(crate) struct Translation {
    /// One key a line.
    pub(crate) toml: String,
    /// The line of the YAML file that each line comes from.
    pub(crate) lines: Vec<usize>,
    /// Keys without an effect here.
    pub(crate) warnings: Vec<Fault>,
}

/// Pairs of a mapping: key, its line, value. Keys that are no text are left out.
pub(crate) fn pairs<'a, 'i>(node: &'a MarkedYaml<'i>) -> Option<Vec<(&'a str, usize, &'a MarkedYaml<'i>)>> {
    let YamlData::Mapping(map) = &node.data else { return None };
    let text = |key: &'a MarkedYaml<'i>| match &key.data {
        YamlData::Value(Scalar::String(text)) => Some(text.as_ref()),
        _ => None,
    };
    Some(map.iter().filter_map(|(key, value)| Some((text(key)?, line(key), value))).collect())
}

pub(crate) fn line(node: &MarkedYaml<'_>) -> usize {
    node.span.start.line()
}

pub(crate) fn items<'a, 'i>(node: &'a MarkedYaml<'i>) -> Option<&'a [MarkedYaml<'i>]> {
    match &node.data {
        YamlData::Sequence(items) => Some(items.as_slice()),
        _ => None,
    }
}

pub(crate) fn is_null(node: &MarkedYaml<'_>) -> bool {
    matches!(&node.data, YamlData::Value(Scalar::Null))
}

/// A number, or a text that is one (the original takes sensor properties as texts).
pub(crate) fn number(node: &MarkedYaml<'_>) -> Option<f64> {
    match &node.data {
        YamlData::Value(Scalar::Integer(n)) => Some(*n as f64),
        YamlData::Value(Scalar::FloatingPoint(n)) => Some(n.into_inner()),
        YamlData::Value(Scalar::String(text)) => text.trim().parse().ok(),
        _ => None,
    }
}

pub(crate) fn flag(node: &MarkedYaml<'_>) -> Option<bool> {
    match &node.data {
        YamlData::Value(Scalar::Boolean(flag)) => Some(*flag),
        YamlData::Value(Scalar::String(text)) => text.trim().to_ascii_lowercase().parse().ok(),
        _ => None,
    }
}

pub(crate) fn text<'a>(node: &'a MarkedYaml<'_>) -> Option<&'a str> {
    match &node.data {
        YamlData::Value(Scalar::String(text)) => Some(text.as_ref()),
        _ => None,
    }
}

/// A text in TOML.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A number in TOML: whole numbers without a point, so that they do for integers.
pub(crate) fn decimal(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value:.0}") } else { format!("{value:?}") }
}

/// Any value in TOML, as it is: what it should be is for the reader to say.
fn verbatim(node: &MarkedYaml<'_>) -> Option<String> {
    match &node.data {
        YamlData::Value(Scalar::String(text)) => {
            Some(number(node).filter(|n| n.is_finite()).map_or_else(|| quoted(text), decimal))
        }
        YamlData::Value(Scalar::Boolean(flag)) => Some(flag.to_string()),
        YamlData::Value(Scalar::Integer(n)) => Some(n.to_string()),
        YamlData::Value(Scalar::FloatingPoint(n)) => Some(format!("{:?}", n.into_inner())),
        YamlData::Sequence(items) => {
            let items: Vec<String> = items.iter().map(verbatim).collect::<Option<_>>()?;
            Some(format!("[{}]", items.join(", ")))
        }
        _ => None,
    }
}

/// Gathers lines of TOML.
pub(crate) struct Writer<'f> {
    file: &'f str,
    out: Translation,
    /// What was written, by key.
    written: BTreeMap<String, String>,
}

impl<'f> Writer<'f> {
    /// Nothing yet; `file` is named in warnings.
    pub(crate) fn new(file: &'f str) -> Self {
        Self { file, out: Translation::default(), written: BTreeMap::new() }
    }

    /// What was written.
    pub(crate) fn finish(self) -> Translation {
        self.out
    }

    /// Writes a key, once.
    pub(crate) fn put(&mut self, at: usize, path: &str, value: String) {
        if let Some(first) = self.written.get(path) {
            if *first != value {
                self.warn(at, format!("there is one value for `{path}`: {first} counts, {value} does not"));
            }
            return;
        }
        self.out.toml.push_str(&format!("{path} = {value}\n"));
        self.out.lines.push(at);
        self.written.insert(path.to_owned(), value);
    }

    /// Says that a key has no effect, or another one.
    pub(crate) fn warn(&mut self, at: usize, message: String) {
        self.out.warnings.push(Fault { file: self.file.to_owned(), line: Some(at), message });
    }

    /// Writes a value by a rule.
    pub(crate) fn follow(&mut self, rule: &Rule, key: &str, at: usize, value: &MarkedYaml<'_>) {
        match rule {
            Rule::Same(path) => match verbatim(value) {
                Some(text) => self.put(at, path, text),
                None if is_null(value) => {}
                None => self.warn(at, format!("`{key}`: expected a plain value, ignored")),
            },
            Rule::Percent(path, usual) => match number(value) {
                Some(percent) => {
                    // What is a tenth or more by default is hardly meant to be below a hundredth.
                    if *usual >= 0.1 && 0.0 < percent && percent < 1.0 {
                        let meant = decimal((1e11 * percent).round() / 1e9);
                        let message = format!(
                            "`{key}` is {percent} of 100 percent, next to nothing: write {meant} if a share is meant"
                        );
                        self.warn(at, message);
                    }
                    self.put(at, path, decimal(percent / 100.0));
                }
                None => self.warn(at, format!("`{key}`: expected a number, ignored")),
            },
            Rule::Nothing(why) => self.warn(at, format!("`{key}` has no effect here: {why}")),
        }
    }
}
