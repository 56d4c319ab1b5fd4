//! Devices against the CPU. Where Vulkan has no adapter these tests are skipped.

mod common;
mod exact;
mod rays;
mod rules;
mod visibility;
