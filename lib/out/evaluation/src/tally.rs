//! What came of one scene, and of several.

use crate::details::Details;
use crate::mode::Mode;
use crate::nuscenes::{NuScenesScores, NuScenesTally};
use crate::opv2v::{Opv2vScores, Opv2vTally};
use crate::protocol::Protocol;
use crate::simbev2x::{SimBev2xScores, SimBev2xTally};

/// The scores of the predictions of one mode.
#[derive(Clone, Debug)]
pub struct ModeScores {
    /// With whom the model worked together.
    pub mode: Mode,
    /// How many samples have predictions of it.
    pub samples: u64,
    /// SimBEV2X's scores, if they were asked for.
    pub simbev2x: Option<SimBev2xScores>,
    /// What pages show of SimBEV2X's metrics, if they and it were asked for.
    pub details: Option<Details>,
    /// SimBEV2X's scores in its mode by overlap, likewise.
    pub simbev2x_iou: Option<SimBev2xScores<9>>,
    /// nuScenes' scores, likewise.
    pub nuscenes: Option<NuScenesScores>,
    /// OPV2V's scores, likewise.
    pub opv2v: Option<Opv2vScores>,
}

/// What is counted of the predictions of one mode.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) samples: u64,
    pub(crate) simbev2x: SimBev2xTally,
    pub(crate) simbev2x_iou: SimBev2xTally<9>,
    pub(crate) nuscenes: NuScenesTally,
    pub(crate) opv2v: Opv2vTally,
}

impl Tally {
    fn append(&mut self, later: Self) {
        self.samples += later.samples;
        self.simbev2x.append(later.simbev2x);
        self.simbev2x_iou.append(later.simbev2x_iou);
        self.nuscenes.append(later.nuscenes);
        self.opv2v.append(later.opv2v);
    }
}

/// What scores are taken of tallies.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    pub(crate) protocols: Vec<Protocol>,
    /// How many of the worst frames are told; none: no details.
    pub(crate) worst_frames: Option<usize>,
    /// Whether predictions say attributes.
    pub(crate) has_attributes: bool,
}

impl Wanted {
    pub(crate) fn has(&self, protocol: Protocol) -> bool {
        self.protocols.contains(&protocol)
    }
}

/// What a scene, or an ego of it, gives: of each mode, and counts.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) modes: Vec<Tally>,
    pub(crate) counts: Counts,
}

/// What was looked at and what not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames of egos that were looked at.
    pub samples: u64,
    /// Of those, how many the file names without a box.
    pub without_boxes: u64,
    /// How many lie between those that the file names and are not named, and so not looked at.
    pub between: u64,
    /// Rows of the file that are of these samples, whether they have a box and where it is.
    pub rows: u64,
    /// Predictions that were looked at.
    pub predictions: u64,
    /// Rows of other frames and egos of these scenes, which were left out.
    pub left_out: u64,
}

impl Part {
    pub(crate) fn new(modes: usize) -> Self {
        let modes = std::iter::repeat_with(Tally::default).take(modes).collect();
        Self { modes, counts: Counts::default() }
    }

    /// All parts as one, in their order.
    pub(crate) fn of_all<'a>(modes: usize, parts: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut whole = Self::new(modes);
        parts.into_iter().for_each(|part| whole.append(part.clone()));
        whole
    }

    pub(crate) fn append(&mut self, later: Self) {
        let counts = &mut self.counts;
        counts.samples += later.counts.samples;
        counts.without_boxes += later.counts.without_boxes;
        counts.between += later.counts.between;
        counts.rows += later.counts.rows;
        counts.predictions += later.counts.predictions;
        counts.left_out += later.counts.left_out;
        self.modes.iter_mut().zip(later.modes).for_each(|(tally, later)| tally.append(later));
    }

    /// The scores of each mode.
    pub(crate) fn scores(&self, modes: &[Mode], wanted: &Wanted) -> Vec<ModeScores> {
        let of = |(mode, tally): (&Mode, &Tally)| ModeScores {
            mode: *mode,
            samples: tally.samples,
            simbev2x: wanted.has(Protocol::SimBev2x).then(|| tally.simbev2x.scores()),
            details: wanted
                .worst_frames
                .filter(|_| wanted.has(Protocol::SimBev2x))
                .map(|frames| tally.simbev2x.details(frames)),
            simbev2x_iou: wanted.has(Protocol::SimBev2xIou).then(|| tally.simbev2x_iou.scores()),
            nuscenes: wanted.has(Protocol::NuScenes).then(|| tally.nuscenes.scores(wanted.has_attributes)),
            opv2v: wanted.has(Protocol::Opv2v).then(|| tally.opv2v.scores()),
        };
        modes.iter().zip(&self.modes).map(of).collect()
    }
}
