//! Which of a stage's shards another one reads, and what each of them depends on: by shard, not by stage,
//! work is kept or done again.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use schema::scene_info::SCENE_FILE;
use schema::{AgentId, ImageKind};
use serde::Serialize;
use settings::stages::{RangeRig, SensorSettings, ValiditySettings};
use settings::{DatasetSettings, PerAgent};
use store::{Manifest, Output, Scope, keys};

use crate::editions::Editions;
use crate::record::Record;
use crate::seen::{IsRead, MadeFrom, StageSettings, ViewError};

/// What a stage depends on of an input.
#[derive(Debug)]
pub(crate) struct Part {
    /// The input's manifest.
    record: Arc<Record>,
    /// The manifest with the outputs that are read, and the digest of them; none where all are read.
    read: Option<(Manifest, String)>,
}

impl Part {
    /// All of an input.
    pub(crate) fn whole(record: Arc<Record>) -> Self {
        Self { record, read: None }
    }

    /// What a stage that sees some settings depends on.
    fn of<S: StageSettings>(all: &DatasetSettings, scope: Scope, record: &Arc<Record>) -> Self {
        let view = S::of(all);
        let Some((manifest, is_read)) = record.sound().and_then(|m| Some((m, view.reads(&m.stage)?))) else {
            return Self::whole(record.clone());
        };
        let folder = format!("{}/", scope.folder());
        let reads = |output: &Output| output.key.strip_prefix(&folder).is_some_and(&is_read);
        let mut read = manifest.clone();
        read.outputs.retain(reads);
        Self { record: record.clone(), read: Some((read, manifest.digest_of(reads))) }
    }

    /// The digest that is remembered.
    pub(crate) fn digest(&self) -> &str {
        self.read.as_ref().map_or_else(|| self.whole_digest(), |(_, digest)| digest)
    }

    /// That of the whole manifest: older programs remembered it.
    pub(crate) fn whole_digest(&self) -> &str {
        self.record.digest()
    }

    fn manifest(&self) -> Option<&Manifest> {
        self.read.as_ref().map(|(manifest, _)| manifest).or_else(|| self.record.sound())
    }

    /// The input's manifest with the outputs that are read.
    pub(crate) fn into_manifest(self) -> Option<Manifest> {
        self.manifest().cloned()
    }

    /// Whether an output is read.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.manifest().is_some_and(|manifest| manifest.output(key).is_some())
    }

    /// Whether this is what a digest remembers.
    pub(crate) fn is(&self, remembered: &str) -> bool {
        remembered == self.digest() || remembered == self.whole_digest()
    }
}

/// Whether a stage's shard is read, by the stage and the path in the scene's folder.
type ReadOfScenes = Box<dyn Fn(&str, &str) -> bool + Send + Sync>;

/// What is told of a stage's shards, without its settings' type.
#[derive(Clone, Copy)]
pub(crate) struct Shards {
    /// What it depends on of an input.
    pub(crate) part: fn(&DatasetSettings, Scope, &Arc<Record>) -> Part,
    /// Which shards of scenes it reads, where it works on the whole dataset.
    pub(crate) reads: fn(&Editions) -> ReadOfScenes,
    /// What its own shards of a scene depend on.
    pub(crate) made_from: fn(&DatasetSettings, u32, &[AgentId]) -> Result<MadeFrom, ViewError>,
}

impl Shards {
    /// Those of the stage that sees some settings.
    pub(crate) const fn of<S: StageSettings>() -> Self {
        Self {
            part: Part::of::<S>,
            reads: |editions| {
                let view = S::of_dataset(editions);
                Box::new(move |stage, path| view.reads(stage).is_none_or(|is_read| is_read(path)))
            },
            made_from: |all, scene, agents| S::of(all).made_from(scene, agents),
        }
    }
}

/// The keys of a scene's shards that are written again, or go, or come, when a stage is done again because
/// its settings changed; none where it tells no shards apart, or the manifest does not.
pub(crate) fn changed(
    made_from: impl Fn(u32, &[AgentId]) -> Result<MadeFrom, ViewError>,
    scene: u32,
    manifest: &Manifest,
) -> Result<Option<BTreeSet<String>>, ViewError> {
    let then: BTreeMap<&str, Option<&str>> =
        manifest.outputs.iter().map(|output| (output.key.as_str(), output.made_from.as_deref())).collect();
    if then.values().all(Option::is_none) {
        return Ok(None);
    }
    let now = made_from(scene, &agents_of(scene, manifest))?;
    let stays = |key: &str| now.get(key).is_some_and(|now| then.get(key) == Some(&Some(now)));
    let all = then.keys().copied().chain(now.keys().map(String::as_str));
    Ok(Some(all.filter(|key| !stays(key)).map(str::to_owned).collect()))
}

/// The agents that a stage has counted for.
fn agents_of(scene: u32, manifest: &Manifest) -> Vec<AgentId> {
    let counts = keys::scene(scene, &format!("stats/{}.", manifest.stage));
    let agent = |output: &Output| output.key.strip_prefix(&counts)?.strip_suffix(".parquet")?.parse().ok();
    manifest.outputs.iter().filter_map(agent).collect()
}

/// Digest of settings.
fn digest(stage: &'static str, settings: &impl Serialize) -> Result<String, ViewError> {
    let bytes = serde_json::to_vec(settings).map_err(|source| ViewError::Json { stage, source })?;
    Ok(store::hash_bytes(&bytes))
}

/// What the tables of sensors depend on, and the counts of each agent, which are of all its tables.
pub(crate) fn of_sensors(
    settings: &SensorSettings,
    scene: u32,
    agents: &[AgentId],
) -> Result<MadeFrom, ViewError> {
    let stage = SensorSettings::STAGE;
    let mut made_from = MadeFrom::new();
    for &agent in agents {
        let mut of_agent = MadeFrom::new();
        for table in settings.tables(agent) {
            of_agent.insert(keys::sensor(scene, agent, &table.name), digest(stage, &table)?);
        }
        made_from.insert(keys::partial_stats(scene, &format!("{stage}.{agent}")), digest(stage, &of_agent)?);
        made_from.append(&mut of_agent);
    }
    Ok(made_from)
}

/// Of a scene its partial counts, its description, and the colour images for its picture.
pub(crate) fn is_read_for_statistics(path: &str) -> bool {
    let is_colour = |table: &str| {
        let name = table.rsplit_once('/').map_or(table, |(_, name)| name);
        name.strip_prefix(ImageKind::Rgb.spec().prefix).is_some_and(|rest| rest.starts_with('-'))
    };
    path.starts_with("stats/") || path == SCENE_FILE || path.strip_prefix("sensors/").is_some_and(is_colour)
}

/// Of the sensors' tables those of lidars and radars, and what instance images show.
pub(crate) fn read_for_validity<'a>(settings: &'a ValiditySettings, stage: &str) -> Option<IsRead<'a>> {
    (stage == SensorSettings::STAGE).then(|| {
        let rigs: &PerAgent<RangeRig> = &settings.rigs;
        let is_read = move |path: &str| {
            let table = || path.strip_prefix("sensors/")?.strip_suffix(".parquet")?.split_once('/');
            table().is_some_and(|(agent, name)| {
                agent.parse().is_ok_and(|agent: AgentId| rigs.of(agent).reads(name))
            })
        };
        Box::new(is_read) as IsRead<'a>
    })
}

#[cfg(test)]
mod tests {
    use schema::ImageKind;

    use super::*;
    use crate::views::example_settings;

    const SCENE: u32 = 2;

    /// A manifest of `render-sensors`, as it is made by some settings.
    fn rendered(all: &DatasetSettings, agents: &[AgentId]) -> Manifest {
        let made_from = of_sensors(&SensorSettings::of(all), SCENE, agents).expect("are settings");
        let output = |(key, made_from): (String, String)| Output {
            blake3: made_from.clone(),
            made_from: Some(made_from),
            key,
            bytes: 1,
            rows: 1,
            counts: BTreeMap::new(),
        };
        Manifest {
            format_version: 1,
            stage: SensorSettings::STAGE.into(),
            code_version: "1".into(),
            config_hash: store::hash_bytes(&serde_json::to_vec(&SensorSettings::of(all)).expect("is JSON")),
            generation: 0,
            inputs: BTreeMap::new(),
            outputs: made_from.into_iter().map(output).collect(),
            sections: BTreeMap::new(),
            accepted_by: Vec::new(),
            made_by: None,
        }
    }

    fn changed_by(change: fn(&mut DatasetSettings)) -> Vec<String> {
        let (before, agents) = (example_settings(), [AgentId::vehicle(0), AgentId::rsu(0)]);
        let mut after = before.clone();
        change(&mut after);
        let made_from = |scene, agents: &[AgentId]| of_sensors(&SensorSettings::of(&after), scene, agents);
        let changed = changed(made_from, SCENE, &rendered(&before, &agents)).expect("are settings");
        changed.expect("are told apart").into_iter().collect()
    }

    #[test]
    fn a_changed_sensor_is_a_changed_table_and_other_counts() {
        assert_eq!(changed_by(|_| {}), [""; 0]);
        assert_eq!(
            changed_by(|all| all.scenario.rsu_rig.lidars[0].noise_m = 0.5),
            ["scenes/0002/sensors/rsu_0/LIDAR.parquet", "scenes/0002/stats/render-sensors.rsu_0.parquet"]
        );
        // What comes and what goes.
        assert_eq!(
            changed_by(|all| all.scenario.vehicle_rig.radars[0].name = "OTHER".into()),
            [
                "scenes/0002/sensors/vehicle_0/OTHER.parquet",
                "scenes/0002/sensors/vehicle_0/RAD_LEFT.parquet",
                "scenes/0002/stats/render-sensors.vehicle_0.parquet"
            ]
        );
        assert_eq!(changed_by(|all| all.annotation.box_radius_m = 9.0), [""; 0]);
    }

    #[test]
    fn manifests_of_before_tell_no_shards_apart() {
        let all = example_settings();
        let mut old = rendered(&all, &[AgentId::vehicle(0)]);
        old.outputs.iter_mut().for_each(|output| output.made_from = None);
        let made_from = |scene, agents: &[AgentId]| of_sensors(&SensorSettings::of(&all), scene, agents);
        assert_eq!(changed(made_from, SCENE, &old).expect("are settings"), None);
    }

    /// Whether boxes are judged anew after a change of the sensors.
    fn judged_anew(change: fn(&mut DatasetSettings)) -> bool {
        let (before, agents) = (example_settings(), [AgentId::vehicle(0), AgentId::rsu(0)]);
        let mut after = before.clone();
        change(&mut after);
        let part = |all: &DatasetSettings| {
            Part::of::<ValiditySettings>(all, Scope::Scene(SCENE), &Record::of(rendered(all, &agents)))
        };
        let (then, now) = (part(&before), part(&after));
        assert!(now.is(now.whole_digest()) && now.is(now.digest()));
        !now.is(then.digest())
    }

    #[test]
    fn boxes_are_judged_by_the_tables_that_are_read() {
        assert!(!judged_anew(|_| {}));
        assert!(!judged_anew(|all| all.scenario.vehicle_rig.camera.images.set(ImageKind::Flow, true)));
        assert!(!judged_anew(|all| all.scenario.vehicle_rig.camera.jpeg_quality = 17));
        assert!(!judged_anew(|all| all.scenario.rsu_rig.imu = Some(settings::ImuSpec::default())));
        assert!(judged_anew(|all| all.scenario.vehicle_rig.lidars[0].scan.channels = 16));
        assert!(judged_anew(|all| all.scenario.vehicle_rig.radars[0].every_n_frames = 2));
        // Instance images show what is there.
        assert!(judged_anew(|all| all.scenario.vehicle_rig.cameras[0].optics.width = 99));
        let part = |stage: &str| {
            let manifest = Manifest { stage: stage.into(), ..rendered(&example_settings(), &[]) };
            Part::of::<ValiditySettings>(&example_settings(), Scope::Scene(SCENE), &Record::of(manifest))
        };
        let whole = part("occupancy-gt");
        assert_eq!(whole.digest(), whole.whole_digest(), "it is read whole");
    }
}
