//! What a user may choose of the layout.

use clap::Args;
use serde::Serialize;

/// What a user may choose.
#[derive(Clone, Copy, Debug, Args, Serialize)]
pub struct McapOptions {
    /// Voxels reach this far ahead, behind and to the sides, metres (0: none).
    #[arg(long = "voxel-range", value_name = "M", default_value_t = 24.0)]
    pub voxel_range_m: f64,
    /// So many voxels along each axis become one.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub voxel_block: u32,
    /// Write depth pictures, too, as metres.
    #[arg(long)]
    pub depth: bool,
}
