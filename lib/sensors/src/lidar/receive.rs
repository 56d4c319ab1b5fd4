//! From hits of rays to returns.

use glam::{Affine3A, Vec3};
use random::Stream;
use renderer::{Hit, Hits};
use schema::geometry::Snapshot;
use schema::settings::LidarSpec;
use schema::{ObjectId, ReturnKind};

use super::air::Air;
use super::beam::{Echo, Met, add_air, echoes_of, keep};
use super::reflectance::reflectance;
use crate::struck::Struck;

/// Returns within this distance ahead or behind and [`CROP_LEFT_M`] to the sides are of the agent's own body.
const CROP_AHEAD_M: f32 = 2.44;
/// See [`CROP_AHEAD_M`].
const CROP_LEFT_M: f32 = 1.04;
/// Random words of a beam besides its first four have numbers: from here on of its further returns, and of the air.
const FURTHER: u32 = 1;
/// See [`FURTHER`].
const OF_AIR: u32 = 4;

/// Some beams of a sweep: numbers and random words, and where their rays go in the snapshot's local frame.
pub(super) struct Volley {
    pub(super) beams: Vec<(u32, [u32; 4])>,
    /// As many for each beam.
    pub(super) directions: Vec<Vec3>,
}

/// One return.
#[derive(Clone, Copy)]
pub(super) struct Return {
    pub(super) ray: u32,
    pub(super) point_m: Vec3,
    pub(super) intensity: f32,
    pub(super) id: ObjectId,
    pub(super) tag: u8,
    pub(super) cos_angle: f32,
    /// Number among the returns of its beam, from 1, and how many these are.
    pub(super) number: u8,
    pub(super) count: u8,
    pub(super) kind: ReturnKind,
}

/// Turns hits of rays that were fired at one moment into returns.
pub(super) struct Receiver<'a> {
    pub(super) spec: &'a LidarSpec,
    /// Unit directions of all beams in the sensor frame.
    pub(super) directions: &'a [Vec3],
    pub(super) snapshot: &'a Snapshot,
    /// The moment: 0 at the frame, 1 a period ago.
    pub(super) before: f32,
    /// Sensor frame of the moment to that of the frame, where points are given in the latter.
    pub(super) now_from_then: Option<Affine3A>,
    pub(super) air: Option<&'a Air>,
    pub(super) stream: &'a Stream,
    pub(super) frame: u32,
}

/// The random words of a beam at a frame, by number.
pub(super) fn words_of(stream: &Stream, frame: u32, ray: u32, number: u32) -> [u32; 4] {
    // Rays are numbered below 2^22 (`ScanPattern::MAX_RAYS`).
    stream.at(u64::from(frame) << 32 | u64::from(number) << 22 | u64::from(ray))
}

impl Receiver<'_> {
    /// The returns of a volley, beam by beam.
    pub(super) fn receive(&self, volley: &Volley, hits: &Hits) -> Vec<Return> {
        if !self.spec.tells_returns() {
            let rays = volley.beams.iter().zip(&volley.directions).zip(hits.iter());
            return rays
                .filter_map(|((&(ray, words), &direction), hit)| self.single(ray, words, direction, &hit?))
                .collect();
        }
        let rays = volley.directions.len() / volley.beams.len().max(1);
        let (mut met, mut echoes, mut returns) = (Vec::new(), Vec::new(), Vec::new());
        for (beam, &(ray, words)) in volley.beams.iter().enumerate() {
            met.clear();
            echoes.clear();
            let own = beam * rays..(beam + 1) * rays;
            met.extend(
                own.clone().filter_map(|at| self.met(volley.directions[at], &hits.get(at)?, at == own.start)),
            );
            echoes_of(&mut met, rays, self.air, &mut echoes);
            if let Some(air) = self.air {
                let nearest_m = met.first().map_or(f32::INFINITY, |met| met.range_m);
                let words = |number| words_of(self.stream, self.frame, ray, OF_AIR + number);
                add_air(air, self.spec.range_m as f32, nearest_m, &words, &mut echoes);
            }
            keep(&mut echoes, self.spec.beam.returned);
            self.echoed(ray, words, &echoes, &mut returns);
        }
        returns
    }

    /// The return of a beam of one ray, unless it is too weak or of the agent's own body.
    fn single(&self, ray: u32, words: [u32; 4], direction_local: Vec3, hit: &Hit) -> Option<Return> {
        let (point_m, bare) = self.place(ray, words, hit.t, true)?;
        let met = self.met(direction_local, hit, true)?;
        let (intensity, kind) = (met.intensity(bare), ReturnKind::Surface);
        let Met { cos_angle, id, tag, .. } = met;
        Some(Return { ray, point_m, intensity, id, tag, cos_angle, number: 1, count: 1, kind })
    }

    /// The returns of a beam from its echoes, the nearest first.
    fn echoed(&self, ray: u32, words: [u32; 4], echoes: &[Echo], returns: &mut Vec<Return>) {
        let first = returns.len();
        for (number, echo) in (0..).zip(echoes) {
            let words = match number {
                0 => words,
                further => words_of(self.stream, self.frame, ray, FURTHER + further - 1),
            };
            let is_surface = echo.kind == ReturnKind::Surface;
            let Some((point_m, bare)) = self.place(ray, words, echo.range_m, is_surface) else { continue };
            let Echo { intensity, id, tag, cos_angle, kind, .. } = *echo;
            let number = (returns.len() - first + 1) as u8;
            returns.push(Return {
                ray,
                point_m,
                intensity: bare * intensity,
                id,
                tag,
                cos_angle,
                number,
                count: 0,
                kind,
            });
        }
        let count = (returns.len() - first) as u8;
        returns[first..].iter_mut().for_each(|r| r.count = count);
    }

    /// What a ray met.
    fn met(&self, direction_local: Vec3, hit: &Hit, is_axis: bool) -> Option<Met> {
        let surface = Struck::before(self.snapshot, hit, self.before)?;
        let cos_angle = surface.normal_local.dot(direction_local).abs().min(1.0);
        Some(Met {
            range_m: hit.t,
            reflectance: reflectance(surface.part),
            cos_angle,
            id: surface.object,
            tag: surface.part.tag as u8,
            is_axis,
        })
    }

    /// Where a return of a distance is seen, and its bare intensity `exp(-attenuation d)`; none if it is dropped for weakness (a
    /// surface's) or of the agent's own body.
    fn place(&self, ray: u32, words: [u32; 4], range_m: f32, is_surface: bool) -> Option<(Vec3, f32)> {
        let spec = self.spec;
        let bare = frames::math::f32::exp(-(spec.attenuation_per_m as f32) * range_m);
        let mut range_m = range_m;
        if !spec.semantic {
            let limit = spec.dropoff_intensity_limit as f32;
            let zero = spec.dropoff_zero_intensity as f32;
            let is_weak = is_surface && limit > 0.0 && bare <= limit;
            if is_weak && random::unit_f32(words[1]) >= 1.0 - zero + bare * zero / limit {
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
        Some((self.now_from_then.map_or(point_m, |turned| turned.transform_point3(point_m)), bare))
    }
}
