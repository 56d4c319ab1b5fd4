//! A small XML writer.
//!
//! By hand rather than with quick-xml, which gains no time here, wants numbers as text, and checks neither
//! names nor characters: what XML cannot hold is left out below.

use std::fmt::{Display, Write};

use crate::model::Element;

/// Attributes of one element.
pub(super) type Attributes<'a> = Vec<(&'static str, &'a dyn Display)>;

/// Adds an attribute where there is a value.
pub(super) fn maybe<'a, T: Display>(
    attributes: &mut Attributes<'a>,
    name: &'static str,
    value: &'a Option<T>,
) {
    if let Some(value) = value {
        attributes.push((name, value));
    }
}

/// Adds an attribute where there is text.
pub(super) fn unless_empty<'a, T: Display + AsRef<str>>(
    attributes: &mut Attributes<'a>,
    name: &'static str,
    text: &'a T,
) {
    if !text.as_ref().is_empty() {
        attributes.push((name, text));
    }
}

/// Adds an attribute that says yes, or nothing.
pub(super) fn if_true(attributes: &mut Attributes<'_>, name: &'static str, value: bool) {
    if value {
        attributes.push((name, &"true"));
    }
}

/// Adds a word unless it is the one that its absence means.
pub(super) fn unless_default<'a, T: Default + PartialEq>(
    attributes: &mut Attributes<'a>,
    name: &'static str,
    value: &T,
    word: &'a &'static str,
) {
    if *value != T::default() {
        attributes.push((name, word));
    }
}

/// Builds indented XML text.
pub(super) struct Xml {
    text: String,
    open: Vec<String>,
}

impl Xml {
    pub(super) fn new() -> Self {
        Self { text: String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"), open: Vec::new() }
    }

    fn tag<'a>(&mut self, name: &str, attributes: impl IntoIterator<Item = (&'a str, &'a dyn Display)>) {
        for _ in 0..self.open.len() {
            self.text.push_str("  ");
        }
        self.text.push('<');
        self.text.push_str(name);
        for (key, value) in attributes {
            self.text.push(' ');
            self.text.push_str(key);
            self.text.push_str("=\"");
            // Numbers print in the shortest form that reads back as the same number. Writing to a string
            // cannot fail.
            let _ = write!(Escaped(&mut self.text), "{value}");
            self.text.push('"');
        }
    }

    /// An element without content.
    pub(super) fn leaf(&mut self, name: &str, attributes: &[(&'static str, &dyn Display)]) {
        self.tag(name, attributes.iter().copied());
        self.text.push_str("/>\n");
    }

    /// Begins an element; `close` ends it.
    pub(super) fn open(&mut self, name: &str, attributes: &[(&'static str, &dyn Display)]) {
        self.tag(name, attributes.iter().copied());
        self.text.push_str(">\n");
        self.open.push(name.to_owned());
    }

    /// Ends the element begun last.
    pub(super) fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            for _ in 0..self.open.len() {
                self.text.push_str("  ");
            }
            // Writing to a string cannot fail.
            let _ = writeln!(self.text, "</{name}>");
        }
    }

    /// An element with text in it.
    pub(super) fn text(&mut self, name: &str, content: &str) {
        self.tag(name, []);
        self.text.push('>');
        let _ = Escaped(&mut self.text).write_str(content);
        self.text.push_str(&format!("</{name}>\n"));
    }

    /// Elements that were kept as they are; names that XML does not allow are left out.
    pub(super) fn kept(&mut self, elements: &[Element]) {
        for element in elements.iter().filter(|e| is_name(&e.name)) {
            let attributes = element.attributes.iter().filter(|(key, _)| is_name(key) && key != "xmlns");
            self.tag(&element.name, attributes.map(|(key, value)| (key.as_str(), value as &dyn Display)));
            self.text.push('>');
            let _ = Escaped(&mut self.text).write_str(&element.text);
            if !element.children.is_empty() {
                self.text.push('\n');
                self.open.push(element.name.clone());
                self.kept(&element.children);
                self.close();
            } else {
                self.text.push_str(&format!("</{}>\n", element.name));
            }
        }
    }

    pub(super) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }
}

/// Whether XML 1.0 allows a name (production 5, without colons).
fn is_name(text: &str) -> bool {
    let start = |c: char| {
        matches!(c, 'A'..='Z' | 'a'..='z' | '_' | '\u{c0}'..='\u{d6}' | '\u{d8}'..='\u{f6}' | '\u{f8}'..='\u{2ff}'
            | '\u{370}'..='\u{37d}' | '\u{37f}'..='\u{1fff}' | '\u{200c}' | '\u{200d}' | '\u{2070}'..='\u{218f}'
            | '\u{2c00}'..='\u{2fef}' | '\u{3001}'..='\u{d7ff}' | '\u{f900}'..='\u{fdcf}' | '\u{fdf0}'..='\u{fffd}'
            | '\u{10000}'..='\u{effff}')
    };
    let further = |c: char| {
        start(c)
            || matches!(c, '-' | '.' | '0'..='9' | '\u{b7}' | '\u{300}'..='\u{36f}' | '\u{203f}' | '\u{2040}')
    };
    text.chars().next().is_some_and(start) && text.chars().all(further)
}

/// Escapes text for attributes and content; characters that XML cannot hold are dropped.
struct Escaped<'a>(&'a mut String);

impl Write for Escaped<'_> {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for c in text.chars() {
            match c {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                '\n' => self.0.push_str("&#10;"),
                '\r' => self.0.push_str("&#13;"),
                '\t' => self.0.push_str("&#9;"),
                c if c < ' ' || c == '\u{fffe}' || c == '\u{ffff}' => {}
                c => self.0.push(c),
            }
        }
        Ok(())
    }
}
