//! What the reading functions share: line numbers, warnings, and attributes turned into values.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::ReadError;
use super::check::is_absurd;
use crate::model::{Element, UnknownElement, Warning};

/// Beyond this many, warnings are only counted: a broken file must not fill the memory.
const MAX_WARNINGS: usize = 2000;
/// Beyond this many different paths, unknown elements are only counted together.
const MAX_UNKNOWN: usize = 1000;
/// Where they are counted then.
const FURTHER: &str = "...";

/// State of one reading.
pub(super) struct Context {
    /// Byte offsets of the line ends, ascending.
    line_ends: Vec<u32>,
    warnings: Vec<Warning>,
    left_out: usize,
    unknown: BTreeMap<String, UnknownElement>,
    /// Id of the road being read.
    pub(super) road: Option<String>,
}

impl Context {
    pub(super) fn new(xml: &str) -> Self {
        // Longer texts are refused before they come here.
        let line_ends = xml.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i as u32).collect();
        Self { line_ends, warnings: Vec::new(), left_out: 0, unknown: BTreeMap::new(), road: None }
    }

    /// Line of a node, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        let at = node.range().start;
        self.line_ends.partition_point(|&end| (end as usize) < at) as u32 + 1
    }

    /// Notes something that was put up with.
    pub(super) fn warn(&mut self, node: Node<'_, '_>, s: Option<f64>, message: impl Into<String>) {
        let line = self.line(node);
        self.note(Warning { line, road: self.road.clone(), s, message: message.into() });
    }

    /// Notes a warning made elsewhere.
    pub(super) fn note(&mut self, warning: Warning) {
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(warning);
        } else {
            self.left_out += 1;
        }
    }

    /// Counts an element that this reader does not understand, and skips it.
    pub(super) fn unknown(&mut self, node: Node<'_, '_>) {
        if !node.is_element() || node.tag_name().name() == "userData" {
            return;
        }
        let mut names: Vec<&str> = node.ancestors().map(|n| n.tag_name().name()).collect();
        // The ancestors end with the root element and the document.
        names.truncate(names.len().saturating_sub(2));
        names.reverse();
        let mut path = names.join("/");
        if self.unknown.len() >= MAX_UNKNOWN && !self.unknown.contains_key(&path) {
            path = FURTHER.to_owned();
        }
        let line = self.line(node);
        self.unknown.entry(path).or_insert(UnknownElement { count: 0, line }).count += 1;
    }

    /// Keeps an element as it is. It is counted as unknown unless its name is among those that the
    /// standard has here.
    pub(super) fn kept(&mut self, node: Node<'_, '_>, standard: &[&str]) -> Option<Element> {
        let name = node.tag_name().name();
        if !node.is_element() || name == "userData" {
            return None;
        }
        if !standard.contains(&name) {
            self.unknown(node);
        }
        Some(element(node))
    }

    /// Whether no number of something is beyond all measure; else it is to be left out, which is noted.
    pub(super) fn sane(&mut self, node: Node<'_, '_>, numbers: &[f64]) -> bool {
        let absurd = numbers.iter().find(|n| is_absurd(**n));
        if let Some(number) = absurd {
            let message =
                format!("{number:e} is beyond all measure: the {} is left out", node.tag_name().name());
            self.warn(node, None, message);
        }
        absurd.is_none()
    }

    /// An error at a node.
    pub(super) fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> ReadError {
        ReadError::Content { line: self.line(node), road: self.road.clone(), message: message.into() }
    }

    /// All warnings, those about unknown elements last, and the counts of those.
    pub(super) fn finish(mut self) -> (Vec<Warning>, BTreeMap<String, UnknownElement>) {
        for (path, seen) in &self.unknown {
            let message = format!("{} <{path}> elements are not understood (first one here)", seen.count);
            self.warnings.push(Warning { line: seen.line, road: None, s: None, message });
        }
        if self.left_out > 0 {
            let message = format!("{} further warnings were left out", self.left_out);
            self.warnings.push(Warning { message, ..Warning::default() });
        }
        (self.warnings, self.unknown)
    }

    /// A number that must be there.
    pub(super) fn number(&self, node: Node<'_, '_>, name: &str) -> Result<f64, ReadError> {
        let text = node.attribute(name).ok_or_else(|| self.missing(node, name))?;
        parse_number(text).ok_or_else(|| {
            self.error(node, format!("<{}> {name}=\"{text}\" is not a finite number", node.tag_name().name()))
        })
    }

    /// A number that may be absent; an unreadable one counts as absent, with a warning.
    pub(super) fn maybe_number(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        let text = node.attribute(name)?;
        let value = parse_number(text);
        if value.is_none() && !text.trim().is_empty() {
            let tag = node.tag_name().name();
            self.warn(node, None, format!("<{tag}> {name}=\"{text}\" is not a finite number: ignored"));
        }
        value
    }

    /// A number that is 0 where absent.
    pub(super) fn number_or_zero(&mut self, node: Node<'_, '_>, name: &str) -> f64 {
        self.maybe_number(node, name).unwrap_or(0.0)
    }

    /// Text that must be there.
    pub(super) fn text(&self, node: Node<'_, '_>, name: &str) -> Result<String, ReadError> {
        node.attribute(name).map(str::to_owned).ok_or_else(|| self.missing(node, name))
    }

    /// A lane id that must be there.
    pub(super) fn lane_id(&self, node: Node<'_, '_>, name: &str) -> Result<i16, ReadError> {
        let text = node.attribute(name).ok_or_else(|| self.missing(node, name))?;
        text.trim().parse().map_err(|_| {
            self.error(node, format!("<{}> {name}=\"{text}\" is not a lane id", node.tag_name().name()))
        })
    }

    /// A word of a vocabulary; the default where absent, and with a warning where unknown.
    pub(super) fn word<T: Default>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        read: fn(&str) -> Option<T>,
    ) -> T {
        let Some(text) = node.attribute(name) else { return T::default() };
        read(text.trim()).unwrap_or_else(|| {
            let tag = node.tag_name().name();
            self.warn(node, None, format!("<{tag}> {name}=\"{text}\" is unknown: the default is taken"));
            T::default()
        })
    }

    fn missing(&self, node: Node<'_, '_>, name: &str) -> ReadError {
        self.error(node, format!("<{}> has no {name}", node.tag_name().name()))
    }

    /// Warns where records are not in order of s, and puts them in order; warns where two begin at one place.
    pub(super) fn sort_by_s<T>(
        &mut self,
        node: Node<'_, '_>,
        what: &str,
        records: &mut [T],
        s_of: fn(&T) -> f64,
    ) {
        if !records.is_sorted_by(|a, b| s_of(a) <= s_of(b)) {
            self.warn(node, None, format!("{what} records are not in order of s: sorted"));
            records.sort_by(|a, b| s_of(a).total_cmp(&s_of(b)));
        }
    }

    /// Warns where two records of a list begin at one place: only the later one has any effect.
    pub(super) fn doubled<T>(&mut self, node: Node<'_, '_>, what: &str, records: &[T], s_of: fn(&T) -> f64) {
        let mut pairs = records.windows(2).filter(|pair| s_of(&pair[0]) == s_of(&pair[1]));
        if let Some(first) = pairs.next() {
            let (s, count) = (s_of(&first[0]), pairs.count() + 1);
            self.warn(node, Some(s), format!("{count} {what} records begin where the one before does"));
        }
    }
}

/// The elements in a node.
pub(super) fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(Node::is_element)
}

/// The elements of one name in a node.
pub(super) fn named<'a, 'input>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |n| n.tag_name().name() == name)
}

/// An element and all in it; how deep it can be is limited before reading.
fn element(node: Node<'_, '_>) -> Element {
    let mut attributes: Vec<(String, String)> = Vec::new();
    for attribute in node.attributes() {
        // Without their prefixes two names may be one, and a name may be that of a namespace declaration.
        let name = attribute.name();
        if name != "xmlns" && attributes.iter().all(|(seen, _)| seen != name) {
            attributes.push((name.to_owned(), attribute.value().to_owned()));
        }
    }
    let text: String = node.children().filter(|n| n.is_text()).filter_map(|n| n.text()).collect();
    Element {
        name: node.tag_name().name().to_owned(),
        attributes,
        text: text.trim().to_owned(),
        children: elements(node).filter(|n| n.tag_name().name() != "userData").map(element).collect(),
    }
}

/// Attribute text, or nothing.
pub(super) fn text_or_empty(node: Node<'_, '_>, name: &str) -> String {
    node.attribute(name).unwrap_or_default().to_owned()
}

/// Whether an attribute says yes.
pub(super) fn flag(node: Node<'_, '_>, name: &str) -> bool {
    matches!(node.attribute(name).map(str::trim), Some("true" | "yes" | "1"))
}

/// A finite number; also in the old Fortran spelling without exponent letter, `1.5-3`.
pub(super) fn parse_number(text: &str) -> Option<f64> {
    let text = text.trim();
    let parsed = text.parse::<f64>().ok().or_else(|| {
        let bytes = text.as_bytes();
        let sign = (1..bytes.len()).rev().find(|&i| {
            matches!(bytes[i], b'+' | b'-') && (bytes[i - 1].is_ascii_digit() || bytes[i - 1] == b'.')
        })?;
        let (mantissa, exponent) = (text.get(..sign)?, text.get(sign..)?);
        format!("{mantissa}e{exponent}").parse().ok()
    })?;
    parsed.is_finite().then_some(parsed)
}

#[cfg(test)]
mod tests {
    use super::parse_number;

    #[test]
    fn numbers_in_all_spellings() {
        assert_eq!(parse_number(" 1.5e-3 "), Some(1.5e-3));
        assert_eq!(parse_number("1.5-3"), Some(1.5e-3));
        assert_eq!(parse_number("0.000000+0"), Some(0.0));
        assert_eq!(parse_number("-2"), Some(-2.0));
        for bad in ["nan", "inf", "", "-", "+", "1-2-", "1,5", "é+1", "1e", "--1"] {
            assert_eq!(parse_number(bad), None, "{bad}");
        }
    }
}
