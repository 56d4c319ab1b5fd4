//! Tables over scenes.

use std::collections::{BTreeMap, BTreeSet};

use schema::scene_info::SceneInfo;
use schema::{Published, SceneBins};

use super::histogram::histogram;
use crate::table::{Section, Table};

/// Histograms over scenes, one table each.
pub(crate) struct SceneHistogram {
    pub(crate) table: &'static str,
    pub(crate) title: &'static str,
    width: u64,
    overflow: Option<u64>,
    pub(super) value: fn(&SceneInfo) -> u64,
    pub(super) published: SceneBins,
}

pub(crate) const SCENE_HISTOGRAMS: [SceneHistogram; 7] = [
    SceneHistogram {
        table: "scenes_by_vehicles",
        title: "Data-collection vehicles",
        width: 1,
        overflow: None,
        value: |scene| agents(scene, "vehicle_"),
        published: Published::VEHICLES,
    },
    SceneHistogram {
        table: "scenes_by_rsus",
        title: "Road-side units",
        width: 1,
        overflow: None,
        value: |scene| agents(scene, "rsu_"),
        published: Published::RSUS,
    },
    SceneHistogram {
        table: "scenes_by_duration",
        title: "Duration (whole seconds)",
        width: 1,
        overflow: None,
        // A half-frame's tolerance: 8 s written as 7.999999 are 8 s.
        value: |scene| (scene.duration_s + 0.5 * schema::FRAME_PERIOD_S) as u64,
        published: Published::DURATIONS,
    },
    SceneHistogram {
        table: "scenes_by_background_vehicles",
        title: "Background vehicles",
        width: 20,
        overflow: Some(400),
        value: |scene| scene.n_vehicles.into(),
        published: Published::BACKGROUND_VEHICLES,
    },
    SceneHistogram {
        table: "scenes_by_pedestrians",
        title: "Background pedestrians",
        width: 20,
        overflow: Some(400),
        value: |scene| scene.n_walkers.into(),
        published: Published::PEDESTRIANS,
    },
    SceneHistogram {
        table: "scenes_by_accidents",
        title: "Accidents",
        width: 1,
        overflow: Some(10),
        value: |scene| scene.n_accident_hazards.into(),
        published: Published::ACCIDENTS,
    },
    SceneHistogram {
        table: "scenes_by_road_works",
        title: "Road works",
        width: 1,
        overflow: Some(10),
        value: |scene| scene.n_road_work_hazards.into(),
        published: Published::ROAD_WORKS,
    },
];

pub(super) fn agents(scene: &SceneInfo, prefix: &str) -> u64 {
    scene.agents.iter().filter(|agent| agent.agent.starts_with(prefix)).count() as u64
}

pub(super) fn tables(scenes: &[&SceneInfo], kinds: &BTreeMap<u32, String>) -> Vec<Table> {
    let mut tables = vec![maps(scenes)];
    tables.extend((!kinds.is_empty()).then(|| groups(scenes, kinds)));
    for spec in SCENE_HISTOGRAMS {
        let values: Vec<u64> = scenes.iter().map(|scene| (spec.value)(scene)).collect();
        let bins = histogram(&values, spec.width, spec.overflow);
        tables.push(
            Table::new(spec.table, Section::Scenes, spec.title, "")
                .with_strings("bin", bins.iter().map(|bin| bin.label.as_str()))
                .with_counts("lower", bins.iter().map(|bin| bin.lower))
                .with_counts("scenes", bins.iter().map(|bin| bin.count)),
        );
    }
    tables.push(each_scene(scenes, kinds));
    tables
}

/// Scenes of each map and split.
fn maps(scenes: &[&SceneInfo]) -> Table {
    let sorted = |name: fn(&SceneInfo) -> &str| {
        let mut names: Vec<&str> = scenes.iter().map(|scene| name(scene)).collect();
        names.sort_unstable();
        names.dedup();
        names
    };
    let maps = sorted(|scene| &scene.map);
    let known = ["train", "val", "test"];
    let others = sorted(|scene| &scene.split).into_iter().filter(|split| !known.contains(split));
    let splits: Vec<&str> = known.into_iter().chain(others).collect();

    let count = |map: Option<&str>, split: Option<&str>| {
        let matches = |scene: &&&SceneInfo| {
            map.is_none_or(|map| scene.map == map) && split.is_none_or(|split| scene.split == split)
        };
        scenes.iter().filter(matches).count() as u64
    };
    // The last row is the sum, when there is anything to sum.
    let total = (!maps.is_empty()).then_some(None);
    let rows: Vec<Option<&str>> = maps.iter().copied().map(Some).chain(total).collect();
    let mut table = Table::new("scenes_by_map", Section::Scenes, "Scenes by map and split", "")
        .with_strings("map", rows.iter().map(|map| map.unwrap_or("total")));
    for split in splits {
        table = table.with_counts(split, rows.iter().map(|map| count(*map, Some(split))));
    }
    table.with_counts("total", rows.iter().map(|map| count(*map, None)))
}

/// Scenes of each kind.
fn groups(scenes: &[&SceneInfo], kinds: &BTreeMap<u32, String>) -> Table {
    let name = |scene: &SceneInfo| kinds.get(&scene.scene).map_or("", String::as_str);
    let names: BTreeSet<&str> = scenes.iter().map(|scene| name(scene)).collect();
    let of = |wanted: &str, value: &dyn Fn(&SceneInfo) -> u64| -> u64 {
        scenes.iter().filter(|scene| name(scene) == wanted).map(|scene| value(scene)).sum()
    };
    Table::new("scenes_by_group", Section::Scenes, "Scenes by group", "")
        .with_strings("group", names.iter().copied())
        .with_counts("scenes", names.iter().map(|name| of(name, &|_| 1)))
        .with_counts("frames", names.iter().map(|name| of(name, &|scene| scene.frames.into())))
        .with_counts("vehicles", names.iter().map(|name| of(name, &|scene| agents(scene, "vehicle_"))))
        .with_counts("rsus", names.iter().map(|name| of(name, &|scene| agents(scene, "rsu_"))))
}

/// One row a scene.
fn each_scene(scenes: &[&SceneInfo], kinds: &BTreeMap<u32, String>) -> Table {
    let mut table = Table::new("scenes", Section::Scenes, "Every scene", "")
        .with_counts("scene", scenes.iter().map(|scene| scene.scene.into()))
        .with_strings("split", scenes.iter().map(|scene| scene.split.as_str()))
        .with_strings("map", scenes.iter().map(|scene| scene.map.as_str()));
    if !kinds.is_empty() {
        let name = |scene: &&SceneInfo| kinds.get(&scene.scene).map_or("", String::as_str);
        table = table.with_strings("group", scenes.iter().map(name));
    }
    table
        .with_numbers("duration_s", 2, scenes.iter().map(|scene| Some(scene.duration_s)))
        .with_counts("frames", scenes.iter().map(|scene| scene.frames.into()))
        .with_counts("vehicles", scenes.iter().map(|scene| agents(scene, "vehicle_")))
        .with_counts("rsus", scenes.iter().map(|scene| agents(scene, "rsu_")))
        .with_counts("background_vehicles", scenes.iter().map(|scene| scene.n_vehicles.into()))
        .with_counts("pedestrians", scenes.iter().map(|scene| scene.n_walkers.into()))
        .with_counts("accidents", scenes.iter().map(|scene| scene.n_accident_hazards.into()))
        .with_counts("road_works", scenes.iter().map(|scene| scene.n_road_work_hazards.into()))
        .with_strings("spawn_mode", scenes.iter().map(|scene| scene.spawn_mode.as_str()))
        .with_strings(
            "weather",
            scenes.iter().map(|scene| if scene.dynamic_weather { "dynamic" } else { "static" }),
        )
}
