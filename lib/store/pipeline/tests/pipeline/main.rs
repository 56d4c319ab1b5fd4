//! Tests of what others see of the crate.

mod digests;
