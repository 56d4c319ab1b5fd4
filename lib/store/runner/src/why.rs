//! Why a stage of a scene is in the state that it is in: with all that it was made from, down to the plan.

use std::collections::BTreeSet;

use indicatif::DecimalBytes;
use store::{Manifest, Scope, Store};

use crate::editions::Editions;
use crate::graph::{StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::programs::Programs;
use crate::state::{NOT_DONE, SOURCE, Staleness, State, StateError, plan_section};
use crate::status::Status;
use crate::survey::Survey;
use crate::views::{config_hash, shards_of};

/// Statistics name so many stages of scenes that changed.
const MOST: usize = 20;

/// Why a stage is done, stale, missing or failed for a scope, line by line: its state, what speaks against
/// what was made, and set in below that the same of each stage that it reads. A store that was imported has
/// no editions.
///
/// # Errors
/// The store cannot be read.
pub fn why(
    store: &Store,
    editions: Option<&Editions>,
    programs: &Programs,
    (spec, scope): (&'static StageSpec, Scope),
) -> Result<Vec<String>, StateError> {
    let status = match editions {
        Some(editions) => Status::new(store, editions, programs),
        None => Status::of_import(store, programs),
    };
    let mut chain = Chain {
        editions,
        programs,
        surveys: [status.survey(Scope::Plan), status.survey(scope)],
        status: &status,
        lines: Vec::new(),
        told: BTreeSet::new(),
        depth: 0,
    };
    chain.tell(spec, scope)?;
    Ok(chain.lines)
}

struct Chain<'a> {
    editions: Option<&'a Editions>,
    programs: &'a Programs,
    status: &'a Status<'a>,
    /// The plan, and the scope that is asked about.
    surveys: [Survey<'a>; 2],
    lines: Vec<String>,
    /// Stages that were explained already.
    told: BTreeSet<&'static str>,
    depth: usize,
}

impl<'a> Chain<'a> {
    fn survey(&self, scope: Scope) -> &Survey<'a> {
        &self.surveys[usize::from(scope != Scope::Plan)]
    }

    fn add(&mut self, line: &str) {
        self.lines.push(format!("{}{line}", "  ".repeat(self.depth)));
    }

    fn tell(&mut self, spec: &'static StageSpec, scope: Scope) -> Result<(), StateError> {
        let name = spec.name;
        let survey = self.survey(scope);
        let (state, record) = (survey.state(spec)?, survey.record(name)?);
        if !self.told.insert(name) {
            self.add(&format!("{name}: {} (see above)", word(&state)));
            return Ok(());
        }
        self.add(&format!("{name}: {state}"));
        self.depth += 1;
        match record.manifest() {
            Ok(Some(manifest)) if is_imported(manifest) => self.add("imported"),
            Ok(Some(manifest)) => self.made(spec, scope, manifest)?,
            Ok(None) => {
                let units = self.status.store().backend().keys(&scope.parts(name))?.len();
                if units > 0 {
                    self.add(&format!("begun: {units} units are finished and kept"));
                }
            }
            // The state tells how it is damaged.
            Err(_) => {}
        }
        for read in spec.inputs() {
            match (spec.unit, read.unit) {
                // Of each scene; they are told together.
                (UnitKind::Stats, UnitKind::Scene) => {}
                (_, UnitKind::Plan) => self.tell(read, Scope::Plan)?,
                _ => self.tell(read, scope)?,
            }
        }
        self.depth -= 1;
        Ok(())
    }

    /// What was made, and all that speaks against it.
    fn made(&mut self, spec: &'static StageSpec, scope: Scope, made: &Manifest) -> Result<(), StateError> {
        let bytes = made.outputs.iter().map(|output| output.bytes).sum();
        let (version, generation, files) = (&made.code_version, made.generation, made.outputs.len());
        let again = if generation == 0 { String::new() } else { format!(", generation {generation}") };
        let count = if files == 1 { "1 file".to_owned() } else { format!("{files} files") };
        self.add(&format!("made by version {version}{again}: {count}, {}", DecimalBytes(bytes)));
        if let Some(editions) = self.editions
            && made.config_hash != config_hash(spec, editions, scope)?
        {
            self.keys(editions, spec.name, scope);
        }
        match self.status.is_of_code(spec.name, made) {
            Ok(()) => {}
            Err(Staleness::Program) => {
                let short = |digest: &str| digest.chars().take(8).collect::<String>();
                let then = made.made_by.as_ref().map(|by| short(&by.program)).unwrap_or_default();
                let now = self.programs.digest(spec.name).map(|digest| short(&digest)).unwrap_or_default();
                self.add(&format!("program: {then} -> {now} (one of them has uncommitted changes)"));
            }
            Err(_) => self.add(&format!("version: {version} -> {}", crate::code_version(spec.name))),
        }
        if spec.unit == UnitKind::Stats {
            self.scenes(spec, made)?;
        } else {
            self.inputs(spec, scope, made)?;
        }
        for output in &made.outputs {
            match self.survey(scope).size(&output.key)? {
                Some(found) if found == output.bytes => {}
                Some(found) => {
                    self.add(&format!("{}: {found} bytes, {} expected", output.key, output.bytes));
                }
                None => self.add(&format!("{}: is not there", output.key)),
            }
        }
        Ok(())
    }

    /// The keys that the stage sees and that have other values than it was made with.
    fn keys(&mut self, editions: &Editions, stage: &str, scope: Scope) {
        let Some(changes) = editions.changes_of(scope) else {
            self.add("which keys changed is not known: dataset.json does not say what they were");
            return;
        };
        let seen: Vec<String> =
            changes.iter().filter(|change| sees(stage, &change.key)).map(ToString::to_string).collect();
        if seen.is_empty() {
            self.add("which keys changed is not known: dataset.json is of a later run");
        }
        seen.iter().for_each(|change| self.add(&format!("changed: {change}")));
    }

    /// What it read that is another one now.
    fn inputs(&mut self, spec: &StageSpec, scope: Scope, made: &Manifest) -> Result<(), StateError> {
        for read in spec.inputs() {
            let then = made.inputs.get(read.name);
            if let (UnitKind::Plan, Scope::Scene(scene)) = (read.unit, scope) {
                let plan = self.status.plan()?;
                let now = plan.sound().map(|plan| plan.sections.get(&plan_section(scene)));
                match now {
                    Some(None) => self.add(&format!("scene {scene} is not in the plan any more")),
                    Some(now) if now != then => {
                        self.add(&format!("scene {scene} was planned otherwise then"))
                    }
                    _ => {}
                }
                continue;
            }
            let Some(editions) = self.editions else { continue };
            let now = self.survey(scope).record(read.name)?;
            let part = (shards_of(spec)?.part)(editions.of(scope), scope, &now);
            if now.sound().is_some() && then.is_none_or(|then| !part.is(then)) {
                self.add(&format!("{} was made again since", read.name));
            }
        }
        let outside = made.inputs.keys().filter_map(|name| name.strip_prefix(SOURCE));
        let outside: Vec<&str> = outside.collect();
        if !outside.is_empty() {
            self.add(&format!("read from outside the store: {}", outside.join(", ")));
        }
        Ok(())
    }

    /// Which stages of scenes statistics were made without, or from others than there are now.
    fn scenes(&mut self, spec: &StageSpec, made: &Manifest) -> Result<(), StateError> {
        // Statistics are ready whatever scenes there are.
        let Ok(now) = self.survey(Scope::Stats).inputs(spec)? else { return Ok(()) };
        let names: BTreeSet<&String> = now.digests.keys().chain(made.inputs.keys()).collect();
        let word = |then: Option<&String>, now: Option<&String>| match (then.map(String::as_str), now) {
            (_, None) => "is not planned any more",
            (_, Some(now)) if now == NOT_DONE => "is not done any more",
            (None, _) => "was not planned then",
            (Some(NOT_DONE), _) => "was not done then",
            _ => "was made again since",
        };
        let changed: Vec<String> = names
            .into_iter()
            .map(|name| (name, made.inputs.get(name), now.digests.get(name)))
            .filter(|(_, then, now)| then != now)
            .map(|(name, then, now)| format!("{name} {}", word(then, now)))
            .collect();
        changed.iter().take(MOST).for_each(|line| self.add(line));
        if changed.len() > MOST {
            self.add(&format!("and {} more", changed.len() - MOST));
        }
        let left_out = now.digests.values().filter(|digest| *digest == NOT_DONE).count();
        if left_out > 0 {
            self.add(&format!("{left_out} stages of planned scenes are not done (convoy status)"));
        }
        Ok(())
    }
}

/// A state without its reason.
fn word(state: &State) -> &'static str {
    match state {
        State::Done => "done",
        State::Missing => "missing",
        State::Stale(_) => "stale",
        State::Failed(_) => "failed",
    }
}

/// Whether a stage may see a key of the configuration. A few that it does not see are among them: which it
/// sees to the letter is for `views.rs` to say, of whole configurations alone.
fn sees(stage: &str, key: &str) -> bool {
    let section = key.split(['.', '[']).next().unwrap_or_default();
    let is_in = |sections: &[&str]| sections.contains(&section);
    let is_rig = is_in(&["vehicle", "rsu", "rigs"]);
    // A table of `rigs` as a whole, or its agents, concerns both.
    let is_own = section == "rigs" && !key.contains("].rig") && !key.contains("].occupancy");
    let is_grid = is_rig && key.contains("occupancy") || is_own;
    match stage {
        "spawn-planner" => {
            is_in(&[
                "seed",
                "scenes",
                "first_scene",
                "redraw",
                "groups",
                "agents",
                "models",
                "timing",
                "weather",
            ]) || is_in(&["traffic", "walkers", "lights", "hazards"])
        }
        "simulate-and-log" => {
            is_in(&["traffic", "walkers", "lights", "hazards", "world", "annotation", "bev"]) || is_grid
        }
        "render-sensors" => section == "seed" || (is_rig && (!is_grid || is_own)),
        "bev-gt" => is_in(&["bev", "timing"]),
        "occupancy-gt" => is_grid,
        "postprocess-valid" => section == "annotation" || is_rig,
        "merge-tracks" => section == "tracks",
        "stats" => is_in(&["name", "card", "seed", "annotation", "bev"]) || is_rig,
        // A new stage is told all that changed.
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use settings::{DatasetSettings, OwnRig, key_changes};

    use super::*;
    use crate::graph::Graph;
    use crate::views::example_settings;

    /// A stage that `sees` does not know is told every key.
    #[test]
    fn every_stage_is_told_its_own_keys() {
        for spec in &Graph::get().stages {
            assert!(!sees(spec.name, "no_key"), "name {}'s keys in `sees`", spec.name);
        }
    }

    /// A change that makes a stage stale is told.
    #[test]
    fn stages_are_told_the_keys_that_they_see() {
        let mut base = example_settings();
        let (rig, occupancy) = (base.scenario.vehicle_rig.clone(), base.scenario.vehicle_occupancy.clone());
        let own = OwnRig { agents: vec!["vehicle_1".into()], rig, occupancy };
        base.scenario.own_rigs.push(own.clone());
        let json = |settings: &DatasetSettings| serde_json::to_value(settings).expect("is JSON");
        let changes: [fn(&mut DatasetSettings); 22] = [
            |s| s.scenario.vehicle_rig.lidars[0].noise_m = 0.5,
            |s| s.scenario.own_rigs[0].rig.lidars[0].noise_m = 0.5,
            |s| s.scenario.own_rigs[0].occupancy.voxel_m = 0.5,
            |s| s.scenario.own_rigs[0].agents = vec!["vehicle_0".into()],
            |s| s.scenario.own_rigs.clear(),
            |s| s.scenario.rsu_rig.camera.jpeg_quality = 17,
            |s| s.scenario.rsu_rig.lidars.clear(),
            |s| s.scenario.vehicle_occupancy.range_m = 200.0,
            |s| s.scenario.rsu_occupancy.observed = true,
            |s| s.bev.cells = 2000,
            |s| s.tracks.future_s = 3.0,
            |s| s.scenario.timing.warmup_s = 3.0,
            |s| s.name = "other".into(),
            |s| s.card.licence = "CC-BY-4.0".into(),
            |s| s.annotation.valid_by_image ^= true,
            |s| s.annotation.box_radius_m = 90.0,
            |s| s.world.radius_m = 900.0,
            |s| s.world.scenery.tree_density = 0.1,
            |s| s.seed = 3,
            |s| s.scenario.traffic.door_open = 0.5,
            |s| s.scenes.clear(),
            |s| s.redraw.push((0, 1)),
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let mut other = base.clone();
            change(&mut other);
            let keys = key_changes(&json(&base), &json(&other));
            assert!(!keys.is_empty(), "change {number} changes nothing");
            for spec in &Graph::get().stages {
                let scope = match spec.unit {
                    UnitKind::Plan => Scope::Plan,
                    UnitKind::Scene => Scope::Scene(0),
                    UnitKind::Stats => Scope::Stats,
                };
                let hash = |settings| {
                    config_hash(spec, &Editions::only(settings), scope).expect("every stage has a view")
                };
                let is_told = keys.iter().any(|change| sees(spec.name, &change.key));
                assert!(is_told || hash(&base) == hash(&other), "{}: {keys:?}", spec.name);
            }
        }
        assert!(!sees("bev-gt", "vehicle.lidars[LIDAR].noise_m"));
        assert!(!sees("render-sensors", "vehicle.occupancy.voxel_m"));
    }
}
