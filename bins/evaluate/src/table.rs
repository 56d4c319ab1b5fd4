//! Scores as people read them.

use std::fmt::Write;

use evaluation::{
    Evaluation, Level, MASK_THRESHOLDS, MaskEvaluation, MaskMode, Mode, ModeScores, NuScenesScores,
    Opv2vScores, ResultRow, Ring, SimBev2xScores, THRESHOLDS_IOU,
};

/// Where a class has no value, or no class has.
const NONE: &str = "-";

fn percent(value: f64) -> String {
    if value.is_nan() { NONE.into() } else { format!("{:.1}", 100.0 * value) }
}

fn error(value: f64) -> String {
    if value.is_nan() { NONE.into() } else { format!("{value:.3}") }
}

/// All scores of boxes: a table by class for each mode and family of metrics.
pub(crate) fn of_boxes(result: &Evaluation) -> String {
    let counts = &result.counts;
    let mut text = format!("{} samples, {} predictions", counts.samples, counts.predictions);
    if counts.without_boxes > 0 {
        put(&mut text, format!(", {} samples are named without a box", counts.without_boxes));
    }
    if counts.left_out > 0 {
        put(&mut text, format!(", {} rows left out: of other frames or agents", counts.left_out));
    }
    for scores in &result.modes {
        if let Some(simbev2x) = &scores.simbev2x {
            put(&mut text, of_simbev2x("SimBEV2X", simbev2x, scores));
        }
        if let Some(simbev2x) = &scores.simbev2x_iou {
            put(&mut text, of_simbev2x("SimBEV2X by overlap", simbev2x, scores));
        }
        if let Some(nuscenes) = &scores.nuscenes {
            put(&mut text, of_nuscenes(nuscenes, scores));
        }
        if let Some(opv2v) = &scores.opv2v {
            put(&mut text, of_opv2v(opv2v, scores));
        }
    }
    text
}

fn put(text: &mut String, more: impl AsRef<str>) {
    text.push_str(more.as_ref());
}

fn heading(name: &str, scores: &ModeScores) -> String {
    format!("\n\n{name}{}, {} samples with predictions", cooperation(scores.mode), scores.samples)
}

fn cooperation(mode: Mode) -> String {
    let mode = mode.name();
    if mode == NONE { String::new() } else { format!(", cooperation {mode}") }
}

fn line(text: &mut String, first: &str, cells: &[String]) {
    // Writing to a string cannot fail.
    let _ = write!(text, "\n{first:<22}");
    for cell in cells {
        let _ = write!(text, "{cell:>10}");
    }
}

/// Of all levels first those of difficulty, then those of distance and of the agents that saw it.
const DIFFICULTIES: [Level; 4] = [Level::All, Level::Easy, Level::Medium, Level::Hard];
const PLACES: [Level; 5] = [Level::Near, Level::Middle, Level::Far, Level::Ego, Level::Partners];

fn of_simbev2x<const N: usize>(title: &str, scores: &SimBev2xScores<N>, of: &ModeScores) -> String {
    let mut text = heading(title, of);
    let names = ["targets", "AP", "easy", "medium", "hard", "ATE m", "AOE rad", "ASE", "AVE m/s"];
    line(&mut text, "class", &names.map(String::from));
    for class in &scores.classes {
        let mut cells = vec![class.targets[0].to_string()];
        cells.extend(DIFFICULTIES.map(|level| percent(class.mean_ap(level))));
        cells.extend(class.mean_errors().map(error));
        line(&mut text, class.name, &cells);
    }
    let targets: u64 = scores.classes.iter().map(|class| class.targets[0]).sum();
    let all = scores.mean_ap();
    let mut cells = vec![targets.to_string()];
    cells.extend(DIFFICULTIES.map(|level| percent(all[level as usize])));
    cells.extend(scores.mean_errors().map(error));
    line(&mut text, "mean", &cells);
    line(&mut text, "SDS", &[String::new(), percent(scores.sds())]);

    // Of each level AP, and how many targets it has.
    text.push_str("\n\nAP by distance, and by whose lidars have points of the target: the ego's, or those of partners alone");
    let of = |level: Level| [level.name().to_owned(), "targets".to_owned()];
    line(&mut text, "class", &PLACES.map(of).concat());
    for class in &scores.classes {
        let of = |level: Level| [percent(class.mean_ap(level)), class.targets[level as usize].to_string()];
        line(&mut text, class.name, &PLACES.map(of).concat());
    }
    let of = |level: Level| {
        let targets: u64 = scores.classes.iter().map(|class| class.targets[level as usize]).sum();
        [percent(all[level as usize]), targets.to_string()]
    };
    line(&mut text, "mean", &PLACES.map(of).concat());
    text
}

fn of_opv2v(scores: &Opv2vScores, of: &ModeScores) -> String {
    let mut text = heading("OPV2V", of);
    let mut names = vec!["targets".to_owned()];
    names.extend(THRESHOLDS_IOU.map(|iou| format!("AP@{iou}")));
    line(&mut text, "vehicle", &names);
    for (name, ap) in [("sorted globally", scores.sorted), ("frame after frame", scores.by_frame)] {
        let mut cells = vec![scores.targets.to_string()];
        cells.extend(ap.map(percent));
        line(&mut text, name, &cells);
    }
    text
}

/// The means over classes, by map where they are, with their intervals where these were asked for.
pub(crate) fn of_means(rows: &[ResultRow]) -> String {
    let is_mean = |row: &&ResultRow| {
        let measure = &row.measure;
        let (class, name) = (measure.class, measure.name);
        (class == "all" && matches!(name, "mAP" | "SDS" | "mIoU")
            || name.starts_with("NDS")
            || name.starts_with("AP "))
            && measure.threshold.is_none_or(|at| at == 0.5)
    };
    let mut text = String::from("\nMeans, %");
    let names = ["mode", "value", "from", "to", "gain", "from", "to"];
    let _ = write!(text, "\n{:<46}", "map, metrics, measure, level");
    for name in names {
        let _ = write!(text, "{name:>8}");
    }
    for row in rows.iter().filter(is_mean) {
        let measure = &row.measure;
        let map = row.map.as_deref().unwrap_or("all");
        let name = format!("{map}, {}, {}, {}", measure.metrics, measure.name, measure.level);
        let _ = write!(text, "\n{name:<46}{:>8}{:>8}", measure.mode.name(), percent(measure.value));
        if let Some(spread) = row.spread {
            let gain = spread.gain.unwrap_or([f64::NAN; 3]);
            for value in spread.interval.into_iter().chain(gain) {
                let _ = write!(text, "{:>8}", percent(value));
            }
        }
    }
    text
}

/// All scores of masks: a table by class for each mode.
pub(crate) fn of_masks(result: &MaskEvaluation) -> String {
    let mut text = String::new();
    for (i, MaskMode { mode, scores }) in result.modes.iter().enumerate() {
        let gap = if i == 0 { "" } else { "\n\n" };
        put(&mut text, format!("{gap}BEV masks{}, {} frames", cooperation(*mode), scores.frames));
        let mut names: Vec<String> = ["cells", "IoU", "0.7", "0.9"].map(String::from).to_vec();
        names.extend(Ring::ALL.map(|ring| ring.name().to_owned()));
        names.extend(["best", "at"].map(String::from));
        line(&mut text, "class", &names);
        let at = |threshold: f64| MASK_THRESHOLDS.iter().position(|t| *t == threshold).unwrap_or_default();
        let cells = |iou: &[[f64; MASK_THRESHOLDS.len()]; 4]| {
            let all = [0.5, 0.7, 0.9].map(|threshold| percent(iou[0][at(threshold)]));
            let rings = [1, 2, 3].map(|ring: usize| percent(iou[ring][at(0.5)]));
            [all, rings].concat()
        };
        for class in &scores.classes {
            let mut row = vec![class.cells[0].to_string()];
            row.extend(cells(&class.iou));
            let (iou, threshold) = class.best();
            row.extend([percent(iou), format!("{threshold}")]);
            line(&mut text, class.name, &row);
        }
        let mut row = vec![String::new()];
        row.extend(cells(&scores.mean_iou()));
        line(&mut text, "mean", &row);
    }
    text
}

fn of_nuscenes(scores: &NuScenesScores, of: &ModeScores) -> String {
    let mut text = heading("nuScenes", of);
    let names = ["targets", "AP", "@0.5", "@1", "@2", "@4", "ATE m", "ASE", "AOE rad", "AVE m/s", "AAE"];
    line(&mut text, "class", &names.map(String::from));
    for class in &scores.classes {
        let mut cells = vec![class.targets.to_string(), percent(class.ap.iter().sum::<f64>() / 4.0)];
        cells.extend(class.ap.map(percent));
        cells.extend(class.errors.map(error));
        line(&mut text, class.name, &cells);
    }
    let targets: u64 = scores.classes.iter().map(|class| class.targets).sum();
    let mut cells = vec![targets.to_string(), percent(scores.mean_ap())];
    cells.extend(std::iter::repeat_n(String::new(), 4));
    cells.extend(scores.mean_errors().map(error));
    line(&mut text, "mean", &cells);
    line(&mut text, scores.nds_name(), &[String::new(), percent(scores.nds())]);
    text
}
