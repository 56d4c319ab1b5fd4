//! Arguments of the layout `nuscenes`.

use clap::{Args, ValueEnum};
use export_core::Layout;
use export_core::nuscenes::{Modality, NuScenes, NuScenesOptions};

use crate::args::CommonArgs;

/// What the layout takes.
#[derive(Debug, Args)]
pub(crate) struct NuScenesArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// One version for all, by its name, such as v1.0-trainval (default: one for each split and map, v1.0-SPLIT-MAP).
    #[arg(long = "version-name", value_name = "NAME")]
    version_name: Option<String>,
    /// Samples (annotated keyframes) stand at least so many frames apart.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    sample_every: u32,
    /// Write the readings between samples, too, of these: lidar,radar,camera.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    sweeps: Vec<Sweeps>,
    /// Annotate boxes within this distance of the agent, m.
    #[arg(long, value_name = "M", default_value_t = 60.0)]
    radius: f64,
    /// Annotate boxes without a lidar or radar point, too.
    #[arg(long)]
    empty_boxes: bool,
    /// Leave labels of points out.
    #[arg(long)]
    no_lidarseg: bool,
    /// Write blank map masks: for scenes that lie kilometres apart.
    #[arg(long)]
    no_map_mask: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Sweeps {
    Lidar,
    Radar,
    Camera,
}

impl Sweeps {
    fn modality(self) -> Modality {
        match self {
            Self::Lidar => Modality::Lidar,
            Self::Radar => Modality::Radar,
            Self::Camera => Modality::Camera,
        }
    }
}

impl NuScenesArgs {
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        let Self {
            common,
            version_name,
            sample_every,
            sweeps,
            radius,
            empty_boxes,
            no_lidarseg,
            no_map_mask,
        } = self;
        let mut sweeps: Vec<Modality> = sweeps.into_iter().map(Sweeps::modality).collect();
        sweeps.sort_unstable();
        sweeps.dedup();
        let layout = NuScenes::new(NuScenesOptions {
            version: version_name,
            sample_every_n_frames: sample_every,
            sweeps,
            radius_m: radius,
            empty_boxes,
            lidarseg: !no_lidarseg,
            map_mask: !no_map_mask,
        });
        (Box::new(layout), common)
    }
}
