//! The simulation stage: from a scene's plan to its log, the raw boxes and the HD-map records.

mod error;
mod gait;
mod ground;
mod info;
mod labels;
mod lamps;
mod plan;
mod signals;
mod world;

use std::ffi::OsString;
use std::ops::ControlFlow;
use std::process::ExitCode;

use catalogue::Catalogue;
use random::Stream;
use replay::tiles::TileStore;
use runner::{At, Job, Place, Progress, Stage, StageError};
use schema::tables::{PlanSceneRow, TILE_STAGE};
use schema::{ActorKind, Attribute, ObjectId};
use settings::stages::SimulationSettings;
use store::keys;
use traffic::{SceneInput, SimulationLog};

use crate::error::LogError;
use crate::gait::Bodies;
use crate::labels::Labels;
use crate::plan::ScenePlan;
use crate::world::{Nearby, SceneTiles, failed};

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<SimulationSettings> = Stage::new(run);

/// Looks that moving actors of one model share among them (clothes, skin, hair): each is a mesh of its own.
const VARIANTS: u32 = meshes::people::APPEARANCES;

fn run(job: &mut Job<'_, SimulationSettings>) -> Result<(), StageError> {
    let ScenePlan { scene: plan, agents, hazards, weather, routes, trajectories, models } =
        ScenePlan::read(job)?;
    let catalogue = Catalogue::with(&models);
    let map = replay::maps::read(job.store(), &plan.map, &plan.map_hash).at(|| job.place())?;
    let (settings, store) = (job.settings().clone(), job.store().clone());
    let scene = job.scene();

    let (progress, place) = (job.progress(), job.place());
    let Some(mut unit) = job.unit("scene")? else { return Ok(()) };
    let code_version = runner::code_version(TILE_STAGE);
    let tiles = TileStore::new(&store, (&map, &plan.map_hash), (&settings.scenery, &catalogue), code_version);
    let tiles = tiles.map_err(|error| failed(error, &place))?.remarking(job.made_by().clone());
    let nearby = Nearby::new(&tiles, settings.reach_m);
    let simulated = simulate(
        &SceneInput {
            map: &map,
            catalogue: &catalogue,
            scene: &plan,
            agents: &agents,
            hazards: &hazards,
            weather: &weather,
            routes: &routes,
            trajectories: &trajectories,
            settings: &settings,
            fixed: &nearby,
            first_id: 1,
        },
        &progress,
    );
    if let Some(error) = nearby.into_error() {
        return Err(failed(error, &place));
    }
    let mut log = simulated?;
    say_what_lacks(&plan, &log);
    let mut bodies = Bodies::new(&store, &models, &log.actors).at(|| place.clone())?;
    for actor in &mut log.actors {
        let mut draw = Stream::new(plan.seed, scene.into(), "simulate/variant", actor.id.into());
        actor.variant = draw.next_u32() % VARIANTS;
        if actor.kind == ActorKind::Walker
            && let Some(model) = catalogue.find(&actor.model)
        {
            if actor.attributes.is_true(&Attribute::SitsOnBench) {
                actor.variant = gait::seated_variant(model, actor.variant);
            }
            actor.attributes.say(Attribute::Gender, model.gender(actor.variant));
            bodies.add(actor, model, plan.seed, scene);
        }
    }
    bodies.seat(&mut log.states);
    let mut world = SceneTiles::of(&tiles, &log, settings.reach_m, &place)?;
    log.signals = world.signals(&log.signals);
    let lamps = lamps::draw(&mut world.actors, &plan, &settings.lights);
    let mut actors = log.actors.clone();
    actors.append(&mut world.actors);
    signals::describe(&map, &log.signal_groups, &settings.traffic, &mut actors);
    check_ids(&actors.iter().map(|a| a.id).collect::<Vec<_>>()).at(|| place.clone())?;
    ground::stand(tiles.surfaces_of(world.indices()), &mut actors, &mut log.states)
        .map_err(|error| failed(error, &place))?;
    bodies.walk(&mut log.states);

    let mut info = info::scene_info((&plan, &weather), &agents, &log, &map, &settings)?;
    info.models = info::models(&models, &actors);
    let labels = Labels::collect(&map, &actors, &log, &info, settings.box_radius_m)?;
    let json = serde_json::to_vec_pretty(&info).at(|| place.clone())?;
    let key = |name: &str| keys::scene(scene, name);
    unit.bytes(&key(schema::scene_info::SCENE_FILE), &json, 1)?;
    unit.put(scene, &actors)?;
    unit.put(scene, &world.rows)?;
    unit.put(scene, &log.states)?;
    unit.put(scene, &log.frames)?;
    unit.put(scene, &log.signals)?;
    unit.put(scene, &lamps)?;
    unit.put(scene, &labels.agents)?;
    unit.put(scene, &labels.boxes)?;
    unit.put(scene, &labels.hd_map)?;
    unit.rows(&keys::partial_stats(scene, Stage::<SimulationSettings>::NAME), &labels.counts)?;
    unit.finish()?;
    Ok(())
}

/// Warns where fewer background actors found room than were asked for.
fn say_what_lacks(plan: &PlanSceneRow, log: &SimulationLog) {
    let vehicles = plan.background_vehicles.and_then(|wanted| u32::try_from(wanted).ok());
    for (wanted, placed, what) in
        [(vehicles, log.n_vehicles, "background vehicles"), (Some(plan.walkers), log.n_walkers, "walkers")]
    {
        if let Some(wanted) = wanted.filter(|wanted| *wanted > placed) {
            let (scene, map) = (plan.scene, &plan.map);
            let radius_m = plan.spawn_radius_m;
            tracing::warn!(
                "scene {scene} ({map}): {placed} of {wanted} {what} placed: within {radius_m:.0} m of the vehicles' start there is no more room"
            );
        }
    }
}

fn simulate(input: &SceneInput<'_>, progress: &Progress) -> Result<SimulationLog, StageError> {
    let mut stopped = None;
    let mut told = 0;
    let outcome = traffic::simulate(input, &mut |done, total| {
        progress.set_total(total as u64);
        let step = done.saturating_sub(told) as u64;
        told = done;
        match progress.advance(step) {
            Ok(()) => ControlFlow::Continue(()),
            Err(e) => {
                stopped = Some(e);
                ControlFlow::Break(())
            }
        }
    });
    match (stopped, outcome) {
        (Some(stop), _) => Err(stop),
        (None, outcome) => outcome.at(Place::default),
    }
}

/// Ids must be 1, 2, 3, ...: one number per object, never reused.
fn check_ids(ids: &[ObjectId]) -> Result<(), LogError> {
    match ids.iter().enumerate().find(|(i, id)| usize::from(**id) != i + 1) {
        Some((i, id)) => Err(LogError::Ids { number: i + 1, id: *id }),
        None => Ok(()),
    }
}
