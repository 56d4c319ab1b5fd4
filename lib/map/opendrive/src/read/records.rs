//! Reads records that occur in several places.

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, named};
use crate::model::{Cubic, Speed, SpeedUnit};

/// A `speed` element; none where it states no number.
pub(super) fn speed(context: &mut Context, node: Node<'_, '_>) -> Option<Speed> {
    let unit = context.word(node, "unit", SpeedUnit::from_xml);
    match node.attribute("max")?.trim() {
        "no limit" => Some(Speed { max: f64::INFINITY, unit }),
        "undefined" => None,
        _ => context.maybe_number(node, "max").map(|max| Speed { max, unit }),
    }
}

/// All records of one name, in order.
pub(super) fn cubics(
    context: &mut Context,
    parent: Node<'_, '_>,
    tag: &'static str,
    start: &str,
) -> Result<Vec<Cubic>, ReadError> {
    let mut records = Vec::new();
    for node in named(parent, tag) {
        records.push(cubic(context, node, start)?);
    }
    context.sort_by_s(parent, tag, &mut records, |c| c.s);
    context.doubled(parent, tag, &records, |c| c.s);
    Ok(records)
}

/// One record; absent coefficients are 0, unreadable ones an error.
pub(super) fn cubic(context: &Context, node: Node<'_, '_>, start: &str) -> Result<Cubic, ReadError> {
    let number = |name: &str| if node.has_attribute(name) { context.number(node, name) } else { Ok(0.0) };
    Ok(Cubic { s: number(start)?, a: number("a")?, b: number("b")?, c: number("c")?, d: number("d")? })
}
