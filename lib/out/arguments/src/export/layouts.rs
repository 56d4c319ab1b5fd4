//! What each layout takes.

use clap::{Args, ValueEnum};
use schema::DetectionClass;

use super::common::CommonArgs;

/// What `kitti` takes.
#[derive(Debug, Args)]
pub struct KittiArgs {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// The camera that becomes image_2 and carries the labels.
    #[arg(long, value_name = "NAME", default_value = "CAM_FRONT")]
    pub camera: String,
    /// The lidar that becomes velodyne.
    #[arg(long, value_name = "NAME", default_value = "LIDAR")]
    pub lidar: String,
}

/// What `mcap` takes.
#[derive(Debug, Args)]
pub struct McapArgs {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// Voxels reach this far ahead, behind and to the sides, metres (0: none).
    #[arg(long, value_name = "M", default_value_t = 24.0)]
    pub voxel_range: f64,
    /// So many voxels along each axis become one.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub voxel_block: u32,
    /// Write depth pictures, too, as metres.
    #[arg(long)]
    pub depth: bool,
}

/// What `nuscenes` takes.
#[derive(Debug, Args)]
pub struct NuScenesArgs {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// One version for all, by its name, such as v1.0-trainval (default: one for each split and map,
    /// v1.0-SPLIT-MAP).
    #[arg(long = "version-name", value_name = "NAME")]
    pub version_name: Option<String>,
    /// Samples (annotated keyframes) stand at least so many frames apart.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub sample_every: u32,
    /// Write the readings between samples, too, of these: lidar,radar,camera.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub sweeps: Vec<Sweeps>,
    /// Annotate boxes within this distance of the agent, m.
    #[arg(long, value_name = "M", default_value_t = 60.0)]
    pub radius: f64,
    /// Annotate boxes without a lidar or radar point, too.
    #[arg(long)]
    pub empty_boxes: bool,
    /// Leave labels of points out.
    #[arg(long)]
    pub no_lidarseg: bool,
    /// Write blank map masks: for scenes that lie kilometres apart.
    #[arg(long)]
    pub no_map_mask: bool,
}

/// Sensors whose readings between samples are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sweeps {
    /// Lidars.
    Lidar,
    /// Radars.
    Radar,
    /// Cameras.
    Camera,
}

/// What `opv2v` and `v2x-real` take.
#[derive(Debug, Args)]
pub struct SharedArgs {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// The classes of the boxes that are listed (default: car,truck,bus; of v2x-real
    /// pedestrian,motorcycle,bicycle, too).
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = class)]
    pub classes: Vec<DetectionClass>,
    /// The lidar of agents with several (default: LIDAR, else the first by name).
    #[arg(long, value_name = "NAME")]
    pub lidar: Option<String>,
    /// The cameras ahead, right, left and back by name (default: camera0 to camera3, else by where they
    /// look).
    #[arg(long, value_name = "A,B,C,D", value_parser = four)]
    pub cameras: Option<[String; 4]>,
}

/// What `opv2v` takes.
#[derive(Debug, Args)]
pub struct Opv2vArgs {
    /// What both take.
    #[command(flatten)]
    pub shared: SharedArgs,
    /// Give RSUs after the nearest one positive ids, as vehicles have, instead of leaving them out.
    #[arg(long)]
    pub all_rsus: bool,
}

/// What `v2x-real` takes.
#[derive(Debug, Args)]
pub struct V2xRealArgs {
    /// What both take.
    #[command(flatten)]
    pub shared: SharedArgs,
}

fn class(name: &str) -> Result<DetectionClass, String> {
    DetectionClass::from_name(name).ok_or_else(|| {
        let names = DetectionClass::ALL.map(DetectionClass::name);
        format!("there is no such class; there are {}", names.join(", "))
    })
}

fn four(list: &str) -> Result<[String; 4], String> {
    let names: Vec<String> = list.split(',').map(str::to_owned).collect();
    names.try_into().map_err(|names: Vec<String>| format!("these are {}, expected four", names.len()))
}

/// What `simbev2x` takes.
#[derive(Debug, Args)]
pub struct SimBev2xArgs {
    /// What all layouts take.
    #[command(flatten)]
    pub common: CommonArgs,
    /// As before or after SimBEV2X's post-processing.
    #[arg(long, value_enum, default_value = "processed")]
    pub state: StateWord,
    /// Colours of the pictures of BEV masks.
    #[arg(long, value_enum, default_value = "plain")]
    pub palette: PaletteWord,
    /// The folder by which readers will find the dataset (their --path): it stands in the paths of the infos
    /// (default: as --dest is given).
    #[arg(long, value_name = "DIR")]
    pub path_prefix: Option<String>,
}

/// State of a dataset.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum StateWord {
    /// What its generator writes.
    Raw,
    /// With points, validity and difficulty of boxes, combined boxes, filled grids.
    Processed,
}

/// Colours of masks.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PaletteWord {
    /// Bright colours.
    Plain,
    /// Those of Cityscapes.
    Cityscapes,
}
