//! A beam as several rays, and what they met as echoes.

use glam::Vec3;
use schema::{ObjectId, ReturnKind};
use settings::{BeamSpec, Returned};

use super::air::Air;

/// Surfaces nearer to one another than this along a beam make one echo, metres: half the length of a pulse of
/// 7 ns, and what makers of lidars ask for between two returns.
const APART_M: f32 = 1.0;
/// Rays of the ring about the axis.
const RING: usize = 6;
/// Radius of the ring over that of the beam, at which intensity is `exp(-2)` of the axis': the ring goes
/// through the middle of the light that is outside of the axis' own seventh, so that all rays stand for equal
/// parts.
const RING_RADIUS: f32 = 0.583_7;

/// Where the rays of a beam go besides along its axis, radians to the left and upwards. None for a single
/// ray. As in HELIOS++ (Winiwarter et al., "Virtual laser scanning with HELIOS++", Remote Sensing of
/// Environment 269, 2022): rings of rays.
pub(super) fn offsets(beam: &BeamSpec) -> Vec<[f32; 2]> {
    if beam.rays <= 1 {
        return Vec::new();
    }
    let radius = RING_RADIUS * 0.5 * beam.divergence_rad as f32;
    let place = |k: usize| {
        let (sin, cos) = frames::math::f32::sin_cos(std::f32::consts::TAU * k as f32 / RING as f32);
        [radius * cos, radius * sin]
    };
    (0..RING).map(place).collect()
}

/// A unit direction next to a beam's axis (unit length).
pub(super) fn beside(axis: Vec3, [left, up]: [f32; 2]) -> Vec3 {
    let to_left = Vec3::Z.cross(axis).try_normalize().unwrap_or(Vec3::Y);
    (axis + to_left * left + axis.cross(to_left) * up).normalize()
}

/// What one ray of a beam met.
#[derive(Clone, Copy, Debug)]
pub(super) struct BeamHit {
    pub(super) range_m: f32,
    /// Share of light that comes back from the surface, if all of the beam had met it.
    pub(super) share: f32,
    pub(super) cos_angle: f32,
    pub(super) id: ObjectId,
    pub(super) tag: u8,
    pub(super) is_axis: bool,
    /// Whether it is behind a pane.
    pub(super) is_behind: bool,
}

impl BeamHit {
    /// Intensity of an echo of the bare intensity `bare` that all of the beam had from here.
    pub(super) fn intensity(&self, bare: f32) -> f32 {
        bare * self.share
    }
}

/// One echo of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Echo {
    pub(super) range_m: f32,
    /// Without the lidar's own attenuation.
    pub(super) intensity: f32,
    power: f32,
    pub(super) cos_angle: f32,
    pub(super) id: ObjectId,
    pub(super) tag: u8,
    pub(super) kind: ReturnKind,
}

/// The echoes of surfaces that the rays of a beam met, the nearest first.
pub(super) fn echoes_of(met: &mut [BeamHit], rays: usize, air: Option<&Air>, echoes: &mut Vec<Echo>) {
    met.sort_by(|a, b| a.range_m.total_cmp(&b.range_m));
    for cluster in met.chunk_by(|a, b| b.range_m - a.range_m <= APART_M) {
        let Some(shown) = shown_of(cluster) else { continue };
        let passes = air.map_or(1.0, |air| air.passes(shown.range_m));
        let intensity = cluster.iter().map(|m| m.intensity(1.0)).sum::<f32>() / rays as f32 * passes;
        let power = intensity / (shown.range_m * shown.range_m);
        if air.is_some_and(|air| !air.detects(power)) {
            continue;
        }
        let BeamHit { range_m, cos_angle, id, tag, .. } = shown;
        let kind = if shown.is_behind { ReturnKind::BehindGlass } else { ReturnKind::Surface };
        echoes.push(Echo { range_m, intensity, power, cos_angle, id, tag, kind });
    }
}

/// The ray that stands for an echo: of the surface that sends most of its light, the axis, or else the ray
/// that met it nearest to its mean distance.
fn shown_of(cluster: &[BeamHit]) -> Option<BeamHit> {
    let surface = |met: &BeamHit| (met.id, met.tag, met.is_behind);
    let light_of = |one: &BeamHit| -> f32 {
        cluster.iter().filter(|m| surface(m) == surface(one)).map(|m| m.intensity(1.0)).sum()
    };
    let mut brightest = *cluster.first()?;
    for met in cluster {
        if light_of(met) > light_of(&brightest) {
            brightest = *met;
        }
    }
    let same = || cluster.iter().filter(|m| surface(m) == surface(&brightest));
    if let Some(axis) = same().find(|m| m.is_axis) {
        return Some(*axis);
    }
    let mean_m = same().map(|m| m.range_m).sum::<f32>() / same().count() as f32;
    same().copied().min_by(|a, b| (a.range_m - mean_m).abs().total_cmp(&(b.range_m - mean_m).abs()))
}

/// Adds what the air sends back in front of the nearest surface. `words` gives the beam's random words of a
/// number.
pub(super) fn add_air(
    air: &Air,
    reach_m: f32,
    nearest_m: f32,
    words: &dyn Fn(u32) -> [u32; 4],
    echoes: &mut Vec<Echo>,
) {
    let nearest_m = nearest_m.min(reach_m);
    let fog = air.fog_before(nearest_m, words(0)[0]).map(|echo| (echo, ReturnKind::Fog));
    let drop = air.drop_before(nearest_m, &|number| words(1 + number)).map(|echo| (echo, ReturnKind::Rain));
    for (back, kind) in fog.into_iter().chain(drop).filter(|(back, _)| air.detects(back.power)) {
        let (range_m, intensity, power) = (back.range_m, back.intensity, back.power);
        echoes.push(Echo { range_m, intensity, power, cos_angle: 0.0, id: 0, tag: 0, kind });
    }
    echoes.sort_by(|a, b| a.range_m.total_cmp(&b.range_m));
}

/// Keeps those echoes (the nearest first) that are returned.
pub(super) fn keep(echoes: &mut Vec<Echo>, returned: Returned) {
    let Some(last) = echoes.len().checked_sub(1) else { return };
    let mut strongest = 0;
    for (at, echo) in echoes.iter().enumerate() {
        if echo.power > echoes[strongest].power {
            strongest = at;
        }
    }
    let Returned { first, strongest: of_power, last: of_range } = returned;
    let mut at = 0;
    echoes.retain(|_| {
        let kept = first && at == 0 || of_power && at == strongest || of_range && at == last;
        at += 1;
        kept
    });
}
