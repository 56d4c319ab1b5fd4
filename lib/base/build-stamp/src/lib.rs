#![doc = include_str!("../README.md")]

/// The stamp: its name, the commit (spaces where there is none), `+` for a build of just this commit and `-`
/// for one with uncommitted changes.
pub static STAMP: &[u8; 85] = include_bytes!(concat!(env!("OUT_DIR"), "/stamp"));
