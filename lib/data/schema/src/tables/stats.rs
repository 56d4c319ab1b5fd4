//! Partial counts, added up by the statistics stage.

use crate::table;

table! {
    /// Counts that a stage took while it had the data in hand. Rows of the same key add up.
    PartialRow in "stats/{stage}" by "{stage}" {
        /// Whose data was counted; empty when not one agent's.
        agent: String,
        /// What was counted (`bev_cells`, `voxel_cells`, `boxes`, ...).
        measure: String,
        /// Class or bin label.
        class: String,
        /// Number within a histogram, else 0.
        bin: i32,
        /// The count.
        count: u64,
    }
}
