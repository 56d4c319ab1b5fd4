//! The store in a bucket: S3 and what speaks like it, Azure's blobs, Google's storage.
//!
//! Objects go straight to their keys: small ones by one request, larger ones in parts while they are written.
//! Nothing is visible before it is whole. What was begun and never ended cannot be listed there; a rule of
//! the bucket ends it (docs/object-stores.md).

mod address;
mod bucket;
mod failure;
mod profile;
mod ranges;
mod runtime;
mod service;
mod upload;

pub(crate) use address::{open, without_secrets};
pub use bucket::Objects;
pub use service::hurry_when;
