//! The command lines of `viz`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use runner::SceneList;
use schema::AgentId;

/// Commands that draw what a store holds.
#[derive(Debug, Subcommand)]
pub enum PictureCommand {
    /// Draws sensor data and labels: one file a picture.
    Viz(VizArgs),
    /// Draws a contact sheet of a frame as an agent has it: cameras, lidar, masks, voxels, map.
    Preview(PreviewArgs),
    /// Draws a scene as an agent sees it, as an animated PNG, and as MP4 where there is an ffmpeg.
    Film(FilmArgs),
}

impl PictureCommand {
    /// What all of them share.
    #[must_use]
    pub fn common(&self) -> &CommonArgs {
        match self {
            Self::Viz(args) => &args.common,
            Self::Preview(args) => &args.common,
            Self::Film(args) => &args.common,
        }
    }
}

/// Draws what a finished store holds: sensor data and labels, one file a picture.
#[derive(Debug, Parser)]
#[command(
    name = "viz",
    version,
    after_help = "Further commands: `viz preview --help` (a contact sheet), `viz film --help` (a scene as a film)."
)]
pub struct Stills {
    /// What to draw.
    #[command(flatten)]
    pub args: VizArgs,
}

/// What all of them share.
#[derive(Debug, Args)]
pub struct CommonArgs {
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// Worker threads (default: all cores). The pictures do not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Draw boxes that the agent did not see, too.
    #[arg(long)]
    pub all_boxes: bool,
    /// Draw no boxes: pictures are then as cameras took them.
    #[arg(long, conflicts_with = "all_boxes")]
    pub no_boxes: bool,
}

/// Which boxes are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShownBoxes {
    /// None.
    #[default]
    None,
    /// Those of objects that the agent saw.
    SeenBy,
    /// All.
    All,
}

impl CommonArgs {
    /// Which boxes are drawn.
    #[must_use]
    pub fn boxes(&self) -> ShownBoxes {
        match (self.no_boxes, self.all_boxes) {
            (true, _) => ShownBoxes::None,
            (false, true) => ShownBoxes::All,
            (false, false) => ShownBoxes::SeenBy,
        }
    }
}

/// What to draw.
#[derive(Debug, Args)]
pub struct VizArgs {
    /// What all commands share.
    #[command(flatten)]
    pub common: CommonArgs,
    /// Number of the scene (default: the first that is finished).
    #[arg(long, value_name = "N")]
    pub scene: Option<u32>,
    /// Frames, such as 0,10-20 (default: one in the middle).
    #[arg(long, value_name = "LIST")]
    pub frames: Option<SceneList>,
    /// Of these frames (without --frames: of all) every n-th.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub every: Option<u32>,
    /// Agents, such as vehicle_0,rsu_* (default: all).
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub agents: Vec<String>,
    /// Pictures, such as RGB-*,LIDAR3DwBBOX-NEAR (default: all); --list names them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub modes: Vec<String>,
    /// What the colours of points tell (default: of lidars the distance, of semantic ones the tag, of radars
    /// the velocity, of several agents together whose they are).
    #[arg(long, value_name = "WHAT", value_enum)]
    pub colour: Option<Colour>,
    /// The folder to write to.
    #[arg(long, value_name = "DIR", required_unless_present = "list")]
    pub dest: Option<PathBuf>,
    /// Only name the pictures that there are.
    #[arg(long)]
    pub list: bool,
}

/// What to show.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// What all commands share.
    #[command(flatten)]
    pub common: CommonArgs,
    /// Number of the scene (default: the first that is finished).
    #[arg(long, value_name = "N")]
    pub scene: Option<u32>,
    /// The frame (default: one in the middle).
    #[arg(long, value_name = "N")]
    pub frame: Option<u32>,
    /// The agent (default: the first vehicle).
    #[arg(long, value_name = "NAME")]
    pub agent: Option<AgentId>,
    /// Width of the sheet, pixels.
    #[arg(long, value_name = "PX", default_value_t = 2400, value_parser = clap::value_parser!(u32).range(400..=8000))]
    pub width: u32,
    /// The file to write: .png or .jpg.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// What to film.
#[derive(Debug, Args)]
pub struct FilmArgs {
    /// What all commands share.
    #[command(flatten)]
    pub common: CommonArgs,
    /// Number of the scene (default: the first that is finished).
    #[arg(long, value_name = "N")]
    pub scene: Option<u32>,
    /// The agent (default: the first vehicle).
    #[arg(long, value_name = "NAME")]
    pub agent: Option<AgentId>,
    /// Every which frame of the scene is shown.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub every: u32,
    /// Width of the film, pixels.
    #[arg(long, value_name = "PX", default_value_t = 960, value_parser = clap::value_parser!(u32).range(200..=4000))]
    pub width: u32,
    /// The file to write: .png (browsers play it); with an ffmpeg at hand a .mp4 is put beside it.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// What the colours of points tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// Distance from the sensor
    Distance,
    /// Height over the agent's ground
    Height,
    /// Semantic tag
    Tag,
    /// Object
    Id,
    /// Strength of the return
    Intensity,
    /// Radial velocity
    Velocity,
    /// Whose point it is
    Agent,
}
