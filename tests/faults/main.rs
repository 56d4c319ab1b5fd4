//! Faults on purpose: every operation of every program on a tiny store goes wrong in every way in turn, on a
//! disk and in a bucket. After each, nothing that was committed is lost, and the program that runs again
//! makes the same bytes. `make test` tries a share of them by a seed, `make faults` all
//! (docs/reliability.md).
//!
//! `CONVOY_FAULTS` says which: `all`, a share as `1/40` (its seed behind it: `1/40/7`), or one as a failed
//! try names it: `disk/render/17/killed after it`. `CONVOY_FAULTS_TABLE` names a file for the counts.

mod bucket;
mod disk;
mod plan;
mod tally;
