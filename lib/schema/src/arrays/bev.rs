//! BEV masks.

use super::kind::ArrayKind;

/// BEV masks: `[14, rows, columns]`, bool.
pub const BEV_MASKS: ArrayKind = ArrayKind { folder: "bev", stage: "bev-gt" };
