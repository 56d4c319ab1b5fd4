//! A lidar and its sweeps.

use glam::Vec3;
use random::Stream;
use rayon::prelude::*;
use render::{Hits, RayBatch, RayQuery, Scene};
use settings::LidarSpec;

use super::air::Air;
use super::beam::offsets;
use super::detect::Receiver;
use super::emit::{Drawn, Emitter};
use super::patch::{Slice, slices};
use super::path::LidarMoment;
use super::reflectance::wetness;
use super::scan::{Followed, Scan};
use super::sweep::{LidarSweep, joined};
use crate::error::SensorError;
use render::panes::{PaneRays, Panes, TransmittedHit};

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
    /// Channel `i` of `n` is at `upper - i (upper - lower) / (n - 1)`, column `j` of `m` at
    /// `fov / 2 - j fov / m` to the left.
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

    /// Unit directions of all beams in the sensor frame, highest channel first.
    #[must_use]
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// One sweep from where the sensor is.
    ///
    /// `stream` gives the random drops and the noise: ray `r` of frame `f` reads the words at `f << 32 | r`
    /// (further returns and weather those at `f << 32 | n << 22 | r`), so that nothing depends on which rays
    /// hit or on threads. A ray is dropped with [`LidarSpec::dropoff_rate`]; a surface's return whose bare
    /// intensity `I = exp(-attenuation d)` is at most [`LidarSpec::dropoff_intensity_limit`] is kept with the
    /// chance `1 - zero + I zero / limit`. Semantic lidars have neither drops nor noise. Returns with
    /// `|x| <= 2.44` and `|y| <= 1.04` are left out (the agent's own body).
    ///
    /// Of a rolling lidar, columns of a slice are fired at one moment: from where the sensor is then, at
    /// instances that are where [`render::pose_before`] has them.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn sweep(
        &self,
        scene: &dyn Scene,
        at: &LidarMoment,
        stream: &Stream,
    ) -> Result<LidarSweep, SensorError> {
        let (panes, air) = (self.panes(scene), Air::of(&self.spec, &at.weather));
        let swept = self.slices.par_iter().map(|slice| {
            let patches = slice.patches.par_iter();
            let drawn: Vec<Drawn> =
                patches.map(|patch| Drawn::new(&self.spec, patch, stream, at.frame)).collect();
            let kept: Vec<&[u32]> = drawn.iter().map(|drawn| &drawn.kept[..]).collect();
            let followed = self.follow((scene, panes.as_ref()), at, slice, &kept)?;
            let receiver = self.receiver(scene, at, stream, air.as_ref(), slice);
            let each = slice.patches.par_iter().zip(&drawn).zip(&followed);
            Ok(each
                .map(|((patch, drawn), followed)| receiver.receive(patch, drawn, &drawn.kept, followed))
                .collect())
        });
        Ok(joined(&swept.collect::<Result<Vec<_>, SensorError>>()?, self.spec.tells_returns()))
    }

    /// The same, bit for bit, of rays that were followed already: those of all beams, by a lidar that fires
    /// the same at the same moment.
    #[must_use]
    pub fn sweep_of(&self, scan: &Scan, scene: &dyn Scene, at: &LidarMoment, stream: &Stream) -> LidarSweep {
        let air = Air::of(&self.spec, &at.weather);
        let swept = self.slices.par_iter().zip(&scan.slices).map(|(slice, followed)| {
            let receiver = self.receiver(scene, at, stream, air.as_ref(), slice);
            let each = slice.patches.par_iter().zip(followed);
            each.map(|(patch, followed)| {
                let drawn = Drawn::new(&self.spec, patch, stream, at.frame);
                receiver.receive(patch, &drawn, &patch.order, followed)
            })
            .collect()
        });
        joined(&swept.collect::<Vec<_>>(), self.spec.tells_returns())
    }

    /// What receives the returns of a slice.
    fn receiver<'a>(
        &'a self,
        scene: &'a dyn Scene,
        at: &LidarMoment,
        stream: &'a Stream,
        air: Option<&'a Air>,
        slice: &Slice,
    ) -> Receiver<'a> {
        let compensated = self.spec.rolling.as_ref().is_some_and(|rolling| rolling.compensated);
        let now_from_then = || at.path.local_from_sensor.inverse() * at.path.before(slice.before);
        Receiver {
            spec: &self.spec,
            directions: &self.directions,
            rays: 1 + offsets(&self.spec.beam).len(),
            snapshot: scene.snapshot(),
            before: slice.before,
            now_from_then: compensated.then(now_from_then),
            air,
            wetness: self.spec.weather.as_ref().map_or(0.0, |_| wetness(&at.weather)),
            stream,
            frame: at.frame,
        }
    }

    /// Follows the rays of all beams: what [`Lidar::sweep_of`] makes sweeps of, of this lidar and of all that
    /// fire the same beams.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn scan(&self, scene: &dyn Scene, at: &LidarMoment) -> Result<Scan, SensorError> {
        let panes = self.panes(scene);
        let all = |slice: &Slice| {
            let beams: Vec<&[u32]> = slice.patches.iter().map(|patch| &patch.order[..]).collect();
            self.follow((scene, panes.as_ref()), at, slice, &beams)
        };
        Ok(Scan { slices: self.slices.par_iter().map(all).collect::<Result<_, _>>()? })
    }

    /// The panes that its light passes.
    fn panes<'a>(&self, scene: &'a dyn Scene) -> Option<Panes<'a>> {
        if self.spec.glass { Panes::of(scene) } else { None }
    }

    /// Follows the rays of some beams of each patch of a slice.
    fn follow(
        &self,
        (scene, panes): (&dyn Scene, Option<&Panes<'_>>),
        at: &LidarMoment,
        slice: &Slice,
        beams: &[&[u32]],
    ) -> Result<Vec<Followed>, SensorError> {
        let local_from_sensor = at.path.before(slice.before);
        let gun = Emitter::new(&self.spec, &self.directions, local_from_sensor);
        let fired: Vec<Vec<Vec3>> =
            slice.patches.par_iter().zip(beams).map(|(patch, beams)| gun.fire(patch, beams)).collect();
        let origin = Vec3::from(local_from_sensor.translation);
        let range_m = [0.0, self.spec.range_m as f32];
        let query = |directions| RayQuery {
            before: slice.before,
            ..RayQuery::of(RayBatch { origin, directions, range_m, nearest_m: &[] })
        };
        let queries: Vec<RayQuery<'_>> = fired.iter().map(|directions| query(directions)).collect();
        let hits = scene.trace(&queries)?;
        let behind = match panes {
            Some(panes) => self.behind(panes, slice.before, origin, &fired, &hits)?,
            None => vec![Vec::new(); fired.len()],
        };
        let followed = fired.into_iter().zip(hits).zip(behind);
        Ok(followed.map(|((directions, hits), behind)| Followed { directions, hits, behind }).collect())
    }

    /// Of each patch, what those rays met (by their numbers) that passed panes. All are followed at once:
    /// between frames to place moving objects cost more than the rays do.
    fn behind(
        &self,
        panes: &Panes<'_>,
        before: f32,
        origin: Vec3,
        fired: &[Vec<Vec3>],
        hits: &[Hits],
    ) -> Result<Vec<Vec<(u32, TransmittedHit)>>, SensorError> {
        let (mut places, mut rays) = (Vec::new(), PaneRays::new(origin, before, self.spec.range_m as f32));
        for (number, (directions, hits)) in fired.iter().zip(hits).enumerate() {
            for (ray, hit) in (0..).zip(hits.iter()) {
                if let Some(hit) = hit.filter(|hit| panes.is_pane(hit.instance, hit.triangle)) {
                    places.push((number, ray));
                    rays.push(directions[ray as usize], hit.instance, hit.triangle, hit.t);
                }
            }
        }
        let mut behind = vec![Vec::new(); fired.len()];
        let passed = panes.behind(vec![rays])?.into_iter().flatten();
        for ((number, ray), passed) in places.into_iter().zip(passed) {
            behind[number].push((ray, passed));
        }
        Ok(behind)
    }
}
