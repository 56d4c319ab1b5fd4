//! Commit, resume, faults, old formats, verification: on every backend.

mod bucket;
mod commit;
mod common;
mod disk;
mod faults;
mod format;
mod verify;
