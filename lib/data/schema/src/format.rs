//! What every store has in common.

use crate::table::Field;

/// Version of the store's layout: what is written has this number, and a reader refuses a greater one.
/// `docs/versions.md` says what each number stands for.
pub const FORMAT_VERSION: u32 = 2;

/// Whether stores, and records, of a version are read.
#[must_use]
pub const fn is_read(format_version: u32) -> bool {
    1 <= format_version && format_version <= FORMAT_VERSION
}

/// Seconds between frames: frame `k` is at `k * FRAME_PERIOD_S` after warm-up, for every agent.
pub const FRAME_PERIOD_S: f64 = 0.05;

/// The first column of every table of a scene, which no row type names: the store writes it, so that tables
/// of many scenes can be read as one. Tables of format 1 lack it.
pub const SCENE_COLUMN: Field = Field { name: "scene", doc: "Scene number, as in `plan/scenes`." };
