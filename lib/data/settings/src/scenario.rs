//! What a group of scenes may have of its own.

use crate::agents::AgentSettings;
use crate::hazards::HazardSettings;
use crate::key::settings;
use crate::lights::LightSettings;
use crate::occupancy::OccupancySettings;
use crate::per_agent::PerAgent;
use crate::reader::Section;
use crate::rig::{OwnRig, Rig};
use crate::rig_keys;
use crate::timing::TimingSettings;
use crate::traffic::TrafficSettings;
use crate::walkers::WalkerSettings;
use crate::weather::WeatherSettings;

settings! {
    /// Who drives where, for how long, in which weather, with which sensors: what groups of scenes may have
    /// of their own.
    pub struct Scenario {
        /// Data-collection vehicles and RSUs.
        agents: AgentSettings = AgentSettings::default(), table();
        /// Warm-up and durations.
        timing: TimingSettings = TimingSettings::default(), table();
        /// Background vehicles and drivers.
        traffic: TrafficSettings = TrafficSettings::default(), table();
        /// Pedestrians.
        walkers: WalkerSettings = WalkerSettings::default(), table();
        /// Weather draws and overrides.
        weather: WeatherSettings = WeatherSettings::default(), table();
        /// Street lamps and lit windows at night.
        lights: LightSettings = LightSettings::default(), table();
        /// Accidents and road works.
        hazards: HazardSettings = HazardSettings::default(), table();
        /// Sensors of every data-collection vehicle.
        vehicle_rig: Rig = Rig::vehicle(), named("vehicle"), by(rig_keys::rig);
        /// Sensors of every RSU.
        rsu_rig: Rig = Rig::rsu(), named("rsu"), by(rig_keys::rig);
        /// Agents with sensors and voxel grid of their own; besides `agents` all keys of `vehicle` or `rsu`,
        /// with the same defaults.
        own_rigs: Vec<OwnRig> = Vec::new(), named("rigs"), by(rig_keys::own);
        /// Voxel grids of vehicles.
        vehicle_occupancy: OccupancySettings = OccupancySettings::default(), named("vehicle"), by(rig_keys::grid);
        /// Voxel grids of RSUs.
        rsu_occupancy: OccupancySettings = OccupancySettings::default(), named("rsu"), by(rig_keys::grid);
    }
    rule consistent;
}

/// What keys of several tables must be together.
fn consistent(section: &Section<'_>, settings: &Scenario) {
    check_observers(section, settings);
    if settings.agents.penetration.is_some() && settings.traffic.vehicles.is_none() {
        section.fault_at(
            "agents",
            "`agents.penetration` is a share of `traffic.vehicles`: say how many vehicles there are".into(),
        );
    }
}

fn check_observers(section: &Section<'_>, settings: &Scenario) {
    let check = rig_keys::check_observers;
    check(&section.section("vehicle", ""), &settings.vehicle_rig, &settings.vehicle_occupancy);
    check(&section.section("rsu", ""), &settings.rsu_rig, &settings.rsu_occupancy);
    let own = section.sections("rigs", "", "").unwrap_or_default();
    for (section, own) in own.iter().zip(&settings.own_rigs) {
        check(section, &own.rig, &own.occupancy);
    }
}

/// Refuses models of data-collection vehicles that nobody knows, where there are no packs.
pub(crate) fn known_models(section: &Section<'_>, settings: &AgentSettings) {
    for model in &settings.vehicle_models {
        if catalogue::models::find(model).is_none_or(|m| m.wheelbase_m <= 0.0) {
            let problem = format!("`agents.vehicle_models`: no vehicle model `{model}`");
            section.section("agents", "").fault_at("vehicle_models", problem);
        }
    }
}

impl Scenario {
    /// Sensors of each agent.
    #[must_use]
    pub fn rigs(&self) -> PerAgent<Rig> {
        let own = self.own_rigs.iter().map(|own| (own.agents.clone(), own.rig.clone()));
        PerAgent { vehicle: self.vehicle_rig.clone(), rsu: self.rsu_rig.clone(), own: own.collect() }
    }

    /// Voxel grid of each agent.
    #[must_use]
    pub fn occupancy(&self) -> PerAgent<OccupancySettings> {
        let own = self.own_rigs.iter().map(|own| (own.agents.clone(), own.occupancy.clone()));
        PerAgent {
            vehicle: self.vehicle_occupancy.clone(),
            rsu: self.rsu_occupancy.clone(),
            own: own.collect(),
        }
    }
}
