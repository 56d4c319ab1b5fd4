//! Doors: the leaves, and the way into the cabin in place of the closed skin behind an open one.

use std::sync::Arc;

use crate::solids::{Fit, MeshBuilder};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};

use super::Car;
use crate::actors::pieces::{Joint, Piece};

/// Thickness of a door, metres.
const LEAF_M: f32 = 0.07;
/// How far the way in stands out of the skin, metres: farther than handles, which are on the leaf while it is
/// open.
const STANDS_OUT_M: f32 = 0.032;
/// Rings of a door's mesh.
const RINGS: usize = 5;
/// Rows of the skin that a door has.
const ROWS: [f32; 7] = [0.13, 0.32, 0.58, 0.82, 1.0, 1.9, 2.0];

impl Car<'_> {
    /// From where to where along the side each row of doors reaches.
    pub(super) fn doorways(&self) -> Vec<[f32; 2]> {
        let style = &self.hull.style;
        let behind =
            |at: f32| style.pillars.iter().copied().find(|p| *p > at + 0.05).unwrap_or(style.windows.1);
        let middle = behind(style.windows.0);
        let spans = [[style.windows.0, middle], [middle, behind(middle)]];
        spans.into_iter().take(usize::from(self.model.doors) / 2).collect()
    }

    pub(super) fn doors(&self, fit: &Fit) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (row, [ahead, behind]) in self.doorways().into_iter().enumerate() {
            for (side, left) in [(0, true), (1, false)] {
                let door = 2 * row + side;
                let span = [ahead + 0.004, behind - 0.004];
                let at = self.hull.side(&self.hull.section(span[0]), 0.5, left);
                let inward = if left { -0.02 } else { 0.02 };
                // On the road, so that heights in its frame are those of the car.
                let at = fit.apply(at + Vec3::Y * inward).with_z(0.0);
                let leaf = moved(self.leaf(fit, span, left), -at);
                pieces.push(Piece { mesh: Arc::new(leaf), joint: Joint::Door { at, door } });
                let way_in = Arc::new(self.way_in(fit, span, left));
                pieces.push(Piece { mesh: way_in, joint: Joint::Doorway { door } });
            }
        }
        pieces
    }

    fn leaf(&self, fit: &Fit, span: [f32; 2], left: bool) -> TriMesh {
        let looks = &self.looks;
        self.door(fit, span, left, 0.0, looks.trim, |_, row, outside| match row {
            _ if row > 1.0 && row < 1.9 => looks.window,
            _ if !outside => looks.trim,
            _ if row > 0.3 && row < 0.7 => looks.sill,
            _ => looks.paint,
        })
    }

    /// What one looks through into the cabin, framed.
    fn way_in(&self, fit: &Fit, span: [f32; 2], left: bool) -> TriMesh {
        let opening = MeshPart::new(self.looks.tag, Surface::Opening, self.looks.gap.rgb);
        self.door(fit, span, left, STANDS_OUT_M, self.looks.paint, |_, _, _| opening)
    }

    /// A slab over a span of the side, from the sill to the roof, that stands out by so much; `part` of a
    /// ring and row, and whether it is outside.
    fn door(
        &self,
        fit: &Fit,
        span: [f32; 2],
        left: bool,
        out_m: f32,
        rim: MeshPart,
        part: impl Fn(usize, f32, bool) -> MeshPart,
    ) -> TriMesh {
        // From behind to the front: along +x. The rings run counter-clockwise about it.
        let ring = |k: usize| -> Vec<Vec3> {
            let f = span[1] + (span[0] - span[1]) * k as f32 / (RINGS - 1) as f32;
            let at = self.hull.section(f);
            let away = if left { 1.0 } else { -1.0 };
            let side = |push: f32| ROWS.map(|row| self.hull.side(&at, row, left) + Vec3::Y * away * push);
            let mut points: Vec<Vec3> =
                side(out_m).into_iter().chain(side(-LEAF_M).into_iter().rev()).collect();
            if !left {
                points.reverse();
            }
            points.into_iter().map(|p| fit.apply(p)).collect()
        };
        let n = 2 * ROWS.len();
        let skin = |k: usize, j: usize| {
            // Mirrored for the right side, where the order is reversed.
            let j = if left { j } else { (2 * n - 2 - j) % n };
            let row = |i: usize| 0.5 * (ROWS[i] + ROWS[i + 1]);
            match j {
                _ if j + 1 < ROWS.len() => part(k, row(j), true),
                _ if j + 1 == ROWS.len() || j + 1 == n => rim,
                _ => part(k, row(n - 2 - j), false),
            }
        };
        let mut b = MeshBuilder::new();
        let rings: Vec<Vec<Vec3>> = (0..RINGS).map(ring).collect();
        b.loft(&rings, skin, [rim; 2]);
        b.finish()
    }
}

fn moved(mut mesh: TriMesh, by: Vec3) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}
