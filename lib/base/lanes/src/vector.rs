//! Eight vectors.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

use glam::{Mat3, Vec3};

use crate::Lanes;

/// Eight vectors, axis by axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3s {
    /// First axis.
    pub x: Lanes,
    /// Second axis.
    pub y: Lanes,
    /// Third axis.
    pub z: Lanes,
}

impl Vec3s {
    /// Three axes.
    #[inline]
    #[must_use]
    pub const fn new(x: Lanes, y: Lanes, z: Lanes) -> Self {
        Self { x, y, z }
    }

    /// One vector in all lanes.
    #[inline]
    #[must_use]
    pub const fn splat(v: Vec3) -> Self {
        Self { x: Lanes::splat(v.x), y: Lanes::splat(v.y), z: Lanes::splat(v.z) }
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
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Squared lengths.
    #[inline]
    #[must_use]
    pub fn length_squared(self) -> Lanes {
        self.dot(self)
    }

    /// From here to there by shares.
    #[inline]
    #[must_use]
    pub fn lerp(self, other: Self, share: Lanes) -> Self {
        self + (other - self) * share
    }

    /// This where the mask is set, the other elsewhere.
    #[inline]
    #[must_use]
    pub fn or(self, mask: Lanes, other: Self) -> Self {
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

impl Add for Vec3s {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl AddAssign for Vec3s {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3s {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

/// Axis by axis.
impl Mul for Vec3s {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}

impl Mul<Lanes> for Vec3s {
    type Output = Self;
    #[inline]
    fn mul(self, o: Lanes) -> Self {
        Self { x: self.x * o, y: self.y * o, z: self.z * o }
    }
}

impl MulAssign<Lanes> for Vec3s {
    #[inline]
    fn mul_assign(&mut self, o: Lanes) {
        *self = *self * o;
    }
}
