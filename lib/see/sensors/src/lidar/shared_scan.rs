//! Lidars of one agent that fire the same beams.

use render::Scene;
use schema::rate;
use settings::{LidarSpec, Mount, Rig};

use super::instrument::Lidar;
use super::path::LidarMoment;
use super::scan::Scan;
use crate::error::SensorError;

/// What more rays meet is not kept for other lidars: some 64 MB a frame.
const MOST_RAYS: u64 = 1 << 21;

/// Lidars of a rig that fire the same beams, whose rays are followed once for all of them: a semantic lidar
/// is mostly the other one's twin.
#[derive(Clone, Debug)]
pub struct SharedBeams(Vec<Twins>);

#[derive(Clone, Debug)]
struct Twins {
    lidar: Lidar,
    /// Of each of them at how many frames it sweeps once.
    every_n_frames: Vec<u32>,
}

/// Rays of the same beams at a frame.
pub(crate) struct SharedScan {
    spec: LidarSpec,
    pub(crate) scan: Scan,
}

impl SharedBeams {
    /// Looks for such lidars in a rig.
    ///
    /// # Errors
    /// As [`Lidar::new`].
    pub fn of(rig: &Rig) -> Result<Self, SensorError> {
        Self::for_tables(rig, |_| true)
    }

    /// The same among those whose tables are made, by the tables' names.
    ///
    /// # Errors
    /// As [`Lidar::new`].
    pub fn for_tables(rig: &Rig, is_made: impl Fn(&str) -> bool) -> Result<Self, SensorError> {
        let mut all: Vec<(&LidarSpec, Vec<u32>)> = Vec::new();
        for spec in rig.lidars.iter().filter(|spec| is_made(&spec.name)) {
            match all.iter_mut().find(|(first, _)| fire_alike(first, spec)) {
                Some((_, every_n_frames)) => every_n_frames.push(spec.every_n_frames),
                None => all.push((spec, vec![spec.every_n_frames])),
            }
        }
        all.retain(|(spec, every_n_frames)| every_n_frames.len() > 1 && rays(spec) <= MOST_RAYS);
        let twins = |(spec, every_n_frames)| Ok(Twins { lidar: Lidar::new(spec)?, every_n_frames });
        Ok(Self(all.into_iter().map(twins).collect::<Result<_, SensorError>>()?))
    }

    /// Follows the rays that several lidars fire at a frame.
    ///
    /// # Errors
    /// The renderer failed.
    pub(crate) fn scans(
        &self,
        scene: &dyn Scene,
        frame: u32,
        moment: impl Fn(&Mount) -> LidarMoment,
    ) -> Result<Vec<SharedScan>, SensorError> {
        let is_worth = |twins: &&Twins| {
            twins.every_n_frames.iter().filter(|every| rate::is_due(frame, **every)).count() > 1
        };
        let scan = |Twins { lidar, .. }: &Twins| {
            let scan = lidar.scan(scene, &moment(&lidar.spec().mount))?;
            Ok(SharedScan { spec: lidar.spec().clone(), scan })
        };
        self.0.iter().filter(is_worth).map(scan).collect()
    }
}

impl SharedScan {
    /// Whether a lidar fires these beams.
    pub(crate) fn is_of(&self, spec: &LidarSpec) -> bool {
        fire_alike(&self.spec, spec)
    }
}

/// Rays that a lidar fires in a sweep.
fn rays(spec: &LidarSpec) -> u64 {
    u64::from(spec.scan.channels) * u64::from(spec.scan.columns) * u64::from(spec.beam.rays)
}

/// Whether two lidars of an agent fire the same beams and follow them alike.
fn fire_alike(a: &LidarSpec, b: &LidarSpec) -> bool {
    (a.mount, &a.scan, a.range_m, &a.rolling, a.glass) == (b.mount, &b.scan, b.range_m, &b.rolling, b.glass)
        && (a.beam.rays, a.beam.divergence_rad) == (b.beam.rays, b.beam.divergence_rad)
}
