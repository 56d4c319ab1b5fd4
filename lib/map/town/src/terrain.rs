//! The ground before roads are built: a closed form, the same on every machine.

use frames::math::{exp, sin, sin_cos};
use std::f64::consts::TAU;

/// A smooth wave over the whole plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wave {
    /// Half the difference between crest and trough, metres.
    pub(crate) amplitude_m: f64,
    /// Between two crests, metres.
    pub(crate) period_m: f64,
    /// Direction across the crests, radians from east.
    pub(crate) heading_rad: f64,
    pub(crate) phase_rad: f64,
}

/// A hill (or, with a negative height, a hollow): a Gaussian bell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hill {
    /// Metres east and north.
    pub(crate) at_m: [f64; 2],
    pub(crate) height_m: f64,
    /// Distance at which it has fallen to 61 %, metres.
    pub(crate) radius_m: f64,
}

/// Levelled ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pad {
    /// Metres east and north.
    pub(crate) at_m: [f64; 2],
    /// Level up to here, metres.
    pub(crate) radius_m: f64,
    /// As it was from here on, metres.
    pub(crate) blend_m: f64,
}

/// A river bed or a cutting along a line: roads lead over it on bridges.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    /// Its middle, metres east and north.
    pub(crate) line_m: Vec<[f64; 2]>,
    /// Width of its floor, metres.
    pub(crate) width_m: f64,
    /// Width of each slope beside it, metres.
    pub(crate) slope_m: f64,
    pub(crate) depth_m: f64,
}

/// Heights of the ground, metres: waves and hills, levelled by pads, cut by channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Terrain {
    pub(crate) waves: Vec<Wave>,
    pub(crate) hills: Vec<Hill>,
    pub(crate) pads: Vec<Pad>,
    pub(crate) channels: Vec<Channel>,
}

impl Terrain {
    /// Level ground at height 0.
    pub(crate) fn flat() -> Self {
        Self::default()
    }

    /// Lowers waves and hills to a share of their height. Channels stay as deep.
    pub(crate) fn flatten(&mut self, share: f64) {
        self.waves.iter_mut().for_each(|w| w.amplitude_m *= share);
        self.hills.iter_mut().for_each(|h| h.height_m *= share);
    }

    fn raw(&self, x: f64, y: f64) -> f64 {
        let wave = |w: &Wave| {
            let (s, c) = sin_cos(w.heading_rad);
            w.amplitude_m * sin(TAU * (x * c + y * s) / w.period_m + w.phase_rad)
        };
        let hill = |h: &Hill| {
            let (dx, dy) = (x - h.at_m[0], y - h.at_m[1]);
            h.height_m * exp(-0.5 * (dx * dx + dy * dy) / (h.radius_m * h.radius_m))
        };
        self.waves.iter().map(wave).sum::<f64>() + self.hills.iter().map(hill).sum::<f64>()
    }

    /// Height of the ground as if there were no channels: what roads follow.
    pub(crate) fn bank(&self, x: f64, y: f64) -> f64 {
        let mut z = self.raw(x, y);
        for pad in &self.pads {
            let d = distance([x, y], pad.at_m);
            if d < pad.blend_m {
                let share = smooth((pad.blend_m - d) / (pad.blend_m - pad.radius_m).max(1e-9));
                z += share * (self.raw(pad.at_m[0], pad.at_m[1]) - z);
            }
        }
        z
    }

    /// Height of the ground.
    pub(crate) fn ground(&self, x: f64, y: f64) -> f64 {
        let mut deepest = 0.0f64;
        for channel in &self.channels {
            let near = channel.line_m.windows(2).map(|leg| to_segment([x, y], leg[0], leg[1]));
            let d = near.fold(f64::INFINITY, f64::min) - 0.5 * channel.width_m;
            deepest = deepest.max(channel.depth_m * smooth(1.0 - d.max(0.0) / channel.slope_m.max(1e-9)));
        }
        self.bank(x, y) - deepest
    }
}

/// 0 below 0, 1 above 1, level at both and smooth between them.
fn smooth(share: f64) -> f64 {
    let u = share.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}

/// Distance from a point to a segment.
fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy).max(1e-12);
    let u = along.clamp(0.0, 1.0);
    distance(p, [a[0] + u * dx, a[1] + u * dy])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pads_level_and_channels_cut() {
        let terrain = Terrain {
            waves: vec![Wave { amplitude_m: 5.0, period_m: 300.0, heading_rad: 0.4, phase_rad: 1.0 }],
            hills: vec![Hill { at_m: [100.0, 0.0], height_m: 20.0, radius_m: 80.0 }],
            pads: vec![Pad { at_m: [60.0, 10.0], radius_m: 20.0, blend_m: 40.0 }],
            channels: vec![Channel {
                line_m: vec![[-50.0, -200.0], [-50.0, 200.0]],
                width_m: 20.0,
                slope_m: 10.0,
                depth_m: 5.0,
            }],
        };
        let middle = terrain.bank(60.0, 10.0);
        assert!((terrain.bank(75.0, 20.0) - middle).abs() < 1e-12);
        assert!((terrain.bank(60.0, 60.0) - terrain.raw(60.0, 60.0)).abs() < 1e-12);
        assert!((terrain.bank(-45.0, 7.0) - terrain.ground(-45.0, 7.0) - 5.0).abs() < 1e-12);
        assert!((terrain.bank(-65.0, 7.0) - terrain.ground(-65.0, 7.0) - 2.5).abs() < 1e-12);
        assert_eq!(terrain.bank(-71.0, 7.0), terrain.ground(-71.0, 7.0));
    }
}
