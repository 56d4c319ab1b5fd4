//! Elements that are kept as they are.

/// An element of a file that no query looks at: kept, and written back in its place.
///
/// Names and attributes are local names; white space around the text is left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Its name.
    pub name: String,
    /// Its attributes, in file order, each name once.
    pub attributes: Vec<(String, String)>,
    /// Text in it.
    pub text: String,
    /// Elements in it.
    pub children: Vec<Element>,
}

impl Element {
    /// The value of an attribute.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

/// How often an element occurred that the reader does not understand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnknownElement {
    /// How often.
    pub count: usize,
    /// Line of the first one, from 1.
    pub line: u32,
}
