#![doc = include_str!("../README.md")]

/// The stamp: its name, the commit (spaces where there is none), `+` for a build of just this commit and `-`
/// for one with uncommitted changes, and the commit's date as 2026-11-30 (spaces where nobody knows it).
pub static STAMP: &[u8; 95] = include_bytes!(concat!(env!("OUT_DIR"), "/stamp"));
