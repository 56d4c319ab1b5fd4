//! Actors on trajectories that a user gave: checked, and put on the roads.

use std::collections::BTreeMap;

use catalogue::{BaseType, Catalogue};
use frames::math::sin_cos;
use nalgebra::Point3;
use opendrive::Map;
use schema::tables::PlanTrajectoryRow;
use schema::{AgentId, AgentKind, FRAME_PERIOD_S};
use settings::AgentSettings;

use crate::PlanError;
use crate::pool::{SpawnPoint, SpawnPool};

/// Fastest motion that is believed, m/s: of vehicles, and of people.
const FASTEST_MPS: [f64; 2] = [100.0, 15.0];
/// Maps extend no farther than this from their origin, metres.
const FARTHEST_M: f64 = 1e6;
/// Most that a velocity changes from one frame to the next, m/s: positions are noisy by decimetres at most.
const JERKY_MPS: f64 = 5.0;
/// Most that a heading changes from one frame to the next, radians: of vehicles, and of people.
const TURN_RAD: [f64; 2] = [0.4, 1.6];
/// A lane is under an actor whose height is not given if it lies within this distance of its middle, metres:
/// half the width of the widest.
const LANE_REACH_M: f64 = 12.0;
/// Beside the lanes their height holds so far, metres.
const BESIDE_M: f64 = 2.0;
/// Rounds in which the height settles.
const ROUNDS: usize = 4;

/// An actor's poses, as a file gives them.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// The scene that it is in; all scenes where nothing is said.
    pub scene: Option<u32>,
    /// `vehicle_0`, ... of a data-collection vehicle; any other name of any other actor.
    pub actor: String,
    /// Model of its body.
    pub model: Option<String>,
    /// Frame of the first pose; the others follow frame by frame.
    pub first_frame: i32,
    /// The poses.
    pub poses: Vec<TrackPose>,
}

/// A pose of a track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackPose {
    /// Centre of the footprint in the world, metres.
    pub xy_m: [f64; 2],
    /// Height of the ground there, metres; that of the road where nothing is said.
    pub z_m: Option<f64>,
    /// Heading from east, counter-clockwise, radians.
    pub yaw_rad: f64,
    /// Roll, radians; that of the road where nothing is said.
    pub roll_rad: Option<f64>,
    /// Pitch, radians; that of the road where nothing is said.
    pub pitch_rad: Option<f64>,
}

/// Tracks by the name of their file, as configurations write it.
pub type TrackFiles = BTreeMap<String, Vec<Track>>;

/// What tracks of a scene are planned by.
pub(crate) struct TrackScene<'a> {
    pub(crate) file: &'a str,
    pub(crate) scene: u32,
    pub(crate) frames: u32,
    pub(crate) map: &'a Map,
    pub(crate) pool: &'a SpawnPool,
    pub(crate) settings: &'a AgentSettings,
    pub(crate) catalogue: &'a Catalogue,
}

impl TrackScene<'_> {
    fn fault(&self, track: &Track, frame: Option<i32>, problem: String) -> PlanError {
        let frame = frame.map_or(String::new(), |frame| format!(", frame {frame}"));
        PlanError::Trajectory {
            file: self.file.to_owned(),
            place: format!("scene {}, actor `{}`{frame}", self.scene, track.actor),
            problem,
        }
    }

    /// Rows of the tracks of the scene, data-collection vehicles first, then by name.
    ///
    /// # Errors
    /// A track is not one that an actor can be on.
    pub(crate) fn plan(&self, tracks: &[Track]) -> Result<Vec<Vec<PlanTrajectoryRow>>, PlanError> {
        let mut own: Vec<(Option<AgentId>, &Track)> = Vec::new();
        for track in tracks.iter().filter(|t| t.scene.is_none_or(|scene| scene == self.scene)) {
            let agent: Option<AgentId> = track.actor.parse().ok();
            let lower = track.actor.to_lowercase();
            let is_like_one = ["vehicle_", "rsu_"].iter().any(|prefix| lower.starts_with(prefix));
            if is_like_one && agent.is_none_or(|agent| agent.to_string() != track.actor) {
                let problem =
                    "is no agent's name, and looks like one: agents are vehicle_0, vehicle_1, ...".to_owned();
                return Err(self.fault(track, None, problem));
            }
            own.push((agent, track));
        }
        own.sort_by_key(|(agent, track)| (agent.is_none(), *agent, &track.actor));
        own.into_iter().map(|(agent, track)| self.rows(agent, track)).collect()
    }

    fn rows(&self, agent: Option<AgentId>, track: &Track) -> Result<Vec<PlanTrajectoryRow>, PlanError> {
        let (model, is_vehicle) = self.model(agent, track)?;
        let last_frame = track.first_frame + track.poses.len() as i32 - 1;
        let wanted = self.frames as i32 - 1;
        if track.first_frame > 0 || last_frame < wanted {
            let seconds = f64::from(self.frames) * FRAME_PERIOD_S;
            return Err(self.fault(track, None, format!(
                "has frames {} to {last_frame}, and the scene has frames 0 to {wanted} ({seconds} s): an actor is there all \
                 the time; set `timing.min_duration_s` and `timing.max_duration_s` to what the file holds",
                track.first_frame
            )));
        }
        self.check_motion(track, is_vehicle)?;
        let mut rows = Vec::with_capacity(track.poses.len());
        let mut z_m: Option<f64> = None;
        for (k, pose) in track.poses.iter().enumerate() {
            let frame = track.first_frame + k as i32;
            let [x, y] = pose.xy_m;
            let place = match pose.z_m {
                Some(z) => {
                    let level = Placed { z_m: z, roll_pitch_rad: [0.0; 2] };
                    Placed { z_m: z, ..self.ground([x, y], Some(z), pose.yaw_rad).unwrap_or(level) }
                }
                None => self.ground([x, y], z_m, pose.yaw_rad).ok_or_else(|| {
                    let problem =
                        format!("no lane is at {x:.2}, {y:.2}: give a column `z_m`, or another place");
                    self.fault(track, Some(frame), problem)
                })?,
            };
            z_m = Some(place.z_m);
            let of_road = if is_vehicle { place.roll_pitch_rad } else { [0.0; 2] };
            let (roll, pitch) = (pose.roll_rad.unwrap_or(of_road[0]), pose.pitch_rad.unwrap_or(of_road[1]));
            rows.push(PlanTrajectoryRow {
                scene: self.scene,
                actor: track.actor.clone(),
                model: model.clone(),
                frame,
                xyz_m: [x, y, place.z_m],
                rpy_rad: [roll, pitch, frames::wrap_pi(pose.yaw_rad)],
            });
        }
        Ok(rows)
    }

    /// The model of a track's actor, and whether it is a vehicle.
    fn model(&self, agent: Option<AgentId>, track: &Track) -> Result<(String, bool), PlanError> {
        if agent.is_some_and(|agent| agent.kind == AgentKind::Rsu) {
            let problem = "RSUs stand where `agents.rsus_at` says: leave it out".to_owned();
            return Err(self.fault(track, None, problem));
        }
        let models = &self.settings.vehicle_models;
        let usual = agent.and_then(|agent| models.get(usize::from(agent.index) % models.len().max(1)));
        let Some(name) = track.model.as_ref().or(usual) else {
            let problem =
                "has no `model`: name one (docs/gallery has them all), such as car.sedan or walker.police"
                    .to_owned();
            return Err(self.fault(track, None, problem));
        };
        let unknown = || self.fault(track, None, format!("there is no model `{name}`"));
        let model = self.catalogue.find(name).ok_or_else(unknown)?;
        let is_vehicle = model.wheelbase_m > 0.0;
        if !is_vehicle && (agent.is_some() || model.base != BaseType::Pedestrian) {
            let problem = match agent {
                Some(_) => format!("collects data, and its model `{name}` is no vehicle"),
                None => format!("its model `{name}` is neither a vehicle nor a person"),
            };
            return Err(self.fault(track, None, problem));
        }
        Ok((name.clone(), is_vehicle))
    }

    /// Looks for motion that is none.
    fn check_motion(&self, track: &Track, is_vehicle: bool) -> Result<(), PlanError> {
        let kind = usize::from(!is_vehicle);
        let numbers = |pose: &TrackPose| {
            let [z, roll, pitch] = [pose.z_m, pose.roll_rad, pose.pitch_rad].map(Option::unwrap_or_default);
            [pose.xy_m[0], pose.xy_m[1], z, pose.yaw_rad, roll, pitch]
        };
        let frame = |k: usize| track.first_frame + k as i32;
        if let Some(k) = track.poses.iter().position(|pose| !numbers(pose).iter().all(|n| n.is_finite())) {
            return Err(self.fault(track, Some(frame(k)), "a number is missing or not finite".into()));
        }
        let is_far = |pose: &TrackPose| numbers(pose)[..3].iter().any(|m| m.abs() > FARTHEST_M);
        if let Some(k) = track.poses.iter().position(is_far) {
            let [x, y] = track.poses[k].xy_m;
            let problem = format!("is at {x:.0}, {y:.0}, off every map: positions are in the map's frame");
            return Err(self.fault(track, Some(frame(k)), problem));
        }
        let mut before: Option<[f64; 2]> = None;
        for (k, pair) in track.poses.windows(2).enumerate() {
            let moved = [0, 1].map(|axis| pair[1].xy_m[axis] - pair[0].xy_m[axis]);
            let velocity = moved.map(|m| m / FRAME_PERIOD_S);
            let norm = |v: [f64; 2]| (v[0] * v[0] + v[1] * v[1]).sqrt();
            let change = before.map_or(0.0, |b| norm([velocity[0] - b[0], velocity[1] - b[1]]));
            let climbed_m = pair[1].z_m.unwrap_or_default() - pair[0].z_m.unwrap_or_default();
            if norm(velocity) > FASTEST_MPS[kind] || change > JERKY_MPS || climbed_m.abs() > 0.5 * JERKY_MPS {
                let way_m = (norm(moved) * norm(moved) + climbed_m * climbed_m).sqrt();
                return Err(self.fault(track, Some(frame(k + 1)), format!(
                    "jumps: it moves {way_m:.2} m from the frame before, at {:.0} m/s, and its velocity differs by {change:.0} m/s from that before",
                    way_m / FRAME_PERIOD_S
                )));
            }
            let turn_rad = frames::wrap_pi(pair[1].yaw_rad - pair[0].yaw_rad).abs();
            if turn_rad > TURN_RAD[kind] {
                let problem = format!(
                    "turns by {:.0} degrees from the frame before (`yaw_rad` is in radians, from east, counter-clockwise)",
                    frames::to_deg(turn_rad)
                );
                return Err(self.fault(track, Some(frame(k + 1)), problem));
            }
            before = Some(velocity);
        }
        Ok(())
    }

    /// The road under a place: on the level of the place before, or else on that of the nearest spawn point.
    fn ground(&self, [x, y]: [f64; 2], before_m: Option<f64>, yaw_rad: f64) -> Option<Placed> {
        let away = |point: &&SpawnPoint| {
            let (dx, dy) = (point.xyz_m.x - x, point.xyz_m.y - y);
            dx * dx + dy * dy
        };
        let nearest = || self.pool.points.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let mut z_m = before_m.or_else(|| nearest().map(|point| point.xyz_m.z))?;
        let mut found = None;
        for _ in 0..ROUNDS {
            let at = Point3::new(x, y, z_m);
            let hits = match self.map.lanes_within(at, LANE_REACH_M, |_| true) {
                hits if hits.is_empty() => self.map.nearest_lane(at, |_| true).into_iter().collect(),
                hits => hits,
            };
            let beside_m = |hit: &opendrive::LaneHit| hit.t_m.abs() - 0.5 * hit.width_m;
            let hit = hits.iter().find(|hit| hit.is_inside()).or_else(|| {
                hits.iter()
                    .min_by(|a, b| beside_m(a).total_cmp(&beside_m(b)))
                    .filter(|hit| beside_m(hit) < BESIDE_M)
            })?;
            let point = self.map.lane_point(hit.lane, hit.s, hit.t_m)?;
            let (sin, cos) = sin_cos(yaw_rad - point.heading_rad);
            let pitch = point.pitch_rad * cos - point.roll_rad * sin;
            let roll = point.roll_rad * cos + point.pitch_rad * sin;
            z_m = point.position.z;
            found = Some(Placed { z_m, roll_pitch_rad: [roll, pitch] });
        }
        found
    }
}

/// Where a road is under a place.
#[derive(Clone, Copy)]
struct Placed {
    z_m: f64,
    roll_pitch_rad: [f64; 2],
}

/// The place where the vehicle of some rows starts.
pub(crate) fn start_of(rows: &[PlanTrajectoryRow]) -> Option<SpawnPoint> {
    let row = rows.iter().find(|row| row.frame == 0)?;
    Some(SpawnPoint { pos: opendrive::LanePos::default(), xyz_m: row.xyz_m.into(), rpy_rad: row.rpy_rad })
}
