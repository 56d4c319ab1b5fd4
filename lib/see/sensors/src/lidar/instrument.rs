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
        let drawn: Vec<Vec<Drawn>> = self
            .slices
            .par_iter()
            .map(|slice| {
                let patches = slice.patches.par_iter();
                patches.map(|patch| Drawn::new(&self.spec, patch, stream, at.frame)).collect()
            })
            .collect();
        let kept: Vec<Vec<&[u32]>> =
            drawn.iter().map(|drawn| drawn.iter().map(|drawn| &drawn.kept[..]).collect()).collect();
        let scan = self.follow(scene, at, &kept)?;
        let air = Air::of(&self.spec, &at.weather);
        let swept = self.slices.par_iter().zip(&drawn).zip(&scan.slices).map(|((slice, drawn), followed)| {
            let receiver = self.receiver(scene, at, stream, air.as_ref(), slice);
            let each = slice.patches.par_iter().zip(drawn).zip(followed);
            each.map(|((patch, drawn), followed)| receiver.receive(patch, drawn, &drawn.kept, followed))
                .collect()
        });
        Ok(joined(&swept.collect::<Vec<_>>(), self.spec.tells_returns()))
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
        let patches = self.slices.iter().map(|slice| slice.patches.iter());
        let beams: Vec<Vec<&[u32]>> =
            patches.map(|patches| patches.map(|patch| &patch.order[..]).collect()).collect();
        self.follow(scene, at, &beams)
    }

    /// Follows the rays of some beams of each patch of each slice, all at once.
    fn follow(
        &self,
        scene: &dyn Scene,
        at: &LidarMoment,
        beams: &[Vec<&[u32]>],
    ) -> Result<Scan, SensorError> {
        let fired = self.slices.par_iter().zip(beams).map(|(slice, beams)| {
            let local_from_sensor = at.path.before(slice.before);
            let gun = Emitter::new(&self.spec, &self.directions, local_from_sensor);
            let patches = slice.patches.par_iter().zip(beams);
            Fired {
                origin: local_from_sensor.translation.into(),
                before: slice.before,
                directions: patches.map(|(patch, beams)| gun.fire(patch, beams)).collect(),
            }
        });
        let fired: Vec<Fired> = fired.collect();
        let range_m = [0.0, self.spec.range_m as f32];
        let query = |(slice, directions): (&Fired, _)| RayQuery {
            before: slice.before,
            ..RayQuery::of(RayBatch { origin: slice.origin, directions, range_m, nearest_m: &[] })
        };
        let patches =
            fired.iter().flat_map(|slice| slice.directions.iter().map(move |rays| (slice, &rays[..])));
        let queries: Vec<RayQuery<'_>> = patches.map(query).collect();
        let mut hits = scene.trace(&queries)?.into_iter();
        let hits: Vec<Vec<Hits>> =
            fired.iter().map(|slice| hits.by_ref().take(slice.directions.len()).collect()).collect();
        let panes = if self.spec.glass { Panes::of(scene) } else { None };
        let mut behind = match panes {
            Some(panes) => behind_panes(&panes, &fired, &hits, range_m[1])?,
            None => fired.iter().map(|slice| vec![Vec::new(); slice.directions.len()]).collect(),
        }
        .into_iter();
        let slice = |(slice, hits): (Fired, Vec<Hits>)| {
            let behind = behind.next().into_iter().flatten();
            let patches = slice.directions.into_iter().zip(hits).zip(behind);
            patches.map(|((directions, hits), behind)| Followed { directions, hits, behind }).collect()
        };
        Ok(Scan { slices: fired.into_iter().zip(hits).map(slice).collect() })
    }
}

/// Rays that are fired at one moment.
struct Fired {
    /// Where from, snapshot's local frame, metres.
    origin: Vec3,
    /// The moment: 0 is this frame, 1 the one before.
    before: f32,
    /// Unit directions of each patch's rays, snapshot's local frame.
    directions: Vec<Vec<Vec3>>,
}

/// What those rays of a patch met (by their numbers, ascending) that passed panes.
type Transmitted = Vec<(u32, TransmittedHit)>;

/// Of each slice and patch, what is behind the panes that its rays met. All are followed at once: to place
/// moving objects between frames costs more than the rays do.
fn behind_panes(
    panes: &Panes<'_>,
    fired: &[Fired],
    hits: &[Vec<Hits>],
    reach_m: f32,
) -> Result<Vec<Vec<Transmitted>>, SensorError> {
    let met: Vec<(Vec<(usize, u32)>, PaneRays)> = fired
        .par_iter()
        .zip(hits)
        .map(|(slice, hits)| {
            let (mut places, mut rays) = (Vec::new(), PaneRays::new(slice.origin, slice.before, reach_m));
            for (patch, (directions, hits)) in slice.directions.iter().zip(hits).enumerate() {
                for (ray, hit) in (0..).zip(hits.iter()) {
                    if let Some(hit) = hit.filter(|hit| panes.is_pane(hit.instance, hit.triangle)) {
                        places.push((patch, ray));
                        rays.push(directions[ray as usize], hit.instance, hit.triangle, hit.t);
                    }
                }
            }
            (places, rays)
        })
        .collect();
    let (places, rays): (Vec<_>, Vec<_>) = met.into_iter().unzip();
    let passed = panes.behind(rays)?;
    let slices = fired.iter().zip(places).zip(passed).map(|((slice, places), passed)| {
        let mut behind = vec![Vec::new(); slice.directions.len()];
        for ((patch, ray), passed) in places.into_iter().zip(passed) {
            behind[patch].push((ray, passed));
        }
        behind
    });
    Ok(slices.collect())
}
