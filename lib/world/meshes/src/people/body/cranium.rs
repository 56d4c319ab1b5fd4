//! A head in the making: what face, hair and hats have in common.

use crate::solids::MeshBuilder;
use glam::Vec3;
use schema::geometry::MeshPart;

use super::shape::{Shaped, Slice, lofted, slice};
use super::skull::{SQUARE, Skull};

/// Sides of what is lofted: see [`Shaped`].
const SIDES: [usize; 2] = [18, 11];

/// A head in the making. Lengths are shares of its height, from the chin up.
pub(super) struct Head<'a> {
    pub(super) b: &'a mut MeshBuilder,
    /// Height of the head, and of the chin over the neck's lower end, metres.
    pub(super) m: f32,
    pub(super) chin: f32,
    /// The middle of the head before the neck, metres.
    pub(super) x: f32,
    /// Where the highest point has to be.
    pub(super) top: f32,
    pub(super) skull: Skull,
}

impl Head<'_> {
    /// A place of the head in the frame of its bone.
    pub(super) fn place(&self, p: Vec3) -> Vec3 {
        Vec3::new(self.x, 0.0, self.chin) + p * self.m
    }

    /// A slice `(height, front, back, half width)`.
    fn cut(&self, (t, front, back, half): (f32, f32, f32, f32)) -> Slice {
        let m = self.m;
        slice(self.chin + t * m, front * m, back * m, half * m).at(self.x, 0.0)
    }

    /// A solid of one part through slices.
    pub(super) fn solid(&mut self, part: MeshPart, shape: &[(f32, f32, f32, f32)]) {
        let slices: Vec<Slice> = shape.iter().map(|cut| self.cut(*cut)).collect();
        Shaped { slices: &slices, sides: SIDES, square: SQUARE, between: 0, relief: &|_, _| 0.0 }
            .add(self.b, |_| part);
    }

    /// The same through slices that have middles of their own.
    pub(super) fn leaning(&mut self, part: MeshPart, shape: &[(f32, f32, f32, f32, [f32; 2])], sides: usize) {
        let m = self.m;
        let slices: Vec<Slice> = shape
            .iter()
            .map(|(t, front, back, half, [x, y])| {
                self.cut((*t, *front, *back, *half)).at(self.x + x * m, y * m)
            })
            .collect();
        lofted(self.b, &slices, sides, 1.0, |_, _| part);
    }

    pub(super) fn blob(
        &mut self,
        part: MeshPart,
        middle: [f32; 3],
        half: [f32; 3],
        rings: usize,
        sides: usize,
    ) {
        let middle = self.place(Vec3::from_array(middle));
        self.b.ellipsoid(part, middle, Vec3::from_array(half) * self.m, rings, sides);
    }
}
