//! What users say.

use schema::DetectionClass;

/// Which of the two layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
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

/// What users say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Which of the two layouts.
    pub variant: Variant,
    /// Classes of the boxes that are listed.
    pub classes: Vec<DetectionClass>,
    /// OPV2V: whether RSUs after the first get positive ids instead of being left out.
    pub all_rsus: bool,
    /// The lidar, of agents with several: `LIDAR`, or the first by name.
    pub lidar: Option<String>,
    /// The cameras 0 to 3 by name: `camera0` to `camera3`, or those that look ahead, right, left and back.
    pub cameras: Option<[String; 4]>,
}

impl Options {
    /// Nothing said.
    #[must_use]
    pub fn new(variant: Variant) -> Self {
        Self { variant, classes: variant.usual_classes(), all_rsus: false, lidar: None, cameras: None }
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
