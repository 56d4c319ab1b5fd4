//! Lidars: a table of beams, one sweep a frame.

mod air;
mod beam;
mod fire;
mod patch;
mod path;
mod receive;
mod reflectance;
mod sweep;

use std::marker::PhantomData;

use glam::Vec3;
use random::Stream;
use rayon::prelude::*;
use renderer::{Hits, RayBatch, Scene};
use schema::measures::sensors::LIDAR_POINTS;
use schema::settings::LidarSpec;

use self::air::Air;
use self::fire::{Gun, Volley};
use self::patch::{Slice, slices};
pub use self::path::{LidarMoment, SensorPath};
use self::receive::Receiver;
use self::reflectance::wetness;
pub(crate) use self::sweep::SweepRow;
pub use self::sweep::{LidarSweep, OfBeam};
use self::sweep::{Part, joined};
use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::observation::Observation;
use crate::panes::{Behind, Panes, Passing};
use crate::sensor::{Amount, Carrier, Layout, Sensor, SensorTable};

/// A lidar with its beams worked out, for all sweeps of all agents that carry it.
#[derive(Clone, Debug)]
pub struct Lidar {
    spec: LidarSpec,
    /// Unit directions in the sensor frame, highest channel first.
    directions: Vec<Vec3>,
    slices: Vec<Slice>,
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
        let panes = if self.spec.glass { Panes::of(scene) } else { None };
        let air = (air.as_ref(), self.spec.weather.as_ref().map_or(0.0, |_| wetness(&at.weather)));
        let swept = self
            .slices
            .par_iter()
            .map(|slice| self.sweep_slice((scene, panes.as_ref()), at, stream, air, slice));
        Ok(joined(&swept.collect::<Result<Vec<_>, _>>()?, self.spec.tells_returns()))
    }

    /// The returns of a slice, patch by patch.
    fn sweep_slice(
        &self,
        (scene, panes): (&dyn Scene, Option<&Panes<'_>>),
        at: &LidarMoment,
        stream: &Stream,
        (air, wetness): (Option<&Air>, f32),
        slice: &Slice,
    ) -> Result<Vec<Part>, SensorError> {
        let local_from_sensor = at.path.before(slice.before);
        let gun = Gun::new(&self.spec, &self.directions, local_from_sensor, stream, at.frame);
        let fired: Vec<_> = slice.patches.par_iter().map(|patch| gun.fire(patch)).collect();
        let origin = Vec3::from(local_from_sensor.translation);
        let range_m = [0.0, self.spec.range_m as f32];
        let batches: Vec<RayBatch<'_>> = fired
            .iter()
            .map(|volley| RayBatch { origin, directions: &volley.directions, range_m, nearest_m: &[] })
            .collect();
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
            wetness,
            stream,
            frame: at.frame,
        };
        let behind = match panes {
            Some(panes) => self.behind(panes, slice.before, origin, &fired, &hits)?,
            None => vec![Vec::new(); fired.len()],
        };
        let received = slice.patches.par_iter().zip(&fired).zip(&hits).zip(&behind);
        let receive = |(((patch, volley), hits), behind): (((_, _), _), &Vec<_>)| {
            receiver.receive(patch, volley, hits, behind)
        };
        Ok(received.map(receive).collect())
    }

    /// Of each volley, what those rays met (by their numbers) that passed panes. All are followed at once: between frames to place
    /// what moves costs more than the rays do.
    fn behind(
        &self,
        panes: &Panes<'_>,
        before: f32,
        origin: Vec3,
        volleys: &[Volley],
        hits: &[Hits],
    ) -> Result<Vec<Vec<(u32, Behind)>>, SensorError> {
        let (mut places, mut rays) = (Vec::new(), Passing::default());
        for (number, (volley, hits)) in volleys.iter().zip(hits).enumerate() {
            for (ray, hit) in (0..).zip(hits.iter()) {
                if let Some(hit) = hit.filter(|hit| panes.is_pane(hit.instance, hit.triangle)) {
                    places.push((number, ray));
                    rays.push(volley.directions[ray as usize], hit.instance, hit.triangle, hit.t);
                }
            }
        }
        let mut behind = vec![Vec::new(); volleys.len()];
        let passed = panes.behind(before, origin, self.spec.range_m as f32, rays)?;
        for ((number, ray), passed) in places.into_iter().zip(passed) {
            behind[number].push((ray, passed));
        }
        Ok(behind)
    }
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
