//! Masks against a plain reader of triangles that shares no code with the crate.

mod exact;
mod rays;
mod simbev2x;
