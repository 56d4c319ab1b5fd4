//! One agent and all that it carries.

use rayon::prelude::*;
use render::Renderer;
use replay::Replay;
use runner::{At, Place, StageError};
use schema::ObjectId;
use schema::geometry::Snapshot;
use sensors::{AgentState, Cameras, Motion, Observation, Radars, SharedBeams};
use shading::{FrameWeather, Painter, StillWorld};

use crate::recorder::{Channel, Channels};

/// Everything within this distance is handed to the sensors: scenery reaches no further, lidars see less.
pub(crate) const SIGHT_M: f64 = 1000.0;

/// Static objects in a scene, for painters.
pub(crate) struct StaticWorld<'a>(pub(crate) &'a Replay);

impl StillWorld for StaticWorld<'_> {
    fn around(&self, centre_world_m: [f64; 3], nearer_m: f64, detail_m: f64) -> Snapshot {
        self.0.still(centre_world_m, SIGHT_M, nearer_m, detail_m)
    }

    fn moves(&self, object: ObjectId) -> bool {
        self.0.moves(object)
    }
}

/// The renderers of a scene, for all agents in it.
#[derive(Clone, Copy)]
pub(crate) struct Renderers<'a> {
    pub(crate) renderer: &'a dyn Renderer,
    pub(crate) painter: &'a dyn Painter,
}

/// An agent with its cameras.
pub(crate) struct AgentRig<'a> {
    pub(crate) replay: &'a Replay,
    pub(crate) eyes: Renderers<'a>,
    /// Its place in the log's list of agents.
    pub(crate) position: usize,
    pub(crate) cameras: Cameras,
    pub(crate) beams: SharedBeams,
    pub(crate) radars: Radars,
    pub(crate) channels: Channels,
}

impl AgentRig<'_> {
    /// Reads all sensors that are due at a frame; their channels keep the readings until they are written.
    ///
    /// # Errors
    /// The renderer failed or an encoder refused; the message names scene, frame, agent and sensor.
    pub(crate) fn sense(&self, frame: u32) -> Result<(), StageError> {
        let log = &self.replay.log;
        let now = log.world_from_agent(self.position, frame);
        let snapshot = self.replay.snapshot(frame, now.xyz(), SIGHT_M);
        let here = || self.place(frame);
        let scene = self.eyes.renderer.place(&snapshot).at(here)?;
        let row = &log.frames[frame as usize];
        let when = FrameWeather {
            frame,
            time_s: row.time_s,
            weather: row.weather(),
            is_steady: self.sun_is_steady(frame),
        };
        let agent = AgentState {
            own: log.agent(self.position, frame).id,
            motion: Motion::from_row(log.agent(self.position, frame)),
            previous: self.previous_motion(frame),
        };
        let at = Observation::new(&*scene, Some(self.eyes.painter), &self.cameras, &when, agent).at(here)?;
        let at = at.with_scans(&self.beams).at(here)?.with_radars(&self.radars).at(here)?;
        let channels: Vec<&dyn Channel> = self.channels.at(frame).collect();
        let sensed: Vec<Result<(), StageError>> = channels
            .par_iter()
            .map(|channel| channel.sense(&at, &|| self.place(frame).sensor(channel.name())))
            .collect();
        sensed.into_iter().collect()
    }

    /// Whether the sun turns little from a frame to the next (to the last one from that before).
    fn sun_is_steady(&self, frame: u32) -> bool {
        let frames = &self.replay.log.frames;
        let first = (frame as usize).min(frames.len().saturating_sub(2));
        let suns: Vec<[f64; 3]> =
            frames[first..].iter().take(2).map(|row| row.weather().direction_to_sun()).collect();
        let square = |v: f64| v * v;
        let turned2 = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| square(a[k] - b[k])).sum::<f64>();
        suns.iter().all(|sun| turned2(sun, &suns[0]) < square(FrameWeather::STEADY_RAD))
    }

    fn place(&self, frame: u32) -> Place {
        let (scene, agent) = (self.replay.log.info.scene, self.replay.log.agent_ids()[self.position]);
        Place::scene(scene).frame(frame).agent(agent)
    }

    /// The agent's motion one period earlier; before frame 0 it is the log's frame -1.
    fn previous_motion(&self, frame: u32) -> Option<Motion> {
        let log = &self.replay.log;
        if frame > 0 {
            return Some(Motion::from_row(log.agent(self.position, frame - 1)));
        }
        let id = log.agent(self.position, frame).id;
        log.states_at(-1).iter().find(|s| s.id == id).map(|state| Motion {
            world_from_agent: frames::Pose::from_xyz_wxyz(state.xyz_m, state.quaternion),
            velocity_mps: state.velocity_mps.map(f64::from).into(),
            angular_velocity_radps: state.angular_velocity_radps.map(f64::from).into(),
        })
    }
}
