//! The configuration that an imported store says it has: what infos tell of sensors, grids and scenes; the
//! rest is as published.

use std::collections::{BTreeMap, BTreeSet};

use schema::{AgentKind, ImageKind, ImageSet, SensorKind};
use settings::{
    CameraSettings, CameraSpec, DatasetSettings, GnssSpec, ImuSpec, Lens, Optics, Rig as RigSettings,
    SceneCount,
};

use crate::names::{GNSS, IMU, LIDAR, SEMANTIC_LIDAR, VOXELS, cameras, radars, sensor_of};
use crate::rig::Rigs;
use crate::scene_unit::bev_settings;
use crate::survey::SceneSurvey;

/// Of some scenes.
pub(crate) fn settings(name: &str, rigs: &Rigs, scenes: &[&SceneSurvey]) -> DatasetSettings {
    let mut counts: BTreeMap<(settings::Split, String), u32> = BTreeMap::new();
    for scene in scenes {
        *counts.entry((scene.split, scene.plan.map.clone())).or_default() += 1;
    }
    let counts = counts.into_iter().map(|((split, map), count)| SceneCount { split, map, count });
    let mut all = DatasetSettings::with_scenes(counts.collect());
    name.clone_into(&mut all.name);
    let of_kind = |scene: &SceneSurvey, kind| {
        scene.agents.iter().filter(|(agent, _)| agent.kind == kind).count() as u32
    };
    let extent = |kind| {
        let found = || scenes.iter().map(move |scene| of_kind(scene, kind));
        (found().min().unwrap_or(0), found().max().unwrap_or(0))
    };
    (all.scenario.agents.min_vehicles, all.scenario.agents.max_vehicles) = extent(AgentKind::Vehicle);
    (all.scenario.agents.min_rsus, all.scenario.agents.max_rsus) = extent(AgentKind::Rsu);
    match scenes.iter().find_map(|scene| Some((scene.bev_cells?, scene.bev_cell_m))) {
        Some((cells, cell_m)) => all.bev = bev_settings(cells, cell_m),
        None => all.bev.enabled = false,
    }
    let keys = |kind: AgentKind| -> BTreeSet<&str> {
        let agents = scenes.iter().flat_map(|scene| &scene.agents).filter(|(agent, _)| agent.kind == kind);
        agents.flat_map(|(_, keys)| keys.iter().map(String::as_str)).collect()
    };
    let (vehicle, rsu) = (keys(AgentKind::Vehicle), keys(AgentKind::Rsu));
    all.scenario.vehicle_rig = rig(RigSettings::vehicle(), rigs, AgentKind::Vehicle, &vehicle);
    all.scenario.rsu_rig = rig(RigSettings::rsu(), rigs, AgentKind::Rsu, &rsu);
    for (place, kind, keys) in [
        (&mut all.scenario.vehicle_occupancy, AgentKind::Vehicle, &vehicle),
        (&mut all.scenario.rsu_occupancy, AgentKind::Rsu, &rsu),
    ] {
        *place = rigs.rig(kind).occupancy.clone();
        place.enabled = keys.contains(VOXELS);
    }
    all
}

fn rig(published: RigSettings, rigs: &Rigs, kind: AgentKind, keys: &BTreeSet<&str>) -> RigSettings {
    let own = rigs.rig(kind);
    let mut images = ImageSet::NONE;
    for key in keys {
        if let Some(SensorKind::Image(image)) = sensor_of(kind, key) {
            images.set(image, true);
        }
    }
    let has_camera =
        |camera: &str| ImageKind::ALL.iter().any(|image| keys.contains(image.table(camera).as_str()));
    let [[fx, _, cx], [_, fy, cy], _] = own.intrinsics;
    let pixels = |middle: f64| (2.0 * middle).round().clamp(0.0, 1e5) as u32;
    let optics = Optics { width: pixels(cx), height: pixels(cy), fx, fy, cx, cy, lens: Lens::Pinhole };
    let camera =
        |name: &&str| CameraSpec { name: (*name).to_owned(), mount: own.mount(name), optics: optics.clone() };
    // All fields are named: an import has no sensor that SimBEV2X has not.
    let mut made = RigSettings {
        camera: CameraSettings { images, ..published.camera },
        cameras: cameras(kind).iter().filter(|name| has_camera(name)).map(camera).collect(),
        lidars: Vec::new(),
        radars: published.radars,
        gnss: keys.contains(GNSS).then(GnssSpec::default),
        imu: keys.contains(IMU).then(ImuSpec::default),
    };
    for mut lidar in published.lidars.into_iter().take(1) {
        lidar.mount = own.mount(LIDAR);
        let semantic = lidar.semantic();
        made.lidars.extend(keys.contains(LIDAR).then_some(lidar));
        made.lidars.extend(keys.contains(SEMANTIC_LIDAR).then_some(semantic));
    }
    made.radars
        .retain(|radar| keys.contains(radar.name.as_str()) && radars(kind).contains(&radar.name.as_str()));
    made.radars.iter_mut().for_each(|radar| radar.mount = own.mount(&radar.name));
    made
}
