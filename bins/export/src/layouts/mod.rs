//! The layouts, each a subcommand.

mod kitti;

use clap::Subcommand;
use export_core::Layout;

use crate::args::CommonArgs;

/// In which layout.
#[derive(Debug, Subcommand)]
pub(crate) enum LayoutCommand {
    /// KITTI's object and tracking benchmarks: a folder of sequences for each agent.
    Kitti(kitti::KittiArgs),
}

impl LayoutCommand {
    /// The layout, with its options, and what all layouts take.
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        match self {
            Self::Kitti(args) => args.split(),
        }
    }
}
