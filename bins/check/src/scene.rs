//! What a scene's log says, read once for all checks of the scene.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use schema::{FRAME_PERIOD_S, SIGN_TYPES};
use serde_json::Value;

use crate::files::{Batch, Table, Unreadable, read_json};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::space::{Motion, V3};
use crate::vector_map::VectorMap;

/// An object, as `log/actors` has it.
#[derive(Clone, Debug)]
pub(crate) struct Actor {
    pub(crate) model: String,
    pub(crate) role: String,
    pub(crate) tags: Vec<u8>,
    /// Length, width, height, m; of walkers while they stand.
    pub(crate) size_m: V3,
    pub(crate) fixed: bool,
    /// Where it is at frame 0.
    pub(crate) world_from_object: Motion,
    pub(crate) attributes: Value,
}

/// An object at a frame, as `log/states` has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) world_from_object: Motion,
    pub(crate) velocity_mps: V3,
    pub(crate) turning_radps: V3,
    /// Length, width and height about a walker's pose, m; zeros of everything else.
    pub(crate) size_m: V3,
    /// Height of the seat that somebody sits on, m; 0 of all others.
    pub(crate) seat_m: f64,
    /// Whether a door stands open.
    pub(crate) open_door: bool,
}

/// An agent at a frame, as `agents` has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AgentRow {
    pub(crate) world_from_agent: Motion,
    pub(crate) velocity_mps: V3,
    pub(crate) turning_radps: V3,
}

/// An agent of the scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct AgentTrack {
    pub(crate) id: u16,
    /// By frame.
    pub(crate) rows: Vec<AgentRow>,
}

/// A file that a manifest names.
pub(crate) struct Named {
    pub(crate) path: PathBuf,
    /// Its rows, if it is a table.
    pub(crate) rows: usize,
    /// Format of the store when it was written.
    pub(crate) format: u64,
}

/// A scene of a store.
pub(crate) struct Scene {
    pub(crate) folder: PathBuf,
    pub(crate) number: u32,
    pub(crate) frames: u32,
    /// `log/scene.json`.
    pub(crate) facts: Value,
    /// The ground of its map as lines and polygons.
    pub(crate) map: Option<VectorMap>,
    /// By id.
    pub(crate) actors: BTreeMap<u16, Actor>,
    /// Moving objects by frame, from frame -1.
    states: Vec<HashMap<u16, State>>,
    /// Fog and rain by frame, percent.
    pub(crate) fog_and_rain: Vec<[f64; 2]>,
    /// State of traffic lights by frame and id.
    pub(crate) signals: HashMap<(i64, u16), String>,
    /// By name.
    pub(crate) agents: BTreeMap<String, AgentTrack>,
    /// Stages whose manifest stands.
    pub(crate) done: BTreeSet<String>,
    /// Files that these name.
    pub(crate) outputs: Vec<Named>,
    /// Whether it was imported from another layout: its log holds what its labels say.
    pub(crate) is_imported: bool,
}

impl Scene {
    /// Reads a scene's log; none (and a finding) where it cannot be read.
    pub(crate) fn open(store: &Path, number: u32, ledger: &mut Ledger) -> Option<Self> {
        let folder = store.join(format!("scenes/{number:04}"));
        let (done, outputs) = manifests(store, &folder, ledger);
        let made_by =
            read_json(&folder.join("_manifests/simulate-and-log.json")).map(|m| m["code_version"].clone());
        let is_imported = made_by.is_ok_and(|version| version == "import");
        if !done.contains("simulate-and-log") {
            ledger.skip(Rule::Files, format!("scene {number}: it is not simulated"));
            return None;
        }
        let facts = ledger.read(read_json(&folder.join("log/scene.json")))?;
        let map = facts["map"].as_str().unwrap_or_default();
        let map = store.join(format!("maps/{map}.vector.parquet"));
        let map = if is_imported { None } else { ledger.read(VectorMap::open(&map)) };
        let mut scene = Self {
            number,
            map,
            frames: u32::try_from(facts["frames"].as_u64().unwrap_or(0)).unwrap_or(0),
            facts,
            actors: BTreeMap::new(),
            states: Vec::new(),
            fog_and_rain: Vec::new(),
            signals: HashMap::new(),
            agents: BTreeMap::new(),
            done,
            outputs,
            is_imported,
            folder,
        };
        let read = scene.read_actors(ledger).and_then(|()| scene.read_states(ledger));
        let read = read.and_then(|()| scene.read_agents(ledger)).and_then(|()| scene.read_signals());
        let read = read.and_then(|()| scene.read_weather());
        ledger.read(read)?;
        Some(scene)
    }

    /// A file of the scene.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A moving object at a frame, from -1.
    pub(crate) fn state(&self, id: u16, frame: i64) -> Option<&State> {
        self.states.get(usize::try_from(frame + 1).ok()?)?.get(&id)
    }

    /// Where an object is at a frame, from -1.
    pub(crate) fn pose(&self, id: u16, frame: i64) -> Option<Motion> {
        let actor = self.actors.get(&id)?;
        if actor.fixed {
            Some(actor.world_from_object)
        } else {
            self.state(id, frame).map(|state| state.world_from_object)
        }
    }

    /// Where an agent is at a frame, from -1.
    pub(crate) fn agent_pose(&self, agent: &AgentTrack, frame: i64) -> Option<Motion> {
        match usize::try_from(frame) {
            Ok(frame) => agent.rows.get(frame).map(|row| row.world_from_agent),
            Err(_) => self.pose(agent.id, frame),
        }
    }

    /// Where an object is some seconds after a frame (or before it): on the straight way from the frame
    /// before.
    pub(crate) fn pose_at(&self, id: u16, frame: i64, offset_s: f64) -> Option<Motion> {
        let now = self.pose(id, frame)?;
        Some(self.pose(id, frame - 1).map_or(now, |before| now.towards(&before, -offset_s / FRAME_PERIOD_S)))
    }

    /// Where an agent is some seconds after a frame, likewise.
    pub(crate) fn agent_pose_at(&self, agent: &AgentTrack, frame: i64, offset_s: f64) -> Option<Motion> {
        let now = self.agent_pose(agent, frame)?;
        let before = self.agent_pose(agent, frame - 1);
        Some(before.map_or(now, |before| now.towards(&before, -offset_s / FRAME_PERIOD_S)))
    }

    /// All objects that move, at a frame.
    pub(crate) fn moving(&self, frame: i64) -> impl Iterator<Item = (u16, &State)> {
        let states = usize::try_from(frame + 1).ok().and_then(|at| self.states.get(at));
        states.into_iter().flatten().map(|(&id, state)| (id, state))
    }

    fn read_actors(&mut self, ledger: &mut Ledger) -> Result<(), Unreadable> {
        for rows in Table::open(&self.file("log/actors.parquet"))?.batches()? {
            let (ids, tags) = (rows.ints("id")?, rows.int_lists("semantic_tags")?);
            let (models, roles) = (rows.texts("model")?, rows.texts("role")?);
            let sizes = ["length_m", "width_m", "height_m"].map(|side| rows.reals(side));
            let [lengths, widths, heights] = sizes;
            let (lengths, widths, heights) = (lengths?, widths?, heights?);
            let (poses, fixed, attributes) = (poses(&rows)?, rows.flags("fixed")?, rows.facts("attributes")?);
            for (k, &id) in ids.iter().enumerate() {
                let actor = Actor {
                    model: models[k].clone(),
                    role: roles[k].clone(),
                    tags: tags[k].iter().map(|&tag| tag as u8).collect(),
                    size_m: [lengths[k], widths[k], heights[k]],
                    fixed: fixed[k],
                    world_from_object: poses[k],
                    attributes: attributes[k].clone(),
                };
                let word = actor.attributes.get("sign_type").and_then(Value::as_str);
                ledger.expect(Rule::Units, word.is_none_or(|word| SIGN_TYPES.contains(&word)), || {
                    format!("log/actors: the sign_type of object {id} is {word:?}")
                });
                let id = u16::try_from(id).unwrap_or(0);
                let is_new = id != 0 && self.actors.insert(id, actor).is_none();
                ledger.expect(Rule::ImageIds, is_new, || format!("log/actors: id {id} is 0 or there twice"));
            }
        }
        Ok(())
    }

    fn read_states(&mut self, ledger: &mut Ledger) -> Result<(), Unreadable> {
        self.states = vec![HashMap::new(); self.frames as usize + 1];
        for rows in Table::open(&self.file("log/states.parquet"))?.batches()? {
            let (frames, ids, poses) = (rows.ints("frame")?, rows.ints("id")?, poses(&rows)?);
            let (velocities, turning) =
                (rows.vectors("velocity_mps")?, rows.vectors("angular_velocity_radps")?);
            let (doors, sizes) = (rows.vectors::<4>("door_rad")?, rows.vectors("size_m")?);
            let seats = rows.reals("seat_m")?;
            for k in 0..rows.len() {
                let id = u16::try_from(ids[k]).unwrap_or(0);
                let known = self.actors.get(&id).is_some_and(|actor| !actor.fixed);
                ledger.expect(Rule::ImageIds, known, || format!("log/states: {id} is no moving object"));
                let state = State {
                    world_from_object: poses[k],
                    velocity_mps: velocities[k],
                    turning_radps: turning[k],
                    size_m: sizes[k],
                    seat_m: seats[k],
                    open_door: doors[k].iter().any(|&door| door > 0.0),
                };
                let place = usize::try_from(frames[k] + 1).ok().and_then(|at| self.states.get_mut(at));
                let is_new = place.is_some_and(|place| place.insert(id, state).is_none());
                let frame = frames[k];
                ledger.expect(Rule::Times, is_new, || {
                    format!("log/states: frame {frame} of object {id} is beyond the scene or there twice")
                });
            }
        }
        Ok(())
    }

    fn read_agents(&mut self, ledger: &mut Ledger) -> Result<(), Unreadable> {
        for rows in Table::open(&self.file("agents.parquet"))?.batches()? {
            let (frames, names, ids) = (rows.ints("frame")?, rows.texts("agent")?, rows.ints("id")?);
            let poses = poses(&rows)?;
            let (velocities, turning) =
                (rows.vectors("velocity_mps")?, rows.vectors("angular_velocity_radps")?);
            for k in 0..rows.len() {
                let track = self.agents.entry(names[k].clone()).or_default();
                let follows = frames[k] == track.rows.len() as i64;
                ledger.expect(Rule::Times, follows, || {
                    format!("agents: {} has frame {} after {} frames", names[k], frames[k], track.rows.len())
                });
                track.id = u16::try_from(ids[k]).unwrap_or(0);
                track.rows.push(AgentRow {
                    world_from_agent: poses[k],
                    velocity_mps: velocities[k],
                    turning_radps: turning[k],
                });
            }
        }
        for (name, track) in &self.agents {
            let all = track.rows.len() == self.frames as usize;
            ledger.expect(Rule::Times, all, || format!("agents: {name} has {} frames", track.rows.len()));
            let role = self.actors.get(&track.id).map(|actor| actor.role.as_str());
            ledger.expect(Rule::ImageIds, role == Some(name), || {
                format!("agents: {name} is object {}, whose role is {role:?}", track.id)
            });
        }
        Ok(())
    }

    fn read_weather(&mut self) -> Result<(), Unreadable> {
        for rows in Table::open(&self.file("log/frames.parquet"))?.batches()? {
            let (fog, rain) = (rows.reals("fog_density")?, rows.reals("precipitation")?);
            self.fog_and_rain.extend(fog.into_iter().zip(rain).map(|(fog, rain)| [fog, rain]));
        }
        Ok(())
    }

    fn read_signals(&mut self) -> Result<(), Unreadable> {
        for rows in Table::open(&self.file("log/signals.parquet"))?.batches()? {
            let (frames, ids, states) = (rows.ints("frame")?, rows.ints("id")?, rows.texts("state")?);
            for (k, state) in states.into_iter().enumerate() {
                self.signals.insert((frames[k], u16::try_from(ids[k]).unwrap_or(0)), state);
            }
        }
        Ok(())
    }
}

/// Columns `xyz_m` and `quaternion` of a table.
fn poses(rows: &Batch) -> Result<Vec<Motion>, Unreadable> {
    let (places, turns) = (rows.vectors::<3>("xyz_m")?, rows.vectors::<4>("quaternion")?);
    Ok(places.into_iter().zip(turns).map(|(xyz, q)| Motion::of_quaternion(xyz, q)).collect())
}

/// Stages that are done and the files that their manifests name.
fn manifests(store: &Path, folder: &Path, ledger: &mut Ledger) -> (BTreeSet<String>, Vec<Named>) {
    let (mut done, mut outputs) = (BTreeSet::new(), Vec::new());
    let entries = std::fs::read_dir(folder.join("_manifests")).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| {
        path.extension().is_some_and(|e| e == "json") && !path.to_string_lossy().contains(".redo.")
    });
    paths.sort();
    for path in paths {
        let Some(manifest) = ledger.read(read_json(&path)) else { continue };
        done.extend(manifest["stage"].as_str().map(str::to_owned));
        for output in manifest["outputs"].as_array().into_iter().flatten() {
            let rows = usize::try_from(output["rows"].as_u64().unwrap_or(0)).unwrap_or(0);
            let format = manifest["format_version"].as_u64().unwrap_or(0);
            outputs.extend(output["key"].as_str().map(|key| Named { path: store.join(key), rows, format }));
        }
    }
    (done, outputs)
}
