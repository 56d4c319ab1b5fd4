//! What the plan says of a scene.

use runner::{At, Job, StageError};
use schema::table::Row;
use schema::tables::{
    PlanAgentRow, PlanHazardRow, PlanModelRow, PlanRouteRow, PlanSceneRow, PlanTrajectoryRow, PlanWeatherRow,
};
use settings::stages::SimulationSettings;
use store::keys;

use crate::error::LogError;

/// A scene's part of the plan.
pub(crate) struct ScenePlan {
    pub(crate) scene: PlanSceneRow,
    pub(crate) agents: Vec<PlanAgentRow>,
    pub(crate) hazards: Vec<PlanHazardRow>,
    /// Keyframes of its weather, by time.
    pub(crate) weather: Vec<PlanWeatherRow>,
    /// Places on routes that the user gave, by agent.
    pub(crate) routes: Vec<PlanRouteRow>,
    /// Actors on trajectories that the user gave.
    pub(crate) trajectories: Vec<PlanTrajectoryRow>,
    /// The models of packs, of all scenes.
    pub(crate) models: Vec<PlanModelRow>,
}

impl ScenePlan {
    /// Reads the plan of a job's scene.
    ///
    /// # Errors
    /// The plan is missing or broken.
    pub(crate) fn read(job: &Job<'_, SimulationSettings>) -> Result<Self, StageError> {
        let (store, manifest, number) = (job.store(), job.input(PlanSceneRow::STAGE)?, job.scene());
        let rows: Vec<PlanSceneRow> = store.read_rows(manifest, keys::PLAN_SCENES)?;
        let scene = rows.into_iter().find(|r| r.scene == number).ok_or(LogError::NotPlanned);
        let scene = scene.at(|| job.place().in_file(store.location(keys::PLAN_SCENES)))?;
        let mut agents: Vec<PlanAgentRow> = store.read_rows(manifest, keys::PLAN_AGENTS)?;
        agents.retain(|a| a.scene == number);
        let mut hazards: Vec<PlanHazardRow> = store.read_rows(manifest, keys::PLAN_HAZARDS)?;
        hazards.retain(|h| h.scene == number);
        let mut weather: Vec<PlanWeatherRow> = store.read_optional_rows(manifest, keys::PLAN_WEATHER)?;
        weather.retain(|w| w.scene == number);
        let mut routes: Vec<PlanRouteRow> = store.read_optional_rows(manifest, keys::PLAN_ROUTES)?;
        routes.retain(|r| r.scene == number);
        // Of all scenes they may be many.
        let mut trajectories: Vec<PlanTrajectoryRow> = Vec::new();
        if manifest.output(keys::PLAN_TRAJECTORIES).is_some() {
            for group in store.row_groups::<PlanTrajectoryRow>(manifest, keys::PLAN_TRAJECTORIES)? {
                trajectories.extend(group?.into_iter().filter(|row| row.scene == number));
            }
        }
        let models = store.read_optional_rows(manifest, keys::PLAN_MODELS)?;
        Ok(Self { scene, agents, hazards, weather, routes, trajectories, models })
    }
}
