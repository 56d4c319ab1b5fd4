//! Eight vectors.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

use glam::{Mat3, Vec3};

use crate::F32x8;

/// Eight vectors, axis by axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3x8 {
    /// First axis.
    pub x: F32x8,
    /// Second axis.
    pub y: F32x8,
    /// Third axis.
    pub z: F32x8,
}

impl Vec3x8 {
    /// Three axes.
    #[inline]
    #[must_use]
    pub const fn new(x: F32x8, y: F32x8, z: F32x8) -> Self {
        Self { x, y, z }
    }

    /// One vector in all lanes.
    #[inline]
    #[must_use]
    pub const fn splat(v: Vec3) -> Self {
        Self { x: F32x8::splat(v.x), y: F32x8::splat(v.y), z: F32x8::splat(v.z) }
    }

    /// One vector by lane.
    #[inline]
    #[must_use]
    pub fn from_fn(mut of: impl FnMut(usize) -> Vec3) -> Self {
        let all: [Vec3; crate::LANES] = std::array::from_fn(&mut of);
        Self { x: all.map(|v| v.x).into(), y: all.map(|v| v.y).into(), z: all.map(|v| v.z).into() }
    }

    /// The vector of a lane.
    #[inline]
    #[must_use]
    pub fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x.as_array()[i], self.y.as_array()[i], self.z.as_array()[i])
    }

    /// Dot products.
    #[inline]
    #[must_use]
    pub fn dot(self, other: Self) -> F32x8 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Squared lengths.
    #[inline]
    #[must_use]
    pub fn length_squared(self) -> F32x8 {
        self.dot(self)
    }

    /// From here to there by shares.
    #[inline]
    #[must_use]
    pub fn lerp(self, other: Self, share: F32x8) -> Self {
        self + (other - self) * share
    }

    /// This where the mask is set, the other elsewhere.
    #[inline]
    #[must_use]
    pub fn or(self, mask: F32x8, other: Self) -> Self {
        Self {
            x: mask.select(self.x, other.x),
            y: mask.select(self.y, other.y),
            z: mask.select(self.z, other.z),
        }
    }

    /// A matrix times each.
    #[inline]
    #[must_use]
    pub fn turned(self, matrix: &Mat3) -> Self {
        let row = |x: f32, y: f32, z: f32| self.x * x + self.y * y + self.z * z;
        let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        Self { x: row(a.x, b.x, c.x), y: row(a.y, b.y, c.y), z: row(a.z, b.z, c.z) }
    }
}

impl Add for Vec3x8 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl AddAssign for Vec3x8 {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3x8 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

/// Axis by axis.
impl Mul for Vec3x8 {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}

impl Mul<F32x8> for Vec3x8 {
    type Output = Self;
    #[inline]
    fn mul(self, o: F32x8) -> Self {
        Self { x: self.x * o, y: self.y * o, z: self.z * o }
    }
}

impl MulAssign<F32x8> for Vec3x8 {
    #[inline]
    fn mul_assign(&mut self, o: F32x8) {
        *self = *self * o;
    }
}
