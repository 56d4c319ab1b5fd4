//! What numpy's functions would build, built by hand.

use super::PickleError;
use super::machine::Machine;
use super::node::{Array, Content, Element, Global, Id, Node};

/// Most elements of an array of numbers; most dimensions.
const MAX_ELEMENTS: usize = 1 << 20;
const MAX_DIMENSIONS: usize = 4;

/// The items of a tuple.
fn tuple<'m>(machine: &'m Machine<'_>, id: Id) -> Option<Vec<&'m Node>> {
    let Node::Tuple(items) = machine.node(id) else { return None };
    Some(items.iter().map(|&item| machine.node(item)).collect())
}

/// What a call of a function gives.
pub(super) fn reduce(machine: &Machine<'_>, what: Id, arguments: Id) -> Result<Node, PickleError> {
    let Some(items) = tuple(machine, arguments) else {
        return Err(machine.fault("a call without a tuple of arguments"));
    };
    match (machine.node(what), items.as_slice()) {
        // `(ndarray, (0,), b'b')`: the last two say nothing.
        (
            Node::Global(Global::Reconstruct),
            [Node::Global(Global::NdArray), Node::Tuple(_), Node::Bytes(_)],
        ) => Ok(Node::Array(None)),
        (Node::Global(Global::DType), [Node::Text(word), ..]) if items.len() <= 3 => {
            let word = machine.text(word);
            let found = Element::find(word).map(Node::DType);
            found.ok_or_else(|| machine.fault(format!("elements of type `{}`", word.escape_debug())))
        }
        (Node::Global(Global::Scalar), [Node::DType(element), Node::Bytes(raw)]) => {
            let size = element.size().filter(|&size| size == raw.len());
            size.ok_or_else(|| machine.fault("a number of another size than its type"))?;
            Ok(match element {
                Element::Bool => Node::Bool(machine.raw(raw)[0] != 0),
                Element::Float(_) => Node::Float(number(*element, machine.raw(raw))),
                _ => Node::Int(whole(*element, machine.raw(raw))),
            })
        }
        _ => Err(machine.fault("a call that is not known here")),
    }
}

/// What a state makes of something.
pub(super) fn build(machine: &Machine<'_>, what: Id, state: Id) -> Result<Node, PickleError> {
    let Some(items) = tuple(machine, state) else { return Err(machine.fault("a state that is no tuple")) };
    match (machine.node(what), items.as_slice()) {
        // `(3, '<', None, None, None, -1, -1, 0)`.
        (Node::DType(element), [Node::Int(3 | 4), Node::Text(order), ..]) => match machine.text(order) {
            "<" | "|" | "=" => Ok(Node::DType(*element)),
            other => Err(machine.fault(format!("numbers in the order `{}` of bytes", other.escape_debug()))),
        },
        // `(1, (8, 3), dtype, False, b'...')`.
        (
            Node::Array(None),
            [Node::Int(1), Node::Tuple(shape), Node::DType(element), Node::Bool(is_fortran), _],
        ) => {
            let shape = lengths(machine, shape)?;
            let content = content(machine, state, &shape, *element)?;
            Ok(Node::Array(Some(Array { shape, element: *element, is_fortran: *is_fortran, content })))
        }
        _ => Err(machine.fault("a state that is not known here")),
    }
}

fn lengths(machine: &Machine<'_>, shape: &[Id]) -> Result<Vec<usize>, PickleError> {
    let length = |id: &Id| match machine.node(*id) {
        Node::Int(value) => usize::try_from(*value).ok(),
        _ => None,
    };
    let shape: Option<Vec<usize>> = shape.iter().map(length).collect();
    shape.filter(|shape| shape.len() <= MAX_DIMENSIONS).ok_or_else(|| machine.fault("an array of no shape"))
}

/// The elements: as many as the shape says.
fn content(
    machine: &Machine<'_>,
    state: Id,
    shape: &[usize],
    element: Element,
) -> Result<Content, PickleError> {
    let Node::Tuple(ids) = machine.node(state) else { return Err(machine.fault("a state that is no tuple")) };
    let count = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let count = count.filter(|&count| count <= MAX_ELEMENTS);
    let count = count.ok_or_else(|| machine.fault(format!("an array of shape {shape:?}")))?;
    let last = ids.last().copied().unwrap_or_default();
    match (machine.node(last), element.size()) {
        (Node::Bytes(raw), Some(size)) if raw.len() == size * count => Ok(Content::Raw(raw.clone())),
        (Node::List(items), None) if items.len() == count && shape.len() == 1 => Ok(Content::Objects(last)),
        _ => Err(machine.fault(format!("elements that do not fill the shape {shape:?}"))),
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
