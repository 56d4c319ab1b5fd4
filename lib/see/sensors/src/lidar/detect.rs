//! From hits of rays to returns.

use std::ops::Range;

use glam::{Affine3A, Vec3};
use random::Stream;
use render::Hit;
use schema::geometry::Snapshot;
use schema::{ObjectId, ReturnKind};
use settings::LidarSpec;

use super::air::Air;
use super::beam::{BeamHit, Echo, add_air, echoes_of, keep};
use super::emit::{Drawn, words_index};
use super::patch::Patch;
use super::reflectance::{Reflectance, reflectance};
use super::scan::Followed;
use super::sweep::{LidarSweep, Return, SweepPart};
use crate::surface_hit::SurfaceHit;
use render::panes::PASSES;

/// Returns within this distance ahead or behind and [`CROP_LEFT_M`] to the sides are of the agent's own body.
const CROP_AHEAD_M: f32 = 2.44;
/// See [`CROP_AHEAD_M`].
const CROP_LEFT_M: f32 = 1.04;
/// Random words of a beam besides its first four have numbers: from here on of its further returns, and of
/// the air.
const FURTHER: u32 = 1;
/// See [`FURTHER`].
const OF_AIR: u32 = 4;
/// Level are surfaces whose normals rise by more than this.
const LEVEL: f32 = 0.8;

/// Turns hits of rays that were fired at one moment into returns.
pub(super) struct Receiver<'a> {
    pub(super) spec: &'a LidarSpec,
    /// Unit directions of all beams in the sensor frame.
    pub(super) directions: &'a [Vec3],
    /// Rays a beam, of which the first goes along its axis.
    pub(super) rays: usize,
    pub(super) snapshot: &'a Snapshot,
    /// The moment: 0 at the frame, 1 a period ago.
    pub(super) before: f32,
    /// Sensor frame of the moment to that of the frame, where points are given in the latter.
    pub(super) now_from_then: Option<Affine3A>,
    pub(super) air: Option<&'a Air>,
    /// How wet the ground is.
    pub(super) wetness: f32,
    pub(super) stream: &'a Stream,
    pub(super) frame: u32,
}

/// What a task keeps from beam to beam: memory, and the surface that was met last, which neighbours often
/// meet too.
#[derive(Default)]
struct Scratch {
    face: Option<Face>,
    met: Vec<BeamHit>,
    echoes: Vec<Echo>,
    returns: Vec<Return>,
}

/// A triangle as a lidar sees it.
#[derive(Clone, Copy)]
struct Face {
    instance: u32,
    triangle: u32,
    /// Unit normal, either side, local frame.
    normal_local: Vec3,
    reflectance: Reflectance,
    id: ObjectId,
    tag: u8,
}

impl Receiver<'_> {
    /// The returns of a patch, beam by beam, of what the rays of those beams met that were fired: the kept
    /// ones at least.
    pub(super) fn receive(
        &self,
        patch: &Patch,
        drawn: &Drawn,
        fired: &[u32],
        followed: &Followed,
    ) -> SweepPart {
        let tells_returns = self.spec.tells_returns();
        let mut sweep = LidarSweep::with_capacity(drawn.kept.len(), tells_returns);
        let places = drawn.places(fired);
        let mut beams = places.iter().zip(&drawn.words);
        let mut row_ends = Vec::with_capacity(patch.rows.len());
        let mut desk = Scratch::default();
        for row in patch.rows.clone() {
            for (ray, (&place, &words)) in patch.beams(row, self.spec).zip(&mut beams) {
                if place == Drawn::DROPPED {
                    continue;
                }
                let own = place as usize * self.rays..(place as usize + 1) * self.rays;
                if tells_returns {
                    self.echoed(ray as u32, words, own, followed, &mut desk);
                    desk.returns.iter().for_each(|back| sweep.push(back));
                } else if let Some(hit) = followed.hits.get(own.start) {
                    let direction_local = followed.directions[own.start];
                    let back = self.single(ray as u32, words, direction_local, &hit, &mut desk.face);
                    back.iter().for_each(|back| sweep.push(back));
                }
            }
            sweep.ring.resize(sweep.x_m.len(), row as u16);
            row_ends.push(sweep.x_m.len());
        }
        sweep.time_offset_s.resize(sweep.x_m.len(), self.time_offset_s());
        SweepPart { sweep, row_ends }
    }

    fn time_offset_s(&self) -> f32 {
        match self.spec.rolling {
            Some(_) => (-f64::from(self.before) * schema::FRAME_PERIOD_S) as f32,
            None => 0.0,
        }
    }

    /// The return of a beam of one ray, unless it is too weak or of the agent's own body.
    #[inline]
    fn single(
        &self,
        ray: u32,
        words: [u32; 4],
        direction_local: Vec3,
        hit: &Hit,
        face: &mut Option<Face>,
    ) -> Option<Return> {
        let (point_m, bare) = self.place(ray, words, hit.t, true)?;
        let met = self.met(direction_local, hit, true, face)?;
        let (intensity, kind) = (met.intensity(bare), ReturnKind::Surface);
        let BeamHit { cos_angle, id, tag, .. } = met;
        Some(Return { point_m, intensity, id, tag, cos_angle, number: 1, count: 1, kind })
    }

    /// Leaves the returns of a beam of some of the rays on the desk, the nearest first.
    fn echoed(&self, ray: u32, words: [u32; 4], own: Range<usize>, followed: &Followed, desk: &mut Scratch) {
        let Followed { directions, hits, behind } = followed;
        let Scratch { face, met, echoes, returns } = desk;
        met.clear();
        echoes.clear();
        returns.clear();
        let first = behind.partition_point(|(ray, _)| (*ray as usize) < own.start);
        let beyond = || behind[first..].iter().take_while(|(ray, _)| (*ray as usize) < own.end);
        // An open door sends nothing back itself.
        let opened = |at: usize| beyond().any(|(ray, passed)| *ray as usize == at && passed.opened);
        met.extend(
            own.clone()
                .filter(|at| !opened(*at))
                .filter_map(|at| self.met(directions[at], &hits.get(at)?, at == own.start, face)),
        );
        for (ray, passed) in beyond() {
            let at = *ray as usize;
            let Some(hit) = &passed.hit else { continue };
            let seen = self.met(directions[at], hit, at == own.start, face);
            // There and back.
            let share = (0..2 * passed.panes).fold(1.0, |share, _| share * PASSES);
            met.extend(seen.map(|seen| BeamHit { share: share * seen.share, is_behind: true, ..seen }));
        }
        echoes_of(met, self.rays, self.air, echoes);
        if let Some(air) = self.air {
            let nearest_m = met.first().map_or(f32::INFINITY, |met| met.range_m);
            let words = |number| self.further_words(ray, OF_AIR + number);
            add_air(air, self.spec.range_m as f32, nearest_m, &words, echoes);
        }
        keep(echoes, self.spec.beam.returned);
        for (number, echo) in (0..).zip(&*echoes) {
            let words = match number {
                0 => words,
                further => self.further_words(ray, FURTHER + further - 1),
            };
            let is_surface = ReturnKind::is_of_surface(echo.kind as u8);
            let Some((point_m, bare)) = self.place(ray, words, echo.range_m, is_surface) else { continue };
            let Echo { intensity, id, tag, cos_angle, kind, .. } = *echo;
            let (intensity, number) = (bare * intensity, (returns.len() + 1) as u8);
            returns.push(Return { point_m, intensity, id, tag, cos_angle, number, count: 0, kind });
        }
        let count = returns.len() as u8;
        returns.iter_mut().for_each(|r| r.count = count);
    }

    fn further_words(&self, ray: u32, number: u32) -> [u32; 4] {
        self.stream.at(words_index(self.frame, ray, number))
    }

    /// What a ray met.
    #[inline]
    fn met(
        &self,
        direction_local: Vec3,
        hit: &Hit,
        is_axis: bool,
        last: &mut Option<Face>,
    ) -> Option<BeamHit> {
        let known = last.filter(|face| (face.instance, face.triangle) == (hit.instance, hit.triangle));
        let face = match known {
            Some(face) => face,
            None => *last.insert(self.face(hit)?),
        };
        let cos_angle = face.normal_local.dot(direction_local).abs().min(1.0);
        let Face { reflectance, id, tag, .. } = face;
        let share = reflectance.at(cos_angle);
        Some(BeamHit { range_m: hit.t, share, cos_angle, id, tag, is_axis, is_behind: false })
    }

    fn face(&self, hit: &Hit) -> Option<Face> {
        let surface_hit = SurfaceHit::before(self.snapshot, hit, self.before)?;
        Some(Face {
            instance: hit.instance,
            triangle: hit.triangle,
            normal_local: surface_hit.normal_local,
            reflectance: reflectance(
                surface_hit.part,
                surface_hit.paint,
                surface_hit.normal_local.z.abs() > LEVEL,
                self.wetness,
            ),
            id: surface_hit.object,
            tag: surface_hit.part.tag as u8,
        })
    }

    /// Where a return of a distance is seen, and its bare intensity `exp(-attenuation d)`; none if it is
    /// dropped for weakness (a surface's) or of the agent's own body.
    #[inline]
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
