//! Tests of what others see of the crate.

mod docs;
mod pages;
mod schemas;
