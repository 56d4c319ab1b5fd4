//! What the machine has in hand.

use std::ops::Range;

/// Number of a node.
pub(super) type Id = u32;

/// A pickle and what has been made of it.
pub(super) struct Heap<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) nodes: Vec<Node>,
}

impl Heap<'_> {
    pub(super) fn node(&self, id: Id) -> &Node {
        &self.nodes[id as usize]
    }

    pub(super) fn text(&self, range: &Range<usize>) -> &str {
        // Checked when the text was met.
        std::str::from_utf8(self.raw(range)).unwrap_or_default()
    }

    pub(super) fn raw(&self, range: &Range<usize>) -> &[u8] {
        &self.bytes[range.clone()]
    }
}

/// A value in the making. Texts and bytes are places in the pickle.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    None,
    Bool(bool),
    Int(i128),
    Float(f64),
    Text(Range<usize>),
    Bytes(Range<usize>),
    List(Vec<Id>),
    Tuple(Vec<Id>),
    Dict(Vec<(Id, Id)>),
    Global(Global),
    DType(Element),
    /// An array: none before its state is there.
    Array(Option<Array>),
}

/// The functions of numpy that stand in such pickles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Global {
    /// Makes an empty array.
    Reconstruct,
    /// Makes a number.
    Scalar,
    /// The type of arrays.
    NdArray,
    /// Makes the type of elements.
    DType,
}

impl Global {
    /// By module and name: numpy 2 has moved some.
    pub(super) fn find(module: &str, name: &str) -> Option<Self> {
        let in_core = matches!(module, "numpy.core.multiarray" | "numpy._core.multiarray");
        match name {
            "_reconstruct" if in_core => Some(Self::Reconstruct),
            "scalar" if in_core => Some(Self::Scalar),
            "ndarray" if module == "numpy" => Some(Self::NdArray),
            "dtype" if module == "numpy" => Some(Self::DType),
            _ => None,
        }
    }
}

/// Type of an array's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    Object,
    Bool,
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

impl Element {
    /// `f8`, `i4`, `O8`, ...; without a sign for the order of bytes, which is said later.
    pub(super) fn find(word: &str) -> Option<Self> {
        Some(match word.trim_start_matches(['<', '|', '=']) {
            "O8" | "O4" | "O" => Self::Object,
            "b1" => Self::Bool,
            "f8" => Self::Float(8),
            "f4" => Self::Float(4),
            "i8" => Self::Signed(8),
            "i4" => Self::Signed(4),
            "i2" => Self::Signed(2),
            "i1" => Self::Signed(1),
            "u8" => Self::Unsigned(8),
            "u4" => Self::Unsigned(4),
            "u2" => Self::Unsigned(2),
            "u1" => Self::Unsigned(1),
            _ => return None,
        })
    }

    /// Bytes of an element; none of objects.
    pub(super) fn size(self) -> Option<usize> {
        match self {
            Self::Object => None,
            Self::Bool => Some(1),
            Self::Float(size) | Self::Signed(size) | Self::Unsigned(size) => Some(size),
        }
    }
}

/// An array with its elements.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array {
    pub(super) shape: Vec<usize>,
    pub(super) element: Element,
    pub(super) is_fortran: bool,
    pub(super) content: Content,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    /// Numbers, as their bytes in the pickle.
    Raw(Range<usize>),
    /// Objects: the node of their list.
    Objects(Id),
}
