//! Scores one by one.

use crate::mode::Mode;
use crate::nuscenes::{self, NuScenesScores};
use crate::protocol::{Protocol, THRESHOLDS_M};
use crate::run::{Evaluation, ModeScores};
use crate::simbev2x::{self, SimBev2xScores};

/// A number of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The family of metrics.
    pub protocol: Protocol,
    /// With whom the model worked together.
    pub mode: Mode,
    /// The class, or `all`.
    pub class: &'static str,
    /// The difficulty of the targets, or `all`.
    pub level: &'static str,
    /// `AP`, `mAP`, `ATE`, `mATE`, ..., `SDS`, `NDS`, `targets`.
    pub name: &'static str,
    /// The distance up to which a prediction finds a target, m; none of what is a mean over several, or a count.
    pub threshold_m: Option<f64>,
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

impl Evaluation {
    /// All numbers, in an order that stays: by mode and metrics, means first.
    #[must_use]
    pub fn measures(&self) -> Vec<Measure> {
        let of_mode = |scores: &ModeScores| {
            let mut all = Vec::new();
            if let Some(simbev2x) = &scores.simbev2x {
                all.extend(of_simbev2x(simbev2x, scores.mode));
            }
            if let Some(nuscenes) = &scores.nuscenes {
                all.extend(of_nuscenes(nuscenes, scores.mode));
            }
            all
        };
        self.modes.iter().flat_map(of_mode).collect()
    }
}

fn of_simbev2x(scores: &SimBev2xScores, mode: Mode) -> Vec<Measure> {
    let whole = Measure {
        protocol: Protocol::SimBev2x,
        mode,
        class: "all",
        level: "all",
        name: "SDS",
        threshold_m: None,
        value: scores.sds(),
    };
    let mut all = vec![whole];
    for (level, value) in simbev2x::LEVELS.into_iter().zip(scores.mean_ap()) {
        all.push(Measure { name: "mAP", level, value, ..whole });
    }
    for (error, value) in simbev2x::ERRORS.into_iter().zip(scores.mean_errors()) {
        all.push(Measure { name: mean_name(error), value, ..whole });
    }
    for class in &scores.classes {
        let whole = Measure { class: class.name, ..whole };
        for (i, level) in simbev2x::LEVELS.into_iter().enumerate() {
            all.push(Measure { name: "targets", level, value: class.targets[i] as f64, ..whole });
            for (at, ap) in THRESHOLDS_M.into_iter().zip(class.ap) {
                all.push(Measure { name: "AP", level, threshold_m: Some(at), value: ap[i], ..whole });
            }
        }
        for (i, name) in simbev2x::ERRORS.into_iter().enumerate() {
            for (at, errors) in THRESHOLDS_M.into_iter().zip(class.errors) {
                all.push(Measure { name, threshold_m: Some(at), value: errors[i], ..whole });
            }
        }
    }
    all
}

fn of_nuscenes(scores: &NuScenesScores, mode: Mode) -> Vec<Measure> {
    let whole = Measure {
        protocol: Protocol::NuScenes,
        mode,
        class: "all",
        level: "all",
        name: "NDS",
        threshold_m: None,
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
            all.push(Measure { name: "AP", threshold_m: Some(at), value, ..whole });
        }
        for (name, value) in nuscenes::ERRORS.into_iter().zip(class.errors) {
            all.push(Measure { name, threshold_m: Some(2.0), value, ..whole });
        }
    }
    all
}
