//! What a configuration asks for in vain, or hardly means: it is said, and is no fault.

use schema::AgentId;
use schema::AgentKind;
use schema::tables::Weather;

use crate::dataset::DatasetSettings;
use crate::groups::Group;
use crate::map_name::map_name;
use crate::occupancy::OccupancySettings;
use crate::reader::Section;
use crate::rig::Rig;
use crate::weather::WeatherValue;

/// Something suspicious that is not seen from the configuration alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suspicion {
    /// The key that it is about, as a path (`vehicle.lidar.weather`).
    pub key: String,
    /// What is suspicious, and what to do.
    pub message: String,
}

/// Looks at a configuration that is without faults: at its top, and at what each group says of its own.
pub(crate) fn look(root: &Section<'_>, all: &DatasetSettings) {
    let of_group = |group: &Group| {
        let whole = all.of_group(&group.name)?;
        Some(DatasetSettings { scenes: group.scenes.clone(), ..whole })
    };
    let groups: Vec<DatasetSettings> = all.groups.iter().filter_map(of_group).collect();
    let scenes = groups.iter().flat_map(|group| &group.scenes).chain(&all.scenes);
    let top = DatasetSettings { scenes: scenes.cloned().collect(), ..all.clone() };
    weather_shares(root, &top);
    places_without_scenes(root, &top);
    // What the top has for groups alone is no mistake.
    if groups.is_empty() {
        rigs_of_nobody(root, &top);
        if !root.names_all() {
            unused(root, &top);
        }
    }
    if !root.names_all() {
        placed_by_default(root, &top);
    }
    let sections = root.sections("groups", "", "").unwrap_or_default();
    for (section, group) in sections.iter().zip(&groups) {
        weather_shares(section, group);
        places_without_scenes(section, group);
        rigs_of_nobody(section, group);
        if !root.names_all() {
            placed_by_default(section, group);
        }
    }
}

/// Percents that look like shares.
fn weather_shares(root: &Section<'_>, all: &DatasetSettings) {
    let weather = root.section("weather", "");
    let check = |section: &Section<'_>, values: &[(String, WeatherValue)]| {
        let percents = values.iter().filter(|(name, _)| Weather::PERCENTS.contains(&name.as_str()));
        for (name, value) in percents.filter(|(_, value)| 0.0 < value.greatest() && value.greatest() <= 1.0) {
            let path = section.path_of(name);
            let percent = |share: f64| (1e11 * share).round() / 1e9;
            let (is, meant) = match *value {
                WeatherValue::Fixed(share) => (format!("{share}"), format!("{}", percent(share))),
                WeatherValue::Between(two) => (format!("{two:?}"), format!("{:?}", two.map(percent))),
            };
            let message = format!(
                "`{path}` is {is} of 100 percent, next to nothing: write {meant} if a share is meant"
            );
            section.warn_at(name, message);
        }
    };
    check(&weather.section("initial", ""), &all.scenario.weather.initial);
    check(&weather.section("final", ""), &all.scenario.weather.r#final);
    for (section, keyframe) in
        weather.sections("keyframes", "", "").unwrap_or_default().iter().zip(&all.scenario.weather.keyframes)
    {
        check(section, &keyframe.values);
        let longest_s = all.scenario.timing.max_duration_s;
        if keyframe.at_s > longest_s {
            let (path, at_s) = (section.path_of("at_s"), keyframe.at_s);
            let message =
                format!("`{path}` is {at_s}: scenes end before, at `timing.max_duration_s` = {longest_s}");
            section.warn_at("at_s", message);
        }
    }
}

/// Rigs for agents that no scene has.
fn rigs_of_nobody(root: &Section<'_>, all: &DatasetSettings) {
    let (vehicles, why) = most_vehicles(all);
    let rsus = all.scenario.agents.max_rsus;
    let sections = root.sections("rigs", "", "").unwrap_or_default();
    for (section, own) in sections.iter().zip(&all.scenario.own_rigs) {
        for agent in &own.agents {
            let Ok(id) = agent.parse::<AgentId>() else { continue };
            let (most, key) = match id.kind {
                AgentKind::Vehicle => (vehicles, why),
                AgentKind::Rsu => (rsus, "agents.max_rsus"),
            };
            if u32::from(id.index) >= most {
                let path = section.path_of("agents");
                let message = match most {
                    0 => format!("`{path}`: no scene has `{agent}`: `{key}` allows none"),
                    1 => format!("`{path}`: no scene has `{agent}`: `{key}` allows one, number 0"),
                    most => {
                        format!(
                            "`{path}`: no scene has `{agent}`: `{key}` allows {most}, numbers 0 to {}",
                            most - 1
                        )
                    }
                };
                section.warn_at("agents", message);
            }
        }
    }
}

/// Most data-collection vehicles of any scene, and the key that says so.
fn most_vehicles(all: &DatasetSettings) -> (u32, &'static str) {
    let (most, why) = match (all.scenario.agents.penetration, all.scenario.traffic.vehicles) {
        (Some(share), Some(vehicles)) => {
            ((share * f64::from(vehicles)).round_ties_even().max(1.0) as u32, "agents.penetration")
        }
        _ => (all.scenario.agents.max_vehicles, "agents.max_vehicles"),
    };
    // Where starts are given, a scene has no more vehicles than these.
    let places = all.scenes.iter().filter(|wish| wish.count > 0).map(|wish| {
        let here = |map: &str| map_name(map) == map_name(&wish.map);
        match all.scenario.agents.starts.iter().filter(|start| here(&start.map)).count() as u32 {
            0 => u32::MAX,
            places => places,
        }
    });
    match places.max() {
        Some(places) if places < most => (places, "agents.starts"),
        _ => (most, why),
    }
}

/// Places on maps that have no scenes.
fn places_without_scenes(root: &Section<'_>, all: &DatasetSettings) {
    let agents = root.section("agents", "");
    let starts: Vec<&String> = all.scenario.agents.starts.iter().map(|start| &start.map).collect();
    let rsus: Vec<&String> = all.scenario.agents.rsus_at.iter().map(|rsu| &rsu.map).collect();
    let routes: Vec<&String> = all.scenario.agents.routes.iter().map(|route| &route.map).collect();
    for (key, maps) in [("starts", starts), ("rsus_at", rsus), ("routes", routes)] {
        let sections = agents.sections(key, "", "").unwrap_or_default();
        for (section, map) in sections.iter().zip(maps) {
            let is_there = |wish: &str| map_name(wish) == map_name(map);
            if !all.scenes.iter().any(|wish| wish.count > 0 && is_there(&wish.map)) {
                let message = format!("`{}`: there are no scenes on `{map}`", section.path_of("map"));
                section.warn_at("map", message);
            }
        }
    }
    let (given, most) = (all.scenario.agents.rsus_at.len(), all.scenario.agents.max_rsus);
    let fullest = all.scenes.iter().filter(|wish| wish.count > 0).map(|wish| {
        all.scenario.agents.rsus_at.iter().filter(|rsu| map_name(&rsu.map) == map_name(&wish.map)).count()
    });
    if fullest.max().is_some_and(|here| here > most as usize) {
        agents.warn_at(
            "rsus_at",
            format!("`agents.rsus_at` has {given} places, and no scene has more than `agents.max_rsus` = {most} RSUs"),
        );
    }
}

/// Tables whose keys have no effect.
fn unused(root: &Section<'_>, all: &DatasetSettings) {
    let weather = root.section("weather", "");
    if !all.scenario.weather.dynamic {
        say_unused(&weather.section("final", ""), &[], "`weather.dynamic` is false");
    }
    if !all.bev.enabled {
        say_unused(&root.section("bev", ""), &["enabled"], "`bev.enabled` is false");
    }
    if !all.tracks.windows {
        say_unused(&root.section("tracks", ""), &["windows"], "`tracks.windows` is false");
    }
    unused_in_rig(&root.section("vehicle", ""), &all.scenario.vehicle_rig, &all.scenario.vehicle_occupancy);
    let rsu = root.section("rsu", "");
    if all.scenario.agents.max_rsus == 0 {
        say_unused(&rsu, &[], "`agents.max_rsus` is 0");
    } else {
        unused_in_rig(&rsu, &all.scenario.rsu_rig, &all.scenario.rsu_occupancy);
    }
    for (section, own) in root.sections("rigs", "", "").unwrap_or_default().iter().zip(&all.scenario.own_rigs)
    {
        unused_in_rig(section, &own.rig, &own.occupancy);
    }
}

/// Sensors of a list that do not say where they are: they are at one place with others, as a rule.
fn placed_by_default(root: &Section<'_>, all: &DatasetSettings) {
    let own = root.sections("rigs", "", "").unwrap_or_default();
    let own = own.iter().zip(&all.scenario.own_rigs).map(|(section, own)| (section, &own.rig));
    let (vehicle, rsu) = (root.section("vehicle", ""), root.section("rsu", ""));
    let usual = [(&vehicle, &all.scenario.vehicle_rig), (&rsu, &all.scenario.rsu_rig)];
    for (section, has) in usual.into_iter().chain(own) {
        let items = |list| section.sections(list, "", "").unwrap_or_default();
        // A lidar may have one with labels beside it, or be switched off.
        let lidars = items("lidars").into_iter().filter_map(|item| {
            let name = item.text("name", "LIDAR_2", "");
            let spec = has.lidars.iter().find(|l| l.name == name || l.name == format!("SEG-{name}"))?;
            Some((item, spec.mount.xyz_m))
        });
        let cameras = items("cameras").into_iter().zip(has.cameras.iter().map(|camera| camera.mount.xyz_m));
        let radars = items("radars").into_iter().zip(has.radars.iter().map(|radar| radar.mount.xyz_m));
        for (item, xyz_m) in lidars.chain(cameras).chain(radars).filter(|(item, _)| !item.says("xyz_m")) {
            let path = item.path();
            item.warn_here(format!("`{path}` does not say where it is: it is at `xyz_m = {xyz_m:?}`"));
        }
    }
}

fn unused_in_rig(rig: &Section<'_>, has: &Rig, grid: &OccupancySettings) {
    let off = |table: &str| format!("`{}.enabled` is false", rig.path_of(table));
    let Rig { camera: _, cameras, lidars: _, radars, gnss, imu } = has;
    let tables = [
        ("occupancy", grid.enabled),
        ("camera", !cameras.is_empty()),
        ("radar", !radars.is_empty()),
        ("gnss", gnss.is_some()),
        ("imu", imu.is_some()),
    ];
    for (table, _) in tables.into_iter().filter(|(_, is_on)| !is_on) {
        say_unused(&rig.section(table, ""), &["enabled"], &off(table));
    }
    for (list, table, is_on) in
        [("cameras", "camera", !cameras.is_empty()), ("radars", "radar", !radars.is_empty())]
    {
        if !is_on && rig.sections(list, "", "").is_some_and(|items| !items.is_empty()) {
            rig.warn_at(list, format!("`{}` has no effect: {}", rig.path_of(list), off(table)));
        }
    }
    let lidar = rig.section("lidar", "");
    let first = |spec: &&crate::lidar::LidarSpec| ["LIDAR", "SEG-LIDAR"].contains(&spec.name.as_str());
    match has.lidars.iter().find(first) {
        None => say_unused(&lidar, &["enabled", "semantic"], &off("lidar")),
        // The semantic one feels no weather, whatever the other does.
        Some(spec) if !spec.semantic => {
            let keys = [
                ("weather_detected", "weather", spec.weather.is_none()),
                ("rolling_slices", "rolling", spec.rolling.is_none()),
                ("rolling_compensated", "rolling", spec.rolling.is_none()),
            ];
            for (key, switch, _) in keys.into_iter().filter(|(key, _, is_off)| *is_off && lidar.has(key)) {
                let [path, switch] = [key, switch].map(|key| lidar.path_of(key));
                lidar.warn_at(key, format!("`{path}` has no effect: `{switch}` is false"));
            }
        }
        Some(_) => {}
    }
}

/// Says that a table has no effect, if it has keys besides some.
fn say_unused(section: &Section<'_>, but: &[&str], why: &str) {
    if section.has_besides(but) {
        let path = section.path();
        section.warn_here(format!("`{path}` has no effect: {why}"));
    }
}
