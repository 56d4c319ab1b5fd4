//! What readings take, within a factor of two. Bytes as stored, measured on four datasets of 240 agent-frames
//! each (the demo town and three of CARLA's); seconds of one core, from the table of docs/performance.md.

use schema::ImageKind;
use settings::{RadarSpec, Rig};

/// What a pixel of an image takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelCost {
    /// Bytes as stored in images of 640 x 360 pixels; larger images take fewer.
    pub(crate) bytes: f64,
    /// Seconds of one core to make and encode it from what was seen.
    pub(crate) core_s: f64,
}

pub(crate) const fn pixel_cost(kind: ImageKind) -> PixelCost {
    let (bytes, core_s) = match kind {
        ImageKind::Rgb => (0.13, 52e-9),
        ImageKind::Semantic => (0.09, 3e-9),
        ImageKind::Instance => (0.07, 3e-9),
        ImageKind::Depth => (0.45, 15e-9),
        ImageKind::Flow => (0.5, 15e-9),
    };
    PixelCost { bytes, core_s }
}

/// Bytes of a pixel of flow that is kept as half floats: fewer digits, but not split into streams of bytes as
/// floats are.
pub(crate) const HALF_FLOW_PX: f64 = 0.61;
/// So many times the bytes of one ray's returns are those of a beam of several: most beams meet one thing.
const BEAM_BYTES: f64 = 1.04;

/// What one reading of a sensor takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReadingCost {
    /// What the readings are called, for people.
    pub(crate) output: &'static str,
    pub(crate) bytes: f64,
    pub(crate) core_s: f64,
    /// There is one at frames 0, n, 2 n, ...
    pub(crate) every_n_frames: u32,
}

/// What a reading of every sensor takes, cameras aside; receivers of a few numbers cost nothing to speak of.
pub(crate) fn reading_costs(rig: &Rig) -> impl Iterator<Item = ReadingCost> {
    let Rig { camera: _, cameras: _, lidars, radars, gnss: _, imu: _ } = rig;
    let of_rays = |output, rays: f64, bytes_ray, every_n_frames| ReadingCost {
        output,
        bytes: rays * bytes_ray,
        core_s: rays * 0.17e-6,
        every_n_frames,
    };
    let lidars = lidars.iter().map(move |lidar| {
        let (output, bytes_ray) =
            if lidar.semantic { ("semantic lidar sweeps", 8.0) } else { ("lidar sweeps", 9.2) };
        let cost = of_rays(output, lidar.scan.rays() as f64, bytes_ray, lidar.every_n_frames);
        let times = if lidar.beam.rays > 1 { BEAM_BYTES } else { 1.0 };
        ReadingCost { bytes: times * cost.bytes, core_s: cost.core_s * f64::from(lidar.beam.rays), ..cost }
    });
    let of_radar =
        move |radar: &RadarSpec| of_rays("radar readings", f64::from(radar.rays), 20.4, radar.every_n_frames);
    lidars.chain(radars.iter().map(of_radar))
}
