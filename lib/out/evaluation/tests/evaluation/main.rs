//! Scores against those of others, and files of predictions that cannot be.

mod files;
mod golden;
mod invariants;
