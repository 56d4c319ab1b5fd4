//! What `bev-gt` sees.

use serde::Serialize;

use crate::BevSettings;

/// What masks are drawn from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaskSettings {
    /// The masks.
    pub bev: BevSettings,
    /// Time before frame 0, seconds.
    pub warmup_s: f64,
}
