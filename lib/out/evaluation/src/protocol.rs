//! What detection metrics share, and their names.

/// Distances up to which a prediction finds a target, m: of SimBEV2X and nuScenes.
pub const THRESHOLDS_M: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Overlaps of volumes from which on a prediction finds a target, in SimBEV2X's mode by overlap.
pub const THRESHOLDS_VOLUME_IOU: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// A family of metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Protocol {
    /// SimBEV2X: mAP, ATE, AOE, ASE, AVE, SDS.
    SimBev2x,
    /// SimBEV2X in its mode by overlap: the same, found by the overlap of volumes.
    SimBev2xIou,
    /// nuScenes: mAP, ATE, ASE, AOE, AVE, AAE, NDS.
    NuScenes,
    /// OPV2V: AP of vehicles by overlap.
    Opv2v,
}

impl Protocol {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::SimBev2x, Self::SimBev2xIou, Self::NuScenes, Self::Opv2v];
    /// Those that are given where none is asked for: each as its field gives it.
    pub const USUAL: [Self; 3] = [Self::SimBev2x, Self::NuScenes, Self::Opv2v];

    /// Its name on the command line and in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SimBev2x => "simbev2x",
            Self::SimBev2xIou => "simbev2x-iou",
            Self::NuScenes => "nuscenes",
            Self::Opv2v => "opv2v",
        }
    }
}

/// The mean of the values that are numbers; NaN where none is.
pub(crate) fn mean_of_numbers(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) =
        values.into_iter().filter(|v| !v.is_nan()).fold((0.0, 0_u64), |(sum, count), v| (sum + v, count + 1));
    if count == 0 { f64::NAN } else { sum / count as f64 }
}
