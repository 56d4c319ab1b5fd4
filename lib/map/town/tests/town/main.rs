//! Towns: the checker that sees faults, and every town and seed through it.

mod check;
mod seeds;
mod town;
mod towns;
