//! Devices against the CPU. Where Vulkan has no adapter these tests are skipped.

mod common;
mod exact;
mod rules;
mod visibility;
