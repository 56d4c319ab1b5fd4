//! Devices against the CPU. Where Vulkan has no adapter these tests are skipped.

mod exact;
mod rules;
