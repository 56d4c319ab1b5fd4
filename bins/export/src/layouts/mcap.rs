//! Arguments of the layout `mcap`.

use clap::Args;
use export_core::mcap::{Mcap, McapOptions};
use export_core::{ExportError, Layout};

use crate::args::CommonArgs;

/// What the layout takes.
#[derive(Debug, Args)]
pub(crate) struct McapArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// Voxels reach this far ahead, behind and to the sides, metres (0: none).
    #[arg(long, value_name = "M", default_value_t = McapOptions::default().voxel_range_m)]
    voxel_range: f64,
    /// So many voxels along each axis become one.
    #[arg(long, value_name = "N", default_value_t = McapOptions::default().voxel_block, value_parser = clap::value_parser!(u32).range(1..=1000))]
    voxel_block: u32,
    /// Write depth pictures, too, as metres.
    #[arg(long)]
    depth: bool,
}

impl McapArgs {
    pub(crate) fn split(self) -> Result<(Box<dyn Layout>, CommonArgs), ExportError> {
        let Self { common, voxel_range, voxel_block, depth } = self;
        let layout = Mcap::new(McapOptions { voxel_range_m: voxel_range, voxel_block, depth })?;
        Ok((Box::new(layout), common))
    }
}
