//! What is odd in a plan, as far as other settings are not meant to go with it.

use std::collections::BTreeMap;

use schema::tables::{PlanSceneRow, Weather};
use settings::{AgentSettings, Rig, Scenario, Suspicion};

use crate::agents::has_lights;
use crate::scene::{Plan, PlanMap};

/// So many scenes are named.
const MOST_NAMED: usize = 8;

/// Maps without a traffic light, where RSUs are wished for.
#[must_use]
pub fn without_lights(agents: &AgentSettings, maps: &BTreeMap<String, PlanMap>) -> Vec<Suspicion> {
    let most = agents.max_rsus;
    let has_own = |name: &String| agents.rsus_at.iter().any(|rsu| rsu.map == *name);
    let unlit = maps.iter().filter(|(name, map)| most > 0 && !has_own(name) && !has_lights(&map.map));
    let said = |(name, _): (&String, &PlanMap)| Suspicion {
        key: "agents.max_rsus".into(),
        message: format!(
            "`agents.max_rsus` is {most}, and `{name}` has no traffic light at a junction: scenes there have no RSUs but where `agents.rsus_at` puts them"
        ),
    };
    unlit.map(said).collect()
}

/// Rain or fog in the plan, and lidars that do not feel it; `scenario_of` gives what a scene is made by.
#[must_use]
pub fn unfelt_weather<'a>(scenario_of: &dyn Fn(u32) -> &'a Scenario, plan: &Plan) -> Vec<Suspicion> {
    let is_met = |weather: Weather| weather.precipitation > 0.0 || weather.fog_density > 0.0;
    let is_wet = |scene: &PlanSceneRow| {
        let between = plan.weather.iter().filter(|row| row.scene == scene.scene).map(|row| row.weather);
        between.chain([scene.initial_weather, scene.final_weather]).any(is_met)
    };
    let mut wet: BTreeMap<Vec<String>, Vec<u32>> = BTreeMap::new();
    for scene in plan.scenes.iter().filter(|scene| is_wet(scene)) {
        wet.entry(unfeeling(scenario_of(scene.scene))).or_default().push(scene.scene);
    }
    let all = plan.scenes.len();
    wet.into_iter().filter_map(|(keys, scenes)| unfelt(&keys, &scenes, all)).collect()
}

fn unfelt(keys: &[String], scenes: &[u32], all: usize) -> Option<Suspicion> {
    let key = keys.first()?.clone();
    let named = scenes.iter().take(MOST_NAMED).map(u32::to_string).collect::<Vec<_>>();
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    let message = format!(
        "{} {} false, and {} of {all} scenes have rain or fog ({}{}): these lidars do not feel it; switch it on, or fix \
         `precipitation` and `fog_density` at 0",
        quoted.join(", "),
        if keys.len() == 1 { "is" } else { "are" },
        scenes.len(),
        named.join(", "),
        if scenes.len() > MOST_NAMED { ", ..." } else { "" }
    );
    Some(Suspicion { key, message })
}

/// The keys by which lidars of agents that there may be would feel the weather.
fn unfeeling(all: &Scenario) -> Vec<String> {
    let own = all.own_rigs.iter().enumerate().map(|(i, own)| (format!("rigs[{i}]"), &own.rig));
    let rsu = (all.agents.max_rsus > 0).then(|| ("rsu".to_owned(), &all.rsu_rig));
    let rigs = std::iter::once(("vehicle".to_owned(), &all.vehicle_rig)).chain(rsu).chain(own);
    let key = |(path, rig): (String, &Rig)| {
        let unfeeling = rig.lidars.iter().find(|lidar| !lidar.semantic && lidar.weather.is_none())?;
        let table = if unfeeling.name == "LIDAR" { "lidar" } else { "lidars" };
        Some(format!("{path}.{table}.weather"))
    };
    rigs.filter_map(key).collect()
}
