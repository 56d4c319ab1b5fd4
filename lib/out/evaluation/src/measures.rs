//! Scores one by one.

use crate::level::Level;
use crate::masks::{MASK_THRESHOLDS, MaskMode, MaskScores};
use crate::mode::Mode;
use crate::nuscenes::{self, NuScenesScores};
use crate::opv2v::{self, Opv2vScores, THRESHOLDS_IOU};
use crate::protocol::{Protocol, THRESHOLDS_M, THRESHOLDS_VOLUME_IOU};
use crate::ring::Ring;
use crate::simbev2x::{self, SimBev2xScores};
use crate::tally::ModeScores;

/// Name of the metrics of BEV masks in results.
const MASK_METRICS: &str = "bev";

/// A number of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The family of metrics: `simbev2x`, `simbev2x-iou`, `nuscenes`, `opv2v` or `bev`.
    pub metrics: &'static str,
    /// With whom the model worked together.
    pub mode: Mode,
    /// The class, or `all`.
    pub class: &'static str,
    /// Which of the targets or cells: all, or those of a difficulty, a distance, ...; of what is confused,
    /// the class for which it is taken.
    pub level: &'static str,
    /// `AP`, `mAP`, `ATE`, `mATE`, ..., `SDS`, `NDS`, `NDS without AAE`, `targets`, `IoU`, `mIoU`, `cells`,
    /// `confused`.
    pub name: &'static str,
    /// The distance up to which (m), the overlap or the score from which on something is found; none of what
    /// is a mean over several of them, or a count.
    pub threshold: Option<f64>,
    /// Its value; NaN where there is none.
    pub value: f64,
}

/// Names of means of errors by those of the errors.
fn mean_name(error: &str) -> &'static str {
    match error {
        "ATE" => "mATE",
        "AOE" => "mAOE",
        "ASE" => "mASE",
        "AVE" => "mAVE",
        _ => "mAAE",
    }
}

/// All numbers of some modes, in an order that stays: by mode and metrics, means first.
pub(crate) fn of_modes(modes: &[ModeScores]) -> Vec<Measure> {
    let of_mode = |scores: &ModeScores| {
        let mut all = Vec::new();
        if let Some(simbev2x) = &scores.simbev2x {
            all.extend(of_simbev2x(simbev2x, (Protocol::SimBev2x, THRESHOLDS_M), scores.mode));
        }
        if let Some(simbev2x) = &scores.simbev2x_iou {
            all.extend(of_simbev2x(simbev2x, (Protocol::SimBev2xIou, THRESHOLDS_VOLUME_IOU), scores.mode));
        }
        if let Some(nuscenes) = &scores.nuscenes {
            all.extend(of_nuscenes(nuscenes, scores.mode));
        }
        if let Some(opv2v) = &scores.opv2v {
            all.extend(of_opv2v(opv2v, scores.mode));
        }
        all
    };
    modes.iter().flat_map(of_mode).collect()
}

fn of_simbev2x<const N: usize>(
    scores: &SimBev2xScores<N>,
    (protocol, thresholds): (Protocol, [f64; N]),
    mode: Mode,
) -> Vec<Measure> {
    let whole = Measure {
        metrics: protocol.name(),
        mode,
        class: "all",
        level: "all",
        name: "SDS",
        threshold: None,
        value: scores.sds(),
    };
    let mut all = vec![whole];
    for (level, value) in Level::ALL.into_iter().zip(scores.mean_ap()) {
        all.push(Measure { name: "mAP", level: level.name(), value, ..whole });
    }
    for (error, value) in simbev2x::ERRORS.into_iter().zip(scores.mean_errors()) {
        all.push(Measure { name: mean_name(error), value, ..whole });
    }
    for class in &scores.classes {
        let whole = Measure { class: class.name, ..whole };
        for (i, level) in Level::ALL.map(Level::name).into_iter().enumerate() {
            all.push(Measure { name: "targets", level, value: class.targets[i] as f64, ..whole });
            for (at, ap) in thresholds.into_iter().zip(class.ap) {
                all.push(Measure { name: "AP", level, threshold: Some(at), value: ap[i], ..whole });
            }
        }
        for (i, name) in simbev2x::ERRORS.into_iter().enumerate() {
            for (at, errors) in thresholds.into_iter().zip(class.errors) {
                all.push(Measure { name, threshold: Some(at), value: errors[i], ..whole });
            }
        }
    }
    all
}

fn of_opv2v(scores: &Opv2vScores, mode: Mode) -> Vec<Measure> {
    let whole = Measure {
        metrics: Protocol::Opv2v.name(),
        mode,
        class: opv2v::CLASS,
        level: "all",
        name: "targets",
        threshold: None,
        value: scores.targets as f64,
    };
    let mut all = vec![whole];
    for (name, ap) in [("AP", scores.sorted), ("AP by frame", scores.by_frame)] {
        for (at, value) in THRESHOLDS_IOU.into_iter().zip(ap) {
            all.push(Measure { name, threshold: Some(at), value, ..whole });
        }
    }
    all
}

/// All numbers of the masks of some modes, in an order that stays: by mode, means first.
pub(crate) fn of_mask_modes(modes: &[MaskMode]) -> Vec<Measure> {
    modes.iter().flat_map(|mode| of_masks(&mode.scores, mode.mode)).collect()
}

fn of_masks(scores: &MaskScores, mode: Mode) -> Vec<Measure> {
    let levels = [Level::All.name(), Ring::Near.name(), Ring::Middle.name(), Ring::Far.name()];
    let whole = Measure {
        metrics: MASK_METRICS,
        mode,
        class: "all",
        level: levels[0],
        name: "frames",
        threshold: None,
        value: scores.frames as f64,
    };
    let mut all = vec![whole];
    let mut put = |whole: Measure, name: &'static str, iou: &[[f64; MASK_THRESHOLDS.len()]; 4]| {
        for (level, iou) in levels.into_iter().zip(iou) {
            for (at, value) in MASK_THRESHOLDS.into_iter().zip(*iou) {
                all.push(Measure { name, level, threshold: Some(at), value, ..whole });
            }
        }
    };
    put(whole, "mIoU", &scores.mean_iou());
    for class in &scores.classes {
        put(Measure { class: class.name, ..whole }, "IoU", &class.iou);
    }
    for (class, confused) in scores.classes.iter().zip(&scores.confusion) {
        let whole = Measure { class: class.name, ..whole };
        for (level, cells) in levels.into_iter().zip(class.cells) {
            all.push(Measure { name: "cells", level, value: cells as f64, ..whole });
        }
        for (other, cells) in scores.classes.iter().zip(confused) {
            let (level, value) = (other.name, *cells as f64);
            all.push(Measure { name: "confused", level, threshold: Some(0.5), value, ..whole });
        }
    }
    all
}

fn of_nuscenes(scores: &NuScenesScores, mode: Mode) -> Vec<Measure> {
    let whole = Measure {
        metrics: Protocol::NuScenes.name(),
        mode,
        class: "all",
        level: "all",
        name: scores.nds_name(),
        threshold: None,
        value: scores.nds(),
    };
    let mut all = vec![whole, Measure { name: "mAP", value: scores.mean_ap(), ..whole }];
    for (error, value) in nuscenes::ERRORS.into_iter().zip(scores.mean_errors()) {
        all.push(Measure { name: mean_name(error), value, ..whole });
    }
    for class in &scores.classes {
        let whole = Measure { class: class.name, ..whole };
        all.push(Measure { name: "targets", value: class.targets as f64, ..whole });
        for (at, value) in THRESHOLDS_M.into_iter().zip(class.ap) {
            all.push(Measure { name: "AP", threshold: Some(at), value, ..whole });
        }
        for (name, value) in nuscenes::ERRORS.into_iter().zip(class.errors) {
            all.push(Measure { name, threshold: Some(2.0), value, ..whole });
        }
    }
    all
}
