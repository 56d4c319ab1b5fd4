//! What may be chosen of the layout.

/// What a user may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct McapOptions {
    /// Voxels reach this far ahead, behind and to the sides, metres; 0 for none.
    pub voxel_range_m: f64,
    /// So many voxels along each axis become one.
    pub voxel_block: u32,
    /// Write depth pictures, as metres.
    pub depth: bool,
}
