//! Pickles of plain values and numpy arrays, read by a machine that knows no other and calls nothing.
//!
//! A pickle is a program for a stack. Of its opcodes those are known that Python writes for dictionaries,
//! lists, texts, numbers and numpy arrays, and of classes four functions of numpy, which are names here: what
//! they would build is built by hand. Any other opcode or name is an error at its byte. Values that are
//! recalled from the memo are one value with several names, as in Python; they are copied out at the end,
//! within a budget.

mod arrays;
mod error;
mod expand;
mod machine;
mod node;

use crate::value::Value;

pub use error::PickleError;

/// Reads a pickle of protocol 2 to 5.
///
/// Memory: some 100 bytes for each byte of the pickle, of which there may be 32 MiB; what is copied out of
/// the memo is counted each time, and may come to four times the pickle and 16 MiB.
///
/// # Errors
/// [`PickleError`], with the place: truncated, an opcode or name that is not known, values that do not fit
/// together, more than the limits, or something behind the end.
pub fn parse(bytes: &[u8]) -> Result<Value, PickleError> {
    let (nodes, root) = machine::run(bytes)?;
    expand::expand(bytes, &nodes, root)
}

#[cfg(test)]
mod tests;
