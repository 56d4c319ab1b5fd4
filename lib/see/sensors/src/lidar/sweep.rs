//! A sweep as lists, and as rows of tables.

use std::ops::Range;

use glam::Vec3;
use schema::table::{Framed, Row};
use schema::tables::{LidarReturnsRow, LidarRow, SemanticLidarRow};
use schema::{Joined, ObjectId, ReturnKind};

/// One sweep, in the order of the rays: highest channel first, each from the left end of the field of view
/// clockwise; returns of one beam stand together, the nearest first. All lists are equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LidarSweep {
    /// Forward, metres, sensor frame.
    pub x_m: Vec<f32>,
    /// Left, metres.
    pub y_m: Vec<f32>,
    /// Up, metres.
    pub z_m: Vec<f32>,
    /// Returned intensity, 0 to 1.
    pub intensity: Vec<f32>,
    /// Channel, 0 is the highest.
    pub ring: Vec<u16>,
    /// Seconds after the frame's time at which the ray was fired: 0, or less in a rolling scan.
    pub time_offset_s: Vec<f32>,
    /// Whose surface was hit.
    pub id: Vec<ObjectId>,
    /// What was hit.
    pub tag: Vec<u8>,
    /// Cosine of the angle between ray and surface normal, 0 to 1.
    pub cos_angle: Vec<f32>,
    /// Which of their beam's returns these are; none where each is the only one, of a surface.
    pub of_beam: Option<OfBeam>,
}

/// Which returns of their beams the returns of a sweep are. All lists are equally long.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OfBeam {
    /// Number among the returns of the beam, from 1, the nearest first.
    pub number: Vec<u8>,
    /// Returns of the beam.
    pub count: Vec<u8>,
    /// What sent the light back ([`schema::ReturnKind`]).
    pub kind: Vec<u8>,
}

impl LidarSweep {
    pub(super) fn with_capacity(n: usize, tells_returns: bool) -> Self {
        let of_beam = || OfBeam {
            number: Vec::with_capacity(n),
            count: Vec::with_capacity(n),
            kind: Vec::with_capacity(n),
        };
        Self {
            x_m: Vec::with_capacity(n),
            y_m: Vec::with_capacity(n),
            z_m: Vec::with_capacity(n),
            intensity: Vec::with_capacity(n),
            ring: Vec::with_capacity(n),
            time_offset_s: Vec::with_capacity(n),
            id: Vec::with_capacity(n),
            tag: Vec::with_capacity(n),
            cos_angle: Vec::with_capacity(n),
            of_beam: tells_returns.then(of_beam),
        }
    }

    /// Adds a return, but for its ring and its time.
    #[inline]
    pub(super) fn push(&mut self, back: &Return) {
        self.x_m.push(back.point_m.x);
        self.y_m.push(back.point_m.y);
        self.z_m.push(back.point_m.z);
        self.intensity.push(back.intensity);
        self.id.push(back.id);
        self.tag.push(back.tag);
        self.cos_angle.push(back.cos_angle);
        if let Some(of_beam) = &mut self.of_beam {
            of_beam.number.push(back.number);
            of_beam.count.push(back.count);
            of_beam.kind.push(back.kind as u8);
        }
    }

    /// Number of returns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x_m.len()
    }

    /// Whether nothing came back.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x_m.is_empty()
    }
}

/// One return, of a surface or of the air.
pub(super) struct Return {
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

/// What came back to a patch: a sweep of its beams, and where each of its rows ends in that.
pub(super) struct SweepPart {
    pub(super) sweep: LidarSweep,
    pub(super) row_ends: Vec<usize>,
}

/// One sweep of the parts of all slices, as many of each slice and of the same rows.
pub(super) fn joined(slices: &[Vec<SweepPart>], tells_returns: bool) -> LidarSweep {
    let mut pieces = Vec::new();
    for patch in 0..slices.first().map_or(0, Vec::len) {
        let mut done = vec![0; slices.len()];
        for row in 0..slices[0][patch].row_ends.len() {
            for (slice, start) in slices.iter().zip(&mut done) {
                let SweepPart { sweep, row_ends } = &slice[patch];
                pieces.push((sweep, *start..row_ends[row]));
                *start = row_ends[row];
            }
        }
    }
    let mut all = LidarSweep::with_capacity(0, tells_returns);
    let LidarSweep { x_m, y_m, z_m, intensity, ring, time_offset_s, id, tag, cos_angle, of_beam } = &mut all;
    rayon::scope(|tasks| {
        tasks.spawn(|_| *x_m = list(&pieces, |part| Some(&part.x_m)));
        tasks.spawn(|_| *y_m = list(&pieces, |part| Some(&part.y_m)));
        tasks.spawn(|_| *z_m = list(&pieces, |part| Some(&part.z_m)));
        tasks.spawn(|_| *intensity = list(&pieces, |part| Some(&part.intensity)));
        tasks.spawn(|_| *ring = list(&pieces, |part| Some(&part.ring)));
        tasks.spawn(|_| *time_offset_s = list(&pieces, |part| Some(&part.time_offset_s)));
        tasks.spawn(|_| *id = list(&pieces, |part| Some(&part.id)));
        tasks.spawn(|_| *tag = list(&pieces, |part| Some(&part.tag)));
        tasks.spawn(|_| *cos_angle = list(&pieces, |part| Some(&part.cos_angle)));
        if let Some(OfBeam { number, count, kind }) = of_beam {
            tasks.spawn(|_| *number = list(&pieces, |part| Some(&part.of_beam.as_ref()?.number)));
            tasks.spawn(|_| *count = list(&pieces, |part| Some(&part.of_beam.as_ref()?.count)));
            tasks.spawn(|_| *kind = list(&pieces, |part| Some(&part.of_beam.as_ref()?.kind)));
        }
    });
    all
}

/// One list of the pieces of many.
fn list<T: Copy>(
    pieces: &[(&LidarSweep, Range<usize>)],
    of: impl Fn(&LidarSweep) -> Option<&Vec<T>>,
) -> Vec<T> {
    let mut all = Vec::with_capacity(pieces.iter().map(|(_, range)| range.len()).sum());
    for (part, range) in pieces {
        all.extend_from_slice(of(part).map_or(&[], |list| &list[range.clone()]));
    }
    all
}

/// A row that holds a sweep.
pub(crate) trait SweepRow: Row + Clone + Framed + Send + 'static {
    fn of(sweep: LidarSweep, frame: u32) -> Self;

    /// Number of returns.
    fn returns(&self) -> usize;
}

impl SweepRow for LidarRow {
    fn of(sweep: LidarSweep, frame: u32) -> Self {
        Self {
            frame,
            time_s: crate::frame_time_s(frame),
            x: sweep.x_m,
            y: sweep.y_m,
            z: sweep.z_m,
            intensity: sweep.intensity,
            ring: sweep.ring,
            time_offset_s: sweep.time_offset_s,
            cos_angle: sweep.cos_angle,
            id: sweep.id,
            tag: sweep.tag,
        }
    }

    fn returns(&self) -> usize {
        self.x.len()
    }
}

impl SweepRow for SemanticLidarRow {
    fn of(sweep: LidarSweep, frame: u32) -> Self {
        Self {
            frame,
            time_s: crate::frame_time_s(frame),
            x: sweep.x_m,
            y: sweep.y_m,
            z: sweep.z_m,
            cos_angle: sweep.cos_angle,
            intensity: sweep.intensity,
            ring: sweep.ring,
            time_offset_s: sweep.time_offset_s,
            id: sweep.id,
            tag: sweep.tag,
        }
    }

    fn returns(&self) -> usize {
        self.x.len()
    }
}

impl<R: SweepRow> SweepRow for Joined<R, LidarReturnsRow> {
    fn of(mut sweep: LidarSweep, frame: u32) -> Self {
        let OfBeam { number, count, kind } = sweep.of_beam.take().unwrap_or_default();
        let returns = LidarReturnsRow { return_number: number, return_count: count, return_kind: kind };
        Self(R::of(sweep, frame), returns)
    }

    fn returns(&self) -> usize {
        self.0.returns()
    }
}
