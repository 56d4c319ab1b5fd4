//! Reading TOML key by key: types, ranges and unknown keys are checked, faults are gathered.

use std::cell::RefCell;
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

/// A key the configuration understands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigKey {
    /// Dotted path.
    pub path: String,
    /// Type, with its range.
    pub kind: String,
    /// Default value as TOML, or what happens without it.
    pub default: String,
    /// Meaning and unit.
    pub doc: String,
}

struct Context<'a> {
    text: &'a str,
    file: &'a str,
    faults: RefCell<Vec<(usize, Fault)>>,
    keys: RefCell<Vec<ConfigKey>>,
}

impl Context<'_> {
    fn fault(&self, span: Option<Range<usize>>, message: String) {
        let line = span.map(|s| self.text[..s.start.min(self.text.len())].matches('\n').count() + 1);
        let fault = Fault { file: self.file.to_owned(), line, message };
        self.faults.borrow_mut().push((line.unwrap_or(usize::MAX), fault));
    }
}

/// A table of the document, or the absence of one (then every key has its default).
pub(crate) struct Section<'a> {
    context: &'a Context<'a>,
    path: String,
    table: Option<&'a DeTable<'a>>,
    /// Where the table stands; the document itself stands nowhere.
    span: Option<Range<usize>>,
    seen: RefCell<BTreeSet<String>>,
}

/// Parses a text and reads it; keys that were not asked for are faults.
pub(crate) fn with_document<T>(
    text: &str,
    file: &str,
    read: impl FnOnce(&Section<'_>) -> T,
) -> Result<(T, Vec<ConfigKey>), Vec<Fault>> {
    let context = Context { text, file, faults: RefCell::default(), keys: RefCell::default() };
    let (document, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        context.fault(error.span(), error.message().replace('\n', ", "));
    }
    let value = {
        let root = Section {
            context: &context,
            path: String::new(),
            table: Some(document.get_ref()),
            span: None,
            seen: RefCell::default(),
        };
        read(&root)
    };
    let mut faults = context.faults.into_inner();
    if faults.is_empty() {
        return Ok((value, context.keys.into_inner()));
    }
    faults.sort_by_key(|(line, _)| *line);
    Err(faults.into_iter().map(|(_, fault)| fault).collect())
}

/// The keys that a reading function asks for.
pub(crate) fn describe<T>(read: impl FnOnce(&Section<'_>) -> T) -> Vec<ConfigKey> {
    let context = Context { text: "", file: "", faults: RefCell::default(), keys: RefCell::default() };
    let (path, seen) = (String::new(), RefCell::default());
    read(&Section { context: &context, path, table: None, span: None, seen });
    context.keys.into_inner()
}

impl<'a> Section<'a> {
    fn full(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    fn get(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.seen.borrow_mut().insert(key.to_owned());
        self.table?.get(key)
    }

    fn note(&self, key: &str, kind: String, default: String, doc: &str) {
        let doc = doc.to_owned();
        self.context.keys.borrow_mut().push(ConfigKey { path: self.full(key), kind, default, doc });
    }

    fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let found = value.get_ref().type_str();
        let article = if found.starts_with(['a', 'i', 'o']) { "an" } else { "a" };
        let message = format!("`{}` is {article} {found}, expected {expected}", self.full(key));
        self.context.fault(Some(value.span()), message);
    }

    /// Reports a fault at a key (or at its section when the key is absent).
    pub(crate) fn fault_at(&self, key: &str, message: String) {
        self.fault_at_any(&[key], message);
    }

    /// Reports a fault that several keys make together: at the first of them that is there, else at the section.
    pub(crate) fn fault_at_any(&self, keys: &[&str], message: String) {
        let key = keys.iter().find_map(|key| self.table?.get(*key));
        self.context.fault(key.map(Spanned::span).or_else(|| self.span.clone()), message);
    }

    /// The path of the section, for messages.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// The full path of a key, for messages.
    pub(crate) fn path_of(&self, key: &str) -> String {
        self.full(key)
    }

    /// An integer in a range.
    pub(crate) fn integer(&self, key: &str, default: i64, min: i64, max: i64, doc: &str) -> i64 {
        self.optional_integer(key, &default.to_string(), min, max, doc).unwrap_or(default)
    }

    /// An integer in a range, or nothing; `absent` says what happens then.
    pub(crate) fn optional_integer(
        &self,
        key: &str,
        absent: &str,
        min: i64,
        max: i64,
        doc: &str,
    ) -> Option<i64> {
        let range = if max == i64::MAX { format!("from {min}") } else { format!("{min} to {max}") };
        self.note(key, format!("integer, {range}"), absent.to_owned(), doc);
        let value = self.get(key)?;
        let Some(number) = as_integer(value.get_ref()) else {
            self.wrong_type(key, value, "an integer");
            return None;
        };
        if !(min..=max).contains(&number) {
            let message = format!("`{}` is {number}, expected {min} to {max}", self.full(key));
            self.context.fault(Some(value.span()), message);
            return None;
        }
        Some(number)
    }

    /// A number in a range.
    pub(crate) fn number(&self, key: &str, default: f64, min: f64, max: f64, doc: &str) -> f64 {
        self.optional_number(key, &default.to_string(), min, max, doc).unwrap_or(default)
    }

    /// A number in a range, or nothing; `absent` says what happens then.
    pub(crate) fn optional_number(
        &self,
        key: &str,
        absent: &str,
        min: f64,
        max: f64,
        doc: &str,
    ) -> Option<f64> {
        self.note(key, format!("number, {min} to {max}"), absent.to_owned(), doc);
        let value = self.get(key)?;
        let Some(number) = as_number(value.get_ref()) else {
            self.wrong_type(key, value, "a number");
            return None;
        };
        if !(min..=max).contains(&number) {
            let message = format!("`{}` is {number}, expected {min} to {max}", self.full(key));
            self.context.fault(Some(value.span()), message);
            return None;
        }
        Some(number)
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, key: &str, default: bool, doc: &str) -> bool {
        self.note(key, "true or false".into(), default.to_string(), doc);
        let Some(value) = self.get(key) else { return default };
        value.get_ref().as_bool().unwrap_or_else(|| {
            self.wrong_type(key, value, "true or false");
            default
        })
    }

    /// A text.
    pub(crate) fn text(&self, key: &str, default: &str, doc: &str) -> String {
        self.note(key, "string".into(), format!("\"{default}\""), doc);
        let Some(value) = self.get(key) else { return default.to_owned() };
        value.get_ref().as_str().map(str::to_owned).unwrap_or_else(|| {
            self.wrong_type(key, value, "a string");
            default.to_owned()
        })
    }

    /// One of some words.
    pub(crate) fn choice<T: Copy>(&self, key: &str, options: &[(&str, T)], default: usize, doc: &str) -> T {
        let words: Vec<String> = options.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let words = words.join(", ");
        self.note(key, format!("one of {words}"), format!("\"{}\"", options[default].0), doc);
        let Some(value) = self.get(key) else { return options[default].1 };
        let Some(text) = value.get_ref().as_str() else {
            self.wrong_type(key, value, &format!("one of {words}"));
            return options[default].1;
        };
        options.iter().find(|(word, _)| *word == text).map_or_else(
            || {
                let message = format!("`{}` is \"{text}\", expected one of {words}", self.full(key));
                self.context.fault(Some(value.span()), message);
                options[default].1
            },
            |(_, option)| *option,
        )
    }

    /// Some texts.
    pub(crate) fn texts(&self, key: &str, default: &[String], doc: &str) -> Vec<String> {
        self.note(key, "list of strings".into(), format!("{default:?}"), doc);
        self.items(key, "a list of strings", |v| v.as_str().map(str::to_owned))
            .unwrap_or_else(|| default.to_vec())
    }

    /// Three numbers.
    pub(crate) fn triple(&self, key: &str, default: [f64; 3], doc: &str) -> [f64; 3] {
        self.note(key, "three numbers".into(), format!("{default:?}"), doc);
        let Some(numbers) = self.items(key, "three numbers", as_number) else { return default };
        numbers.as_slice().try_into().unwrap_or_else(|_| {
            self.fault_at(key, format!("`{}` has {} numbers, expected three", self.full(key), numbers.len()));
            default
        })
    }

    /// Colours, each three integers 0 to 255.
    pub(crate) fn colors(&self, key: &str, default: &[[u8; 3]], doc: &str) -> Vec<[u8; 3]> {
        self.note(key, "list of [red, green, blue], 0 to 255".into(), format!("{default:?}"), doc);
        let color = |v: &DeValue<'_>| -> Option<[u8; 3]> {
            let parts: Vec<u8> = v
                .as_array()?
                .iter()
                .map(|c| as_integer(c.get_ref()).and_then(|n| u8::try_from(n).ok()))
                .collect::<Option<_>>()?;
            parts.as_slice().try_into().ok()
        };
        self.items(key, "a list of [red, green, blue], 0 to 255", color).unwrap_or_else(|| default.to_vec())
    }

    fn items<T>(
        &self,
        key: &str,
        expected: &str,
        item: impl Fn(&DeValue<'_>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let value = self.get(key)?;
        let items = value.get_ref().as_array().map(|a| a.iter().map(|v| item(v.get_ref())).collect());
        match items {
            Some(Some(items)) => Some(items),
            Some(None) => {
                let message = format!("`{}` is not {expected}", self.full(key));
                self.context.fault(Some(value.span()), message);
                None
            }
            None => {
                self.wrong_type(key, value, expected);
                None
            }
        }
    }

    /// A table within this one.
    pub(crate) fn section(&self, key: &str, doc: &str) -> Section<'a> {
        self.note(key, "table".into(), String::new(), doc);
        let value = self.get(key);
        let table = value.and_then(|value| {
            let table = value.get_ref().as_table();
            if table.is_none() {
                self.wrong_type(key, value, "a table");
            }
            table
        });
        let span = value.map(Spanned::span);
        Section { context: self.context, path: self.full(key), table, span, seen: RefCell::default() }
    }

    /// A list of tables, or `None` when it is absent.
    pub(crate) fn sections(&self, key: &str, absent: &str, doc: &str) -> Option<Vec<Section<'a>>> {
        self.note(key, "list of tables".into(), absent.to_owned(), doc);
        let value = self.get(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "a list of tables");
            return None;
        };
        let mut sections = Vec::new();
        for (i, item) in array.iter().enumerate() {
            let Some(table) = item.get_ref().as_table() else {
                self.wrong_type(key, item, "a table");
                continue;
            };
            let path = format!("{}[{i}]", self.full(key));
            let (span, seen) = (Some(item.span()), RefCell::default());
            sections.push(Section { context: self.context, path, table: Some(table), span, seen });
        }
        Some(sections)
    }

    /// A table within a list of tables, for the description of its keys alone.
    pub(crate) fn describe_item(&self, key: &str) -> Section<'a> {
        let path = format!("{}[]", self.full(key));
        Section { context: self.context, path, table: None, span: None, seen: RefCell::default() }
    }

    /// All keys of a table whose keys are free (map names, weather parameters), in file order.
    pub(crate) fn free_integers(&self, kind: &str, min: i64, max: i64, doc: &str) -> Vec<(String, i64)> {
        self.note(kind, format!("integer, {min} to {max}"), "none".into(), doc);
        let Some(table) = self.table else { return Vec::new() };
        let mut keys: Vec<_> =
            table.iter().map(|(key, _)| (key.span().start, key.get_ref().to_string())).collect();
        keys.sort_unstable();
        let read = |(_, key): (usize, String)| {
            let value = self.get(&key)?;
            match as_integer(value.get_ref()) {
                Some(n) if (min..=max).contains(&n) => Some((key, n)),
                Some(n) => {
                    let message = format!("`{}` is {n}, expected {min} to {max}", self.full(&key));
                    self.context.fault(Some(value.span()), message);
                    None
                }
                None => {
                    self.wrong_type(&key, value, "an integer");
                    None
                }
            }
        };
        keys.into_iter().filter_map(read).collect()
    }
}

impl Drop for Section<'_> {
    /// Keys nobody asked for are faults: a typing mistake must not pass in silence.
    fn drop(&mut self) {
        let Some(table) = self.table else { return };
        let seen = self.seen.borrow();
        for (key, _) in table {
            let name = key.get_ref().as_ref();
            if seen.contains(name) {
                continue;
            }
            let near = seen.iter().map(|s| (strsim::levenshtein(s, name), s)).min();
            let hint = match near {
                Some((d, near)) if d <= 2.max(name.len() / 4) => format!(" (did you mean `{near}`?)"),
                _ => String::new(),
            };
            self.context.fault(Some(key.span()), format!("unknown key `{}`{hint}", self.full(name)));
        }
    }
}

fn as_integer(value: &DeValue<'_>) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok().filter(|f: &f64| f.is_finite()),
        other => as_integer(other).map(|n| n as f64),
    }
}
