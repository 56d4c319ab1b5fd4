//! A sweep as lists, and as rows of tables.

use schema::table::{Framed, Row};
use schema::tables::{LidarReturnsRow, LidarRow, SemanticLidarRow};
use schema::{Joined, ObjectId};

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
