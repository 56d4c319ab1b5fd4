//! Which of the two layouts, and what a user may choose of them.

use clap::Args;
use schema::DetectionClass;
use serde::{Serialize, Serializer};

/// Which of the two layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variant {
    /// OPV2V with what HEAL and CoBEVT add.
    Opv2v,
    /// V2X-Real.
    V2xReal,
}

impl Variant {
    /// Folder of the splits.
    pub(super) fn folder(self) -> &'static str {
        match self {
            Self::Opv2v => "OPV2V",
            Self::V2xReal => "V2X-Real",
        }
    }

    /// The classes of the boxes that are listed unless others are named.
    fn usual_classes(self) -> Vec<DetectionClass> {
        use DetectionClass::{Bicycle, Bus, Car, Motorcycle, Pedestrian, Truck};
        match self {
            Self::Opv2v => vec![Car, Truck, Bus],
            Self::V2xReal => vec![Car, Truck, Bus, Pedestrian, Motorcycle, Bicycle],
        }
    }
}

/// What a user may choose of both layouts.
#[derive(Clone, Debug, PartialEq, Eq, Args, Serialize)]
pub struct SharedOptions {
    /// The classes of the boxes that are listed (default: car,truck,bus; of v2x-real
    /// pedestrian,motorcycle,bicycle, too).
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = class)]
    #[serde(serialize_with = "names")]
    pub classes: Vec<DetectionClass>,
    /// The lidar of agents with several (default: LIDAR, else the first by name).
    #[arg(long, value_name = "NAME")]
    pub lidar: Option<String>,
    /// The cameras ahead, right, left and back by name (default: camera0 to camera3, else by where they
    /// look).
    #[arg(long, value_name = "A,B,C,D", value_parser = four)]
    pub cameras: Option<[String; 4]>,
}

/// What a user may choose of OPV2V.
#[derive(Clone, Debug, PartialEq, Eq, Args, Serialize)]
pub struct Opv2vOptions {
    /// What both layouts take.
    #[command(flatten)]
    #[serde(flatten)]
    pub shared: SharedOptions,
    /// Give RSUs after the nearest one positive ids, as vehicles have, instead of leaving them out.
    #[arg(long)]
    pub all_rsus: bool,
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

fn names<S: Serializer>(classes: &[DetectionClass], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(classes.iter().map(|class| class.name()))
}

/// One of the two layouts, and what was chosen of it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Options {
    /// The export has the layout's name.
    #[serde(skip)]
    pub variant: Variant,
    #[serde(flatten)]
    pub chosen: Opv2vOptions,
}

impl Options {
    /// The layout with what was chosen, and its usual classes where none were.
    pub(super) fn new(variant: Variant, mut chosen: Opv2vOptions) -> Self {
        if chosen.shared.classes.is_empty() {
            chosen.shared.classes = variant.usual_classes();
        }
        Self { variant, chosen }
    }

    /// What both layouts take.
    pub(super) fn shared(&self) -> &SharedOptions {
        &self.chosen.shared
    }
}

/// Folder of a split.
pub(super) fn split_of(split: &str) -> &str {
    if split == "val" { "validate" } else { split }
}

/// Folder of a scene. Loaders replace words in whole paths: names of maps, which may hold any of them, are
/// not in it.
pub(super) fn scenario(scene: u32) -> String {
    format!("scene_{scene:04}")
}
