//! Returns of lidars and radars: whose they are and where.

use std::collections::{BTreeMap, HashMap};

use arrow_array::types::{Float32Type, UInt8Type, UInt16Type};
use schema::ReturnKind;

use super::boxes::{AROUND_M, DOOR_M, Labelled, is_part};
use crate::config::{AgentConfig, LidarConfig, Mounted, ScanConfig};
use crate::files::{Batch, Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{AgentTrack, Scene};
use crate::space::{Motion, V3, norm};

/// Noise is told from a fault by so many standard deviations.
pub(crate) const SIGMAS: f64 = 6.5;

/// What kind of sensor returns come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Lidar,
    SemanticLidar,
    Radar,
}

/// A sensor that returns points.
pub(crate) struct Ranger {
    pub(crate) kind: Kind,
    pub(crate) name: String,
    pub(crate) agent_from_sensor: Motion,
    /// Standard deviation of the distance, m.
    pub(crate) noise_m: f64,
    /// Whether a radar sees wheels and limbs move.
    pub(crate) micro_motion: bool,
    /// How a lidar scans; none of radars.
    pub(super) scan: Option<ScanConfig>,
    channels: u64,
    reach_m: f64,
    /// It has rows at frames 0, n, 2 n, ...
    every: usize,
    pub(super) table: Table,
}

/// The returns of one sensor at one frame.
pub(crate) struct Cloud<'a> {
    pub(crate) ranger: &'a Ranger,
    pub(crate) world_from_sensor: Motion,
    /// As the file has them, m.
    pub(crate) points: Vec<V3>,
    pub(crate) ids: Vec<u16>,
    pub(crate) tags: Vec<u8>,
    /// What sent the light back: 0 surfaces, others the air.
    pub(super) kinds: Vec<u8>,
    /// Radial velocities of a radar, m/s.
    pub(crate) velocities: Vec<f32>,
    /// Seconds after the frame's time at which rays were fired.
    pub(super) offsets_s: Vec<f32>,
    /// In the frame of the sensor when the ray was fired, m.
    pub(super) fired: Vec<V3>,
    /// Where the surface that was met is in the world at the frame's time; on moving objects it is
    /// carried on with the object.
    now: Vec<V3>,
    /// Whether rays were fired at another time than the frame's.
    pub(crate) rolls: bool,
}

/// A return from a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfSurface {
    /// Where the surface is in the world at the frame's time, m.
    pub(crate) point: V3,
    pub(crate) id: u16,
    pub(crate) tag: u8,
    /// How far from there the beam's light may have met it, m.
    pub(crate) around_m: f64,
    /// Whether the light came through a pane.
    pub(crate) behind_glass: bool,
}

/// Opens the tables of all lidars and radars of an agent.
pub(crate) fn open(scene: &Scene, config: &AgentConfig, agent: &str, ledger: &mut Ledger) -> Vec<Ranger> {
    let mut rangers = Vec::new();
    let mut add = |mounted: &Mounted, every: u32, ranger: &dyn Fn(Table) -> Ranger| {
        let path = scene.file(&format!("sensors/{agent}/{}.parquet", mounted.name));
        let Some(table) = ledger.read(Table::open(&path)) else { return };
        super::cameras::expect_mount(&table, mounted, ("flu", every), ledger);
        rangers.push(ranger(table));
    };
    for LidarConfig { mounted, range_m, channels, noise_m, semantic, every, scan } in config.lidars() {
        add(&mounted, every, &|table| Ranger {
            kind: if semantic { Kind::SemanticLidar } else { Kind::Lidar },
            name: mounted.name.clone(),
            agent_from_sensor: mounted.agent_from_sensor,
            noise_m: if semantic { 0.0 } else { noise_m },
            micro_motion: false,
            scan: Some(scan),
            channels,
            reach_m: range_m,
            every: every as usize,
            table,
        });
    }
    for radar in config.radars() {
        let wide = libm::tan(0.5 * radar.horizontal_fov_rad);
        let high = libm::tan(0.5 * radar.vertical_fov_rad);
        add(&radar.mounted, radar.every, &|table| Ranger {
            kind: Kind::Radar,
            name: radar.mounted.name.clone(),
            agent_from_sensor: radar.mounted.agent_from_sensor,
            noise_m: 0.0,
            micro_motion: radar.micro_motion,
            scan: None,
            channels: 0,
            // Rays end on a plane ahead: those at the side reach farther.
            reach_m: radar.range_m * (1.0 + wide * wide + high * high).sqrt(),
            every: radar.every as usize,
            table,
        });
    }
    rangers
}

impl Ranger {
    /// Whether it has a row of a frame.
    pub(crate) fn is_due(&self, frame: usize) -> bool {
        frame.is_multiple_of(self.every)
    }

    /// Where in its table a frame is of which it has a row.
    pub(super) fn row_of(&self, frame: usize) -> usize {
        frame / self.every
    }

    /// The returns of a frame of which it has a row.
    pub(crate) fn frame(
        &self,
        scene: &Scene,
        agent: &AgentTrack,
        frame: usize,
    ) -> Result<Cloud<'_>, Unreadable> {
        let row = self.table.row(self.row_of(frame))?;
        let is_radar = self.kind == Kind::Radar;
        let points = if is_radar { polar(&row)? } else { cartesian(&row)? };
        let (ids, tags) = (row.first_list::<UInt16Type>("id")?, row.first_list::<UInt8Type>("tag")?);
        let all = points.len();
        let has_kinds = self.table.has("return_kind");
        let kinds = if has_kinds { row.first_list::<UInt8Type>("return_kind")? } else { vec![0; all] };
        let offsets_s =
            if is_radar { vec![0.0; all] } else { row.first_list::<Float32Type>("time_offset_s")? };
        if [ids.len(), tags.len(), kinds.len(), offsets_s.len()] != [all; 4] {
            return Err(Unreadable::new(
                self.table.path(),
                format!("frame {frame}: lists are not equally long"),
            ));
        }
        let velocities = if is_radar { row.first_list::<Float32Type>("velocity")? } else { Vec::new() };
        let rolls = offsets_s.iter().any(|&t| t != 0.0);
        let world_from_sensor = agent.rows[frame].world_from_agent.then(&self.agent_from_sensor);
        let mut cloud = Cloud {
            ranger: self,
            world_from_sensor,
            fired: points.clone(),
            now: points.iter().map(|point| world_from_sensor.outward(*point)).collect(),
            points,
            ids,
            tags,
            kinds,
            velocities,
            offsets_s,
            rolls,
        };
        if rolls {
            cloud.carry_on(scene, agent, frame as i64);
        }
        Ok(cloud)
    }

    /// Rings and reach of a frame.
    pub(crate) fn check_reach(&self, cloud: &Cloud<'_>, frame: usize, ledger: &mut Ledger) {
        let most = self.reach_m * (1.0 + 1e-5) + SIGMAS * self.noise_m;
        let far = cloud.fired.iter().map(|p| norm(*p)).fold(0.0, f64::max);
        ledger.expect(Rule::Units, far <= most, || {
            format!(
                "frame {frame}: {} has a return at {far:.3} m, it reaches {:.1} m",
                self.name, self.reach_m
            )
        });
        if !self.table.has("ring") {
            return;
        }
        let rings = self.table.row(self.row_of(frame)).and_then(|row| row.first_list::<UInt16Type>("ring"));
        let Some(rings) = ledger.read(rings) else { return };
        let most = rings.iter().max().copied().unwrap_or(0);
        ledger.expect(Rule::Units, u64::from(most) < self.channels, || {
            format!("frame {frame}: {} has ring {most} of {}", self.name, self.channels)
        });
    }
}

fn cartesian(row: &Batch) -> Result<Vec<V3>, Unreadable> {
    let axis = |name| row.first_list::<Float32Type>(name);
    let (x, y, z) = (axis("x")?, axis("y")?, axis("z")?);
    let points = x.iter().zip(&y).zip(&z);
    Ok(points.map(|((&x, &y), &z)| [f64::from(x), f64::from(y), f64::from(z)]).collect())
}

fn polar(row: &Batch) -> Result<Vec<V3>, Unreadable> {
    let column = |name| row.first_list::<Float32Type>(name);
    let (depth, up, left) = (column("depth")?, column("altitude")?, column("azimuth")?);
    let point = |((&depth, &up), &left): ((&f32, &f32), &f32)| {
        let (su, cu) = libm::sincos(f64::from(up));
        let (sl, cl) = libm::sincos(f64::from(left));
        [cu * cl, cu * sl, su].map(|part| part * f64::from(depth))
    };
    Ok(depth.iter().zip(&up).zip(&left).map(point).collect())
}

impl Cloud<'_> {
    /// Finds out where rays of a rolling scan were fired, and where what they met is at the frame's time.
    fn carry_on(&mut self, scene: &Scene, agent: &AgentTrack, frame: i64) {
        let compensated = self.ranger.scan.is_some_and(|scan| scan.compensated);
        let mut sensors: HashMap<u32, Motion> = HashMap::new();
        let mut objects: HashMap<(u16, u32), Option<[Motion; 2]>> = HashMap::new();
        for (k, point) in self.points.iter().enumerate() {
            let (id, offset_s) = (self.ids[k], self.offsets_s[k]);
            let (key, offset) = (offset_s.to_bits(), f64::from(offset_s));
            let then = sensors.entry(key).or_insert_with(|| {
                let pose = scene.agent_pose_at(agent, frame, offset);
                pose.map_or(self.world_from_sensor, |pose| pose.then(&self.ranger.agent_from_sensor))
            });
            let met = if compensated { self.world_from_sensor } else { *then }.outward(*point);
            self.fired[k] = then.inward(met);
            let moved = objects.entry((id, key)).or_insert_with(|| {
                let moves = scene.actors.get(&id).is_some_and(|actor| !actor.fixed);
                let poses = || Some([scene.pose_at(id, frame, offset)?, scene.pose(id, frame)?]);
                if moves { poses() } else { None }
            });
            self.now[k] = moved.map_or(met, |[then, now]| now.outward(then.inward(met)));
        }
    }

    /// The returns in the world, as the file has them.
    pub(crate) fn in_world(&self) -> impl Iterator<Item = V3> + '_ {
        self.points.iter().map(|point| self.world_from_sensor.outward(*point))
    }

    /// The same without what the air sent back.
    pub(crate) fn surfaces_in_world(&self) -> impl Iterator<Item = V3> + '_ {
        self.in_world()
            .zip(&self.kinds)
            .filter(|(_, kind)| ReturnKind::is_of_surface(**kind))
            .map(|(point, _)| point)
    }

    /// The returns from surfaces, where these are at the frame's time.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = OfSurface> + '_ {
        let beam_rad = self.ranger.scan.map_or(0.0, |scan| scan.beam_rad);
        (0..self.points.len()).filter(|&k| ReturnKind::is_of_surface(self.kinds[k])).map(move |k| OfSurface {
            point: self.now[k],
            id: self.ids[k],
            tag: self.tags[k],
            behind_glass: self.kinds[k] == ReturnKind::BehindGlass as u8,
            around_m: if beam_rad > 0.0 { beam_rad * norm(self.fired[k]) } else { 0.0 },
        })
    }

    /// Ids and tags are those of the log; objects' returns lie in their boxes.
    pub(crate) fn check(&self, scene: &Scene, boxes: &[Labelled], frame: usize, ledger: &mut Ledger) {
        let name = &self.ranger.name;
        let mut parts: BTreeMap<(u16, u8), u64> = BTreeMap::new();
        for OfSurface { id, tag, .. } in self.surfaces() {
            *parts.entry((id, tag)).or_default() += 1;
        }
        for ((id, tag), returns) in parts {
            let tags = scene.actors.get(&id).map(|actor| actor.tags.as_slice());
            if tags.is_some_and(|tags| tags.contains(&tag)) {
                ledger.fine(Rule::PointIds, returns);
                continue;
            }
            let kind = scene.actors.get(&id).map_or("none", |actor| actor.model.as_str());
            ledger.all_off(Rule::PointIds, returns, &format!("{kind} {tag}"), || match scene.actors.get(&id) {
                Some(actor) => format!(
                    "frame {frame}: {returns} returns of {name} from object {id} ({}) have tag {tag}, the log says {:?}",
                    actor.model, actor.tags
                ),
                None => format!("frame {frame}: {returns} returns of {name} from object {id}, which the log has not"),
            });
        }
        let by_id: BTreeMap<u16, &Labelled> = boxes.iter().map(|b| (b.id, b)).collect();
        for OfSurface { point, id, tag, around_m, .. } in self.surfaces() {
            let Some(labelled) = by_id.get(&id).filter(|b| is_part(b, tag)) else { continue };
            let doors = if labelled.open_door { DOOR_M } else { 0.0 };
            let around = AROUND_M + doors + SIGMAS * self.ranger.noise_m + around_m;
            ledger.expect(Rule::BoxPoints, labelled.holds(point, around), || {
                let scene_model = scene.actors.get(&id).map_or("", |a| a.model.as_str());
                format!(
                    "frame {frame}: a return of {name} from object {id} ({scene_model}) lies outside its box"
                )
            });
        }
    }
}
