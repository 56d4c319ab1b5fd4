//! Scores as a page.

use analysis::{
    FoundBar, Moment, PrecisionCurves, ScorePart, Section, Table, TableColumn, Values, scores_html,
};
use evaluation::{
    Details, Evaluation, Level, MASK_THRESHOLDS, MaskEvaluation, MaskScores, Mode, ModeScores,
    NuScenesScores, Opv2vScores, Ring, SimBev2xScores, THRESHOLDS_IOU, THRESHOLDS_M,
};

/// The page of what was evaluated.
pub(crate) fn page(name: &str, boxes: Option<&Evaluation>, masks: Option<&MaskEvaluation>) -> String {
    let mut about = Vec::new();
    let mut parts = Vec::new();
    if let Some(boxes) = boxes {
        about
            .push(format!("{} samples, {} predicted boxes.", boxes.counts.samples, boxes.counts.predictions));
        parts.extend(boxes.modes.iter().map(part_of_boxes));
    }
    if let Some(masks) = masks {
        let frames: u64 = masks.modes.iter().map(|mode| mode.scores.frames).sum();
        about.push(format!("Predicted BEV masks of {frames} frames."));
        parts.extend(masks.modes.iter().map(|mode| ScorePart {
            title: titled("BEV masks", mode.mode),
            tables: vec![of_masks(&mode.scores)],
            ..ScorePart::default()
        }));
    }
    scores_html(name, &about.join(" "), &parts)
}

fn titled(what: &str, mode: Mode) -> String {
    if mode == Mode::Unsaid { what.to_owned() } else { format!("{what}, cooperation {}", mode.name()) }
}

fn part_of_boxes(scores: &ModeScores) -> ScorePart {
    let mut tables = Vec::new();
    tables.extend(scores.simbev2x.as_ref().map(|scores| of_simbev2x("SimBEV2X", scores)));
    tables.extend(scores.simbev2x_iou.as_ref().map(|scores| of_simbev2x("SimBEV2X by overlap", scores)));
    tables.extend(scores.nuscenes.as_ref().map(of_nuscenes));
    tables.extend(scores.opv2v.as_ref().map(of_opv2v));
    let mut part = ScorePart { title: titled("Boxes", scores.mode), tables, ..ScorePart::default() };
    if let Some(details) = &scores.details {
        put_details(&mut part, details);
    }
    part
}

fn put_details(part: &mut ScorePart, details: &Details) {
    for class in details.classes.iter().filter(|class| class.curves.iter().any(|curve| !curve.is_empty())) {
        let curves =
            THRESHOLDS_M.iter().zip(&class.curves).map(|(m, points)| (format!("{m} m"), points.clone()));
        part.curves.push(PrecisionCurves { title: class.name.replace('_', " "), curves: curves.collect() });
    }
    part.found_note = "Targets found up to 2 m by predictions from that score on that gives their class the best F1; false ones at their \
                       own distance."
        .into();
    for class in &details.classes {
        for (ring, found) in Ring::ALL.into_iter().zip(class.rings) {
            let targets = found.found + found.missed;
            if targets + found.wrong > 0 {
                let label = format!("{}, {}", class.name.replace('_', " "), ring.name());
                part.found.push(FoundBar { label, targets, found: found.found, wrong: found.wrong });
            }
        }
    }
    part.worst.extend(details.worst.iter().map(|(sample, found)| Moment {
        scene: sample.scene,
        frame: sample.frame,
        ego: sample.ego.to_string(),
        found_missed_wrong: [found.found, found.missed, found.wrong],
    }));
}

/// A number that may be none.
fn number(value: f64) -> Option<f64> {
    Some(value).filter(|v| !v.is_nan())
}

fn percent(value: f64) -> Option<f64> {
    number(100.0 * value)
}

/// A table whose rows begin with a name.
struct Rows {
    columns: Vec<(String, usize)>,
    names: Vec<String>,
    values: Vec<Vec<Option<f64>>>,
}

impl Rows {
    fn new(columns: impl IntoIterator<Item = (String, usize)>) -> Self {
        let columns: Vec<(String, usize)> = columns.into_iter().collect();
        let values = vec![Vec::new(); columns.len()];
        Self { columns, names: Vec::new(), values }
    }

    fn push(&mut self, name: &str, values: impl IntoIterator<Item = Option<f64>>) {
        self.names.push(name.into());
        for (column, value) in self.values.iter_mut().zip(values) {
            column.push(value);
        }
    }

    fn table(self, title: &str, note: &str) -> Table {
        let mut columns = vec![TableColumn { name: "class".into(), values: Values::Str(self.names) }];
        for ((name, decimals), values) in self.columns.into_iter().zip(self.values) {
            columns.push(TableColumn { name, values: Values::F64 { values, decimals } });
        }
        let (title, note) = (title.to_owned(), note.to_owned());
        Table { name: "scores".into(), section: Section::Boxes, title, note, columns }
    }
}

fn named(names: &[&str], decimals: usize) -> Vec<(String, usize)> {
    names.iter().map(|name| ((*name).to_owned(), decimals)).collect()
}

fn of_simbev2x<const N: usize>(title: &str, scores: &SimBev2xScores<N>) -> Table {
    let mut columns = named(&["targets"], 0);
    columns.extend(
        Level::ALL.map(|level| (if level == Level::All { "AP".into() } else { level.name().into() }, 1)),
    );
    columns.extend(named(&["ATE_m", "AOE, rad", "ASE", "AVE, m/s"], 3));
    let mut rows = Rows::new(columns);
    for class in scores.classes.iter().filter(|class| class.targets[0] > 0) {
        let ap = Level::ALL.map(|level| percent(class.mean_ap(level)));
        let errors = class.mean_errors().map(number);
        rows.push(class.name, [Some(class.targets[0] as f64)].into_iter().chain(ap).chain(errors));
    }
    let targets: u64 = scores.classes.iter().map(|class| class.targets[0]).sum();
    let (ap, errors) = (scores.mean_ap().map(percent), scores.mean_errors().map(number));
    rows.push("mean", [Some(targets as f64)].into_iter().chain(ap).chain(errors));
    let note = format!(
        "SDS {}. AP in %: of all targets, by difficulty, by distance, and of those with points of the ego's lidars or of partners' alone.",
        percent(scores.sds()).map_or("none".into(), |sds| format!("{sds:.1}"))
    );
    rows.table(title, &note)
}

fn of_nuscenes(scores: &NuScenesScores) -> Table {
    let mut columns = named(&["targets"], 0);
    columns.extend(named(&["AP", "0.5 m", "1 m", "2 m", "4 m"], 1));
    columns.extend(named(&["ATE_m", "ASE", "AOE, rad", "AVE, m/s", "AAE"], 3));
    let mut rows = Rows::new(columns);
    for class in scores.classes.iter().filter(|class| class.targets > 0) {
        let ap = [class.ap.iter().sum::<f64>() / 4.0].into_iter().chain(class.ap).map(percent);
        rows.push(
            class.name,
            [Some(class.targets as f64)].into_iter().chain(ap).chain(class.errors.map(number)),
        );
    }
    let note = format!(
        "{} {:.1}, mAP {:.1} % over all ten classes, those without targets too.",
        scores.nds_name(),
        100.0 * scores.nds(),
        100.0 * scores.mean_ap()
    );
    rows.table("nuScenes", &note)
}

fn of_opv2v(scores: &Opv2vScores) -> Table {
    let mut columns = named(&["targets"], 0);
    columns.extend(THRESHOLDS_IOU.map(|iou| (format!("AP@{iou}"), 1)));
    let mut rows = Rows::new(columns);
    for (name, ap) in [("sorted globally", scores.sorted), ("frame after frame", scores.by_frame)] {
        rows.push(name, [Some(scores.targets as f64)].into_iter().chain(ap.map(percent)));
    }
    rows.table("OPV2V", "AP of vehicles in %, by overlap from above.")
}

fn of_masks(scores: &MaskScores) -> Table {
    let mut columns = named(&["cells"], 0);
    columns.extend(MASK_THRESHOLDS.map(|threshold| (format!("{threshold}"), 1)));
    columns.extend(Ring::ALL.map(|ring| (ring.name().to_owned(), 1)));
    let mut rows = Rows::new(columns);
    let half = MASK_THRESHOLDS.iter().position(|threshold| *threshold == 0.5).unwrap_or_default();
    let values = |iou: &[[f64; MASK_THRESHOLDS.len()]; 4]| {
        let rings = [1, 2, 3].map(|ring: usize| percent(iou[ring][half]));
        iou[0].map(percent).into_iter().chain(rings).collect::<Vec<_>>()
    };
    for class in &scores.classes {
        rows.push(class.name, [Some(class.cells[0] as f64)].into_iter().chain(values(&class.iou)));
    }
    rows.push("mean", [None].into_iter().chain(values(&scores.mean_iou())));
    rows.table("IoU", "IoU in % by the score from which on cells count, and by distance from the ego at 0.5.")
}
