//! Beams of a patch as rays.

use glam::{Affine3A, Vec3};
use random::Stream;
use settings::LidarSpec;

use super::beam::{beside, offsets};
use super::patch::Patch;

/// Beams that are worked out at once.
const LANES: usize = 8;

/// What beams are fired with at one moment.
pub(super) struct Emitter<'a> {
    spec: &'a LidarSpec,
    /// Unit directions of all beams in the sensor frame.
    directions: &'a [Vec3],
    local_from_sensor: Affine3A,
    /// Where the rays of a beam go besides along its axis.
    offsets: Vec<[f32; 2]>,
}

/// What chance decided of the beams of a patch.
pub(super) struct Drawn {
    /// Random words of each beam of the patch, row by row.
    pub(super) words: Vec<[u32; 4]>,
    /// Those that are not dropped at random, in following order.
    pub(super) kept: Vec<u32>,
}

/// The index of a beam's random words of a number at a frame.
pub(super) fn words_index(frame: u32, ray: u32, number: u32) -> u64 {
    // Rays are numbered below 2^22 (`ScanPattern::MAX_RAYS`).
    u64::from(frame) << 32 | u64::from(number) << 22 | u64::from(ray)
}

impl<'a> Emitter<'a> {
    pub(super) fn new(spec: &'a LidarSpec, directions: &'a [Vec3], local_from_sensor: Affine3A) -> Self {
        Self { spec, directions, local_from_sensor, offsets: offsets(&spec.beam) }
    }

    /// Rays a beam.
    pub(super) fn rays(&self) -> usize {
        1 + self.offsets.len()
    }

    /// Where the rays of some beams of a patch go, of each that along its axis first: unit directions in the
    /// snapshot's local frame.
    pub(super) fn fire(&self, patch: &Patch, beams: &[u32]) -> Vec<Vec3> {
        let mut axes = Vec::with_capacity(patch.order.len());
        for row in patch.rows.clone() {
            turn(&self.local_from_sensor, &self.directions[patch.beams(row, self.spec)], &mut axes);
        }
        let mut directions = Vec::with_capacity(beams.len() * self.rays());
        for &beam in beams {
            let at = beam as usize;
            directions.push(axes[at]);
            if !self.offsets.is_empty() {
                let (row, column) = (at / patch.columns.len(), at % patch.columns.len());
                let axis = self.directions[patch.beams(patch.rows.start + row, self.spec).start + column];
                let turned = |direction| self.local_from_sensor.transform_vector3(direction).normalize();
                directions.extend(self.offsets.iter().map(|&offset| turned(beside(axis, offset))));
            }
        }
        directions
    }
}

impl Drawn {
    pub(super) const DROPPED: u32 = u32::MAX;

    /// Draws for the beams of a patch.
    pub(super) fn new(spec: &LidarSpec, patch: &Patch, stream: &Stream, frame: u32) -> Self {
        let mut words = Vec::with_capacity(patch.order.len());
        for row in patch.rows.clone() {
            let beams = patch.beams(row, spec);
            draw(spec, (stream, frame), beams.start as u32, beams.len(), &mut words);
        }
        let drop_below = if spec.semantic { 0.0 } else { spec.dropoff_rate as f32 };
        let is_kept =
            |beam: &u32| drop_below <= 0.0 || random::unit_f32(words[*beam as usize][0]) >= drop_below;
        let kept = patch.order.iter().copied().filter(is_kept).collect();
        Self { words, kept }
    }

    /// Place of each beam of the patch, row by row, among those that were fired (the kept ones and maybe
    /// others, in following order); [`Drawn::DROPPED`] for those that are not kept.
    pub(super) fn places(&self, fired: &[u32]) -> Vec<u32> {
        let mut places = vec![Self::DROPPED; self.words.len()];
        let mut kept = self.kept.iter().peekable();
        for (beam, place) in fired.iter().zip(0..) {
            if kept.next_if_eq(&beam).is_some() {
                places[*beam as usize] = place;
            }
        }
        places
    }
}

/// Adds the first random words of some beams of a row.
fn draw(
    spec: &LidarSpec,
    (stream, frame): (&Stream, u32),
    first: u32,
    count: usize,
    words: &mut Vec<[u32; 4]>,
) {
    let end = words.len() + count;
    if spec.semantic {
        words.resize(end, [0; 4]);
        return;
    }
    let mut index = words_index(frame, first, 0);
    while words.len() < end {
        let drawn = stream.run_at::<LANES>(index);
        let left = end - words.len();
        words.extend((0..left.min(LANES)).map(|lane| drawn.map(|word| word[lane])));
        index += LANES as u64;
    }
}

/// Adds unit directions turned into another frame, of unit length again. Lanes of plain arrays, which the
/// compiler turns into vector instructions.
fn turn(turn: &Affine3A, directions: &[Vec3], turned: &mut Vec<Vec3>) {
    let alone = |direction: &Vec3| turn.transform_vector3(*direction).normalize();
    let (groups, rest) = directions.as_chunks::<LANES>();
    let [a, b, c] = [turn.matrix3.x_axis, turn.matrix3.y_axis, turn.matrix3.z_axis].map(Vec3::from);
    for group in groups {
        let lanes = [group.map(|d| d.x), group.map(|d| d.y), group.map(|d| d.z)];
        let [mut x, mut y, mut z] = lanes;
        for ((x, y), z) in x.iter_mut().zip(&mut y).zip(&mut z) {
            // In the order of glam's own operations: the same bits.
            let to = [
                a.x * *x + b.x * *y + c.x * *z,
                a.y * *x + b.y * *y + c.y * *z,
                a.z * *x + b.z * *y + c.z * *z,
            ];
            let scale = 1.0 / (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]).sqrt();
            [*x, *y, *z] = to.map(|along| along * scale);
        }
        turned.extend((0..LANES).map(|lane| Vec3::new(x[lane], y[lane], z[lane])));
    }
    turned.extend(rest.iter().map(alone));
}
