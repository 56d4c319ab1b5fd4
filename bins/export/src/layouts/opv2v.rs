//! Arguments of the layouts `opv2v` and `v2x-real`.

use clap::Args;
use export_core::Layout;
use export_core::opv2v::{Options, Opv2v, Variant};
use schema::DetectionClass;

use crate::args::CommonArgs;

/// HEAL replaces these words wherever they stand in a path.
const REPLACED: [&str; 5] = ["OPV2V", "train", "validate", "test", "yaml"];

/// What both take.
#[derive(Debug, Args)]
pub(crate) struct SharedArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// The classes of the boxes that are listed (default: car,truck,bus; of v2x-real pedestrian,motorcycle,bicycle, too).
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = class)]
    classes: Vec<DetectionClass>,
    /// The lidar of agents with several (default: LIDAR, else the first by name).
    #[arg(long, value_name = "NAME")]
    lidar: Option<String>,
    /// The cameras ahead, right, left and back by name (default: camera0 to camera3, else by where they look).
    #[arg(long, value_name = "A,B,C,D", value_parser = four)]
    cameras: Option<[String; 4]>,
}

/// What `opv2v` takes.
#[derive(Debug, Args)]
pub(crate) struct Opv2vArgs {
    #[command(flatten)]
    shared: SharedArgs,
    /// Give RSUs after the nearest one positive ids, as vehicles have, instead of leaving them out.
    #[arg(long)]
    all_rsus: bool,
}

/// What `v2x-real` takes.
#[derive(Debug, Args)]
pub(crate) struct V2xRealArgs {
    #[command(flatten)]
    shared: SharedArgs,
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

impl SharedArgs {
    fn split(self, variant: Variant, all_rsus: bool) -> (Box<dyn Layout>, CommonArgs) {
        let Self { common, classes, lidar, cameras } = self;
        let usual = Options::new(variant);
        let classes = if classes.is_empty() { usual.classes } else { classes };
        (Box::new(Opv2v::new(Options { variant, classes, all_rsus, lidar, cameras })), common)
    }
}

impl Opv2vArgs {
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        let dest = std::path::absolute(&self.shared.common.dest).unwrap_or_default();
        if let Some(word) = REPLACED.iter().find(|word| dest.to_string_lossy().contains(**word)) {
            let dest = dest.display();
            tracing::warn!(
                "{dest}: HEAL replaces `{word}` in whole paths: read it from a folder without that word"
            );
        }
        self.shared.split(Variant::Opv2v, self.all_rsus)
    }
}

impl V2xRealArgs {
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        self.shared.split(Variant::V2xReal, false)
    }
}
