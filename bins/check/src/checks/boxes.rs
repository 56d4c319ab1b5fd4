//! Boxes against the log.

use std::collections::BTreeSet;

use schema::{DetectionClass, Tag};

use crate::config::Config;
use crate::files::{Batch, Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{Actor, AgentTrack, Scene, State};
use crate::space::{Motion, V3, add, apart, cross, dot, norm, scale, sub, within};

/// Greatest difference of lengths and angles of a box from the log's, m and rad.
const SHAPE: f64 = 1e-5;
/// Greatest difference of velocities (32 bits), m/s and rad/s.
const VELOCITY: f64 = 1e-4;
/// Objects this near the radius may be listed or not, m.
const EDGE_M: f64 = 1e-3;
/// Housings of lights are annotated above this half height, m, and at least this half width.
const LIGHT_HALF_M: [f64; 2] = [0.3, 0.12];
/// Fixed objects are annotated below this half height, m, and at least this half extent.
const FIXED_HALF_M: [f64; 2] = [3.2, 0.03];
/// Parts of an object may reach this far over its box, m.
pub(crate) const AROUND_M: f64 = 0.1;
/// An object with an open door reaches this far beyond its box, m.
pub(crate) const DOOR_M: f64 = 1.3;
/// Signs of the corners along length, width and height.
const CORNERS: [V3; 8] = [
    [-1.0, 1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, -1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0],
    [1.0, -1.0, 1.0],
];

/// A box of an agent's list, and what its sensors saw of it.
#[derive(Clone, Debug)]
pub(crate) struct Labelled {
    pub(crate) id: u16,
    pub(crate) class: DetectionClass,
    pub(crate) tags: Vec<u8>,
    pub(crate) corners: [V3; 8],
    pub(crate) center_m: V3,
    pub(crate) speed_mps: f64,
    pub(crate) distance_m: f64,
    /// To the left of the agent's forward axis; none of the agent itself.
    pub(crate) angle_rad: Option<f64>,
    /// Whether a door of it stands open.
    pub(crate) open_door: bool,
    /// Row of `boxes_valid`, if that is there.
    pub(crate) seen: Option<Evidence>,
}

/// Points and pixels of a box.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    pub(crate) lidar: u64,
    pub(crate) radar: u64,
    pub(crate) pixels: u64,
    pub(crate) valid: bool,
    pub(crate) difficulty: String,
}

impl Labelled {
    /// Whether a point lies in the box and some way around it.
    pub(crate) fn holds(&self, point: V3, around_m: f64) -> bool {
        let from = sub(point, self.corners[0]);
        [2, 4, 1].iter().all(|&to| {
            let edge = sub(self.corners[to], self.corners[0]);
            let length = norm(edge);
            let way = dot(from, edge) / length;
            -around_m <= way && way <= length + around_m
        })
    }

    /// The corners of the box grown by some way.
    pub(crate) fn grown(&self, by_m: f64) -> [V3; 8] {
        let along = |from: usize, to: usize| {
            let edge = sub(self.corners[to], self.corners[from]);
            scale(edge, by_m / norm(edge).max(1e-9))
        };
        let [length, width, height] = [along(0, 4), along(2, 0), along(0, 1)];
        std::array::from_fn(|k| {
            let [l, w, h] = CORNERS[k];
            add(self.corners[k], add(scale(length, l), add(scale(width, w), scale(height, h))))
        })
    }

    /// What it stands on, as a closed loop in the plane.
    pub(crate) fn footprint(&self) -> [[f64; 2]; 4] {
        [0, 2, 6, 4].map(|k| [self.corners[k][0], self.corners[k][1]])
    }

    /// What it covers, as a closed loop in the plane: on a slope a box leans over what it stands on.
    pub(crate) fn outline(&self) -> Vec<[f64; 2]> {
        crate::space::convex_hull(self.corners.map(|[x, y, _]| [x, y]))
    }
}

/// Half extents of an object's box; none for objects that are not annotated.
/// The box of a walker is that of its pose.
pub(crate) fn annotated(actor: &Actor, state: Option<&State>) -> Option<(DetectionClass, V3)> {
    let class = DetectionClass::from_tags(&actor.tags)?;
    let posed = state.map(|state| state.size_m).filter(|size| *size != [0.0; 3]);
    let half = posed.unwrap_or(actor.size_m).map(|side| 0.5 * side);
    if class == DetectionClass::TrafficLight {
        let [least_height, least] = LIGHT_HALF_M;
        return (half[2] > least_height).then(|| (class, [half[0].max(least), half[1].max(least), half[2]]));
    }
    if actor.fixed {
        let [most_height, least] = FIXED_HALF_M;
        return (half[2] < most_height).then(|| (class, half.map(|side| side.max(least))));
    }
    Some((class, half))
}

/// Where an object is said to be: the middle of its footprint, of people that of the body.
fn location(class: DetectionClass, half: V3, pose: &Motion) -> V3 {
    if class == DetectionClass::Pedestrian { pose.outward([0.0, 0.0, half[2]]) } else { pose.origin }
}

/// Reads an agent's boxes by frame, and holds each against the log.
pub(crate) fn read(
    scene: &Scene,
    config: &Config,
    name: &str,
    agent: &AgentTrack,
    ledger: &mut Ledger,
) -> Result<Vec<Vec<Labelled>>, Unreadable> {
    let mut by_frame: Vec<Vec<Labelled>> = vec![Vec::new(); scene.frames as usize];
    let boxes = Table::open(&scene.file("boxes.parquet"))?;
    let is_validated = scene.done.contains("postprocess-valid");
    let valid = is_validated.then(|| Table::open(&scene.file("boxes_valid.parquet"))).transpose()?;
    let mut valid_rows = Vec::new();
    if let Some(valid) = &valid {
        let unlike = valid.row_count() != boxes.row_count();
        ledger.expect(Rule::BoxShape, !unlike, || "boxes and boxes_valid are not equally long".into());
        valid_rows = valid.batches()?;
    }
    // Both tables are cut into batches in the same way when they are equally long.
    for (k, rows) in boxes.batches()?.iter().enumerate() {
        let seen = valid_rows.get(k).filter(|seen| seen.len() == rows.len());
        read_batch(scene, (name, agent), (rows, seen), &mut by_frame, ledger)?;
    }
    for (frame, list) in by_frame.iter().enumerate().step_by(config.label_every() as usize) {
        complete(scene, config, name, agent, frame, list, ledger);
    }
    Ok(by_frame)
}

/// The list of a frame holds all that it must, once.
fn complete(
    scene: &Scene,
    config: &Config,
    name: &str,
    agent: &AgentTrack,
    frame: usize,
    list: &[Labelled],
    ledger: &mut Ledger,
) {
    let listed: BTreeSet<u16> = list.iter().map(|b| b.id).collect();
    ledger.expect(Rule::BoxList, listed.len() == list.len(), || {
        format!("frame {frame}: {name} lists an object twice")
    });
    let Some(row) = agent.rows.get(frame) else { return };
    for (&id, actor) in &scene.actors {
        let pose = scene.pose(id, frame as i64);
        let Some((pose, (class, half))) = pose.zip(annotated(actor, scene.state(id, frame as i64))) else {
            ledger.expect(Rule::BoxList, !listed.contains(&id), || {
                format!("frame {frame}: {name} lists object {id}, which is not annotated")
            });
            continue;
        };
        let distance = apart(location(class, half, &pose), row.world_from_agent.origin);
        let margin = distance - config.box_radius_m();
        let holds = margin.abs() < EDGE_M || listed.contains(&id) == (margin < 0.0);
        ledger.expect(Rule::BoxList, holds, || {
            let word = if margin < 0.0 { "does not list" } else { "lists" };
            format!("frame {frame}: {name} {word} object {id} ({}) at {distance:.3} m", class.name())
        });
    }
}

type Whose<'a> = (&'a str, &'a AgentTrack);

fn read_batch(
    scene: &Scene,
    (name, agent): Whose<'_>,
    (rows, seen): (&Batch, Option<&Batch>),
    by_frame: &mut [Vec<Labelled>],
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let (agents, frames, ids) = (rows.texts("agent")?, rows.ints("frame")?, rows.ints("id")?);
    let (classes, models, tags) =
        (rows.texts("class")?, rows.texts("model")?, rows.int_lists("semantic_tags")?);
    let (corners, centers) = (rows.vectors::<24>("corners_m")?, rows.vectors::<3>("center_m")?);
    let (sizes, turns) = (rows.vectors::<3>("size_m")?, rows.vectors::<3>("rpy_rad")?);
    let (velocities, turning) =
        (rows.vectors::<3>("velocity_mps")?, rows.vectors::<3>("angular_velocity_radps")?);
    let (distances, angles) = (rows.reals("distance_m")?, rows.maybe_reals("angle_rad")?);
    let (signals, attributes) = (rows.maybe_texts("signal_state")?, rows.facts("attributes")?);
    let egos = rows.maybe_there("is_ego", Batch::flags)?;
    let seen = seen.map(SeenColumns::of).transpose()?;
    for k in (0..rows.len()).filter(|&k| agents[k] == name) {
        let (frame, id) = (frames[k], u16::try_from(ids[k]).unwrap_or(0));
        let fault =
            |what: &str| format!("frame {frame}: {name}'s box of object {id} ({}): {what}", classes[k]);
        let known = scene.actors.get(&id).zip(scene.pose(id, frame));
        let row = usize::try_from(frame).ok().and_then(|at| agent.rows.get(at));
        let (Some((actor, pose)), Some(row), Some(class)) =
            (known, row, DetectionClass::from_name(&classes[k]))
        else {
            ledger.off(Rule::BoxList, || fault("no such object, frame or class"));
            continue;
        };
        let found = Found {
            corners: std::array::from_fn(|c| std::array::from_fn(|i| corners[k][3 * c + i])),
            center_m: centers[k],
            size_m: sizes[k],
            rpy_rad: turns[k],
            distance_m: distances[k],
            angle_rad: angles[k],
        };
        let wrong =
            found.unlike((actor, scene.state(id, frame)), &pose, &row.world_from_agent, id == agent.id);
        ledger.expect(Rule::BoxShape, wrong.is_none(), || fault(&wrong.unwrap_or_default()));
        let state = scene.state(id, frame);
        let (velocity, rates) = state.map_or(([0.0; 3], [0.0; 3]), |s| (s.velocity_mps, s.turning_radps));
        let off = apart(velocity, velocities[k]).max(apart(rates, turning[k]));
        ledger.expect(Rule::BoxShape, within(off, VELOCITY), || fault("its velocity is not the log's"));
        let row_tags: Vec<u8> = tags[k].iter().map(|&tag| tag as u8).collect();
        // The box is around some of the object's parts: of a light's, not around its pole.
        let same_tags = row_tags.iter().all(|tag| actor.tags.contains(tag));
        let same =
            same_tags && DetectionClass::from_tags(&row_tags) == Some(class) && actor.model == models[k];
        ledger.expect(Rule::BoxShape, same, || fault("tags, class or model are not the log's"));
        let same =
            attributes[k] == actor.attributes && signals[k].as_ref() == scene.signals.get(&(frame, id));
        ledger.expect(Rule::BoxShape, same, || fault("attributes or signal state are not the log's"));
        let marked = |egos: &Option<Vec<bool>>| egos.as_ref().is_none_or(|egos| egos[k] == (id == agent.id));
        let marked = marked(&egos) && seen.as_ref().is_none_or(|seen| marked(&seen.egos));
        ledger.expect(Rule::BoxShape, marked, || fault("is_ego is wrong"));
        let seen = seen.as_ref().map(|seen| {
            let same = seen.is_about(k, (frame, name, ids[k]), &classes[k], &corners[k], distances[k]);
            ledger.expect(Rule::BoxShape, same, || fault("boxes_valid has another box in this row"));
            seen.row(k)
        });
        let Some(list) = usize::try_from(frame).ok().and_then(|at| by_frame.get_mut(at)) else { continue };
        list.push(Labelled {
            id,
            class,
            tags: row_tags,
            corners: found.corners,
            center_m: found.center_m,
            speed_mps: norm(velocities[k]),
            distance_m: distances[k],
            angle_rad: angles[k],
            open_door: state.is_some_and(|s| s.open_door),
            seen,
        });
    }
    Ok(())
}

/// Columns of `boxes_valid`.
struct SeenColumns {
    keys: Vec<(i64, String, i64)>,
    classes: Vec<String>,
    corners: Vec<[f64; 24]>,
    distances: Vec<f64>,
    /// Format 1 has none.
    egos: Option<Vec<bool>>,
    seen: Vec<Evidence>,
}

impl SeenColumns {
    fn of(rows: &Batch) -> Result<Self, Unreadable> {
        let (frames, agents, ids) = (rows.ints("frame")?, rows.texts("agent")?, rows.ints("id")?);
        let (lidar, radar, pixels) =
            (rows.ints("num_lidar_pts")?, rows.ints("num_radar_pts")?, rows.ints("num_pixels")?);
        let (valid, difficulty) = (rows.flags("valid_flag")?, rows.texts("difficulty")?);
        let row = |k: usize| Evidence {
            lidar: lidar[k].unsigned_abs(),
            radar: radar[k].unsigned_abs(),
            pixels: pixels[k].unsigned_abs(),
            valid: valid[k],
            difficulty: difficulty[k].clone(),
        };
        Ok(Self {
            seen: (0..rows.len()).map(row).collect(),
            keys: frames.into_iter().zip(agents).zip(ids).map(|((f, a), i)| (f, a, i)).collect(),
            classes: rows.texts("class")?,
            corners: rows.vectors("corners_m")?,
            distances: rows.reals("distance_m")?,
            egos: rows.maybe_there("is_ego", Batch::flags)?,
        })
    }

    fn is_about(
        &self,
        k: usize,
        (frame, agent, id): (i64, &str, i64),
        class: &str,
        corners: &[f64; 24],
        distance_m: f64,
    ) -> bool {
        let (f, a, i) = &self.keys[k];
        (*f, a.as_str(), *i) == (frame, agent, id)
            && self.classes[k] == class
            && self.corners[k] == *corners
            && self.distances[k] == distance_m
    }

    fn row(&self, k: usize) -> Evidence {
        self.seen[k].clone()
    }
}

/// The geometry of a row.
struct Found {
    corners: [V3; 8],
    center_m: V3,
    size_m: V3,
    rpy_rad: V3,
    distance_m: f64,
    angle_rad: Option<f64>,
}

impl Found {
    /// What differs from the log, if anything.
    fn unlike(
        &self,
        (actor, state): (&Actor, Option<&State>),
        pose: &Motion,
        agent: &Motion,
        itself: bool,
    ) -> Option<String> {
        let Some((class, half)) = annotated(actor, state) else { return Some("it is not annotated".into()) };
        let size = apart(self.size_m, scale(half, 2.0));
        let center = apart(self.center_m, pose.outward([0.0, 0.0, half[2]]));
        let turn = pose.turned_from(&Motion::of_angles(pose.origin, self.rpy_rad));
        let corner = |k: usize| {
            let [l, w, h] = CORNERS[k];
            pose.outward([l * half[0], w * half[1], (h + 1.0) * half[2]])
        };
        let corners = (0..8).map(|k| apart(self.corners[k], corner(k))).fold(0.0, crate::space::worse);
        let to_object = sub(location(class, half, pose), agent.origin);
        let distance = self.distance_m - norm(to_object);
        let angle = match (self.angle_rad, itself) {
            (None, true) => 0.0,
            (Some(angle), false) => crate::space::wrapped(angle - bearing(agent.ahead(), to_object)),
            _ => f64::NAN,
        };
        let parts = [
            ("size", size),
            ("centre", center),
            ("rotation", turn),
            ("corners", corners),
            ("distance", distance),
            ("angle", angle),
        ];
        let (name, off) = parts.into_iter().find(|(_, off)| !within(*off, SHAPE))?;
        Some(format!("its {name} is off by {off:.6}"))
    }
}

/// The angle between two directions in space, rad, positive where the second one is to the left of the first.
fn bearing(ahead: V3, to_object: V3) -> f64 {
    let across = cross(ahead, to_object);
    let angle = libm::atan2(norm(across), dot(ahead, to_object));
    if across[2] < 0.0 { -angle } else { angle }
}

/// Whether an object shows what its box is around, in a pixel or point of this tag.
pub(crate) fn is_part(labelled: &Labelled, tag: u8) -> bool {
    labelled.tags.contains(&tag) && tag != Tag::Unlabeled as u8
}
