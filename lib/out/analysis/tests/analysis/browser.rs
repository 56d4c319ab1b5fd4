//! The pages in a headless Chromium. `CONVOY_SHOTS` names a folder that keeps the screenshots.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use analysis::{
    DatasetFacts, FoundBar, GroupTotals, MeasureTotals, Moment, PrecisionCurves, SceneCard, ScorePart,
    Section, Table, TableColumn, Values, compute_tables, draw_figures, published_html, report_html,
    scores_html,
};
use schema::measures::{Bins, bev, sensors, sightings, simulation, tracks, voxels};
use schema::scene_info::{AgentInfo, SceneInfo};
use schema::tables::PartialRow;
use schema::{BevClass, DetectionClass, Tag};

/// Scenes of two maps and three splits.
fn scenes() -> Vec<SceneInfo> {
    let weather = |value: f64| {
        let names = ["cloudiness", "precipitation", "fog_density", "sun_altitude_deg"];
        names.map(|name| (name.to_owned(), value)).into_iter().collect::<BTreeMap<_, _>>()
    };
    let agent = |agent: String| AgentInfo { agent, ..AgentInfo::default() };
    let scene = |i: u32| SceneInfo {
        scene: i,
        split: ["train", "train", "train", "val", "train", "test"][i as usize % 6].into(),
        map: ["Town01", "Town02"][i as usize % 2].into(),
        duration_s: f64::from(8 + i * 7 % 11),
        frames: 20 * (8 + i * 7 % 11) * if i == 4 { 100 } else { 1 },
        agents: (0..2 + i % 3)
            .map(|k| agent(format!("vehicle_{k}")))
            .chain((0..i % 2).map(|k| agent(format!("rsu_{k}"))))
            .collect(),
        n_vehicles: 45 * i,
        n_walkers: 30 * i,
        n_accident_hazards: i % 4,
        n_road_work_hazards: i,
        initial_weather: weather(f64::from(i) * 8.0 - 20.0),
        final_weather: weather(f64::from(i) * 5.0),
        ..SceneInfo::default()
    };
    (0..12).map(scene).collect()
}

/// Counts of everything there is, small and large ones.
fn counts() -> MeasureTotals {
    let mut rows = Vec::new();
    let mut add = |agent: &str, measure: &str, class: &str, bin: i32, count: u64| {
        rows.push(PartialRow {
            agent: agent.into(),
            measure: measure.into(),
            class: class.into(),
            bin,
            count,
        });
    };
    add("vehicle_0", simulation::AGENT_FRAMES, "", 0, 492_000);
    add("rsu_0", simulation::AGENT_FRAMES, "", 0, 96_520);
    add("", tracks::FRAMES, "", 0, 102_200);
    for (k, class) in (0_u64..).zip(DetectionClass::ALL) {
        let (name, most) = (class.name(), 10_u64.pow(7 - (k % 5) as u32));
        add("", tracks::BOXES, name, 0, most);
        add("", tracks::BOXES_VALID, name, 0, most / (k + 2));
        let binned: [(&str, Bins); 4] = [
            (tracks::VALID_PER_FRAME, tracks::VALID_PER_FRAME_BINS),
            (tracks::YAW_DEG, tracks::YAW_BINS),
            (tracks::SPEED_MPS, tracks::SPEED_BINS),
            (tracks::YAW_RATE_DPS, tracks::YAW_RATE_BINS),
        ];
        for (measure, bins) in binned {
            for (i, edge) in (1_u64..).zip(bins.edges().chain([bins.upper])) {
                add("", measure, name, edge, (k + 1) * 1000 / i);
            }
        }
        for step in 0..sightings::POINTS_STEPS {
            for level in 0..sightings::LEVELS - step {
                let count = 1 + (k + 3) * (level as u64) * 10 / (1 + step as u64);
                add("", sightings::LIDAR_POINTS_AT, name, step * sightings::LEVELS + level, count);
                if level < 10 {
                    add("", sightings::RADAR_POINTS_AT, name, step * sightings::LEVELS + level, count);
                }
            }
        }
        for bin in (0..sightings::PLACES * sightings::PLACES).step_by(7) {
            let from_middle = (bin / sightings::PLACES - 40).abs() + (bin % sightings::PLACES - 40).abs();
            add("", sightings::SEEN_BY_VEHICLES, name, bin, 100_000 / (1 + from_middle.pow(2) as u64));
            add("", sightings::SEEN_BY_RSUS, name, bin, 1 + from_middle as u64);
        }
    }
    add("vehicle_0", bev::BEV_GRIDS, "exact", 0, 588_520);
    for (k, class) in (0_u64..).zip(BevClass::ALL) {
        add("vehicle_0", bev::BEV_CELLS, class.name(), 0, 10_u64.pow(11 - (k % 6) as u32));
        for bin in 0..2500_u64 {
            add("", bev::BEV_HEAT, class.name(), bin as i32, 20_000_000 / (1 + k * bin));
        }
    }
    add("vehicle_0", voxels::VOXEL_GRIDS, "", 0, 588_520);
    for (k, tag) in (0_u64..).zip(Tag::ALL) {
        add("vehicle_0", voxels::VOXEL_CELLS, tag.name(), 0, 10_u64.pow(12 - (k % 8) as u32));
        add(
            "vehicle_0",
            voxels::VOXEL_CELLS_FILLED,
            tag.name(),
            0,
            (10 + k % 4) * 10_u64.pow(11 - (k % 8) as u32),
        );
    }
    for (sensor, bytes) in [("LIDAR", 17_000_000_000_000), ("RAD_BACK", 90_000), ("RGB", 4_000_000_000_000)] {
        add("vehicle_0", sensors::SENSOR_BYTES, sensor, 0, bytes);
    }
    add("vehicle_0", sensors::IMAGES, "RGB", 0, 3_241_560);
    let mut counts = MeasureTotals::default();
    counts.add(&rows);
    counts
}

/// Counts of boxes alone, and few.
fn few_counts() -> MeasureTotals {
    let row = |measure: &str, bin: i32, count: u64| PartialRow {
        measure: measure.into(),
        class: "car".into(),
        bin,
        count,
        ..PartialRow::default()
    };
    let mut counts = MeasureTotals::default();
    counts.add(&[
        row(tracks::FRAMES, 0, 20),
        row(tracks::BOXES, 0, 70),
        row(tracks::BOXES_VALID, 0, 30),
        row(tracks::SPEED_MPS, 3, 30),
    ]);
    counts
}

/// A grey JPEG of 8 by 8 pixels, the least that one can be.
fn picture() -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = jpeg_encoder::Encoder::new(&mut bytes, 80);
    encoder.encode(&[128; 192], 8, 8, jpeg_encoder::ColorType::Rgb).expect("is encoded");
    bytes
}

fn write_pages(folder: &Path) {
    let facts = |name: &str| DatasetFacts {
        name: name.into(),
        planned_scenes: 12,
        bev_cells: 400,
        bev_cell_m: 0.4,
        ..DatasetFacts::default()
    };
    let card = |scene: &SceneInfo| SceneCard {
        scene: scene.scene,
        split: scene.split.clone(),
        map: scene.map.clone(),
        kind: String::new(),
        words: "10 s, 3 vehicles, 1 RSU".into(),
        picture: Some(format!("scenes/{:04}.jpg", scene.scene)),
    };
    std::fs::create_dir_all(folder.join("scenes")).expect("is made");
    let scenes = scenes();
    for scene in &scenes {
        std::fs::write(folder.join(format!("scenes/{:04}.jpg", scene.scene)), picture()).expect("is written");
    }
    let tables = compute_tables(&facts("a demo"), &scenes, &counts());
    let figures = draw_figures(&tables);
    let cards: Vec<SceneCard> = scenes.iter().map(card).collect();
    // Scenes to learn from have everything, the others boxes alone.
    let mut groups = GroupTotals::default();
    for scene in &scenes {
        let counts = if scene.split == "train" { counts() } else { few_counts() };
        groups.add(scene, "", &counts);
    }
    let whole = facts("a demo");
    let write = |name: &str, page: &str| std::fs::write(folder.join(name), page).expect("is written");
    write("report.html", &report_html(&tables, &figures, &cards, groups.groups(&whole)));
    write("published.html", &published_html(&tables, &figures).expect("has numbers"));
    write("scores.html", &scores_html("a demo", "10,000 samples, 300,000 predicted boxes.", &scores()));
    // A scene without a frame, of which nothing was counted: classes and labels are absent.
    let bare = SceneInfo { map: "Town01".into(), ..SceneInfo::default() };
    let row = |measure: &str| PartialRow {
        agent: String::new(),
        measure: measure.into(),
        class: String::new(),
        bin: 0,
        count: 0,
    };
    let mut nothing = MeasureTotals::default();
    nothing
        .add(&[tracks::FRAMES, tracks::BOXES, bev::BEV_CELLS, bev::BEV_GRIDS, voxels::VOXEL_CELLS].map(row));
    let tables = compute_tables(&facts("bare"), std::slice::from_ref(&bare), &nothing);
    let figures = draw_figures(&tables);
    write("bare.html", &report_html(&tables, &figures, &[], []));
}

/// Scores of all classes, of two models.
fn scores() -> Vec<ScorePart> {
    let curve = |k: usize, at: usize| {
        let recall = |i: u32| f64::from(i) * 0.008 * (1.0 - 0.05 * k as f64);
        let points = (0..=100).map(|i| [recall(i), 1.0 - recall(i) * recall(i) * (1.1 - 0.2 * at as f64)]);
        (["0.5 m", "1 m", "2 m", "4 m"][at].to_owned(), points.collect())
    };
    let classes = || DetectionClass::ALL.into_iter().enumerate();
    let bar = |(k, class): (usize, DetectionClass)| {
        ["0-20 m", "20-40 m", "over 40 m"].map(|ring| FoundBar {
            label: format!("{}, {ring}", class.name().replace('_', " ")),
            targets: 10_u64.pow(6 - k as u32 / 2),
            found: 10_u64.pow(6 - k as u32 / 2) / (k as u64 + 1),
            wrong: 1234 * k as u64,
        })
    };
    let numbers = |scale: f64| Values::F64 {
        values: classes().map(|(k, _)| (k % 4 < 3).then_some(scale * k as f64)).collect(),
        decimals: 1,
    };
    let names = classes().map(|(_, class)| class.name().to_owned()).collect();
    let mut columns = vec![TableColumn { name: "class".into(), values: Values::Str(names) }];
    let levels =
        ["AP", "easy", "medium", "hard", "0-20 m", "20-40 m", "over 40 m", "ego", "partners", "ATE_m"];
    columns.extend(levels.map(|name| TableColumn { name: name.into(), values: numbers(9.9) }));
    let table = Table {
        name: "scores".into(),
        section: Section::Boxes,
        title: "SimBEV2X".into(),
        note: "SDS 12.3".into(),
        columns,
    };
    let part = |title: &str| ScorePart {
        title: title.into(),
        tables: vec![table.clone()],
        curves: classes()
            .map(|(k, class)| PrecisionCurves {
                title: class.name().replace('_', " "),
                curves: (0..4).map(|at| curve(k, at)).collect(),
            })
            .collect(),
        found_note: "Found up to 2 m.".into(),
        found: classes().flat_map(bar).collect(),
        worst: (0..20)
            .map(|i| Moment {
                scene: 7,
                frame: 40 + i,
                ego: "vehicle_0".into(),
                found_missed_wrong: [u64::from(i), 1000, 20],
            })
            .collect(),
    };
    vec![part("Boxes, cooperation none"), part("Boxes, cooperation x2x")]
}

#[test]
fn pages_are_sound_and_usable_in_a_browser() {
    let Some(chromium) = testkit::chromium() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    // A name that a shell would take apart.
    let stats = folder.path().join("a store/stats");
    std::fs::create_dir_all(&stats).expect("is made");
    write_pages(&stats);
    let mut look = Command::new("node");
    look.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/analysis/look.mjs"))
        .arg(&chromium)
        .arg(&stats);
    if let Some(shots) = std::env::var_os("CONVOY_SHOTS") {
        look.arg(Path::new(&shots).join("report"));
    }
    let output = look.output().expect("node starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
