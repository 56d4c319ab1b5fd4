//! Reading TOML key by key: types, ranges and unknown keys are checked, faults are gathered.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::config_key::{Absent, ConfigKey, Kind, YamlName, listed};
use crate::document::{Document, Fault, Source, as_integer, as_number};

struct Context<'a> {
    /// The configuration first.
    documents: &'a [Document<'a>],
    faults: RefCell<Vec<(Home, Fault)>>,
    /// What is suspicious, and no fault.
    warnings: RefCell<Vec<(Home, Fault)>>,
    /// The tables that were read, by path.
    tables: RefCell<BTreeMap<String, Table<'a>>>,
    /// Without documents: the keys that were asked for.
    keys: RefCell<Vec<ConfigKey>>,
}

/// A table of the configuration that was read.
#[derive(Default)]
struct Table<'a> {
    layers: Vec<Layer<'a>>,
    /// Keys that were asked for.
    seen: BTreeSet<String>,
}

/// Number of a document and line in it.
type Home = (usize, usize);

impl<'a> Context<'a> {
    fn new(documents: &'a [Document<'a>]) -> Self {
        let (faults, warnings, tables, keys) = Default::default();
        Self { documents, faults, warnings, tables, keys }
    }

    fn fault(&self, document: usize, span: Option<Range<usize>>, message: String) {
        self.note_in(&self.faults, document, span, message);
    }

    fn warn(&self, document: usize, span: Option<Range<usize>>, message: String) {
        self.note_in(&self.warnings, document, span, message);
    }

    fn note_in(
        &self,
        list: &RefCell<Vec<(Home, Fault)>>,
        document: usize,
        span: Option<Range<usize>>,
        message: String,
    ) {
        let Some(known) = self.documents.get(document) else { return };
        let source = known.source;
        let line = span.map(|span| known.line_of(&span));
        let fault = Fault { file: source.file.clone(), line, message };
        let found = ((document, line.unwrap_or(usize::MAX)), fault);
        let mut list = list.borrow_mut();
        if !list.contains(&found) {
            list.push(found);
        }
    }

    /// Whether something is wrong already on the line where a span begins.
    fn has_fault_at(&self, document: usize, span: &Range<usize>) -> bool {
        let line = self.documents.get(document).map(|known| known.line_of(span));
        self.faults.borrow().iter().any(|((d, l), _)| *d == document && Some(*l) == line)
    }

    /// A table that is read; the first time its layers are those that are given.
    fn open(&'a self, path: String, layers: impl FnOnce() -> Vec<Layer<'a>>) -> Section<'a> {
        let is_known = self.tables.borrow().contains_key(&path);
        if !is_known {
            let table = Table { layers: layers(), seen: BTreeSet::new() };
            self.tables.borrow_mut().insert(path.clone(), table);
        }
        let layers = self.tables.borrow().get(&path).map(|t| t.layers.clone()).unwrap_or_default();
        Section { context: self, path, layers }
    }

    /// Keys that were never asked for are faults: a typing mistake must not pass in silence.
    fn check_unknown(&self) {
        for (path, Table { layers, seen }) in &*self.tables.borrow() {
            let own = layers.iter().filter(|layer| !layer.is_inherited);
            for (key, document) in own.flat_map(|l| l.table.iter().map(|(k, _)| (k, l.document))) {
                let name = key.get_ref().as_ref();
                if seen.contains(name) {
                    continue;
                }
                let near = seen.iter().map(|s| (strsim::levenshtein(s, name), s)).min();
                let hint = match near {
                    Some((d, near)) if d <= 2.max(name.len() / 4) => format!(" (did you mean `{near}`?)"),
                    _ => {
                        let known: Vec<&str> = seen.iter().map(String::as_str).take(MOST_KEYS).collect();
                        let more = if seen.len() > MOST_KEYS { ", ..." } else { "" };
                        format!("; there are {}{more}", known.join(", "))
                    }
                };
                let message = format!("unknown key `{}`{hint}", joined(path, name));
                self.fault(document, Some(key.span()), message);
            }
        }
    }
}

/// So many keys of a table are named beside an unknown one.
const MOST_KEYS: usize = 16;

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// A table of a document.
#[derive(Clone)]
struct Layer<'a> {
    table: &'a DeTable<'a>,
    document: usize,
    /// Where the table stands; a document itself stands nowhere.
    span: Option<Range<usize>>,
    /// A group has it from the top, where it was read and judged by itself.
    is_inherited: bool,
}

impl<'a> Layer<'a> {
    fn of_document(whole: &'a Document<'a>, document: usize) -> Self {
        Self { table: whole.table.get_ref(), document, span: None, is_inherited: false }
    }
}

/// A table of the configuration, or the absence of one (then every key has its default). Below it may lie the
/// same table of another file: it has the keys that the first one lacks. A table can be opened as often as
/// needed.
pub(crate) struct Section<'a> {
    context: &'a Context<'a>,
    path: String,
    layers: Vec<Layer<'a>>,
}

/// A value and the document that it stands in.
#[derive(Clone, Copy)]
struct Found<'a> {
    value: &'a Spanned<DeValue<'a>>,
    document: usize,
    is_inherited: bool,
}

/// Parses a configuration and the files that it names, and reads it; keys that were not asked for are faults.
/// With what was read comes what is suspicious.
pub(crate) fn with_documents<T>(
    sources: &[Source],
    read: impl FnOnce(&Section<'_>) -> T,
) -> Result<(T, Vec<Fault>), Vec<Fault>> {
    let (mut documents, mut broken) = (Vec::with_capacity(sources.len()), Vec::new());
    for (number, source) in sources.iter().enumerate() {
        let (table, errors) = DeTable::parse_recoverable(source.text.as_deref().unwrap_or_default());
        broken.extend(errors.into_iter().map(|error| (number, error)));
        documents.push(Document { source, table });
    }
    let context = Context::new(&documents);
    for (number, error) in broken {
        context.fault(number, error.span(), error.message().replace('\n', ", "));
    }
    let whole = context.documents.first();
    let layer = whole.map(|whole| Layer::of_document(whole, 0));
    let value = read(&context.open(String::new(), || layer.into_iter().collect()));
    context.check_unknown();
    let in_order = |mut found: Vec<(Home, Fault)>| -> Vec<Fault> {
        found.sort_by_key(|(home, _)| *home);
        found.into_iter().map(|(_, fault)| fault).collect()
    };
    let faults = in_order(context.faults.take());
    if faults.is_empty() { Ok((value, in_order(context.warnings.take()))) } else { Err(faults) }
}

/// The keys that a reading function asks for.
pub(crate) fn describe<T>(read: impl FnOnce(&Section<'_>) -> T) -> Vec<ConfigKey> {
    let context = Context::new(&[]);
    read(&context.open(String::new(), Vec::new));
    context.keys.take()
}

impl<'a> Section<'a> {
    fn full(&self, key: &str) -> String {
        joined(&self.path, key)
    }

    fn get(&self, key: &str) -> Option<Found<'a>> {
        self.see(key);
        self.all(key).next()
    }

    fn see(&self, key: &str) {
        let mut tables = self.context.tables.borrow_mut();
        tables.entry(self.path.clone()).or_default().seen.insert(key.to_owned());
    }

    /// What a key has in each layer, the topmost first.
    fn all(&self, key: &str) -> impl Iterator<Item = Found<'a>> {
        let found = |l: &Layer<'a>| {
            Some(Found { value: l.table.get(key)?, document: l.document, is_inherited: l.is_inherited })
        };
        self.layers.iter().filter_map(found)
    }

    fn fault(&self, found: Found<'_>, message: String) {
        let span = found.value.span();
        // What is wrong with a key at the top is said once, not for each group.
        if !(found.is_inherited && self.context.has_fault_at(found.document, &span)) {
            self.context.fault(found.document, Some(span), message);
        }
    }

    /// Lays the section over another one: keys and tables that it lacks are taken from there.
    pub(crate) fn over(mut self, base: &Self) -> Self {
        let inherited = base.layers.iter().map(|layer| Layer { is_inherited: true, ..layer.clone() });
        self.layers.extend(inherited);
        self.keep_layers();
        self
    }

    /// The section has these layers wherever it is opened again.
    fn keep_layers(&self) {
        let mut tables = self.context.tables.borrow_mut();
        tables.entry(self.path.clone()).or_default().layers.clone_from(&self.layers);
    }

    /// Keys that stand in the section itself and were asked for in another one, but not in this one; from
    /// here on they count as asked for.
    pub(crate) fn take_keys_of(&self, other: &Self) -> Vec<String> {
        let tables = self.context.tables.borrow();
        let seen = |path: &str, key: &str| tables.get(path).is_some_and(|table| table.seen.contains(key));
        let own = self.layers.iter().filter(|layer| !layer.is_inherited);
        let keys = own.flat_map(|layer| layer.table.iter().map(|(key, _)| key.get_ref().to_string()));
        let keys: Vec<String> = keys.filter(|key| !seen(&self.path, key) && seen(&other.path, key)).collect();
        drop(tables);
        keys.iter().for_each(|key| self.see(key));
        keys
    }

    /// Lays the section over the file that a key names, if it does: keys that it lacks are taken from there.
    pub(crate) fn over_file(mut self, key: &str, doc: &str) -> Self {
        self.note(key, Kind::Text, Absent::Words("none".into()), doc);
        let Some(found) = self.get(key) else { return self };
        let Some(written) = found.value.get_ref().as_str() else {
            self.wrong_type(key, found, "a string");
            return self;
        };
        if written.is_empty() {
            self.fault(found, format!("`{}` is empty, expected the name of a file", self.full(key)));
            return self;
        }
        let mut documents = self.context.documents.iter().enumerate();
        let Some((number, document)) = documents.find(|(_, d)| d.source.written == written) else {
            return self;
        };
        if self.layers.iter().any(|l| l.document == number) {
            return self;
        }
        if let Err(why) = &document.source.text {
            let message = format!("`{}`: {}: cannot read: {why}", self.full(key), document.source.file);
            self.fault(found, message);
        }
        let table = document.table.get_ref();
        if let Some(nested) = table.get(key) {
            let message = format!("`{}`: such a file names no other", self.full(key));
            self.context.fault(number, Some(nested.span()), message);
        }
        // Before what a group has from the top.
        let below = self.layers.iter().position(|l| l.table.get(key).is_some()).map_or(0, |at| at + 1);
        let is_inherited = found.is_inherited;
        self.layers.insert(below, Layer { is_inherited, ..Layer::of_document(document, number) });
        self.keep_layers();
        self
    }

    fn note(&self, key: &str, kind: Kind, default: Absent, doc: &str) {
        let mut keys = self.context.keys.borrow_mut();
        let path = self.full(key);
        if self.context.documents.is_empty() && !keys.iter().any(|known| known.path == path) {
            keys.push(ConfigKey { path, kind, default, doc: doc.trim().to_owned(), yaml: Vec::new() });
        }
    }

    /// Tells the names that a key has in SimBEV2X.
    pub(crate) fn named_there(&self, key: &str, names: &[YamlName]) {
        let path = self.full(key);
        if let Some(known) = self.context.keys.borrow_mut().iter_mut().find(|known| known.path == path) {
            known.yaml = names.to_vec();
        }
    }

    fn wrong_type(&self, key: &str, found: Found<'_>, expected: &str) {
        let kind = found.value.get_ref().type_str();
        let article = if kind.starts_with(['a', 'i', 'o']) { "an" } else { "a" };
        self.fault(found, format!("`{}` is {article} {kind}, expected {expected}", self.full(key)));
    }

    /// Reports a fault at a key (or at its section when the key is absent).
    pub(crate) fn fault_at(&self, key: &str, message: String) {
        self.fault_at_any(&[key], message);
    }

    /// Reports a fault that several keys make together: at the first of them that is there, else at the
    /// section.
    pub(crate) fn fault_at_any(&self, keys: &[&str], message: String) {
        if let Some(found) = keys.iter().find_map(|key| self.all(key).next()) {
            self.fault(found, message);
        } else {
            let layer = self.layers.first();
            self.context.fault(layer.map_or(0, |l| l.document), layer.and_then(|l| l.span.clone()), message);
        }
    }

    /// Says that something is suspicious at a key (or at its section when the key is absent).
    pub(crate) fn warn_at(&self, key: &str, message: String) {
        match self.all(key).next() {
            // What a group has from the top is looked at there.
            Some(found) if found.is_inherited => {}
            Some(found) => self.context.warn(found.document, Some(found.value.span()), message),
            None => self.warn_here(message),
        }
    }

    /// Says that a table is suspicious.
    pub(crate) fn warn_here(&self, message: String) {
        let layer = self.layers.first();
        if layer.is_some_and(|layer| layer.is_inherited) {
            return;
        }
        self.context.warn(layer.map_or(0, |l| l.document), layer.and_then(|l| l.span.clone()), message);
    }

    /// Whether the configuration itself has any of the table's keys besides some, files that it names aside.
    pub(crate) fn has_besides(&self, but: &[&str]) -> bool {
        let own = self.layers.iter().filter(|layer| layer.document == 0 && !layer.is_inherited);
        own.flat_map(|layer| layer.table.iter()).any(|(key, _)| !but.contains(&key.get_ref().as_ref()))
    }

    /// Whether the configuration itself has a key, files that it names aside.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.layers.iter().any(|layer| layer.document == 0 && layer.table.contains_key(key))
    }

    /// Whether a key stands in any file, above or below.
    pub(crate) fn says(&self, key: &str) -> bool {
        self.layers.iter().any(|layer| layer.table.contains_key(key))
    }

    /// Whether the configuration comes from a language in which all keys are written down, used or not.
    pub(crate) fn names_all(&self) -> bool {
        self.context.documents.first().is_some_and(|document| document.source.names_all)
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
        let absent = Absent::Value(default.to_string());
        self.found_integer(key, absent, (min, max), doc).unwrap_or(default)
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
        self.found_integer(key, Absent::Words(absent.to_owned()), (min, max), doc)
    }

    fn found_integer(&self, key: &str, absent: Absent, (min, max): (i64, i64), doc: &str) -> Option<i64> {
        self.note(key, Kind::Integer { min, max }, absent, doc);
        let found = self.get(key)?;
        let Some(number) = as_integer(found.value.get_ref()) else {
            self.wrong_type(key, found, "an integer");
            return None;
        };
        if !(min..=max).contains(&number) {
            self.fault(found, format!("`{}` is {number}, expected {min} to {max}", self.full(key)));
            return None;
        }
        Some(number)
    }

    /// A number in a range.
    pub(crate) fn number(&self, key: &str, default: f64, min: f64, max: f64, doc: &str) -> f64 {
        let absent = Absent::Value(default.to_string());
        self.found_number(key, absent, (min, max), doc).unwrap_or(default)
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
        self.found_number(key, Absent::Words(absent.to_owned()), (min, max), doc)
    }

    /// A number in a range, or the least and the most of a part of it (one number is both); or nothing:
    /// `absent` says what happens then.
    pub(crate) fn number_or_two(
        &self,
        key: &str,
        absent: &str,
        (min, max): (f64, f64),
        doc: &str,
    ) -> Option<[f64; 2]> {
        self.note(key, Kind::NumberOrTwo { min, max }, Absent::Words(absent.to_owned()), doc);
        let found = self.get(key)?;
        let value = found.value.get_ref();
        let list =
            || value.as_array()?.iter().map(|item| as_number(item.get_ref())).collect::<Option<Vec<_>>>();
        let two = as_number(value).map(|one| [one; 2]).or_else(|| list()?.try_into().ok());
        let Some([least, most]) = two else {
            self.wrong_type(key, found, "a number, or two: [least, most]");
            return None;
        };
        if let Some(wrong) = [least, most].into_iter().find(|number| !(min..=max).contains(number)) {
            self.fault(found, format!("`{}` is {wrong}, expected {min} to {max}", self.full(key)));
            return None;
        }
        if least > most {
            let path = self.full(key);
            self.fault(found, format!("`{path}` is [{least}, {most}], expected the least first"));
            return None;
        }
        Some([least, most])
    }

    fn found_number(&self, key: &str, absent: Absent, (min, max): (f64, f64), doc: &str) -> Option<f64> {
        self.note(key, Kind::Number { min, max }, absent, doc);
        let found = self.get(key)?;
        let Some(number) = as_number(found.value.get_ref()) else {
            self.wrong_type(key, found, "a number");
            return None;
        };
        if !(min..=max).contains(&number) {
            self.fault(found, format!("`{}` is {number}, expected {min} to {max}", self.full(key)));
            return None;
        }
        Some(number)
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, key: &str, default: bool, doc: &str) -> bool {
        self.note(key, Kind::Flag, Absent::Value(default.to_string()), doc);
        let Some(found) = self.get(key) else { return default };
        found.value.get_ref().as_bool().unwrap_or_else(|| {
            self.wrong_type(key, found, "true or false");
            default
        })
    }

    /// A text.
    pub(crate) fn text(&self, key: &str, default: &str, doc: &str) -> String {
        self.note(key, Kind::Text, Absent::Value(format!("\"{default}\"")), doc);
        let Some(found) = self.get(key) else { return default.to_owned() };
        found.value.get_ref().as_str().map(str::to_owned).unwrap_or_else(|| {
            self.wrong_type(key, found, "a string");
            default.to_owned()
        })
    }

    /// A string, or nothing; `absent` says what happens then.
    pub(crate) fn optional_text(&self, key: &str, absent: &str, doc: &str) -> Option<String> {
        self.note(key, Kind::Text, Absent::Words(absent.to_owned()), doc);
        let found = self.get(key)?;
        let text = found.value.get_ref().as_str().map(str::to_owned);
        if text.is_none() {
            self.wrong_type(key, found, "a string");
        }
        text
    }

    /// One of some words.
    pub(crate) fn choice<T: Copy>(&self, key: &str, options: &[(&str, T)], default: usize, doc: &str) -> T {
        let words: Vec<String> = options.iter().map(|(word, _)| (*word).to_owned()).collect();
        let absent = Absent::Value(format!("\"{}\"", options[default].0));
        self.note(key, Kind::Choice(words.clone()), absent, doc);
        let words = listed(&words);
        let Some(found) = self.get(key) else { return options[default].1 };
        let Some(text) = found.value.get_ref().as_str() else {
            self.wrong_type(key, found, &format!("one of {words}"));
            return options[default].1;
        };
        options.iter().find(|(word, _)| *word == text).map_or_else(
            || {
                let message = format!("`{}` is \"{text}\", expected one of {words}", self.full(key));
                self.fault(found, message);
                options[default].1
            },
            |(_, option)| *option,
        )
    }

    /// Some texts.
    pub(crate) fn texts(&self, key: &str, default: &[String], doc: &str) -> Vec<String> {
        self.note(key, Kind::Texts, Absent::Value(format!("{default:?}")), doc);
        self.items(key, "a list of strings", |v| v.as_str().map(str::to_owned))
            .unwrap_or_else(|| default.to_vec())
    }

    /// Some numbers, or nothing; `absent` says what happens then.
    pub(crate) fn numbers(&self, key: &str, absent: &str, doc: &str) -> Option<Vec<f64>> {
        self.note(key, Kind::Numbers, Absent::Words(absent.to_owned()), doc);
        self.items(key, "a list of numbers", as_number)
    }

    /// Three numbers.
    pub(crate) fn triple(&self, key: &str, default: [f64; 3], doc: &str) -> [f64; 3] {
        self.note(key, Kind::Triple, Absent::Value(format!("{default:?}")), doc);
        let Some(numbers) = self.items(key, "three numbers", as_number) else { return default };
        numbers.as_slice().try_into().unwrap_or_else(|_| {
            self.fault_at(key, format!("`{}` has {} numbers, expected three", self.full(key), numbers.len()));
            default
        })
    }

    /// Points, or nothing; `absent` says what happens then.
    pub(crate) fn points(&self, key: &str, absent: &str, doc: &str) -> Option<Vec<[f64; 3]>> {
        self.note(key, Kind::Points, Absent::Words(absent.to_owned()), doc);
        let point = |v: &DeValue<'_>| -> Option<[f64; 3]> {
            let numbers: Option<Vec<f64>> = v.as_array()?.iter().map(|n| as_number(n.get_ref())).collect();
            numbers?.try_into().ok()
        };
        self.items(key, "a list of points, each [x, y, z]", point)
    }

    /// Colours, each three integers 0 to 255.
    pub(crate) fn colors(&self, key: &str, default: &[[u8; 3]], doc: &str) -> Vec<[u8; 3]> {
        self.note(key, Kind::Colors, Absent::Value(format!("{default:?}")), doc);
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
        let found = self.get(key)?;
        let items = found.value.get_ref().as_array().map(|a| a.iter().map(|v| item(v.get_ref())).collect());
        match items {
            Some(Some(items)) => Some(items),
            Some(None) => {
                self.fault(found, format!("`{}` is not {expected}", self.full(key)));
                None
            }
            None => {
                self.wrong_type(key, found, expected);
                None
            }
        }
    }

    /// A table within this one.
    pub(crate) fn section(&self, key: &str, doc: &str) -> Section<'a> {
        self.note(key, Kind::Table, Absent::Words(String::new()), doc);
        self.see(key);
        let layers = || {
            let mut layers = Vec::new();
            for found in self.all(key) {
                match found.value.get_ref().as_table() {
                    Some(table) => {
                        let span = Some(found.value.span());
                        let Found { document, is_inherited, .. } = found;
                        layers.push(Layer { table, document, span, is_inherited });
                    }
                    None => self.wrong_type(key, found, "a table"),
                }
            }
            layers
        };
        self.context.open(self.full(key), layers)
    }

    /// A list of tables, or `None` when it is absent.
    pub(crate) fn sections(&self, key: &str, absent: &str, doc: &str) -> Option<Vec<Section<'a>>> {
        self.note(key, Kind::Tables, Absent::Words(absent.to_owned()), doc);
        let found = self.get(key)?;
        let Some(array) = found.value.get_ref().as_array() else {
            self.wrong_type(key, found, "a list of tables");
            return None;
        };
        let mut sections = Vec::new();
        for (i, item) in array.iter().enumerate() {
            let Some(table) = item.get_ref().as_table() else {
                self.wrong_type(key, Found { value: item, ..found }, "a table");
                continue;
            };
            let path = format!("{}[{i}]", self.full(key));
            let Found { document, is_inherited, .. } = found;
            let layer = Layer { table, document, span: Some(item.span()), is_inherited };
            sections.push(self.context.open(path, || vec![layer]));
        }
        Some(sections)
    }

    /// A table within a list of tables, for the description of its keys alone.
    pub(crate) fn describe_item(&self, key: &str) -> Section<'a> {
        self.context.open(format!("{}[]", self.full(key)), Vec::new)
    }

    /// All keys of a table whose keys are free (map names, weather parameters), in file order.
    pub(crate) fn free_integers(&self, kind: &str, min: i64, max: i64, doc: &str) -> Vec<(String, i64)> {
        self.note(kind, Kind::Integer { min, max }, Absent::Words("none".into()), doc);
        let Some(Layer { table, .. }) = self.layers.first() else { return Vec::new() };
        let mut keys: Vec<_> =
            table.iter().map(|(key, _)| (key.span().start, key.get_ref().to_string())).collect();
        keys.sort_unstable();
        let read = |(_, key): (usize, String)| {
            let found = self.get(&key)?;
            match as_integer(found.value.get_ref()) {
                Some(n) if (min..=max).contains(&n) => Some((key, n)),
                Some(n) => {
                    self.fault(found, format!("`{}` is {n}, expected {min} to {max}", self.full(&key)));
                    None
                }
                None => {
                    self.wrong_type(&key, found, "an integer");
                    None
                }
            }
        };
        keys.into_iter().filter_map(read).collect()
    }
}
