//! What is known of a key, for pages, schemas and translations.

use std::fmt;

/// A key the configuration understands.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfigKey {
    /// Dotted path; `[]` stands for each table of a list.
    pub path: String,
    /// Type, with its range.
    pub kind: Kind,
    /// What counts where the key is absent.
    pub default: Absent,
    /// Meaning and unit.
    pub doc: String,
    /// Its names in SimBEV2X.
    pub(crate) yaml: Vec<YamlName>,
}

/// A key's name in a configuration of SimBEV2X. Names of sensors are those of vehicles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum YamlName {
    /// With the same value.
    Same(&'static str),
    /// With percents instead of shares.
    Percent(&'static str),
    /// A flag of a kind of image, by ours.
    Camera(&'static str),
    /// Within a mapping.
    In(&'static str, &'static str),
}

/// What a key takes.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "their `Display` says what each takes")]
pub enum Kind {
    Table,
    Tables,
    Flag,
    Text,
    Texts,
    Numbers,
    Triple,
    Points,
    Colors,
    /// One of some words.
    Choice(Vec<String>),
    Integer {
        min: i64,
        max: i64,
    },
    Number {
        min: f64,
        max: f64,
    },
    /// One, or the least and the most of those that are meant.
    NumberOrTwo {
        min: f64,
        max: f64,
    },
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Table => f.write_str("table"),
            Self::Tables => f.write_str("list of tables"),
            Self::Flag => f.write_str("true or false"),
            Self::Text => f.write_str("string"),
            Self::Texts => f.write_str("list of strings"),
            Self::Numbers => f.write_str("list of numbers"),
            Self::Triple => f.write_str("three numbers"),
            Self::Points => f.write_str("list of [x, y, z]"),
            Self::Colors => f.write_str("list of [red, green, blue], 0 to 255"),
            Self::Choice(words) => write!(f, "one of {}", listed(words)),
            Self::Integer { min, max: i64::MAX } => write!(f, "integer, from {min}"),
            Self::Integer { min, max } => write!(f, "integer, {min} to {max}"),
            Self::Number { min, max } => write!(f, "number, {min} to {max}"),
            Self::NumberOrTwo { min, max } => write!(f, "number, {min} to {max}, or [least, most]"),
        }
    }
}

/// Words in quotes.
pub(crate) fn listed(words: &[String]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}

/// What counts where a key is absent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Absent {
    /// A value, as TOML.
    Value(String),
    /// Something that no value tells, in words.
    Words(String),
}

impl fmt::Display for Absent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Value(text) | Self::Words(text)) = self;
        f.write_str(text)
    }
}
