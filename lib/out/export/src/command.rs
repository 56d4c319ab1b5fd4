//! The command line of `export`: each layout is a subcommand, with its own options and those that all take.

use arguments::export::CommonArgs;
use clap::{Args, Parser, Subcommand};

use crate::kitti::{Kitti, KittiOptions};
use crate::mcap::{Mcap, McapOptions};
use crate::nuscenes::{NuScenes, NuScenesOptions};
use crate::opv2v::{Opv2v, Opv2vOptions, SharedOptions};
use crate::simbev2x::{self, SimBev2x};
use crate::{ExportError, Layout};

/// Exports a finished store in a layout that other people's loaders read.
#[derive(Debug, Parser)]
#[command(
    name = "export",
    version,
    after_help = "Exit codes: 0 done, 1 the store or what it holds does not allow it, 2 bad arguments or a destination of \
                  something else, 75 stopped by a signal or a full disk (run the same command again)."
)]
pub struct Export {
    /// The layout, with its options.
    #[command(subcommand)]
    pub layout: LayoutCommand,
}

/// What all layouts take, and what one of them takes.
#[derive(Debug, Args)]
pub struct With<O: Args> {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// What this layout takes.
    #[command(flatten)]
    pub options: O,
}

/// In which layout.
#[derive(Debug, Subcommand)]
pub enum LayoutCommand {
    /// KITTI's object and tracking benchmarks: a folder of sequences for each agent.
    Kitti(With<KittiOptions>),
    /// MCAP recordings of Foxglove's messages: a file for each scene.
    Mcap(With<McapOptions>),
    /// nuScenes 1.x, as nuscenes-devkit reads it: a scene of it for every agent of a scene.
    #[command(name = "nuscenes")]
    NuScenes(With<NuScenesOptions>),
    /// OPV2V, for OpenCOOD, HEAL and CoBEVT: scenarios of vehicles and an RSU.
    Opv2v(With<Opv2vOptions>),
    /// V2X-Real: scenarios of vehicles and any number of RSUs.
    V2xReal(With<SharedOptions>),
    /// SimBEV2X's own layout, as its tools and data loader read it.
    #[command(name = "simbev2x")]
    SimBev2x(With<simbev2x::Options>),
}

impl LayoutCommand {
    /// The layout, with its options, and what all layouts take.
    ///
    /// # Errors
    /// An option makes no sense.
    pub fn split(self) -> Result<(Box<dyn Layout>, CommonArgs), ExportError> {
        Ok(match self {
            Self::Kitti(With { common, options }) => (Box::new(Kitti::new(options)), common),
            Self::Mcap(With { common, options }) => (Box::new(Mcap::new(options)?), common),
            Self::NuScenes(With { common, options }) => (Box::new(NuScenes::new(options)), common),
            Self::Opv2v(With { common, options }) => (Box::new(Opv2v::for_heal(options)), common),
            Self::V2xReal(With { common, options }) => (Box::new(Opv2v::v2x_real(options)), common),
            Self::SimBev2x(With { common, mut options }) => {
                options.path_prefix.get_or_insert_with(|| common.dest.to_string_lossy().into_owned());
                (Box::new(SimBev2x::new(options)), common)
            }
        })
    }
}

/// The options of a command line that has none.
#[cfg(test)]
pub(crate) fn usual<O: Args>() -> O {
    let command = O::augment_args(clap::Command::new("export"));
    O::from_arg_matches(&command.get_matches_from(["export"])).expect("nothing is required")
}
