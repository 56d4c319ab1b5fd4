//! Nodes to values: what has several names is copied each time, within a budget.

use super::arrays::number;
use super::error::PickleError;
use super::node::{Array, Content, Id, Node};
use crate::value::Value;

/// Deepest nesting.
const MAX_DEPTH: usize = 32;
/// Bytes that may be copied out however short the pickle is.
const BASE_BUDGET: usize = 16 << 20;
/// What a value costs besides its content: its place in memory.
const COST: usize = 64;

/// The value of a node.
pub(super) fn expand(bytes: &[u8], nodes: &[Node], root: Id) -> Result<Value, PickleError> {
    // A plain pickle takes two bytes a value at least.
    let budget = bytes.len().saturating_mul(4 + COST / 2).saturating_add(BASE_BUDGET);
    Expansion { bytes, nodes, budget }.value(root, 0)
}

struct Expansion<'a> {
    bytes: &'a [u8],
    nodes: &'a [Node],
    budget: usize,
}

impl Expansion<'_> {
    fn fault(&self, problem: &str) -> PickleError {
        PickleError { offset: self.bytes.len(), problem: problem.to_owned() }
    }

    fn pay(&mut self, bytes: usize) -> Result<(), PickleError> {
        let left = self.budget.checked_sub(COST.saturating_add(bytes));
        self.budget = left.ok_or_else(|| self.fault("far more comes out of it than is in it"))?;
        Ok(())
    }

    fn value(&mut self, id: Id, depth: usize) -> Result<Value, PickleError> {
        if depth > MAX_DEPTH {
            return Err(self.fault("values are nested too deep, or hold themselves"));
        }
        self.pay(0)?;
        let nodes = self.nodes;
        Ok(match &nodes[id as usize] {
            Node::None => Value::None,
            Node::Bool(value) => Value::Bool(*value),
            Node::Int(value) => Value::Int(*value),
            Node::Float(value) => Value::Float(*value),
            Node::Text(range) => {
                self.pay(range.len())?;
                Value::Text(String::from_utf8_lossy(&self.bytes[range.clone()]).into_owned())
            }
            Node::Bytes(range) => {
                self.pay(range.len())?;
                Value::Bytes(self.bytes[range.clone()].to_vec())
            }
            Node::List(items) | Node::Tuple(items) => self.list(items, depth)?,
            Node::Dict(entries) => {
                let mut found = Vec::new();
                for &(key, value) in entries {
                    let Value::Text(key) = self.value(key, depth + 1)? else {
                        return Err(self.fault("a key that is no text"));
                    };
                    found.push((key, self.value(value, depth + 1)?));
                }
                Value::Dict(found)
            }
            Node::Array(Some(array)) => self.array(array, depth)?,
            Node::Array(None) => return Err(self.fault("an array without a state")),
            Node::Global(_) | Node::DType(_) => return Err(self.fault("a class where a value is expected")),
        })
    }

    fn list(&mut self, items: &[Id], depth: usize) -> Result<Value, PickleError> {
        let items: Result<Vec<Value>, PickleError> =
            items.iter().map(|&item| self.value(item, depth + 1)).collect();
        items.map(Value::List)
    }

    fn array(&mut self, array: &Array, depth: usize) -> Result<Value, PickleError> {
        let range = match &array.content {
            Content::Objects(list) => return self.value(*list, depth + 1),
            Content::Raw(range) => range.clone(),
        };
        let size = array.element.size().unwrap_or(1).max(1);
        self.pay(8 * (range.len() / size))?;
        let raw = &self.bytes[range];
        let values: Vec<f64> = raw.chunks_exact(size).map(|one| number(array.element, one)).collect();
        let shape = array.shape.clone();
        let values = match shape.as_slice() {
            // Columns stand one behind another.
            &[rows, columns] if array.is_fortran => {
                (0..rows * columns).map(|k| values[k % columns * rows + k / columns]).collect()
            }
            [] | [_] => values,
            _ if !array.is_fortran => values,
            _ => return Err(self.fault("Fortran order of more than two dimensions")),
        };
        Ok(Value::Numbers { shape, values })
    }
}
