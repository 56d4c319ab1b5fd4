//! Lidars: a table of beams, one sweep a frame.

mod air;
mod beam;
mod path;
mod receive;
mod reflectance;
mod sweep;

use std::marker::PhantomData;
use std::ops::Range;

use glam::{Affine3A, Vec3};
use random::Stream;
use rayon::prelude::*;
use renderer::{RayBatch, Scene};
use schema::measures::sensors::LIDAR_POINTS;
use schema::settings::{LidarSpec, ScanPattern};

use self::air::Air;
use self::beam::{beside, offsets};
pub use self::path::{LidarMoment, SensorPath};
use self::receive::{Receiver, Return, Volley, words_of};
pub(crate) use self::sweep::SweepRow;
pub use self::sweep::{LidarSweep, OfBeam};
use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::observation::Observation;
use crate::sensor::{Amount, Carrier, Layout, Sensor, SensorTable};

/// Columns and channels of the blocks in which rays are followed: 16 neighbours make a packet.
const BLOCK: [usize; 2] = [4, 4];
/// Beams a parallel task: fixed, so that results are joined in the same order on any number of threads.
const CHUNK: usize = 4096;

/// A lidar with its beams worked out, for all sweeps of all agents that carry it.
#[derive(Clone, Debug)]
pub struct Lidar {
    spec: LidarSpec,
    /// Unit directions in the sensor frame, highest channel first.
    directions: Vec<Vec3>,
    slices: Vec<Slice>,
}

/// Columns that are fired at one moment.
#[derive(Clone, Debug)]
struct Slice {
    columns: Range<usize>,
    /// The moment: 0 at the frame, 1 a period ago.
    before: f32,
    /// The order in which its beams are followed: neighbours together.
    order: Vec<u32>,
}

impl Lidar {
    /// Works out the beams of a lidar.
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
        Ok(Self { spec: spec.clone(), directions, slices: slices(spec) })
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

    /// Unit directions of all beams in the sensor frame, highest channel first.
    #[must_use]
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// One sweep from where the sensor is.
    ///
    /// `stream` gives the random drops and the noise: ray `r` of frame `f` reads the words at `f << 32 | r` (further returns and
    /// weather those at `f << 32 | n << 22 | r`), so that nothing depends on which rays hit or on threads. A ray is dropped with
    /// [`LidarSpec::dropoff_rate`]; a surface's return whose bare intensity `I = exp(-attenuation d)` is at most
    /// [`LidarSpec::dropoff_intensity_limit`] is kept with the chance `1 - zero + I zero / limit`. Semantic lidars have neither
    /// drops nor noise. Returns with `|x| <= 2.44` and `|y| <= 1.04` are left out (the agent's own body).
    ///
    /// Of a rolling lidar, columns of a slice are fired at one moment: from where the sensor is then, at instances that are where
    /// [`renderer::pose_before`] has them.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn sweep(
        &self,
        scene: &dyn Scene,
        at: &LidarMoment,
        stream: &Stream,
    ) -> Result<LidarSweep, SensorError> {
        let air = Air::of(&self.spec, &at.weather);
        let swept =
            self.slices.par_iter().map(|slice| self.sweep_slice(scene, at, stream, air.as_ref(), slice));
        let swept = swept.collect::<Result<Vec<_>, _>>()?;
        Ok(self.collect(&swept.into_iter().flatten().collect::<Vec<_>>()))
    }

    fn sweep_slice(
        &self,
        scene: &dyn Scene,
        at: &LidarMoment,
        stream: &Stream,
        air: Option<&Air>,
        slice: &Slice,
    ) -> Result<Vec<Vec<Return>>, SensorError> {
        let local_from_sensor = at.path.before(slice.before);
        let fired = self.fire(&slice.order, local_from_sensor, stream, at.frame);
        let origin = Vec3::from(local_from_sensor.translation);
        let range_m = [0.0, self.spec.range_m as f32];
        let batches: Vec<RayBatch<'_>> =
            fired.iter().map(|volley| RayBatch { origin, directions: &volley.directions, range_m }).collect();
        let is_now = slice.before == 0.0;
        let hits =
            if is_now { scene.trace(&batches)? } else { scene.trace_before(slice.before, &batches)? };
        let compensated = self.spec.rolling.as_ref().is_some_and(|rolling| rolling.compensated);
        let receiver = Receiver {
            spec: &self.spec,
            directions: &self.directions,
            snapshot: scene.snapshot(),
            before: slice.before,
            now_from_then: compensated.then(|| at.path.local_from_sensor.inverse() * local_from_sensor),
            air,
            stream,
            frame: at.frame,
        };
        Ok(fired.par_iter().zip(&hits).map(|(volley, hits)| receiver.receive(volley, hits)).collect())
    }

    /// The beams that are not dropped at random, chunk by chunk.
    fn fire(&self, order: &[u32], local_from_sensor: Affine3A, stream: &Stream, frame: u32) -> Vec<Volley> {
        let semantic = self.spec.semantic;
        let drop_below = if semantic { 0.0 } else { self.spec.dropoff_rate as f32 };
        let offsets = offsets(&self.spec.beam);
        let volley = |rays: &[u32]| {
            let beams: Vec<(u32, [u32; 4])> = rays
                .iter()
                .map(|&ray| (ray, if semantic { [0; 4] } else { words_of(stream, frame, ray, 0) }))
                .filter(|(_, words)| drop_below <= 0.0 || random::unit_f32(words[0]) >= drop_below)
                .collect();
            let turned = |direction: Vec3| local_from_sensor.transform_vector3(direction).normalize();
            let mut directions = Vec::with_capacity(beams.len() * (1 + offsets.len()));
            for &(ray, _) in &beams {
                let axis = self.directions[ray as usize];
                directions.push(turned(axis));
                directions.extend(offsets.iter().map(|&offset| turned(beside(axis, offset))));
            }
            Volley { beams, directions }
        };
        order.par_chunks(CHUNK).map(volley).collect()
    }

    /// Returns in following order to lists in the order of the beams.
    fn collect(&self, returns: &[Vec<Return>]) -> LidarSweep {
        const NONE: u32 = u32::MAX;
        let all: Vec<&Return> = returns.iter().flatten().collect();
        let mut by_ray = vec![NONE; self.directions.len()];
        for (index, r) in all.iter().enumerate().filter(|(_, r)| r.number == 1) {
            by_ray[r.ray as usize] = index as u32;
        }
        let columns = self.spec.scan.columns.max(1);
        let mut offset_s = vec![0.0; columns as usize];
        for slice in self.slices.iter().filter(|_| self.spec.rolling.is_some()) {
            let offset = -f64::from(slice.before) * schema::FRAME_PERIOD_S;
            offset_s[slice.columns.clone()].fill(offset as f32);
        }
        let mut sweep = LidarSweep::with_capacity(all.len(), self.spec.tells_returns());
        for index in by_ray.into_iter().filter(|&index| index != NONE) {
            let first = index as usize;
            for r in &all[first..first + usize::from(all[first].count)] {
                sweep.x_m.push(r.point_m.x);
                sweep.y_m.push(r.point_m.y);
                sweep.z_m.push(r.point_m.z);
                sweep.intensity.push(r.intensity);
                sweep.ring.push((r.ray / columns) as u16);
                sweep.time_offset_s.push(offset_s[(r.ray % columns) as usize]);
                sweep.id.push(r.id);
                sweep.tag.push(r.tag);
                sweep.cos_angle.push(r.cos_angle);
                if let Some(of_beam) = &mut sweep.of_beam {
                    of_beam.number.push(r.number);
                    of_beam.count.push(r.count);
                    of_beam.kind.push(r.kind as u8);
                }
            }
        }
        sweep
    }
}

/// The slices of a revolution; all of it at the frame's time unless it rolls.
fn slices(spec: &LidarSpec) -> Vec<Slice> {
    let columns = spec.scan.columns as usize;
    let Some(rolling) = &spec.rolling else {
        return vec![Slice { columns: 0..columns, before: 0.0, order: order(&spec.scan, 0..columns) }];
    };
    let count = (rolling.slices as usize).clamp(1, columns.max(1));
    let slice = |k: usize| {
        let [first, end] = [k, k + 1].map(|k| k * columns / count);
        let middle = (first + end) as f64 / (2 * columns.max(1)) as f64;
        Slice { columns: first..end, before: (1.0 - middle) as f32, order: order(&spec.scan, first..end) }
    };
    (0..count).map(slice).collect()
}

/// Numbers of the beams of some columns, block by block.
fn order(scan: &ScanPattern, columns: Range<usize>) -> Vec<u32> {
    let (rows, width) = (scan.channels as usize, scan.columns as usize);
    let mut order = Vec::with_capacity(rows * columns.len());
    for row in (0..rows).step_by(BLOCK[1]) {
        for column in columns.clone().step_by(BLOCK[0]) {
            for r in row..(row + BLOCK[1]).min(rows) {
                order.extend((column..(column + BLOCK[0]).min(columns.end)).map(|c| (r * width + c) as u32));
            }
        }
    }
    order
}

/// A lidar of an agent, with the rows of its table.
pub(crate) struct LidarSensor<R> {
    lidar: Lidar,
    stream: Stream,
    rows: PhantomData<fn() -> R>,
}

impl<R> LidarSensor<R> {
    pub(crate) fn new(spec: &LidarSpec, carrier: &Carrier) -> Result<Self, SensorError> {
        Ok(Self { lidar: Lidar::new(spec)?, stream: carrier.stream(&spec.name), rows: PhantomData })
    }
}

impl<R: SweepRow> Sensor for LidarSensor<R> {
    type Row = R;

    fn table(&self) -> SensorTable {
        self.lidar.table()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<R>, SensorError> {
        let [local_from_sensor, _] = at.local_from_sensor(&self.lidar.spec.mount);
        let [local_from_agent, previous_local_from_agent] = at.local_from_agent();
        let path = SensorPath { local_from_sensor, local_from_agent, previous_local_from_agent };
        let moment = LidarMoment { frame: at.frame, path, weather: at.weather };
        Ok(vec![R::of(self.lidar.sweep(at.scene, &moment, &self.stream)?, at.frame)])
    }

    fn amount(&self, rows: &[R]) -> Option<Amount> {
        let count = rows.iter().map(|row| row.returns() as u64).sum();
        Some(Amount { measure: LIDAR_POINTS, count })
    }
}
