//! Rows of the scene log.

use frames::{Object, Pose, World};
use schema::ObjectId;
use schema::scene_info::DriverInfo;
use schema::tables::{ActorRow, PlanAgentRow, Weather};
use schema::{ActorKind, ActorRole, Attribute, Attributes, Tag, lights};

use crate::input::SimulationLog;
use crate::road::net::Net;
use crate::road::sides::Side;
use crate::scene::placing::ActorIds;
use crate::scene::rows::{actor_lamps, moving};
use crate::scene::spawn::Start;
use crate::vehicle::Vehicle;
use crate::vehicle::lateral::LaneChange;
use crate::walking::walker::Walker;

/// Blinkers go on this far before a junction, metres.
const BLINK_M: f64 = 15.0;
/// Size of an RSU's body, metres.
const RSU_SIZE_M: [f64; 3] = [0.3, 0.3, 3.4];

fn vehicle_actor(id: ObjectId, start: &Start) -> ActorRow {
    let pose = Pose::from_xyz_rpy(start.point.coords.into(), [0.0, 0.0, start.yaw_rad]);
    let facts = start
        .model
        .facts()
        .with(Attribute::Reckless, start.driver.reckless)
        .with(Attribute::Distracted, start.driver.distracted);
    moving(id, ActorKind::Vehicle, start.role, start.model, &start.color, &pose, facts)
}

fn walker_actor(id: ObjectId, walker: &Walker, crosses_anywhere: bool) -> ActorRow {
    let pose = walker.world_from_object();
    let mut facts = walker
        .model()
        .facts()
        .with(Attribute::CrossesAnywhere, crosses_anywhere)
        .with(Attribute::Speed, format_args!("{:.3}", walker.wished_speed_mps()));
    if walker.seat_m() > 0.0 {
        facts.say(Attribute::SitsOnBench, true);
    }
    moving(id, ActorKind::Walker, ActorRole::Walker, walker.model(), &walker.color(), &pose, facts)
}

fn rsu_actor(id: ObjectId, agent: &PlanAgentRow) -> ActorRow {
    let pose = Pose::<World, Object>::from_xyz_rpy(agent.xyz_m, agent.rpy_rad);
    ActorRow {
        id,
        kind: ActorKind::Rsu,
        model: agent.model.clone(),
        role: ActorRole::Agent(agent.agent),
        semantic_tags: [Tag::Pole, Tag::Static].map(|tag| tag as u8).to_vec(),
        length_m: RSU_SIZE_M[0],
        width_m: RSU_SIZE_M[1],
        height_m: RSU_SIZE_M[2],
        color: agent.color.clone(),
        fixed: true,
        xyz_m: pose.xyz(),
        quaternion: pose.wxyz(),
        variant: 0,
        parent: None,
        opendrive_id: agent.signal.clone(),
        attributes: Attributes::new(),
    }
}

/// Adds agents, RSUs and background vehicles to the log, and the drivers of the last ones.
pub(crate) fn log_vehicles(
    log: &mut SimulationLog,
    ids: &ActorIds,
    starts: &[Start],
    rsus: &[&PlanAgentRow],
) {
    let (agents, background) = starts.split_at(ids.agents.len());
    log.actors.extend(ids.agents.iter().zip(agents).map(|(id, start)| vehicle_actor(*id, start)));
    log.actors.extend(ids.rsus.iter().zip(rsus).map(|(id, agent)| rsu_actor(*id, agent)));
    for (id, start) in ids.background.iter().zip(background) {
        log.actors.push(vehicle_actor(*id, start));
        log.n_vehicles += 1;
        log.n_reckless += u32::from(start.driver.reckless);
        log.n_distracted += u32::from(start.driver.distracted);
        log.drivers.push(DriverInfo {
            id: *id,
            speed_difference: start.driver.speed_difference,
            standstill_gap_m: start.driver.idm.standstill_gap_m,
            reckless: start.driver.reckless,
            distracted: start.driver.distracted,
        });
    }
}

/// Adds what background vehicles tow to the log, each attached to the one that tows it.
pub(crate) fn log_towed(log: &mut SimulationLog, ids: &ActorIds, starts: &[Start]) {
    let mut own = ids.towed.iter();
    for (lead, start) in ids.agents.iter().chain(&ids.background).zip(starts) {
        let Some(towed) = &start.towed else { continue };
        let Some(id) = own.next() else { return };
        let pose = Pose::from_xyz_rpy(towed.point.coords.into(), [0.0, 0.0, towed.yaw_rad]);
        let model = towed.train.towed;
        let row = moving(*id, ActorKind::Vehicle, start.role, model, &towed.color, &pose, model.facts());
        log.actors.push(ActorRow { parent: Some(i32::from(*lead)), ..row });
    }
}

/// Adds walkers, each given with whether it crosses roads anywhere, to the log.
pub(crate) fn log_walkers(log: &mut SimulationLog, ids: &ActorIds, walkers: &[(Walker, bool)]) {
    for ((walker, anywhere), id) in walkers.iter().zip(&ids.walkers) {
        log.actors.push(walker_actor(*id, walker, *anywhere));
        log.n_walkers += 1;
    }
}

/// Lamps that the weather and the time of day ask for.
pub(crate) fn weather_lamps(weather: &Weather) -> u32 {
    let mut lamps = 0;
    if weather.sun_altitude_deg < 35.0 {
        lamps |= lights::POSITION;
    }
    if weather.sun_altitude_deg < 15.0 || weather.precipitation > 80.0 {
        lamps |= lights::POSITION | lights::LOW_BEAM;
    }
    if weather.fog_density > 20.0 {
        lamps |= lights::POSITION | lights::LOW_BEAM | lights::FOG;
    }
    lamps
}

/// Lamps of a vehicle: those of the weather, brake lamps, blinkers before and in junctions, flashing lights.
pub(crate) fn vehicle_lamps(net: &Net, vehicle: &Vehicle, weather: u32) -> u32 {
    let mut lamps = actor_lamps(weather, vehicle.motion().acceleration_mps2(), vehicle.speed_mps());
    if vehicle.flashes() {
        lamps |= lights::EMERGENCY;
    }
    let side = |side: Side| if side == Side::Left { lights::BLINK_LEFT } else { lights::BLINK_RIGHT };
    let meant = vehicle.lateral().change().map(LaneChange::side).or_else(|| vehicle.asked_side(net));
    if let Some(meant) = meant {
        return lamps | side(meant);
    }
    let mut turn = 0;
    for (lane, start) in vehicle.lanes_ahead(net) {
        if start - vehicle.half_length_m() > BLINK_M {
            break;
        }
        turn = net.lanes[lane].turn;
        if net.lanes[lane].junction.is_some() {
            break;
        }
    }
    match turn {
        1 => lamps | lights::BLINK_LEFT,
        -1 => lamps | lights::BLINK_RIGHT,
        _ => lamps,
    }
}
