//! JSON as Python's `json.dump(..., indent=4)` writes it.
//!
//! By hand: `serde_json` writes numbers that are none as `null` and text beyond ASCII as it is; the files'
//! readers are Python's, and compare well with files that Python wrote.

use std::fmt::Write;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Int(i128),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    /// Keys in the order of writing.
    Object(Vec<(String, Node)>),
}

impl Node {
    /// An object of keys in this order.
    pub(super) fn object<K: Into<String>>(entries: impl IntoIterator<Item = (K, Self)>) -> Self {
        Self::Object(entries.into_iter().map(|(key, value)| (key.into(), value)).collect())
    }

    /// A list of numbers.
    pub(super) fn floats(values: &[f64]) -> Self {
        Self::List(values.iter().map(|&value| Self::Float(value)).collect())
    }

    /// A text.
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl From<f64> for Node {
    fn from(value: f64) -> Self {
        Self::Float(value)
    }
}

impl From<bool> for Node {
    fn from(value: bool) -> Self {
        Self::Bool(value)
    }
}

impl From<u32> for Node {
    fn from(value: u32) -> Self {
        Self::Int(i128::from(value))
    }
}

impl<T: Into<Node>> From<Option<T>> for Node {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, Into::into)
    }
}

/// A value as text, its further lines indented by so many levels more.
pub(super) fn write(out: &mut String, node: &Node, level: usize) {
    match node {
        Node::Null => out.push_str("null"),
        Node::Bool(value) => out.push_str(if *value { "true" } else { "false" }),
        Node::Int(value) => {
            let _ = write!(out, "{value}");
        }
        Node::Float(value) => out.push_str(&float(*value)),
        Node::Text(text) => quote(out, text),
        Node::List(items) => within(out, '[', ']', level, items, |out, item| write(out, item, level + 1)),
        Node::Object(entries) => within(out, '{', '}', level, entries, |out, (key, value)| {
            quote(out, key);
            out.push_str(": ");
            write(out, value, level + 1);
        }),
    }
}

fn within<T>(
    out: &mut String,
    open: char,
    close: char,
    level: usize,
    items: &[T],
    one: impl Fn(&mut String, &T),
) {
    out.push(open);
    for (i, item) in items.iter().enumerate() {
        out.push_str(if i == 0 { "\n" } else { ",\n" });
        indent(out, level + 1);
        one(out, item);
    }
    if !items.is_empty() {
        out.push('\n');
        indent(out, level);
    }
    out.push(close);
}

/// The blanks of a level.
pub(super) fn indent(out: &mut String, level: usize) {
    out.extend(std::iter::repeat_n(' ', 4 * level));
}

/// A text in quotes, everything beyond ASCII as escapes of UTF-16.
pub(super) fn quote(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            '\u{8}' => out.push_str("\\b"),
            '\u{c}' => out.push_str("\\f"),
            ' '..='~' => out.push(c),
            other => {
                for unit in other.encode_utf16(&mut [0; 2]) {
                    let _ = write!(out, "\\u{unit:04x}");
                }
            }
        }
    }
    out.push('"');
}

/// A number as Python's `repr` writes it: the shortest decimal that reads back, from 1e-4 up to 1e16 without
/// an exponent; `NaN`, `Infinity` and `-Infinity` as Python's `json` names them.
pub(super) fn float(value: f64) -> String {
    if value.is_nan() {
        return "NaN".into();
    }
    if value.is_infinite() {
        return if value > 0.0 { "Infinity".into() } else { "-Infinity".into() };
    }
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) {
        return format!("{value:?}");
    }
    // `1.5e-7` in Rust, `1.5e-07` in Python.
    let text = format!("{value:e}");
    match text.split_once('e') {
        Some((digits, exponent)) => {
            let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
            format!("{digits}e{sign}{exponent:0>2}")
        }
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_pythons() {
        // Left: what `json.dumps` of Python 3.11 prints.
        for (text, value) in [
            ("0.0", 0.0),
            ("-0.0", -0.0),
            ("1.0", 1.0),
            ("0.1", 0.1),
            ("396.3190612792969", 396.3190612792969),
            ("0.0001", 1e-4),
            ("9.999e-05", 9.999e-5),
            ("4e-07", 4e-7),
            ("1.5e-300", 1.5e-300),
            ("1e+16", 1e16),
            ("9999999999999998.0", 9_999_999_999_999_998.0),
            ("1.7976931348623157e+308", f64::MAX),
            ("NaN", f64::NAN),
            ("-Infinity", f64::NEG_INFINITY),
        ] {
            assert_eq!(float(value), text);
        }
    }

    #[test]
    fn layout_and_escapes_are_pythons() {
        let node = Node::object([
            ("a", Node::List(vec![])),
            ("b", Node::object::<&str>([])),
            ("c", Node::List(vec![Node::Int(1), Node::Null])),
            ("d\u{e9}\u{1f697}\u{7f}\"", Node::from(true)),
        ]);
        let mut out = String::new();
        write(&mut out, &node, 1);
        assert_eq!(
            out,
            "{\n        \"a\": [],\n        \"b\": {},\n        \"c\": [\n            1,\n            null\n        ],\n        \
             \"d\\u00e9\\ud83d\\ude97\\u007f\\\"\": true\n    }"
        );
    }
}
