//! Tests across stages, on the real programs, and of the generated pages.

mod check;
mod crates;
mod crosswalks;
mod docs;
mod evaluate;
mod exports;
mod failures;
mod far;
mod growth;
mod hazards;
mod help;
mod maps;
mod masks;
mod merge;
mod packs;
mod pipeline;
mod plain;
mod probes;
mod python;
mod replay;
mod rigs;
mod seen;
mod shell;
mod slips;
mod towns;
mod view;
