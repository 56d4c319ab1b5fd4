//! What cameras and rays are asked: the two questions of a [`Scene`](crate::Scene).

use crate::camera::PinholeCamera;
use crate::ray::RayBatch;

/// What a camera is asked. [`CameraQuery::of`] asks for everything that is seen of all instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraQuery<'a> {
    /// The camera.
    pub camera: PinholeCamera,
    /// Numbers of instances, ascending: the picture is as if there were no others. `None`: all instances.
    pub among: Option<&'a [u32]>,
    /// What the answer holds.
    pub outputs: Outputs,
    /// Where panes of vehicles stop the view.
    pub panes: Stipple,
}

/// What the answer to a [`CameraQuery`] holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outputs {
    /// Instance, triangle and depth of every pixel.
    #[default]
    Surfaces,
    /// The same depths; the lists of instances and triangles stay empty.
    Depths,
}

/// Pixels at which panes with something behind them ([`has_cabin`](schema::geometry::Snapshot::has_cabin))
/// are opaque: a pattern of two columns and two rows, repeated over the picture. This is screen-door
/// transparency. All other surfaces are always opaque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stipple {
    /// Bit `2 * (row % 2) + column % 2`: whether panes are opaque there.
    opaque: u8,
}

/// What rays are asked. [`RayQuery::of`] asks for the closest surface of this frame's instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayQuery<'a> {
    /// The rays.
    pub rays: RayBatch<'a>,
    /// Numbers of instances, ascending: rays meet no others. `None`: all instances.
    pub among: Option<&'a [u32]>,
    /// The moment: 0 is this frame and 1 the previous one. Every instance is where
    /// [`pose_before`](crate::pose_before) has it then.
    pub before: f32,
    /// Whether rays also meet what is behind panes ([`cabins`](schema::geometry::Snapshot::cabins)). A caller
    /// that has met a pane asks for what is farther than the pane.
    pub cabins: bool,
}

impl CameraQuery<'_> {
    /// Everything that a camera sees of all instances.
    #[must_use]
    pub fn of(camera: PinholeCamera) -> Self {
        Self { camera, among: None, outputs: Outputs::Surfaces, panes: Stipple::OPAQUE }
    }
}

impl<'a> RayQuery<'a> {
    /// The closest surface of this frame's instances along every ray.
    #[must_use]
    pub fn of(rays: RayBatch<'a>) -> Self {
        Self { rays, among: None, before: 0.0, cabins: false }
    }
}

impl Stipple {
    /// Panes are as opaque as anything else.
    pub const OPAQUE: Self = Self { opaque: 0b1111 };

    /// The pattern of two rows of two columns: whether panes are opaque there.
    #[must_use]
    pub const fn new([[a, b], [c, d]]: [[bool; 2]; 2]) -> Self {
        Self { opaque: a as u8 | (b as u8) << 1 | (c as u8) << 2 | (d as u8) << 3 }
    }

    /// A row of the pattern: its lowest bit is 1 where panes are opaque at even columns, the next bit the
    /// same for odd ones.
    #[must_use]
    #[inline]
    pub const fn row(self, y: u32) -> u32 {
        (self.opaque as u32 >> (2 * (y & 1))) & 0b11
    }
}
