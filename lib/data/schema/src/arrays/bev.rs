//! BEV masks.

use super::kind::ArrayKind;

/// BEV masks: `[classes, rows, columns]`, bool.
pub const BEV_MASKS: ArrayKind = ArrayKind { folder: "bev", stage: "bev-gt" };
/// Paint that is no lane marking: `[3, rows, columns]`, bool. Stop lines, outlines of parking spaces, arrows
/// and words.
pub const BEV_PAINT: ArrayKind = ArrayKind { folder: "bev_paint", stage: "bev-gt" };
/// The object that is highest over each cell, of those that masks show: `[rows, columns]`, u16, 0 is none.
pub const BEV_IDS: ArrayKind = ArrayKind { folder: "bev_ids", stage: "bev-gt" };
/// Height of the shown ground above the agent's origin, metres: `[rows, columns]`, f32, NaN where there is
/// none.
pub const BEV_HEIGHTS: ArrayKind = ArrayKind { folder: "bev_heights", stage: "bev-gt" };
