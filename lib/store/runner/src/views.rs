//! What each stage sees of the configuration, and its digest.

use schema::{AgentId, ImageKind};
use settings::stages::{
    MaskSettings, PlanSettings, RangeRig, RangeSensor, SensorSettings, SimulationSettings,
    StatisticsSettings, ValiditySettings,
};
use settings::{DatasetSettings, Group, OccupancySettings, PerAgent, Rig, TrackSettings};
use store::Scope;

use crate::editions::Editions;
use crate::graph::StageSpec;
use crate::seen::{IsRead, MadeFrom, StageSettings, ViewError, of_scope};
use crate::shards::{self, Shards};

impl StageSettings for PlanSettings {
    const STAGE: &'static str = "spawn-planner";

    fn of(all: &DatasetSettings) -> Self {
        Self {
            seed: all.seed,
            scenes: all.scenes.clone(),
            first_scene: all.first_scene,
            redraw: all.redraw.clone(),
            agents: all.scenario.agents.clone(),
            models: all.models.clone(),
            timing: all.scenario.timing.clone(),
            traffic: all.scenario.traffic.clone(),
            walkers: all.scenario.walkers.clone(),
            weather: all.scenario.weather.clone(),
            lights: all.scenario.lights.clone(),
            hazards: all.scenario.hazards.clone(),
            groups: all.groups.iter().filter_map(|group| plan_of_group(all, group)).collect(),
            older: Vec::new(),
        }
    }

    fn of_dataset(editions: &Editions) -> Self {
        let older = editions.all().split_last().map_or(&[][..], |(_, older)| older);
        Self { older: older.iter().map(Self::of).collect(), ..Self::of(editions.newest()) }
    }
}

fn plan_of_group(all: &DatasetSettings, group: &Group) -> Option<(String, PlanSettings)> {
    let settings = all.of_group(&group.name)?;
    Some((group.name.clone(), PlanSettings { scenes: group.scenes.clone(), ..PlanSettings::of(&settings) }))
}

impl StageSettings for SimulationSettings {
    const STAGE: &'static str = "simulate-and-log";

    fn of(all: &DatasetSettings) -> Self {
        Self {
            traffic: all.scenario.traffic.clone(),
            walkers: all.scenario.walkers.clone(),
            lights: all.scenario.lights.clone(),
            hazards: all.scenario.hazards.clone(),
            scenery: all.world.scenery.clone(),
            reach_m: reach_m(all),
            box_radius_m: all.annotation.box_radius_m,
            label_every_n_frames: all.annotation.every_n_frames,
        }
    }
}

/// How far from agents the static world must be there, metres: what boxes and grids reach, whatever is asked
/// for.
fn reach_m(all: &DatasetSettings) -> f64 {
    let diagonal = std::f64::consts::SQRT_2;
    let grids = all.scenario.occupancy();
    let occupancy = [&grids.vehicle, &grids.rsu].into_iter().chain(grids.own.iter().map(|(_, grid)| grid));
    let half = occupancy.map(|grid| grid.range_m).fold(0.0, f64::max);
    // Voxels reach up and down as well.
    (diagonal * half + 20.0).max(all.bev.reach_m()).max(all.annotation.box_radius_m).max(all.world.radius_m)
}

impl StageSettings for SensorSettings {
    const STAGE: &'static str = "render-sensors";

    fn of(all: &DatasetSettings) -> Self {
        Self { seed: all.seed, rigs: all.scenario.rigs() }
    }

    fn made_from(&self, scene: u32, agents: &[AgentId]) -> Result<MadeFrom, ViewError> {
        shards::of_sensors(self, scene, agents)
    }
}

impl StageSettings for MaskSettings {
    const STAGE: &'static str = "bev-gt";

    fn of(all: &DatasetSettings) -> Self {
        Self { bev: all.bev.clone(), warmup_s: all.scenario.timing.warmup_s }
    }
}

impl StageSettings for PerAgent<OccupancySettings> {
    const STAGE: &'static str = "occupancy-gt";

    fn of(all: &DatasetSettings) -> Self {
        all.scenario.occupancy().map(|grid| OccupancySettings { observed: false, ..grid.clone() })
    }
}

impl StageSettings for ValiditySettings {
    const STAGE: &'static str = "postprocess-valid";

    fn of(all: &DatasetSettings) -> Self {
        Self {
            valid_by_image: all.annotation.valid_by_image,
            rigs: all.scenario.rigs().map(range_rig),
            occupancy: all.scenario.occupancy(),
        }
    }

    fn reads(&self, stage: &str) -> Option<IsRead<'_>> {
        shards::read_for_validity(self, stage)
    }
}

fn range_rig(rig: &Rig) -> RangeRig {
    let plain = rig.lidars.iter().filter(|lidar| !lidar.semantic);
    let sensor = |name: &str, mount, every_n_frames, tells_returns| RangeSensor {
        name: name.to_owned(),
        mount,
        every_n_frames,
        tells_returns,
    };
    RangeRig {
        lidars: plain.map(|s| sensor(&s.name, s.mount, s.every_n_frames, s.tells_returns())).collect(),
        radars: rig.radars.iter().map(|s| sensor(&s.name, s.mount, s.every_n_frames, false)).collect(),
        instance: rig.camera.images.has(ImageKind::Instance),
    }
}

impl StageSettings for TrackSettings {
    const STAGE: &'static str = "merge-tracks";

    fn of(all: &DatasetSettings) -> Self {
        all.tracks.clone()
    }
}

impl StageSettings for StatisticsSettings {
    const STAGE: &'static str = "stats";

    fn of(all: &DatasetSettings) -> Self {
        Self {
            name: all.name.clone(),
            card: all.card.clone(),
            seed: all.seed,
            rigs: all.scenario.rigs(),
            annotation: all.annotation.clone(),
            bev: all.bev.clone(),
            occupancy: all.scenario.occupancy(),
            groups: all.groups.iter().filter_map(|group| statistics_of_group(all, group)).collect(),
            older: Vec::new(),
        }
    }

    fn of_dataset(editions: &Editions) -> Self {
        let older = editions.all().split_last().map_or(&[][..], |(_, older)| older);
        Self { older: older.iter().map(Self::of).collect(), ..Self::of(editions.newest()) }
    }

    fn reads(&self, _stage: &str) -> Option<IsRead<'_>> {
        Some(Box::new(shards::is_read_for_statistics))
    }
}

fn statistics_of_group(all: &DatasetSettings, group: &Group) -> Option<(String, StatisticsSettings)> {
    Some((group.name.clone(), StatisticsSettings::of(&all.of_group(&group.name)?)))
}

/// A stage, the bytes of what it sees, and what is told of its shards.
type View = (&'static str, fn(&Editions, Scope) -> serde_json::Result<Vec<u8>>, Shards);

const fn view<S: StageSettings>() -> View {
    (S::STAGE, |editions, scope| serde_json::to_vec(&of_scope::<S>(editions, scope)), Shards::of::<S>())
}

/// What each stage sees. A stage that is missing here cannot be run: [`config_hash`] says so.
const VIEWS: &[View] = &[
    view::<PlanSettings>(),
    view::<SimulationSettings>(),
    view::<SensorSettings>(),
    view::<MaskSettings>(),
    view::<PerAgent<OccupancySettings>>(),
    view::<ValiditySettings>(),
    view::<TrackSettings>(),
    view::<StatisticsSettings>(),
];

fn view_of(spec: &StageSpec) -> Result<&'static View, ViewError> {
    VIEWS.iter().find(|(name, ..)| *name == spec.name).ok_or(ViewError::Unknown { stage: spec.name })
}

/// What is told of a stage's shards.
pub(crate) fn shards_of(spec: &StageSpec) -> Result<Shards, ViewError> {
    view_of(spec).map(|(_, _, shards)| *shards)
}

/// Digest of what a stage sees of the configuration for a scope.
///
/// # Errors
/// Nothing is said of the stage, or its view cannot be written down: both are bugs.
pub fn config_hash(spec: &StageSpec, editions: &Editions, scope: Scope) -> Result<String, ViewError> {
    let stage = spec.name;
    let (_, bytes, _) = view_of(spec)?;
    let bytes = bytes(editions, scope).map_err(|source| ViewError::Json { stage, source })?;
    Ok(store::hash_bytes(&bytes))
}

/// Default settings with one scene, for tests.
#[cfg(test)]
pub(crate) fn example_settings() -> DatasetSettings {
    settings::parse("[scenes.train]\n\"convoy/demo\" = 1\n", "example.toml")
        .expect("the smallest configuration is valid")
}

#[cfg(test)]
mod tests {
    use schema::ImageSet;
    use settings::{BevRule, OwnRig, RollingScan, WeatherSpec};

    use super::*;
    use crate::graph::{Graph, UnitKind};

    fn base() -> DatasetSettings {
        let mut base = example_settings();
        base.scenario.own_rigs.push(OwnRig {
            agents: vec!["vehicle_1".into()],
            rig: base.scenario.vehicle_rig.clone(),
            occupancy: base.scenario.vehicle_occupancy.clone(),
        });
        base
    }

    /// Stages whose digest a change of the configuration alters.
    fn stale(change: fn(&mut DatasetSettings)) -> Vec<&'static str> {
        let (before, mut after) = (base(), base());
        change(&mut after);
        let hash = |spec: &StageSpec, settings: &DatasetSettings| {
            let scope = match spec.unit {
                UnitKind::Plan => Scope::Plan,
                UnitKind::Scene => Scope::Scene(0),
                UnitKind::Stats => Scope::Stats,
            };
            config_hash(spec, &Editions::only(settings), scope).expect("every stage has a view")
        };
        let stages = Graph::get().stages.iter();
        stages.filter(|s| hash(s, &before) != hash(s, &after)).map(|s| s.name).collect()
    }

    #[test]
    fn just_the_stages_that_see_a_key_become_stale() {
        let rendered = ["render-sensors", "stats"];
        assert_eq!(stale(|s| s.scenario.vehicle_rig.lidars[0].noise_m = 0.5), rendered);
        assert_eq!(stale(|s| s.scenario.own_rigs[0].rig.lidars[0].noise_m = 0.5), rendered);
        assert_eq!(stale(|s| s.scenario.rsu_rig.camera.jpeg_quality = 17), rendered);
        let rolls = |s: &mut DatasetSettings| {
            s.scenario.vehicle_rig.lidars[0].rolling = Some(RollingScan { slices: 8, compensated: true });
        };
        assert_eq!(stale(rolls), rendered);
        let judged = ["render-sensors", "postprocess-valid", "stats"];
        assert_eq!(
            stale(|s| s.scenario.rsu_rig.lidars[0].weather = Some(WeatherSpec { detected: 0.1 })),
            judged
        );
        assert_eq!(stale(|s| s.scenario.rsu_rig.camera.images = ImageSet::NONE), judged);
        assert_eq!(stale(|s| s.scenario.rsu_rig.camera.images.set(ImageKind::Flow, true)), rendered);
        assert_eq!(stale(|s| s.scenario.rsu_rig.camera.flow_half = true), rendered);
        let voxels = ["occupancy-gt", "postprocess-valid", "stats"];
        assert_eq!(stale(|s| s.scenario.own_rigs[0].occupancy.voxel_m = 0.5), voxels);
        assert_eq!(stale(|s| s.scenario.vehicle_occupancy.range_m = 32.0), voxels);
        assert_eq!(stale(|s| s.scenario.rsu_occupancy.observed = true), ["postprocess-valid", "stats"]);
        assert_eq!(stale(|s| s.bev.cells = 200), ["bev-gt", "stats"]);
        assert_eq!(stale(|s| s.bev.cell_m = 0.2), ["bev-gt", "stats"]);
        assert_eq!(stale(|s| s.tracks.future_s = 3.0), ["merge-tracks"]);
        assert_eq!(stale(|s| s.bev.rule = BevRule::Simbev2x), ["bev-gt", "stats"]);
        assert_eq!(stale(|s| s.scenario.timing.warmup_s = 3.0), ["spawn-planner", "bev-gt"]);
        assert_eq!(stale(|s| s.name = "other".into()), ["stats"]);
        assert_eq!(stale(|s| s.card.licence = "CC-BY-4.0".into()), ["stats"]);
        assert_eq!(stale(|s| s.annotation.valid_by_image ^= true), ["postprocess-valid", "stats"]);
        assert_eq!(stale(|s| s.annotation.box_radius_m = 90.0), ["simulate-and-log", "stats"]);
        assert_eq!(stale(|s| s.annotation.every_n_frames = 10), ["simulate-and-log", "stats"]);
        assert_eq!(stale(|s| s.scenario.rsu_rig.camera.every_n_frames = 10), rendered);
        assert_eq!(stale(|s| s.scenario.rsu_rig.lidars[0].every_n_frames = 2), judged);
        assert_eq!(stale(|s| s.scenario.rsu_occupancy.every_n_frames = 10), voxels);
        assert_eq!(stale(|s| s.bev.every_n_frames = 10), ["bev-gt", "stats"]);
        assert_eq!(stale(|s| s.world.radius_m = 90.0), ["simulate-and-log"]);
        assert_eq!(stale(|s| s.scenario.timing.max_duration_s = 9.0), ["spawn-planner"]);
        assert_eq!(stale(|s| s.seed = 3), ["spawn-planner", "render-sensors", "stats"]);
        assert_eq!(stale(|s| s.scenario.traffic.door_open = 0.5), ["spawn-planner", "simulate-and-log"]);
    }
}
