//! Lanes as chains of samples with arc length: what drivers and walkers follow.

use nalgebra::{Point3, Vector3};
use opendrive::{LaneId, LaneInfo, Map};

/// Distance between samples, metres of s.
const STEP_M: f64 = 2.0;
/// Most samples of one lane.
const MAX_SAMPLES: f64 = 100_000.0;
/// Two lanes whose ends are nearer than this make one smooth line, metres.
const MIN_LENGTH_M: f64 = 1e-3;

/// One sample of a way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Metres along the way, from where travel enters it.
    pub(crate) along_m: f64,
    /// On the surface.
    pub(crate) point: Point3<f64>,
    /// Direction of travel, unit length.
    pub(crate) tangent: Vector3<f64>,
    /// Roll of the surface about the direction of travel, radians.
    pub(crate) roll_rad: f64,
    /// Width of the lane, metres.
    pub(crate) width_m: f64,
}

/// A place on a way, between its samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CentrelinePoint {
    pub(crate) point: Point3<f64>,
    /// Direction of travel, radians from east.
    pub(crate) heading_rad: f64,
    /// Positive nose down.
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
    pub(crate) width_m: f64,
}

impl CentrelinePoint {
    /// Metres ahead of and to the left of it.
    pub(crate) fn local(&self, point: &Point3<f64>) -> [f64; 2] {
        let (sin, cos) = frames::math::sin_cos(self.heading_rad);
        let away = point - self.point;
        [away.x * cos + away.y * sin, away.y * cos - away.x * sin]
    }
}

/// A lane's centre line in the direction of travel.
#[derive(Clone, Debug)]
pub(crate) struct Centreline {
    pub(crate) lane: LaneId,
    pub(crate) length_m: f64,
    pub(crate) samples: Vec<Sample>,
}

impl Centreline {
    /// Samples a lane; None where it has no extent.
    pub(crate) fn new(map: &Map, lane: &LaneInfo) -> Option<Self> {
        Self::beside(map, lane, &|_| 0.0)
    }

    /// Samples a line beside a lane's middle, so far to its left in the direction of travel as is told for
    /// its width; None where that has no extent.
    pub(crate) fn beside(map: &Map, lane: &LaneInfo, left_m: &dyn Fn(f64) -> f64) -> Option<Self> {
        let length = lane.s_length();
        let steps = (length / STEP_M).ceil().clamp(1.0, MAX_SAMPLES);
        let mut samples: Vec<Sample> = Vec::new();
        let mut along_m = 0.0;
        for i in 0..=steps as usize {
            let s = lane.s_of_along(length * (i as f64 / steps));
            let mut at = map.lane_point(lane.id, s, 0.0)?;
            let left_m = left_m(at.width_m);
            if left_m != 0.0 {
                at = map.lane_point(lane.id, s, left_m)?;
            }
            let (sin, cos) = frames::math::sin_cos(at.heading_rad);
            let (down, flat) = frames::math::sin_cos(at.pitch_rad);
            let tangent = Vector3::new(cos * flat, sin * flat, -down);
            if let Some(last) = samples.last() {
                if (at.position - last.point).norm() < MIN_LENGTH_M {
                    continue;
                }
                along_m += arc_m((&last.point, &last.tangent), (&at.position, &tangent));
            }
            samples.push(Sample {
                along_m,
                point: at.position,
                tangent,
                roll_rad: at.roll_rad,
                width_m: at.width_m,
            });
        }
        (along_m > MIN_LENGTH_M).then_some(Self { lane: lane.id, length_m: along_m, samples })
    }

    /// The parts of it whose samples are wanted and that are at least so long, with a width of their own.
    pub(crate) fn parts(&self, wanted: &dyn Fn(&Sample) -> bool, least_m: f64, width_m: f64) -> Vec<Self> {
        let runs = self.samples.chunk_by(|a, b| wanted(a) == wanted(b)).filter(|run| wanted(&run[0]));
        let long = runs.filter(|run| run[run.len() - 1].along_m - run[0].along_m >= least_m && run.len() > 1);
        let part = |run: &[Sample]| {
            let from_m = run[0].along_m;
            let moved = |s: &Sample| Sample { along_m: s.along_m - from_m, width_m, ..*s };
            let samples: Vec<Sample> = run.iter().map(moved).collect();
            Self { lane: self.lane, length_m: samples[samples.len() - 1].along_m, samples }
        };
        long.map(part).collect()
    }

    /// Where travel enters it.
    pub(crate) fn start(&self) -> Point3<f64> {
        self.samples[0].point
    }

    /// Where travel leaves it.
    pub(crate) fn end(&self) -> Point3<f64> {
        self.samples[self.samples.len() - 1].point
    }

    /// Moves the end of the way to a point, and the last `span_m` metres with it, less and less towards the
    /// beginning of the stretch: by the smoothstep 3 u^2 - 2 u^3, whose slope is zero at both ends, so that
    /// the way's direction there stays.
    pub(crate) fn bend_end(&mut self, to: Point3<f64>, span_m: f64) {
        let (off, straight_m) = (to - self.end(), self.length_m - span_m);
        let mut along_m = 0.0;
        let mut before: Option<(Point3<f64>, Vector3<f64>)> = None;
        for sample in &mut self.samples {
            let u = ((sample.along_m - straight_m) / span_m).clamp(0.0, 1.0);
            sample.point += off * (u * u * (3.0 - 2.0 * u));
            sample.tangent = (sample.tangent + off * (6.0 * u * (1.0 - u) / span_m)).normalize();
            if let Some((point, tangent)) = &before {
                along_m += arc_m((point, tangent), (&sample.point, &sample.tangent));
            }
            sample.along_m = along_m;
            before = Some((sample.point, sample.tangent));
        }
        self.length_m = along_m;
    }

    /// Index of the last sample at or before a distance (never the last one).
    pub(crate) fn index(&self, along_m: f64) -> usize {
        let last = self.samples.len() - 2;
        // Samples are nearly evenly spaced: start from a guess and step.
        let guess = (along_m / self.length_m * (last + 1) as f64).clamp(0.0, last as f64);
        let mut i = guess as usize;
        while i > 0 && self.samples[i].along_m > along_m {
            i -= 1;
        }
        while i < last && self.samples[i + 1].along_m <= along_m {
            i += 1;
        }
        i
    }

    /// The place at a distance (clamped to the way): a cubic through the two samples with their tangents.
    pub(crate) fn place(&self, along_m: f64) -> CentrelinePoint {
        let along_m = along_m.clamp(0.0, self.length_m);
        let i = self.index(along_m);
        let (a, b) = (&self.samples[i], &self.samples[i + 1]);
        let span = b.along_m - a.along_m;
        let u = (along_m - a.along_m) / span;
        let (u2, v) = (u * u, 1.0 - u);
        let (h1, h2) = (u2 * (3.0 - 2.0 * u), u * v * v);
        let h3 = -u2 * v;
        let point = a.point + (b.point - a.point) * h1 + (a.tangent * h2 + b.tangent * h3) * span;
        // Its derivative by u, for the heading.
        let slope = (b.point - a.point) * (6.0 * u * v)
            + (a.tangent * (v * (1.0 - 3.0 * u)) + b.tangent * (u * (3.0 * u - 2.0))) * span;
        let flat = (slope.x * slope.x + slope.y * slope.y).sqrt();
        let mix = |x: f64, y: f64| x + (y - x) * u;
        CentrelinePoint {
            point,
            heading_rad: heading(&slope),
            pitch_rad: -frames::math::atan2(slope.z, flat),
            roll_rad: mix(a.roll_rad, b.roll_rad),
            width_m: mix(a.width_m, b.width_m),
        }
    }

    /// The place at a distance, before the beginning and beyond the end on the straight line that goes on
    /// there.
    pub(crate) fn place_beyond(&self, along_m: f64) -> CentrelinePoint {
        let mut place = self.place(along_m);
        let over_m = along_m - along_m.clamp(0.0, self.length_m);
        if over_m != 0.0 {
            let (sin, cos) = frames::math::sin_cos(place.heading_rad);
            let (down, flat) = frames::math::sin_cos(place.pitch_rad);
            place.point += Vector3::new(cos * flat, sin * flat, -down) * over_m;
        }
        place
    }

    /// The nearest distance along the way to a point, and the point's offset to the left, by the chords of
    /// the samples.
    pub(crate) fn project(&self, point: Point3<f64>) -> (f64, f64) {
        let mut best = (f64::INFINITY, 0.0, 0.0);
        for pair in self.samples.windows(2) {
            let (chord, away) = (pair[1].point - pair[0].point, point - pair[0].point);
            let part = (away.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
            let off = away - chord * part;
            let distance = off.norm_squared();
            if distance < best.0 {
                let left = (chord.x * off.y - chord.y * off.x)
                    / (chord.x * chord.x + chord.y * chord.y).sqrt().max(1e-9);
                best = (distance, pair[0].along_m + part * (pair[1].along_m - pair[0].along_m), left);
            }
        }
        (best.1, best.2)
    }
}

impl Centreline {
    /// The distance along the way whose cross-section holds a point, and the point's offset to the left
    /// there, on the curve itself. `near_m` is about right.
    pub(crate) fn cross(&self, point: Point3<f64>, near_m: f64) -> (f64, f64) {
        let mut along_m = near_m;
        let mut left_m = 0.0;
        for _ in 0..4 {
            let [ahead, left] = self.place(along_m).local(&point);
            left_m = left;
            along_m = (along_m + ahead).clamp(0.0, self.length_m);
        }
        (along_m, left_m)
    }

    /// The same on the way and its straight continuations.
    pub(crate) fn cross_beyond(&self, point: Point3<f64>, near_m: f64) -> (f64, f64) {
        let mut along_m = near_m;
        let mut left_m = 0.0;
        for _ in 0..8 {
            let [ahead, left] = self.place_beyond(along_m).local(&point);
            left_m = left;
            along_m += ahead;
        }
        (along_m, left_m)
    }

    /// Turn per metre to the left at a distance, radians.
    pub(crate) fn curvature(&self, along_m: f64) -> f64 {
        let [a, b] = [along_m - 1.0, along_m + 1.0].map(|s| s.clamp(0.0, self.length_m));
        frames::wrap_pi(self.place(b).heading_rad - self.place(a).heading_rad) / (b - a).max(1e-3)
    }
}

impl Centreline {
    /// The sharpest turn per metre to the left from a sample to the next one, on the curve itself, radians.
    pub(crate) fn sharpest(&self, index: usize) -> f64 {
        let (a, b) = (&self.samples[index], &self.samples[index + 1]);
        let (span, chord) = (b.along_m - a.along_m, b.point - a.point);
        let curvature = |u: f64| {
            let v = 1.0 - u;
            let first = chord * (6.0 * u * v)
                + (a.tangent * (v * (1.0 - 3.0 * u)) + b.tangent * (u * (3.0 * u - 2.0))) * span;
            let second =
                chord * (6.0 - 12.0 * u) + (a.tangent * (6.0 * u - 4.0) + b.tangent * (6.0 * u - 2.0)) * span;
            let square = first.x * first.x + first.y * first.y;
            (first.x * second.y - first.y * second.x) / (square * square.sqrt()).max(1e-9)
        };
        let parts = [0.0, 0.25, 0.5, 0.75, 1.0].map(curvature);
        parts.into_iter().fold(0.0, |most: f64, k| if k.abs() > most.abs() { k } else { most })
    }
}

/// Length of the way between two points with their directions of travel, metres: a circle's arc over its
/// chord is half the turn over its sine.
fn arc_m(from: (&Point3<f64>, &Vector3<f64>), to: (&Point3<f64>, &Vector3<f64>)) -> f64 {
    let half_turn = 0.5 * frames::wrap_pi(heading(to.1) - heading(from.1)).abs();
    (to.0 - from.0).norm() * (1.0 + half_turn * half_turn / 6.0)
}

/// Heading of a vector, radians from east.
pub(crate) fn heading(v: &Vector3<f64>) -> f64 {
    frames::math::atan2(v.y, v.x)
}
