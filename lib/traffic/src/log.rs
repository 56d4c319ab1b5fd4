//! Rows of the scene log.

use frames::{Object, Pose, World};
use schema::ObjectId;
use schema::lights;
use schema::models::Model;
use schema::tables::{ActorRow, PlanAgentRow, StateRow, Weather};

use crate::net::Net;
use crate::spawn::{Start, tags};
use crate::vehicles::Vehicle;
use crate::walkers::Walker;

/// Braking above this lights the brake lamps, m/s2.
const BRAKE_LAMP_MPS2: f64 = 1.0;
/// Blinkers go on this far before a junction, metres.
const BLINK_M: f64 = 15.0;
/// Size of an RSU's body, metres.
const RSU_SIZE_M: [f64; 3] = [0.3, 0.3, 3.4];

/// A JSON object of strings; keys and values are plain words.
fn attributes(pairs: &[(&str, &str)]) -> String {
    let members: Vec<String> = pairs.iter().map(|(key, value)| format!("\"{key}\":\"{value}\"")).collect();
    format!("{{{}}}", members.join(","))
}

fn moving(
    id: ObjectId,
    kind: &str,
    role: &str,
    model: &Model,
    color: &[u8],
    pose: &Pose<World, Object>,
) -> ActorRow {
    ActorRow {
        id,
        kind: kind.into(),
        model: model.name.into(),
        role: role.into(),
        semantic_tags: tags(model.base),
        length_m: model.size_m[0],
        width_m: model.size_m[1],
        height_m: model.size_m[2],
        color: color.to_vec(),
        fixed: false,
        xyz_m: pose.xyz(),
        quaternion: pose.wxyz(),
        variant: 0,
        parent: None,
        opendrive_id: None,
        attributes: String::new(),
    }
}

pub(crate) fn vehicle_actor(id: ObjectId, start: &Start) -> ActorRow {
    let pose = Pose::from_xyz_rpy(start.point.coords.into(), [0.0, 0.0, start.yaw_rad]);
    let word = |b: bool| if b { "true" } else { "false" };
    let facts = attributes(&[
        ("base_type", start.model.base.name()),
        ("special_type", start.model.special),
        ("reckless", word(start.driver.reckless)),
        ("distracted", word(start.driver.distracted)),
    ]);
    ActorRow { attributes: facts, ..moving(id, "vehicle", &start.role, start.model, &start.color, &pose) }
}

pub(crate) fn walker_actor(id: ObjectId, walker: &Walker, crosses_anywhere: bool) -> ActorRow {
    let pose = Pose::from_xyz_rpy(walker.point.coords.into(), [0.0, 0.0, walker.yaw_rad]);
    let facts = attributes(&[("crosses_anywhere", if crosses_anywhere { "true" } else { "false" })]);
    ActorRow { attributes: facts, ..moving(id, "walker", "walker", walker.model, &walker.color, &pose) }
}

pub(crate) fn rsu_actor(id: ObjectId, agent: &PlanAgentRow) -> ActorRow {
    let pose = Pose::<World, Object>::from_xyz_rpy(agent.xyz_m, agent.rpy_rad);
    ActorRow {
        id,
        kind: "rsu".into(),
        model: agent.model.clone(),
        role: agent.agent.clone(),
        semantic_tags: vec![schema::Tag::Pole as u8],
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
        attributes: attributes(&[]),
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
pub(crate) fn vehicle_lamps(net: &Net, vehicle: &Vehicle, weather: u32, emergency: bool) -> u32 {
    let mut lamps = weather;
    if vehicle.acceleration_mps2 < -BRAKE_LAMP_MPS2 || vehicle.speed_mps < 0.05 {
        lamps |= lights::BRAKE;
    }
    if emergency {
        lamps |= lights::EMERGENCY;
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

/// State of one object, from its pose now and one step before.
pub(crate) struct Snapshot {
    pub(crate) id: ObjectId,
    pub(crate) xyz_m: [f64; 3],
    pub(crate) rpy_rad: [f64; 3],
    pub(crate) velocity_mps: [f64; 3],
    pub(crate) yaw_rate_radps: f64,
    pub(crate) steer_rad: f64,
    pub(crate) phase_rad: f64,
    pub(crate) lights: u32,
}

impl Snapshot {
    pub(crate) fn row(&self, frame: i32) -> StateRow {
        let pose = Pose::<World, Object>::from_xyz_rpy(self.xyz_m, self.rpy_rad);
        StateRow {
            frame,
            id: self.id,
            xyz_m: self.xyz_m,
            quaternion: pose.wxyz(),
            velocity_mps: self.velocity_mps.map(|v| v as f32),
            angular_velocity_radps: [0.0, 0.0, self.yaw_rate_radps as f32],
            steer_rad: self.steer_rad as f32,
            phase_rad: self.phase_rad as f32,
            lights: self.lights,
        }
    }
}
