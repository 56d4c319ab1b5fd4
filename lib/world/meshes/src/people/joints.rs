//! Turning and bending: rotations about the axes, and limbs of two bones that reach for a place.

use frames::math::f32::sin_cos;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// A turn about y, radians: positive noses down.
#[must_use]
pub fn about_y(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, 0.0, -s), Vec3A::Y, Vec3A::new(s, 0.0, c))
}

/// A turn about z, radians: positive to the left.
#[must_use]
pub fn about_z(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, s, 0.0), Vec3A::new(-s, c, 0.0), Vec3A::Z)
}

/// A turn about x: positive tips to the right.
pub(crate) fn about_x(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::X, Vec3A::new(0.0, c, s), Vec3A::new(0.0, -s, c))
}

pub(crate) fn frame(turn: Mat3A, at: Vec3) -> Affine3A {
    Affine3A { matrix3: turn, translation: at.into() }
}

/// A limb of two bones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limb {
    pub(crate) root: Vec3,
    pub(crate) upper: f32,
    pub(crate) lower: f32,
    /// Where the middle joint bends to, roughly across the limb.
    pub(crate) bends: Vec3,
    /// Whether the bones' x axes look where the joint bends to (knees) or away from it (elbows).
    pub(crate) forward: bool,
}

impl Limb {
    /// Frames of both bones, and where the end comes to, for an end that reaches for a place. Where that is
    /// too far the limb is all but straight towards it (law of cosines).
    pub(crate) fn reach(&self, to: Vec3) -> ([Affine3A; 2], Vec3) {
        let way = to - self.root;
        let least = (self.upper - self.lower).abs() + 1e-3;
        let distance = way.length().clamp(least, 0.9995 * (self.upper + self.lower));
        let along = way.normalize_or(Vec3::NEG_Z);
        let near =
            (self.upper * self.upper - self.lower * self.lower + distance * distance) / (2.0 * distance);
        let out = (self.upper * self.upper - near * near).max(0.0).sqrt();
        let aside = (self.bends - along * self.bends.dot(along)).normalize_or(Vec3::X);
        let middle = self.root + near * along + out * aside;
        let end = self.root + distance * along;
        let ahead = if self.forward { aside } else { -aside };
        ([hanging(self.root, middle, ahead), hanging(middle, end, ahead)], end)
    }
}

/// The frame of a bone that hangs from one place to another, its x axis as near to `ahead` as it can be.
pub(crate) fn hanging(from: Vec3, to: Vec3, ahead: Vec3) -> Affine3A {
    let up = (from - to).normalize_or(Vec3::Z);
    let x = (ahead - up * ahead.dot(up)).normalize_or(Vec3::X);
    let y = up.cross(x);
    frame(Mat3A::from_cols(x.into(), y.into(), up.into()), from)
}
