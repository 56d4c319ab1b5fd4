//! Returns of lidars and radars: whose they are and where.

use std::collections::BTreeMap;

use arrow_array::types::{Float32Type, UInt8Type, UInt16Type};

use super::boxes::{AROUND_M, DOOR_M, Labelled, is_part};
use crate::config::{AgentConfig, LidarConfig, Mounted};
use crate::files::{Batch, Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
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
    channels: u64,
    reach_m: f64,
    /// It has rows at frames 0, n, 2 n, ...
    every: usize,
    table: Table,
}

/// The returns of one sensor at one frame.
pub(crate) struct Cloud<'a> {
    pub(crate) ranger: &'a Ranger,
    pub(crate) world_from_sensor: Motion,
    /// In the sensor's frame, m.
    pub(crate) points: Vec<V3>,
    pub(crate) ids: Vec<u16>,
    pub(crate) tags: Vec<u8>,
    /// Radial velocities of a radar, m/s.
    pub(crate) velocities: Vec<f32>,
    /// Whether rays were fired at another time than the frame's.
    pub(crate) rolls: bool,
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
    for LidarConfig { mounted, range_m, channels, noise_m, semantic, every } in config.lidars() {
        add(&mounted, every, &|table| Ranger {
            kind: if semantic { Kind::SemanticLidar } else { Kind::Lidar },
            name: mounted.name.clone(),
            agent_from_sensor: mounted.agent_from_sensor,
            noise_m: if semantic { 0.0 } else { noise_m },
            micro_motion: false,
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

    /// The returns of a frame of which it has a row.
    pub(crate) fn frame(&self, frame: usize, world_from_agent: &Motion) -> Result<Cloud<'_>, Unreadable> {
        let row = self.table.row(frame / self.every)?;
        let is_radar = self.kind == Kind::Radar;
        let points = if is_radar { polar(&row)? } else { cartesian(&row)? };
        let (ids, tags) = (row.first_list::<UInt16Type>("id")?, row.first_list::<UInt8Type>("tag")?);
        if ids.len() != points.len() || tags.len() != points.len() {
            return Err(Unreadable::new(
                self.table.path(),
                format!("frame {frame}: lists are not equally long"),
            ));
        }
        let velocities = if is_radar { row.first_list::<Float32Type>("velocity")? } else { Vec::new() };
        let offsets = self.table.has("time_offset_s").then(|| row.first_list::<Float32Type>("time_offset_s"));
        let rolls = offsets.transpose()?.is_some_and(|offsets| offsets.iter().any(|&t| t != 0.0));
        let world_from_sensor = world_from_agent.then(&self.agent_from_sensor);
        Ok(Cloud { ranger: self, world_from_sensor, points, ids, tags, velocities, rolls })
    }

    /// Rings and reach of a frame.
    pub(crate) fn check_reach(&self, cloud: &Cloud<'_>, frame: usize, ledger: &mut Ledger) {
        let most = self.reach_m * (1.0 + 1e-5) + SIGMAS * self.noise_m;
        let far = cloud.points.iter().map(|p| norm(*p)).fold(0.0, f64::max);
        ledger.expect(Rule::Units, far <= most, || {
            format!(
                "frame {frame}: {} has a return at {far:.3} m, it reaches {:.1} m",
                self.name, self.reach_m
            )
        });
        if !self.table.has("ring") {
            return;
        }
        let rings = self.table.row(frame / self.every).and_then(|row| row.first_list::<UInt16Type>("ring"));
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
    /// The returns in the world.
    pub(crate) fn in_world(&self) -> impl Iterator<Item = V3> + '_ {
        self.points.iter().map(|point| self.world_from_sensor.outward(*point))
    }

    /// Ids and tags are those of the log; objects' returns lie in their boxes.
    pub(crate) fn check(&self, scene: &Scene, boxes: &[Labelled], frame: usize, ledger: &mut Ledger) {
        let name = &self.ranger.name;
        let mut parts: BTreeMap<(u16, u8), u64> = BTreeMap::new();
        for part in self.ids.iter().copied().zip(self.tags.iter().copied()) {
            *parts.entry(part).or_default() += 1;
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
        if self.rolls {
            ledger.skip(Rule::BoxPoints, format!("{name}: its rays are fired over the frame"));
            return;
        }
        let by_id: BTreeMap<u16, &Labelled> = boxes.iter().map(|b| (b.id, b)).collect();
        for ((point, id), &tag) in self.in_world().zip(&self.ids).zip(&self.tags) {
            let Some(labelled) = by_id.get(id).filter(|b| is_part(b, tag)) else { continue };
            let doors = if labelled.open_door { DOOR_M } else { 0.0 };
            let around = AROUND_M + doors + SIGMAS * self.ranger.noise_m;
            ledger.expect(Rule::BoxPoints, labelled.holds(point, around), || {
                let scene_model = scene.actors.get(id).map_or("", |a| a.model.as_str());
                format!(
                    "frame {frame}: a return of {name} from object {id} ({scene_model}) lies outside its box"
                )
            });
        }
    }
}
