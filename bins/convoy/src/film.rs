//! A scene's log from above, as an animated picture.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use codecs::images::AnimationWriter;
use frames::{Object, Pose, World};
use mapview::{ActorStyle, Film, Light, MapActor, StopBar, ViewOptions, Window, frame_png};
use nalgebra::Point3;
use opendrive::{LaneHit, Map};
use runner::{At, Place, StageError};
use scene::{SceneError, SceneLog, SceneReader};
use schema::tables::{ActorRow, SignalRow};
use schema::{ActorKind, ActorRole, AgentId, AgentKind, Attribute, SignalState, lights};
use store::Store;

use crate::files::{Fault, exit_code, save, write_file};
use crate::maps::point;

/// Ground shown around the ways of the agents, metres, and the smallest half side of the picture.
const MARGIN_M: f64 = 70.0;
const LEAST_RADIUS_M: f64 = 60.0;
/// How high over a vehicle a deck may lie, metres.
const DECK_M: [f64; 2] = [3.0, 12.0];

/// Commands about scenes.
#[derive(Debug, Subcommand)]
pub(crate) enum FilmCommand {
    /// Draws the log of a scene from above as an animated PNG: lanes, lights, vehicles, walkers, agents.
    SceneVideo {
        /// The store: a folder.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
        /// Number of the scene.
        #[arg(long, value_name = "N")]
        scene: u32,
        /// The file to write: .png (browsers play it).
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// A folder for each frame as a picture of its own, too.
        #[arg(long, value_name = "DIR")]
        frames: Option<PathBuf>,
        /// Middle of the picture, metres east and north; else the ways of the agents.
        #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
        around: Option<[f64; 2]>,
        /// Half the side of the picture, metres.
        #[arg(long, value_name = "M", default_value_t = 100.0, requires = "around")]
        radius: f64,
        /// Longer side of the map in the picture, pixels.
        #[arg(long, value_name = "PX", default_value_t = 900, value_parser = clap::value_parser!(u32).range(120..=4000))]
        size: u32,
        /// Every which frame of the scene is drawn.
        #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
        every: u32,
    },
}

/// Runs a command; its exit code.
pub(crate) fn run(command: FilmCommand) -> u8 {
    let FilmCommand::SceneVideo { store, scene, out, frames, around, radius, size, every } = command;
    let window = around.map(|centre_m| Window { centre_m, radius_m: radius });
    let options = ViewOptions { size_px: f64::from(size), window, title: None };
    exit_code(film(&store, scene, options, every, &out, frames.as_deref()))
}

fn film(
    folder: &Path,
    scene: u32,
    options: ViewOptions,
    every: u32,
    out: &Path,
    frames: Option<&Path>,
) -> Result<(), Fault> {
    if out.extension().is_none_or(|e| e != "png") {
        return Err(Fault::Usage(format!("{}: an animated picture must end in .png", out.display())));
    }
    let store = Store::open(folder).map_err(StageError::from)?;
    let reader = SceneReader::open(&store, scene, &[schema::scene_info::LOG_STAGE]).at(Place::default)?;
    let log = match SceneLog::read(&reader) {
        Err(SceneError::NotMade { stage, .. }) => {
            let message = format!("{}: scene {scene} has no log: run {stage}", folder.display());
            return Err(Fault::Usage(message));
        }
        other => other.at(Place::default)?,
    };
    let map = replay::maps::read(&store, &log.info.map, &log.info.map_hash).at(Place::default)?;
    let options = ViewOptions {
        window: options.window.or_else(|| Some(around_agents(&log))),
        title: Some(format!("{} scene {scene:04} {}", log.info.map, log.info.split)),
        ..options
    };
    let picture = || Place::file(out.to_string_lossy());
    let cast = FilmActors::new(&log, &map);
    let standing: Vec<MapActor> = log
        .actors
        .iter()
        .filter_map(|actor| Some(MapActor { covered: is_covered(&map, actor.xyz_m), ..standing(actor)? }))
        .collect();
    let film = Film::new(&map, &options, &standing).at(picture)?;
    let shown: Vec<u32> = (0..log.frame_count()).step_by(every as usize).collect();
    let millis = (1000.0 * f64::from(every) * schema::FRAME_PERIOD_S).round().clamp(1.0, 60_000.0) as u16;
    let mut bytes = Vec::new();
    let mut writer =
        AnimationWriter::new(&mut bytes, film.size_px(), shown.len() as u32, millis).at(picture)?;
    for frame in shown {
        let (bars, things) = cast.at(&log, frame);
        let time_s = f64::from(frame) * schema::FRAME_PERIOD_S;
        let pixels = film.frame(&bars, &things, &format!("{time_s:.2} s"));
        if let Some(folder) = frames {
            let png = frame_png(&pixels, film.size_px()).at(picture)?;
            save(&folder.join(format!("{frame:04}.png")), &png)?;
        }
        writer.push(pixels).at(picture)?;
    }
    writer.finish().at(picture)?;
    write_file(out, &bytes)
}

/// A square around the ways of all agents.
fn around_agents(log: &SceneLog) -> Window {
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for position in 0..log.agent_ids().len() {
        for row in log.agent_rows(position) {
            for axis in 0..2 {
                low[axis] = low[axis].min(row.xyz_m[axis]);
                high[axis] = high[axis].max(row.xyz_m[axis]);
            }
        }
    }
    if low[0] > high[0] {
        return Window { centre_m: [0.0; 2], radius_m: 2.0 * LEAST_RADIUS_M };
    }
    let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]) + MARGIN_M;
    Window { centre_m: [0, 1].map(|k| 0.5 * (low[k] + high[k])), radius_m: half.max(LEAST_RADIUS_M) }
}

fn heading_rad(quaternion: [f64; 4]) -> f64 {
    Pose::<World, Object>::from_xyz_wxyz([0.0; 3], quaternion).rpy()[2]
}

/// A thing that never moves, as far as it is shown.
fn standing(actor: &ActorRow) -> Option<MapActor> {
    if !actor.fixed {
        return None;
    }
    let style = match actor.kind {
        ActorKind::Building => ActorStyle::Building,
        ActorKind::Vegetation => ActorStyle::Plant,
        ActorKind::Parked | ActorKind::Vehicle => ActorStyle::Vehicle,
        ActorKind::Rsu => ActorStyle::Station,
        ActorKind::Walker => ActorStyle::Walker,
        ActorKind::Prop | ActorKind::Sign if actor.role == ActorRole::Hazard => ActorStyle::Obstacle,
        ActorKind::Prop => ActorStyle::Furniture,
        ActorKind::Sign | ActorKind::TrafficLight | ActorKind::Pole | ActorKind::Surface => return None,
    };
    Some(thing(actor, style, actor.xyz_m, heading_rad(actor.quaternion), 0))
}

fn thing(actor: &ActorRow, style: ActorStyle, xyz_m: [f64; 3], heading_rad: f64, lamps: u32) -> MapActor {
    let mut rgb = [150; 3];
    rgb.iter_mut().zip(&actor.color).for_each(|(to, from)| *to = *from);
    let is_agent = matches!(style, ActorStyle::Agent | ActorStyle::Station);
    MapActor {
        style,
        at_m: [xyz_m[0], xyz_m[1]],
        heading_rad,
        size_m: [actor.length_m, actor.width_m],
        rgb,
        covered: false,
        brakes: lamps & lights::BRAKE != 0,
        blinks: [lights::BLINK_LEFT, lights::BLINK_RIGHT].map(|lamp| lamps & lamp != 0),
        label: is_agent.then(|| actor.role.to_string()),
    }
}

/// Whether a road leads over a place: one at least 3 m above it.
fn is_covered(map: &Map, [x, y, z]: [f64; 3]) -> bool {
    let above = Point3::new(x, y, z + 0.5 * (DECK_M[0] + DECK_M[1]));
    let reach_m = 0.5 * (DECK_M[1] - DECK_M[0]);
    map.lanes_within(above, reach_m, |_| true).iter().any(LaneHit::is_inside)
}

/// The moving actors, and where lights stop them.
struct FilmActors<'a> {
    map: &'a Map,
    actors: BTreeMap<u16, (&'a ActorRow, ActorStyle)>,
    /// By the OpenDRIVE id of the signal.
    bars: BTreeMap<&'a str, Vec<StopBar>>,
}

impl<'a> FilmActors<'a> {
    fn new(log: &'a SceneLog, map: &'a Map) -> Self {
        let style_of = |actor: &ActorRow| {
            let is_careless =
                [Attribute::Reckless, Attribute::Distracted].iter().any(|a| actor.attributes.is_true(a));
            match (actor.kind, actor.role) {
                (ActorKind::Walker, _) => ActorStyle::Walker,
                (ActorKind::Prop, _) => ActorStyle::Obstacle,
                (_, ActorRole::Agent(AgentId { kind: AgentKind::Vehicle, .. })) => ActorStyle::Agent,
                _ if is_careless => ActorStyle::Careless,
                _ => ActorStyle::Vehicle,
            }
        };
        let bars = map.signals().iter().enumerate().map(|(i, signal)| {
            let bars = map.stop_points(i).into_iter().filter_map(|pos| {
                let lane = map.lane(pos.lane)?;
                let place = map.lane_point(pos.lane, lane.s_of_along(pos.along_m), 0.0)?;
                Some(StopBar {
                    at_m: [place.position.x, place.position.y],
                    heading_rad: place.heading_rad,
                    width_m: place.width_m,
                    light: Light::Off,
                })
            });
            (signal.id.as_str(), bars.collect())
        });
        Self {
            map,
            actors: log.actors.iter().map(|actor| (actor.id, (actor, style_of(actor)))).collect(),
            bars: bars.collect(),
        }
    }

    fn at(&self, log: &SceneLog, frame: u32) -> (Vec<StopBar>, Vec<MapActor>) {
        let light = |row: &SignalRow| match row.state {
            SignalState::Red => Light::Red,
            SignalState::Yellow => Light::Yellow,
            SignalState::Green => Light::Green,
            SignalState::Off => Light::Off,
        };
        let signals = log.signals_at(i64::from(frame)).iter();
        let bars = signals.flat_map(|row| {
            let bars = self.bars.get(row.opendrive_id.as_str()).into_iter().flatten();
            bars.map(move |bar| StopBar { light: light(row), ..*bar })
        });
        let states = log.states_at(i64::from(frame)).iter();
        let mut things: Vec<MapActor> = states
            .filter_map(|state| {
                let (actor, style) = self.actors.get(&state.id)?;
                let thing = thing(actor, *style, state.xyz_m, heading_rad(state.quaternion), state.lights);
                Some(MapActor { covered: is_covered(self.map, state.xyz_m), ..thing })
            })
            .collect();
        // Agents and their names lie over the rest.
        things.sort_by_key(|thing| thing.label.is_some());
        (bars.collect(), things)
    }
}
