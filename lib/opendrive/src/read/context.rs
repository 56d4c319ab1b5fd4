//! What the reading functions share: line numbers, warnings, and attributes turned into values.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{ReadError, Warning};

/// Beyond this many, warnings are only counted: a broken file must not fill the memory.
const MAX_WARNINGS: usize = 2000;

/// State of one reading.
pub(super) struct Context {
    /// Byte offsets of the line ends, ascending.
    line_ends: Vec<usize>,
    warnings: Vec<Warning>,
    left_out: usize,
    unknown: BTreeMap<String, (usize, u32)>,
    /// Id of the road being read.
    pub(super) road: Option<String>,
}

impl Context {
    pub(super) fn new(xml: &str) -> Self {
        let line_ends = xml.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i).collect();
        Self { line_ends, warnings: Vec::new(), left_out: 0, unknown: BTreeMap::new(), road: None }
    }

    /// Line of a node, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        let at = node.range().start;
        u32::try_from(self.line_ends.partition_point(|&end| end < at) + 1).unwrap_or(u32::MAX)
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

    /// Counts an element this reader does not use.
    pub(super) fn unknown(&mut self, node: Node<'_, '_>) {
        if !node.is_element() {
            return;
        }
        let name = node.tag_name().name();
        if let Some(seen) = self.unknown.get_mut(name) {
            seen.0 += 1;
        } else {
            let line = self.line(node);
            self.unknown.insert(name.to_owned(), (1, line));
        }
    }

    /// An error at a node.
    pub(super) fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> ReadError {
        ReadError::Content { line: self.line(node), road: self.road.clone(), message: message.into() }
    }

    /// All warnings, those about unused elements last.
    pub(super) fn into_warnings(mut self) -> Vec<Warning> {
        for (name, (count, line)) in self.unknown {
            let message = format!("{count} <{name}> elements are not used (first one here)");
            self.warnings.push(Warning { line, road: None, s: None, message });
        }
        if self.left_out > 0 {
            let message = format!("{} further warnings were left out", self.left_out);
            self.warnings.push(Warning { message, ..Warning::default() });
        }
        self.warnings
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

    /// Warns where records are not in order of s, and puts them in order.
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
}

/// Attribute text, or nothing.
pub(super) fn text_or_empty(node: Node<'_, '_>, name: &str) -> String {
    node.attribute(name).unwrap_or_default().to_owned()
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
