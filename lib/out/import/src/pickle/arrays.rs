//! What numpy's functions would build, built by hand.

use super::node::{Array, Content, Element, Global, Heap, Id, Node};

/// Most elements of an array of numbers; most dimensions.
const MAX_ELEMENTS: usize = 1 << 20;
const MAX_DIMENSIONS: usize = 4;

/// The items of a tuple.
fn tuple<'m>(heap: &'m Heap<'_>, id: Id) -> Option<Vec<&'m Node>> {
    let Node::Tuple(items) = heap.node(id) else { return None };
    Some(items.iter().map(|&item| heap.node(item)).collect())
}

/// What a call of a function gives.
pub(super) fn reduce(heap: &Heap<'_>, what: Id, arguments: Id) -> Result<Node, String> {
    let Some(items) = tuple(heap, arguments) else {
        return Err("a call without a tuple of arguments".to_owned());
    };
    match (heap.node(what), items.as_slice()) {
        // `(ndarray, (0,), b'b')`: the last two say nothing.
        (
            Node::Global(Global::Reconstruct),
            [Node::Global(Global::NdArray), Node::Tuple(_), Node::Bytes(_)],
        ) => Ok(Node::Array(None)),
        (Node::Global(Global::DType), [Node::Text(word), ..]) if items.len() <= 3 => {
            let word = heap.text(word);
            let found = Element::find(word).map(Node::DType);
            found.ok_or_else(|| format!("elements of type `{}`", word.escape_debug()))
        }
        (Node::Global(Global::Scalar), [Node::DType(element), Node::Bytes(raw)]) => {
            let size = element.size().filter(|&size| size == raw.len());
            size.ok_or_else(|| "a number of another size than its type".to_owned())?;
            Ok(match element {
                Element::Bool => Node::Bool(heap.raw(raw)[0] != 0),
                Element::Float(_) => Node::Float(number(*element, heap.raw(raw))),
                _ => Node::Int(whole(*element, heap.raw(raw))),
            })
        }
        _ => Err("a call that is not known here".to_owned()),
    }
}

/// What a state makes of something.
pub(super) fn build(heap: &Heap<'_>, what: Id, state: Id) -> Result<Node, String> {
    let Some(items) = tuple(heap, state) else { return Err("a state that is no tuple".to_owned()) };
    match (heap.node(what), items.as_slice()) {
        // `(3, '<', None, None, None, -1, -1, 0)`.
        (Node::DType(element), [Node::Int(3 | 4), Node::Text(order), ..]) => match heap.text(order) {
            "<" | "|" | "=" => Ok(Node::DType(*element)),
            other => Err(format!("numbers in the order `{}` of bytes", other.escape_debug())),
        },
        // `(1, (8, 3), dtype, False, b'...')`.
        (
            Node::Array(None),
            [Node::Int(1), Node::Tuple(shape), Node::DType(element), Node::Bool(is_fortran), _],
        ) => {
            let shape = lengths(heap, shape)?;
            let content = content(heap, state, &shape, *element)?;
            Ok(Node::Array(Some(Array { shape, element: *element, is_fortran: *is_fortran, content })))
        }
        _ => Err("a state that is not known here".to_owned()),
    }
}

fn lengths(heap: &Heap<'_>, shape: &[Id]) -> Result<Vec<usize>, String> {
    let length = |id: &Id| match heap.node(*id) {
        Node::Int(value) => usize::try_from(*value).ok(),
        _ => None,
    };
    let shape: Option<Vec<usize>> = shape.iter().map(length).collect();
    shape.filter(|shape| shape.len() <= MAX_DIMENSIONS).ok_or_else(|| "an array of no shape".to_owned())
}

/// The elements: as many as the shape says.
fn content(heap: &Heap<'_>, state: Id, shape: &[usize], element: Element) -> Result<Content, String> {
    let Node::Tuple(ids) = heap.node(state) else { return Err("a state that is no tuple".to_owned()) };
    let count = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let count = count.filter(|&count| count <= MAX_ELEMENTS);
    let count = count.ok_or_else(|| format!("an array of shape {shape:?}"))?;
    let last = ids.last().copied().unwrap_or_default();
    match (heap.node(last), element.size()) {
        (Node::Bytes(raw), Some(size)) if raw.len() == size * count => Ok(Content::Raw(raw.clone())),
        (Node::List(items), None) if items.len() == count && shape.len() == 1 => Ok(Content::Objects(last)),
        _ => Err(format!("elements that do not fill the shape {shape:?}")),
    }
}

/// A number of so many bytes, lowest first.
pub(super) fn number(element: Element, raw: &[u8]) -> f64 {
    match (element, raw) {
        (Element::Float(8), &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        (Element::Float(4), &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => whole(element, raw) as f64,
    }
}

fn whole(element: Element, raw: &[u8]) -> i128 {
    let is_negative = matches!(element, Element::Signed(_)) && raw.last().is_some_and(|&b| b >= 0x80);
    let mut wide = [if is_negative { 0xff } else { 0 }; 16];
    for (place, byte) in wide.iter_mut().zip(raw) {
        *place = *byte;
    }
    i128::from_le_bytes(wide)
}
