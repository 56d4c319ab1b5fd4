//! The dataset card: one Markdown page that says what a dataset is, for those who did not make it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use schema::{FRAME_PERIOD_S, IMPORTED};
use settings::stages::StatisticsSettings;
use settings::{BevRule, CameraSpec, OccupancySettings, Rig};

use crate::table::{Section, Tables, Values};
use crate::text::{grouped, words};

/// What is said of the sensors and labels of imported scenes.
const IMPORTED_SENSORS: &str = "As the dataset had them: rates, poses and intrinsics stand in the metadata of each sensor's table, and so do \
    columns that the dataset did not say (`zero_columns`): they hold zeros.\n";
const IMPORTED_LABELS: &str = "As the dataset had them: grids say of themselves what they are.\n";

/// By which code a dataset was made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MadeBy {
    /// Version of the program.
    pub convoy: String,
    /// Version of the store's format.
    pub format: u32,
    /// Code versions of each stage, by its name in running order: more than one where scenes are older than
    /// others.
    pub stages: Vec<(String, BTreeSet<String>)>,
}

impl MadeBy {
    /// Whether scenes were imported: then the configuration says nothing of their sensors and labels.
    fn is_imported(&self) -> bool {
        self.stages.iter().flat_map(|(_, codes)| codes).any(|code| schema::is_imported(code))
    }
}

/// The card. Its first lines are YAML, as Hugging Face reads them.
#[must_use]
pub fn dataset_card(settings: &StatisticsSettings, made_by: &MadeBy, tables: &Tables) -> String {
    let name = line(&settings.name);
    let card = &settings.card;
    let licence = line(&card.licence);
    let known = if licence.is_empty() { "unknown" } else { &licence };
    let mut text = format!(
        "---\npretty_name: {}\nlicense: {}\ntags: [v2x, cooperative-perception, autonomous-driving, simulation]\n---\n\n# {}\n\n",
        quoted(&name),
        quoted(known),
        escaped(&name)
    );
    if card.description.trim().is_empty() && made_by.is_imported() {
        text += "A dataset for cooperative perception, imported from another layout.\n";
    } else if card.description.trim().is_empty() {
        text += "A simulated dataset for cooperative perception: several connected vehicles and road-side units drive through or watch \
                 the same traffic; every sensor of every agent is rendered and every frame is annotated.\n";
    } else {
        text += card.description.trim();
        text.push('\n');
    }
    if let Some([covered, planned]) = tables.partial {
        let _ = writeln!(
            text,
            "\n**Unfinished:** {covered} of {planned} scenes are done; the numbers below are of these."
        );
    }
    let (sensors, labels) = match made_by.is_imported() {
        true => (IMPORTED_SENSORS.to_owned(), IMPORTED_LABELS.to_owned()),
        false => (sensors(settings), labels(settings)),
    };
    for (title, part) in [
        ("Size", size(tables)),
        ("Sensors", sensors),
        ("Labels", labels),
        ("Settings and versions", versions(settings, made_by)),
        ("Licence", licence_words(&licence)),
        ("How to cite", citation(settings, made_by)),
    ] {
        let _ = write!(text, "\n## {title}\n\n{part}");
    }
    text
}

/// How much there is.
fn size(tables: &Tables) -> String {
    let mut text = String::from("| | |\n|---|---:|\n");
    if let Some(overview) = tables.get("overview") {
        for (name, value) in overview.strings("quantity").iter().zip(overview.counts("value")) {
            let _ =
                writeln!(text, "| {} | {} |", crate::page::column_title(name), grouped(&value.to_string()));
        }
    }
    for (name, title) in [
        ("scenes_by_map", "Scenes"),
        ("scenes_by_group", "Scenes by group"),
        ("boxes_per_class", "Boxes, each object once a frame"),
    ] {
        let Some(table) = tables.get(name).filter(|table| !table.is_empty()) else { continue };
        let heads: Vec<String> = table.columns.iter().map(|column| escaped(&words(&column.name))).collect();
        let ends = table
            .columns
            .iter()
            .map(|column| if matches!(column.values, Values::Str(_)) { "---" } else { "---:" });
        let _ = write!(
            text,
            "\n{title}:\n\n| {} |\n|{}|\n",
            heads.join(" | "),
            ends.collect::<Vec<_>>().join("|")
        );
        for row in 0..table.len() {
            let cells = table.columns.iter().map(|column| match &column.values {
                Values::Str(names) if column.name == "class" => escaped(&words(&names[row])),
                Values::Str(names) => escaped(&names[row]),
                values => grouped(&values.text(row)),
            });
            let _ = writeln!(text, "| {} |", cells.collect::<Vec<_>>().join(" | "));
        }
    }
    text += "\nAll numbers: [stats/report.html](stats/report.html)";
    if tables.tables.iter().any(|table| table.section == Section::Published && !table.is_empty()) {
        text += ", and beside the published SimBEV2X dataset in [stats/published.html](stats/published.html)";
    }
    text + ".\n"
}

/// What agents carry.
fn sensors(settings: &StatisticsSettings) -> String {
    let mut text = String::from("| agents | sensor | Hz | |\n|---|---|---:|---|\n");
    let named = [(String::new(), settings)].into_iter().chain(unlike(settings));
    for (whose, settings) in named {
        let own = settings.rigs.own.iter().map(|(agents, rig)| (agents.join(", "), rig));
        let kinds =
            [("vehicles".to_owned(), &settings.rigs.vehicle), ("RSUs".to_owned(), &settings.rigs.rsu)];
        for (agents, rig) in kinds.into_iter().chain(own) {
            for (sensor, hz, what) in rig_rows(rig) {
                let agents = escaped(&format!("{agents}{whose}"));
                let _ = writeln!(text, "| {agents} | {} | {hz} | {what} |", escaped(&sensor));
            }
        }
    }
    text
}

/// Groups and older editions whose agents carry other sensors, with words that say whose they are.
fn unlike(settings: &StatisticsSettings) -> Vec<(String, &StatisticsSettings)> {
    let mut all: Vec<(String, &StatisticsSettings)> = Vec::new();
    all.extend(settings.groups.iter().map(|(name, group)| (format!(" (group {name})"), group)));
    for (number, older) in settings.older.iter().enumerate() {
        all.push((format!(" (edition {number})"), older));
        let groups = older.groups.iter();
        all.extend(groups.map(|(name, group)| (format!(" (edition {number}, group {name})"), group)));
    }
    all.retain(|(_, other)| other.rigs != settings.rigs);
    all
}

/// Readings a second of what is read at frames 0, n, 2 n, ...
fn hz(every_n_frames: u32) -> String {
    let hz = 1.0 / (FRAME_PERIOD_S * f64::from(every_n_frames.max(1)));
    crate::text::short((100.0 * hz).round() / 100.0)
}

/// Sensor, rate and a few words; cameras that see alike share a row.
fn rig_rows(rig: &Rig) -> Vec<(String, String, String)> {
    let degrees = |rad: f64| crate::text::short((10.0 * rad.to_degrees()).round() / 10.0);
    let mut rows = Vec::new();
    let images: Vec<&str> = rig.camera.images.iter().map(|kind| kind.spec().plural).collect();
    if !images.is_empty() {
        let mut alike: BTreeMap<String, Vec<&CameraSpec>> = BTreeMap::new();
        for camera in &rig.cameras {
            let [width, height] = [camera.optics.width, camera.optics.height];
            alike
                .entry(format!("{width} x {height} pixels: {}", images.join(", ")))
                .or_default()
                .push(camera);
        }
        rows.extend(alike.into_iter().map(|(what, cameras)| {
            let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
            (names.join(", "), hz(rig.camera.every_n_frames), what)
        }));
    }
    rows.extend(rig.lidars.iter().map(|lidar| {
        let semantic = if lidar.semantic { "semantic, " } else { "" };
        let (channels, columns) = (lidar.scan.channels, lidar.scan.columns);
        let what = format!(
            "{semantic}{channels} channels by {columns}, {} m, {} to {} degrees",
            crate::text::short(lidar.range_m),
            degrees(lidar.scan.lower_rad),
            degrees(lidar.scan.upper_rad)
        );
        (lidar.name.clone(), hz(lidar.every_n_frames), what)
    }));
    rows.extend(rig.radars.iter().map(|radar| {
        let field = [radar.horizontal_fov_rad, radar.vertical_fov_rad].map(degrees);
        let range_m = crate::text::short(radar.range_m);
        let what = format!("{} rays, {range_m} m, {} by {} degrees", radar.rays, field[0], field[1]);
        (radar.name.clone(), hz(radar.every_n_frames), what)
    }));
    rows.extend(rig.gnss.as_ref().map(|gnss| ("GNSS".into(), hz(gnss.every_n_frames), String::new())));
    rows.extend(rig.imu.as_ref().map(|imu| ("IMU".into(), hz(imu.every_n_frames), String::new())));
    rows
}

/// What is annotated.
fn labels(settings: &StatisticsSettings) -> String {
    let StatisticsSettings { annotation, bev, occupancy, .. } = settings;
    let mut lines = vec![format!(
        "3-D boxes of ten classes with tracks, within {} m of an agent, {} Hz.",
        crate::text::short(annotation.box_radius_m),
        hz(annotation.every_n_frames)
    )];
    if bev.enabled {
        let rule = match bev.rule {
            BevRule::Exact => "by the triangles that sensors see",
            BevRule::Simbev2x => "as SimBEV2X draws them",
        };
        lines.push(format!(
            "BEV masks of {} classes, {} x {} cells of {} m, {rule}, {} Hz.",
            bev.classes.len(),
            bev.cells,
            bev.cells,
            bev.cell_m,
            hz(bev.every_n_frames)
        ));
    }
    let own = occupancy.own.iter().map(|(agents, grid)| (agents.join(", "), grid));
    let kinds = [("vehicles".to_owned(), &occupancy.vehicle), ("RSUs".to_owned(), &occupancy.rsu)];
    for (agents, grid) in kinds.into_iter().chain(own).filter(|(_, grid)| grid.enabled) {
        lines.push(grid_words(&agents, grid));
    }
    lines.iter().map(|line| format!("* {line}\n")).collect()
}

fn grid_words(agents: &str, grid: &OccupancySettings) -> String {
    let [x, y, z] = grid.shape();
    format!(
        "Semantic voxel grids of {}, {x} x {y} x {z} cells of {} m, {} Hz.",
        escaped(agents),
        grid.voxel_m,
        hz(grid.every_n_frames)
    )
}

/// By what it was made.
fn versions(settings: &StatisticsSettings, made_by: &MadeBy) -> String {
    let MadeBy { convoy, format, .. } = made_by;
    let mut text = match made_by.is_imported() {
        true => format!(
            "Imported with Convoy {convoy}, store format {format}. Stages of the code `{IMPORTED}` hold what the dataset had.\n"
        ),
        false => format!(
            "Made with Convoy {convoy}, store format {format}, seed {}. Every setting stands in [dataset.json](dataset.json); the same \
             settings, maps and code give the same bytes.\n",
            settings.seed
        ),
    };
    if !made_by.stages.is_empty() {
        text += "\n| stage | code |\n|---|---|\n";
    }
    for (stage, codes) in &made_by.stages {
        let codes: Vec<String> = codes.iter().map(|code| format!("`{code}`")).collect();
        let _ = writeln!(text, "| {stage} | {} |", codes.join(", "));
    }
    text
}

fn licence_words(licence: &str) -> String {
    if licence.is_empty() {
        "Not stated. Who passes the dataset on says so in its configuration: `card.licence`.\n".to_owned()
    } else {
        format!("{}\n", escaped(licence))
    }
}

/// As the configuration says, or made of what is known.
fn citation(settings: &StatisticsSettings, made_by: &MadeBy) -> String {
    let card = &settings.card;
    let given = card.citation.trim();
    if given.is_empty() && made_by.is_imported() {
        return "As the dataset that was imported asks for; the configuration may say it here: `card.citation`.\n".to_owned();
    }
    let entry = if given.is_empty() {
        // BibTeX has signs of its own: names of files and people do without most of them.
        let plain = |text: &str| line(text).replace(['{', '}', '\\', '%', '#', '$', '&', '~', '^'], "");
        let key: String = settings.name.chars().filter(char::is_ascii_alphanumeric).collect();
        let key = if key.is_empty() { "dataset" } else { &key };
        let mut entry = format!("@misc{{{key},\n");
        let _ = writeln!(
            entry,
            "  title = {{{{{}: a simulated dataset for cooperative perception}}}},",
            plain(&settings.name)
        );
        if !card.authors.is_empty() {
            let _ = writeln!(entry, "  author = {{{}}},", plain(&card.authors.join(" and ")));
        }
        if !card.url.is_empty() {
            let _ = writeln!(
                entry,
                "  howpublished = {{\\url{{{}}}}},",
                line(&card.url).replace(['{', '}', '\\', ' '], "")
            );
        }
        let _ =
            write!(entry, "  note = {{Made with Convoy {}, seed {}}},\n}}", made_by.convoy, settings.seed);
        entry
    } else {
        given.to_owned()
    };
    // A fence longer than any within.
    let fence = "`".repeat(3.max(1 + longest_run(&entry, '`')));
    format!("{fence}bibtex\n{entry}\n{fence}\n")
}

fn longest_run(text: &str, sign: char) -> usize {
    text.split(|c| c != sign).map(str::len).max().unwrap_or(0)
}

/// Text as one line.
fn line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace(char::is_control, "")
}

/// A YAML string.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

/// Text without a meaning in Markdown or its tables.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in line(text).chars() {
        if matches!(c, '\\' | '|' | '*' | '`' | '[' | ']' | '<' | '>' | '#') {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}
