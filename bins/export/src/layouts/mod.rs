//! The layouts, each a subcommand.

mod kitti;
mod mcap;
mod nuscenes;
mod opv2v;
mod simbev2x;

use clap::Subcommand;
use export_core::{ExportError, Layout};

use crate::args::CommonArgs;

/// In which layout.
#[derive(Debug, Subcommand)]
pub(crate) enum LayoutCommand {
    /// KITTI's object and tracking benchmarks: a folder of sequences for each agent.
    Kitti(kitti::KittiArgs),
    /// MCAP recordings of Foxglove's messages: a file for each scene.
    Mcap(mcap::McapArgs),
    /// nuScenes 1.x, as nuscenes-devkit reads it: a scene of it for every agent of a scene.
    #[command(name = "nuscenes")]
    NuScenes(nuscenes::NuScenesArgs),
    /// OPV2V, for OpenCOOD, HEAL and CoBEVT: scenarios of vehicles and an RSU.
    Opv2v(opv2v::Opv2vArgs),
    /// V2X-Real: scenarios of vehicles and any number of RSUs.
    V2xReal(opv2v::V2xRealArgs),
    /// SimBEV2X's own layout, as its tools and data loader read it.
    #[command(name = "simbev2x")]
    SimBev2x(simbev2x::SimBev2xArgs),
}

impl LayoutCommand {
    /// The layout, with its options, and what all layouts take.
    ///
    /// # Errors
    /// An option makes no sense.
    pub(crate) fn split(self) -> Result<(Box<dyn Layout>, CommonArgs), ExportError> {
        match self {
            Self::Kitti(args) => Ok(args.split()),
            Self::Mcap(args) => args.split(),
            Self::NuScenes(args) => Ok(args.split()),
            Self::Opv2v(args) => Ok(args.split()),
            Self::V2xReal(args) => Ok(args.split()),
            Self::SimBev2x(args) => Ok(args.split()),
        }
    }
}
