//! The beams of a lidar whose rings nobody knows, told by the heights at which they look.
//!
//! A spinning lidar's beams have each an elevation of its own, and noise along a ray leaves it alone:
//! elevations of points lie at as many places as there are beams, to the last digits of their coordinates.

use scene::SensorEntry;
use schema::AgentId;

use super::clouds::Sweep;
use crate::{ExportError, SceneSource};

/// Sweeps of a scene in which beams are looked for: those that look into the sky here meet something
/// elsewhere.
const LOOKED_AT: u32 = 5;
/// Elevations that lie farther apart are those of two beams, rad: the beams of the finest lidars are 0.1
/// degrees apart.
const APART_RAD: f64 = 0.02 * std::f64::consts::PI / 180.0;
/// Those of one beam lie within this, rad.
const TOGETHER_RAD: f64 = APART_RAD;
/// A beam has at least so many points on average: fewer lie apart by chance.
const LEAST_POINTS: usize = 16;
/// Nothing finer is thinned: more beams than any lidar has are no beams.
const MOST_BEAMS: usize = 1024;

/// Which beam of a lidar each point is of.
#[derive(Clone, Debug)]
pub(super) enum Rings {
    /// The store says it.
    Known,
    /// Nobody says it of an imported scene, but elevations tell.
    Told(Beams),
    /// Nobody knows.
    Unknown,
}

impl Rings {
    /// Of a lidar of a scene.
    ///
    /// # Errors
    /// Its table cannot be read.
    pub(super) fn of(scene: &SceneSource, agent: AgentId, lidar: &SensorEntry) -> Result<Self, ExportError> {
        if !scene.unknown_columns(agent, lidar)?.contains("ring") {
            return Ok(Self::Known);
        }
        let every = lidar.about.every_n_frames.max(1);
        let last = scene.info().frames.saturating_sub(1) / every;
        let mut frames: Vec<u32> = (0..LOOKED_AT).map(|n| every * (n * last / (LOOKED_AT - 1))).collect();
        frames.dedup();
        let (mut readings, mut sweeps) = (scene.readings::<Sweep>(agent, lidar)?, Vec::new());
        for frame in frames {
            sweeps.extend(readings.at(frame)?);
        }
        Ok(Beams::of(&sweeps).map_or(Self::Unknown, Self::Told))
    }
}

/// Elevations of beams, rad, from the highest down.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Beams(Vec<f64>);

impl Beams {
    /// Those of some sweeps of one lidar; none where elevations do not lie at a few places.
    pub(super) fn of(sweeps: &[Sweep]) -> Option<Self> {
        let mut all: Vec<f64> = sweeps.iter().flat_map(Sweep::elevations).collect();
        all.sort_by(|a, b| b.total_cmp(a));
        let mut beams = Vec::new();
        for beam in all.chunk_by(|a, b| a - b <= APART_RAD) {
            let (highest, lowest) = (beam[0], beam[beam.len() - 1]);
            if highest - lowest > TOGETHER_RAD {
                return None;
            }
            beams.push(0.5 * (highest + lowest));
        }
        let is_few = beams.len() > 1 && beams.len() <= MOST_BEAMS && all.len() >= LEAST_POINTS * beams.len();
        is_few.then_some(Self(beams))
    }

    /// The beam of an elevation, from the highest, 0, on: the nearest.
    fn ring(&self, elevation: f64) -> u16 {
        let below = self.0.partition_point(|beam| *beam > elevation);
        let above = below.saturating_sub(1);
        let off = |at: usize| self.0.get(at).map_or(f64::INFINITY, |beam| (beam - elevation).abs());
        // There are no more than a thousand.
        (if off(above) <= off(below) { above } else { below }) as u16
    }

    /// The rings of a sweep's points.
    pub(super) fn rings(&self, sweep: &Sweep) -> Vec<u16> {
        sweep.elevations().map(|elevation| self.ring(elevation)).collect()
    }
}

#[cfg(test)]
mod tests {
    use frames::math;

    use super::*;

    /// A sweep of beams at some elevations (degrees): so many columns, ranges that change from ray to ray,
    /// their rings.
    fn sweep(beams_deg: &[(u16, f64)], columns: u32, smear: f64) -> Sweep {
        let mut sweep = Sweep::default();
        for column in 0..columns {
            let azimuth = f64::from(column) * std::f64::consts::TAU / f64::from(columns);
            for (ring, elevation_deg) in beams_deg {
                let spread = smear * math::sin(7.0 * azimuth);
                let up = frames::deg(elevation_deg + spread);
                let range = 3.0 + f64::from((column * 31 + u32::from(*ring) * 17) % 100);
                sweep.x.push((range * math::cos(up) * math::cos(azimuth)) as f32);
                sweep.y.push((range * math::cos(up) * math::sin(azimuth)) as f32);
                sweep.z.push((range * math::sin(up)) as f32);
                sweep.ring.push(*ring);
            }
        }
        sweep.intensity = vec![0.0; sweep.x.len()];
        sweep
    }

    fn beams(n: u16) -> Vec<(u16, f64)> {
        (0..n).map(|ring| (ring, 10.67 - 41.34 * f64::from(ring) / f64::from(n - 1))).collect()
    }

    #[test]
    fn rings_are_found_again() {
        let all = beams(128);
        let whole = sweep(&all, 90, 0.0);
        // The upper beams meet nothing at this frame: rings are counted from the highest that ever met
        // something.
        let low = sweep(&all[40..], 90, 0.0);
        let found = Beams::of(&[low.clone(), whole.clone()]).expect("has beams");
        assert_eq!(found.0.len(), 128);
        assert_eq!(found.rings(&whole), whole.ring);
        assert_eq!(found.rings(&low), low.ring);
        // Uneven ones too; what lies between two belongs to the nearer one.
        let uneven = [(0, 15.0), (1, 3.0), (2, 2.8), (3, -25.0)];
        let found = Beams::of(&[sweep(&uneven, 90, 0.0)]).expect("has beams");
        assert_eq!(
            [20.0, 9.1, 8.9, -11.0, -11.2, -80.0].map(|deg| found.ring(frames::deg(deg))),
            [0, 0, 1, 2, 3, 3]
        );
    }

    #[test]
    fn clouds_without_beams_are_told() {
        // A tenth of a degree up and down: beams run into one another.
        assert_eq!(Beams::of(&[sweep(&beams(128), 200, 0.2)]), None);
        // Few points, each at a place of its own.
        assert_eq!(Beams::of(&[sweep(&beams(100), 1, 0.0)]), None);
        assert_eq!(Beams::of(&[sweep(&beams(2)[..1], 200, 0.0)]), None, "a single one cannot be thinned");
        assert_eq!((Beams::of(&[]), Beams::of(&[Sweep::default()])), (None, None));
    }
}
