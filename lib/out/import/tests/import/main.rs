//! Imports of a small dataset that is made here, whole, stopped, and broken byte by byte.

mod dataset;
mod mutated;
mod resumed;
