//! What `bev-gt` counts.

/// True cells of BEV masks. Class: BEV class.
pub const BEV_CELLS: &str = "bev_cells";
/// BEV masks (one has all channels). Class: the rule by which they were drawn.
pub const BEV_GRIDS: &str = "bev_grids";
