//! Lidars: a table of rays, one sweep a frame.

use glam::{Affine3A, Vec3};
use random::Stream;
use rayon::prelude::*;
use renderer::{Hit, RayBatch, Scene};
use schema::ObjectId;
use schema::geometry::{Part, Snapshot, Surface};
use schema::measures::sensors::LIDAR_POINTS;
use schema::settings::LidarSpec;
use schema::tables::{LidarRow, SemanticLidarRow};

use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::observation::Observation;
use crate::sensor::{Amount, Carrier, Layout, Sensor, SensorTable};
use crate::struck::Struck;

/// Returns within this distance ahead or behind and [`CROP_LEFT_M`] to the sides are of the agent's own body.
const CROP_AHEAD_M: f32 = 2.44;
/// See [`CROP_AHEAD_M`].
const CROP_LEFT_M: f32 = 1.04;
/// Columns and channels of the blocks in which rays are followed: 16 neighbours make a packet.
const BLOCK: [usize; 2] = [4, 4];
/// Rays a parallel task: fixed, so that results are joined in the same order on any number of threads.
const CHUNK: usize = 4096;

/// A lidar with its rays worked out, for all sweeps of all agents that carry it.
#[derive(Clone, Debug)]
pub struct Lidar {
    spec: LidarSpec,
    /// Unit directions in the sensor frame, highest channel first.
    directions: Vec<Vec3>,
    /// The order in which rays are followed: neighbours together.
    order: Vec<u32>,
}

/// One sweep, in the order of the rays: highest channel first, each from the left end of the field of view
/// clockwise. All lists are equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LidarSweep {
    /// Forward, metres, sensor frame.
    pub x_m: Vec<f32>,
    /// Left, metres.
    pub y_m: Vec<f32>,
    /// Up, metres.
    pub z_m: Vec<f32>,
    /// Returned intensity, 0 to 1.
    pub intensity: Vec<f32>,
    /// Channel, 0 is the highest.
    pub ring: Vec<u16>,
    /// Seconds after the frame's time: 0, all rays of a sweep are fired at once.
    pub time_offset_s: Vec<f32>,
    /// Whose surface was hit.
    pub id: Vec<ObjectId>,
    /// What was hit.
    pub tag: Vec<u8>,
    /// Cosine of the angle between ray and surface normal, 0 to 1.
    pub cos_angle: Vec<f32>,
}

/// Some rays of a sweep: numbers and random words, and where they go in the snapshot's local frame.
struct Volley {
    rays: Vec<(u32, [u32; 4])>,
    directions: Vec<Vec3>,
}

/// One return.
#[derive(Clone, Copy)]
struct Return {
    ray: u32,
    point_m: Vec3,
    intensity: f32,
    id: ObjectId,
    tag: u8,
    cos_angle: f32,
}

impl Lidar {
    /// Works out the rays of a lidar.
    ///
    /// Channel `i` of `n` is at `upper - i (upper - lower) / (n - 1)`, column `j` of `m` at `fov / 2 - j fov / m`
    /// to the left.
    ///
    /// # Errors
    /// The pattern has too many rays.
    pub fn new(spec: &LidarSpec) -> Result<Self, SensorError> {
        let scan = &spec.scan;
        if let Some(problem) = scan.problem() {
            return Err(SensorError::ScanPattern { problem });
        }
        let step_down = (scan.upper_rad - scan.lower_rad) / f64::from(scan.channels.max(2) - 1);
        let step_right = scan.horizontal_fov_rad / f64::from(scan.columns.max(1));
        let columns: Vec<(f64, f64)> = (0..scan.columns)
            .map(|j| frames::math::sin_cos(0.5 * scan.horizontal_fov_rad - f64::from(j) * step_right))
            .collect();
        let mut directions = Vec::with_capacity((scan.channels * scan.columns) as usize);
        for channel in 0..scan.channels {
            let (up, flat) = frames::math::sin_cos(scan.upper_rad - f64::from(channel) * step_down);
            directions.extend(
                columns
                    .iter()
                    .map(|&(left, ahead)| Vec3::new((flat * ahead) as f32, (flat * left) as f32, up as f32)),
            );
        }
        let (rows, width) = (scan.channels as usize, scan.columns as usize);
        let mut order = Vec::with_capacity(directions.len());
        for row in (0..rows).step_by(BLOCK[1]) {
            for column in (0..width).step_by(BLOCK[0]) {
                for r in row..(row + BLOCK[1]).min(rows) {
                    order.extend((column..(column + BLOCK[0]).min(width)).map(|c| (r * width + c) as u32));
                }
            }
        }
        Ok(Self { spec: spec.clone(), directions, order })
    }

    /// What it was made from.
    #[must_use]
    pub fn spec(&self) -> &LidarSpec {
        &self.spec
    }

    fn table(&self) -> SensorTable {
        let every = self.spec.every_n_frames;
        let about = sensor_metadata(&self.spec.name, &self.spec.mount, every);
        SensorTable::new(&self.spec.name, Some(about), Layout::Frames, every)
    }

    /// Unit directions of all rays in the sensor frame, highest channel first.
    #[must_use]
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// One sweep from where the sensor is.
    ///
    /// `stream` gives the random drops and the noise: ray `r` of frame `f` reads the words at `f << 32 | r`, so
    /// that nothing depends on which rays hit or on threads. A ray is dropped with [`LidarSpec::dropoff_rate`];
    /// a return whose bare intensity `I = exp(-attenuation d)` is at most [`LidarSpec::dropoff_intensity_limit`]
    /// is kept with the chance `1 - zero + I zero / limit`. Semantic lidars have neither drops nor noise. Returns
    /// with `|x| <= 2.44` and `|y| <= 1.04` are left out (the agent's own body).
    ///
    /// # Errors
    /// The renderer failed.
    pub fn sweep(
        &self,
        scene: &dyn Scene,
        local_from_sensor: Affine3A,
        stream: &Stream,
        frame: u32,
    ) -> Result<LidarSweep, SensorError> {
        let fired = self.fire(local_from_sensor, stream, frame);
        let origin = Vec3::from(local_from_sensor.translation);
        let range_m = [0.0, self.spec.range_m as f32];
        let batches: Vec<RayBatch<'_>> =
            fired.iter().map(|volley| RayBatch { origin, directions: &volley.directions, range_m }).collect();
        let hits = scene.trace(&batches)?;
        let snapshot = scene.snapshot();
        let returns: Vec<Vec<Return>> = fired
            .par_iter()
            .zip(&hits)
            .map(|(volley, hits)| {
                volley
                    .rays
                    .iter()
                    .zip(&volley.directions)
                    .zip(hits.iter())
                    .filter_map(|((&(ray, words), &direction), hit)| {
                        self.receive(snapshot, ray, words, direction, &hit?)
                    })
                    .collect()
            })
            .collect();
        Ok(self.collect(&returns))
    }

    /// The rays of a sweep that are not dropped at random, chunk by chunk.
    fn fire(&self, local_from_sensor: Affine3A, stream: &Stream, frame: u32) -> Vec<Volley> {
        let semantic = self.spec.semantic;
        let drop_below = if semantic { 0.0 } else { self.spec.dropoff_rate as f32 };
        let words_of = |ray: u32| stream.at(u64::from(frame) << 32 | u64::from(ray));
        let volley = |rays: &[u32]| {
            let rays: Vec<(u32, [u32; 4])> = rays
                .iter()
                .map(|&ray| (ray, if semantic { [0; 4] } else { words_of(ray) }))
                .filter(|(_, words)| drop_below <= 0.0 || random::unit_f32(words[0]) >= drop_below)
                .collect();
            let turned = |ray: u32| local_from_sensor.transform_vector3(self.directions[ray as usize]);
            let directions = rays.iter().map(|&(ray, _)| turned(ray).normalize()).collect();
            Volley { rays, directions }
        };
        self.order.par_chunks(CHUNK).map(volley).collect()
    }

    /// Turns a hit into a return, unless it is too weak or on the agent's own body.
    fn receive(
        &self,
        snapshot: &Snapshot,
        ray: u32,
        words: [u32; 4],
        direction_local: Vec3,
        hit: &Hit,
    ) -> Option<Return> {
        let spec = &self.spec;
        let bare = frames::math::f32::exp(-(spec.attenuation_per_m as f32) * hit.t);
        let mut range_m = hit.t;
        if !spec.semantic {
            let limit = spec.dropoff_intensity_limit as f32;
            let zero = spec.dropoff_zero_intensity as f32;
            if limit > 0.0 && bare <= limit && random::unit_f32(words[1]) >= 1.0 - zero + bare * zero / limit
            {
                return None;
            }
            if spec.noise_m > 0.0 {
                range_m += spec.noise_m as f32 * random::normal_pair_f32(words[2], words[3]).0;
            }
        }
        let point_m = self.directions[ray as usize] * range_m;
        if point_m.x.abs() <= CROP_AHEAD_M && point_m.y.abs() <= CROP_LEFT_M {
            return None;
        }
        let surface = Struck::new(snapshot, hit)?;
        let cos_angle = surface.normal_local.dot(direction_local).abs().min(1.0);
        Some(Return {
            ray,
            point_m,
            intensity: bare * reflectance(surface.part) * (0.25 + 0.75 * cos_angle),
            id: surface.object,
            tag: surface.part.tag as u8,
            cos_angle,
        })
    }

    /// Returns in following order to lists in ray order.
    fn collect(&self, returns: &[Vec<Return>]) -> LidarSweep {
        const NONE: u32 = u32::MAX;
        let all: Vec<&Return> = returns.iter().flatten().collect();
        let mut by_ray = vec![NONE; self.directions.len()];
        for (index, r) in all.iter().enumerate() {
            by_ray[r.ray as usize] = index as u32;
        }
        let columns = self.spec.scan.columns.max(1);
        let n = all.len();
        let mut sweep = LidarSweep::with_capacity(n);
        for index in by_ray.into_iter().filter(|&index| index != NONE) {
            let r = all[index as usize];
            sweep.x_m.push(r.point_m.x);
            sweep.y_m.push(r.point_m.y);
            sweep.z_m.push(r.point_m.z);
            sweep.intensity.push(r.intensity);
            sweep.ring.push((r.ray / columns) as u16);
            sweep.id.push(r.id);
            sweep.tag.push(r.tag);
            sweep.cos_angle.push(r.cos_angle);
        }
        sweep.time_offset_s = vec![0.0; n];
        sweep
    }
}

impl LidarSweep {
    fn with_capacity(n: usize) -> Self {
        Self {
            x_m: Vec::with_capacity(n),
            y_m: Vec::with_capacity(n),
            z_m: Vec::with_capacity(n),
            intensity: Vec::with_capacity(n),
            ring: Vec::with_capacity(n),
            time_offset_s: Vec::new(),
            id: Vec::with_capacity(n),
            tag: Vec::with_capacity(n),
            cos_angle: Vec::with_capacity(n),
        }
    }

    /// Number of returns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x_m.len()
    }

    /// Whether nothing came back.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x_m.is_empty()
    }

    /// The sweep as a row of an ordinary lidar's table.
    #[must_use]
    pub fn into_row(self, frame: u32) -> LidarRow {
        LidarRow {
            frame,
            time_s: crate::frame_time_s(frame),
            x: self.x_m,
            y: self.y_m,
            z: self.z_m,
            intensity: self.intensity,
            ring: self.ring,
            time_offset_s: self.time_offset_s,
            cos_angle: self.cos_angle,
            id: self.id,
            tag: self.tag,
        }
    }

    /// The sweep as a row of a semantic lidar's table.
    #[must_use]
    pub fn into_semantic_row(self, frame: u32) -> SemanticLidarRow {
        SemanticLidarRow {
            frame,
            time_s: crate::frame_time_s(frame),
            x: self.x_m,
            y: self.y_m,
            z: self.z_m,
            cos_angle: self.cos_angle,
            intensity: self.intensity,
            ring: self.ring,
            time_offset_s: self.time_offset_s,
            id: self.id,
            tag: self.tag,
        }
    }
}

/// A lidar of an agent whose returns fade, get lost and scatter.
pub(crate) struct PlainLidar {
    lidar: Lidar,
    stream: Stream,
}

impl PlainLidar {
    pub(crate) fn new(spec: &LidarSpec, carrier: &Carrier) -> Result<Self, SensorError> {
        Ok(Self { lidar: Lidar::new(spec)?, stream: carrier.stream(&spec.name) })
    }
}

impl Sensor for PlainLidar {
    type Row = LidarRow;

    fn table(&self) -> SensorTable {
        self.lidar.table()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<LidarRow>, SensorError> {
        let [pose, _] = at.local_from_sensor(&self.lidar.spec.mount);
        Ok(vec![self.lidar.sweep(at.scene, pose, &self.stream, at.frame)?.into_row(at.frame)])
    }

    fn amount(&self, rows: &[LidarRow]) -> Option<Amount> {
        Some(points(rows.iter().map(|row| row.x.len())))
    }
}

/// A semantic lidar of an agent.
pub(crate) struct SemanticLidar {
    lidar: Lidar,
    stream: Stream,
}

impl SemanticLidar {
    pub(crate) fn new(spec: &LidarSpec, carrier: &Carrier) -> Result<Self, SensorError> {
        Ok(Self { lidar: Lidar::new(spec)?, stream: carrier.stream(&spec.name) })
    }
}

impl Sensor for SemanticLidar {
    type Row = SemanticLidarRow;

    fn table(&self) -> SensorTable {
        self.lidar.table()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<SemanticLidarRow>, SensorError> {
        let [pose, _] = at.local_from_sensor(&self.lidar.spec.mount);
        Ok(vec![self.lidar.sweep(at.scene, pose, &self.stream, at.frame)?.into_semantic_row(at.frame)])
    }

    fn amount(&self, rows: &[SemanticLidarRow]) -> Option<Amount> {
        Some(points(rows.iter().map(|row| row.x.len())))
    }
}

fn points(lengths: impl Iterator<Item = usize>) -> Amount {
    Amount { measure: LIDAR_POINTS, count: lengths.sum::<usize>() as u64 }
}

/// Share of near-infrared light (905 nm) that a surface sends back, 0 to 1.
///
/// Round figures of the usual measurements for dry surfaces: asphalt 0.15, concrete 0.35, plants 0.5, dark glass 0.05.
/// Signs and road markings are retroreflective. Cloth and surfaces that are nothing in particular follow the brightness
/// of their colour; car paint does not, because its clear coat and the metal flakes under it send back light whatever
/// the pigment.
fn reflectance(part: &Part) -> f32 {
    use schema::Tag;
    let [r, g, b] = part.rgb;
    let brightness = (0.2126 * r + 0.7152 * g + 0.0722 * b).clamp(0.0, 1.0);
    if part.tag == Tag::TrafficSign && !matches!(part.surface, Surface::Metal) {
        return 1.0;
    }
    match part.surface {
        Surface::Plain | Surface::Cloth => 0.15 + 0.6 * brightness,
        Surface::Paint => 0.45,
        Surface::Glass => 0.05,
        Surface::Metal => 0.4,
        Surface::Rubber => 0.06,
        Surface::Asphalt => 0.15,
        Surface::RoadMarking => 0.8,
        Surface::Concrete | Surface::Facade => 0.35,
        Surface::Grass | Surface::Foliage => 0.5,
        Surface::Wood => 0.35,
        Surface::Lamp(_) => 0.6,
    }
}
