//! The dataset's card.

use std::collections::BTreeSet;

use analysis::{DatasetFacts, MadeBy, MeasureTotals, Tables, compute_tables, dataset_card};
use schema::scene_info::SceneInfo;
use settings::stages::StatisticsSettings;
use settings::{AnnotationSettings, BevSettings, CardSettings, OccupancySettings, PerAgent, Rig};

fn settings(card: CardSettings) -> StatisticsSettings {
    let grids = |grid: OccupancySettings| PerAgent { vehicle: grid.clone(), rsu: grid, own: Vec::new() };
    StatisticsSettings {
        groups: Vec::new(),
        older: Vec::new(),
        name: "Night | rain's".into(),
        card,
        seed: 27,
        rigs: PerAgent { vehicle: Rig::vehicle(), rsu: Rig::rsu(), own: Vec::new() },
        annotation: AnnotationSettings { every_n_frames: 10, ..AnnotationSettings::default() },
        bev: BevSettings::default(),
        occupancy: grids(OccupancySettings { enabled: false, ..OccupancySettings::default() }),
    }
}

fn made_by() -> MadeBy {
    let codes = |codes: &[&str]| codes.iter().map(|&code| code.to_owned()).collect::<BTreeSet<_>>();
    let stages = vec![
        ("simulate-and-log".to_owned(), codes(&["0.1.0+8f0a"])),
        ("bev-gt".to_owned(), codes(&["aa", "bb"])),
    ];
    MadeBy { convoy: "0.1.0".into(), format: 1, stages }
}

fn tables(scenes: usize) -> Tables {
    let facts = DatasetFacts {
        name: "n".into(),
        planned_scenes: 3,
        bev_cells: 400,
        bev_cell_m: 0.4,
        ..DatasetFacts::default()
    };
    let scene = |i| SceneInfo {
        scene: i,
        map: "Town01".into(),
        split: "val".into(),
        frames: 40,
        ..SceneInfo::default()
    };
    let scenes: Vec<SceneInfo> = (0..scenes as u32).map(scene).collect();
    compute_tables(&facts, &scenes, &MeasureTotals::default())
}

#[test]
fn a_card_says_what_is_known_and_what_is_not() {
    let card = dataset_card(&settings(CardSettings::default()), &made_by(), &tables(2));
    let start = "---\npretty_name: 'Night | rain''s'\nlicense: 'unknown'\ntags: [v2x, ";
    assert!(card.starts_with(start), "{card}");
    for part in [
        "\n# Night \\| rain's\n",
        "\n**Unfinished:** 2 of 3 scenes are done",
        "\n| frames | 80 |\n",
        "\n| map | train | val | test | total |\n|---|---:|---:|---:|---:|\n| Town01 | 0 | 2 | 0 | 2 |\n",
        // The published rig: six cameras, a lidar of 128 channels, four radars; at 20 Hz.
        "\n| vehicles | CAM_FRONT_LEFT, CAM_FRONT, CAM_FRONT_RIGHT, CAM_BACK_LEFT, CAM_BACK, CAM_BACK_RIGHT | 20 | 1600 x 900 pixels: ",
        "\n| vehicles | LIDAR | 20 | 128 channels by 2048, 120 m, ",
        "\n| vehicles | RAD_LEFT | 20 | 2000 rays, 120 m, 100 by 20 degrees |\n",
        "\n| RSUs | RAD_FRONT | 20 | 2400 rays, 120 m, 120 by 20 degrees |\n",
        "\n* 3-D boxes of ten classes with tracks, within 200 m of an agent, 2 Hz.\n",
        "\n* BEV masks of 14 classes, 400 x 400 cells of 0.4 m, by the triangles that sensors see, 20 Hz.\n",
        "store format 1, seed 27",
        "\n| simulate-and-log | `0.1.0+8f0a` |\n| bev-gt | `aa`, `bb` |\n",
        "\n## Licence\n\nNot stated. ",
        "```bibtex\n@misc{Nightrains,\n  title = {{Night | rain's: a simulated dataset for cooperative perception}},\n  note = {Made with Convoy 0.1.0, seed 27},\n}\n```\n",
    ] {
        assert!(card.contains(part), "{part:?} is not in:\n{card}");
    }
    assert!(!card.contains("voxel grids of"), "there are none");
}

#[test]
fn a_card_tells_how_often_each_sensor_is_read() {
    let mut settings = settings(CardSettings::default());
    let rig = &mut settings.rigs.vehicle;
    rig.camera.every_n_frames = 2;
    rig.lidars[0].every_n_frames = 4;
    rig.radars[0].every_n_frames = 20;
    rig.gnss.as_mut().expect("is carried").every_n_frames = 5;
    rig.imu.as_mut().expect("is carried").every_n_frames = 8;
    let card = dataset_card(&settings, &made_by(), &tables(2));
    for part in
        ["CAM_BACK_RIGHT | 10 |", "| LIDAR | 5 |", "| RAD_LEFT | 1 |", "| GNSS | 4 |", "| IMU | 2.5 |"]
    {
        assert!(card.contains(part), "{part:?} is not in:\n{card}");
    }
}

#[test]
fn a_card_has_the_words_of_its_configuration() {
    let words = CardSettings {
        description: "Rain at **night**.\n".into(),
        licence: "CC-BY-4.0".into(),
        authors: vec!["Ada Lovelace".into(), "C. Babbage {}".into()],
        url: "https://example.org/a b".into(),
        citation: String::new(),
    };
    let card = dataset_card(&settings(words.clone()), &made_by(), &tables(3));
    for part in [
        "\nlicense: 'CC-BY-4.0'\n",
        "\n\nRain at **night**.\n",
        "\n## Licence\n\nCC-BY-4.0\n",
        "\n  author = {Ada Lovelace and C. Babbage },\n  howpublished = {\\url{https://example.org/ab}},\n",
    ] {
        assert!(card.contains(part), "{part:?} is not in:\n{card}");
    }
    assert!(!card.contains("Unfinished"));
    let cited = CardSettings { citation: "@inproceedings{x, note = {```}}\n".into(), ..words };
    let card = dataset_card(&settings(cited), &made_by(), &tables(3));
    assert!(
        card.ends_with("\n````bibtex\n@inproceedings{x, note = {```}}\n````\n") && !card.contains("@misc")
    );
}

/// The configuration at hand is not that of what was imported.
#[test]
fn a_card_of_imports_says_nothing_of_the_configuration() {
    let codes = BTreeSet::from(["import".to_owned()]);
    let made_by = MadeBy { stages: vec![("render-sensors".into(), codes)], ..made_by() };
    let card = dataset_card(&settings(CardSettings::default()), &made_by, &tables(2));
    for part in [
        "imported from another layout",
        "zero_columns",
        "| render-sensors | `import` |",
        "\n| frames | 80 |\n",
    ] {
        assert!(card.contains(part), "{part}: {card}");
    }
    for part in ["CAM_FRONT", "simulated", "seed", "@misc"] {
        assert!(!card.contains(part), "{part}: {card}");
    }
}
