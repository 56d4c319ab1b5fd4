//! The command line of `export`: what all layouts take, and the layouts, each a subcommand.

mod common;
mod layouts;

use clap::{Parser, Subcommand};

pub use common::CommonArgs;
pub use layouts::{
    KittiArgs, McapArgs, NuScenesArgs, Opv2vArgs, PaletteWord, SharedArgs, SimBev2xArgs, StateWord, Sweeps,
    V2xRealArgs,
};

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

/// In which layout.
#[derive(Debug, Subcommand)]
pub enum LayoutCommand {
    /// KITTI's object and tracking benchmarks: a folder of sequences for each agent.
    Kitti(KittiArgs),
    /// MCAP recordings of Foxglove's messages: a file for each scene.
    Mcap(McapArgs),
    /// nuScenes 1.x, as nuscenes-devkit reads it: a scene of it for every agent of a scene.
    #[command(name = "nuscenes")]
    NuScenes(NuScenesArgs),
    /// OPV2V, for OpenCOOD, HEAL and CoBEVT: scenarios of vehicles and an RSU.
    Opv2v(Opv2vArgs),
    /// V2X-Real: scenarios of vehicles and any number of RSUs.
    V2xReal(V2xRealArgs),
    /// SimBEV2X's own layout, as its tools and data loader read it.
    #[command(name = "simbev2x")]
    SimBev2x(SimBev2xArgs),
}
