//! Scores as people read them.

use std::fmt::Write;

use evaluation::{Evaluation, ModeScores, NuScenesScores, SimBev2xScores};

/// Where a class has no value, or no class has.
const NONE: &str = "-";

fn percent(value: f64) -> String {
    if value.is_nan() { NONE.into() } else { format!("{:.1}", 100.0 * value) }
}

fn error(value: f64) -> String {
    if value.is_nan() { NONE.into() } else { format!("{value:.3}") }
}

/// All scores: a table by class for each mode and family of metrics.
pub(crate) fn table(result: &Evaluation) -> String {
    let mut text = format!("{} samples, {} predictions", result.samples, result.predictions);
    if result.left_out > 0 {
        put(&mut text, format!(", {} left out: of other frames or agents", result.left_out));
    }
    for scores in &result.modes {
        if let Some(simbev2x) = &scores.simbev2x {
            put(&mut text, of_simbev2x(simbev2x, scores));
        }
        if let Some(nuscenes) = &scores.nuscenes {
            put(&mut text, of_nuscenes(nuscenes, scores));
        }
    }
    text
}

fn put(text: &mut String, more: impl AsRef<str>) {
    text.push_str(more.as_ref());
}

fn heading(name: &str, scores: &ModeScores) -> String {
    let mode = scores.mode.name();
    let mode = if mode == NONE { String::new() } else { format!(", cooperation {mode}") };
    format!("\n\n{name}{mode}, {} samples with predictions", scores.samples)
}

fn line(text: &mut String, first: &str, cells: &[String]) {
    // Writing to a string cannot fail.
    let _ = write!(text, "\n{first:<22}");
    for cell in cells {
        let _ = write!(text, "{cell:>9}");
    }
}

fn of_simbev2x(scores: &SimBev2xScores, of: &ModeScores) -> String {
    let mut text = heading("SimBEV2X", of);
    let names = ["targets", "AP", "easy", "medium", "hard", "ATE m", "AOE rad", "ASE", "AVE m/s"];
    line(&mut text, "class", &names.map(String::from));
    for class in &scores.classes {
        let mean = |of: &[[f64; 4]; 4], i: usize| {
            let values: Vec<f64> = of.iter().map(|row| row[i]).filter(|v| !v.is_nan()).collect();
            if values.is_empty() { f64::NAN } else { values.iter().sum::<f64>() / values.len() as f64 }
        };
        let mut cells = vec![class.targets[0].to_string()];
        cells.extend((0..4).map(|level| percent(mean(&class.ap, level))));
        cells.extend((0..4).map(|i| error(mean(&class.errors, i))));
        line(&mut text, class.name, &cells);
    }
    let targets: u64 = scores.classes.iter().map(|class| class.targets[0]).sum();
    let mut cells = vec![targets.to_string()];
    cells.extend(scores.mean_ap().map(percent));
    cells.extend(scores.mean_errors().map(error));
    line(&mut text, "mean", &cells);
    line(&mut text, "SDS", &[String::new(), percent(scores.sds())]);
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
    line(&mut text, "NDS", &[String::new(), percent(scores.nds())]);
    text
}
