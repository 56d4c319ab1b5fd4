//! Tests of what others see of the crate.

mod archive;
mod digests;
mod order;
