//! The cells that objects on the ground cover.

use std::collections::BTreeMap;

use crate::culling::MeshFacts;
use glam::{Affine3A, Vec3A};
use schema::{BevClass, ObjectId};

use crate::bev::layers::{Ground, LAYER_M};
use crate::bev::raster::Triangle;

/// Objects are shown from this far below the ground they stand on, metres.
const BELOW_M: f32 = 0.5;
/// Surfaces of objects are shown up to this far above the ground: the clearance under a bridge, metres.
const ABOVE_M: f32 = 4.8;
/// Slope that is allowed for between the grid's edge and an object that stands beyond it.
const EDGE_SLOPE: f32 = 0.3;
/// No class.
const NONE: u32 = u32::MAX;

/// All that an object has of one class: a rider and the bicycle are two, a car's body, wheels and doors are
/// one.
#[derive(Clone, Copy, Debug)]
struct Share {
    object: ObjectId,
    class: BevClass,
    /// Corners of the box around it, in the grid.
    low: Vec3A,
    high: Vec3A,
    /// Whether it covers the centre of a cell of the grid.
    covers: bool,
    /// Whether its object stands on the shown layer.
    shown: bool,
}

#[derive(Clone, Copy, Debug)]
struct ShareTriangle {
    share: u32,
    triangle: Triangle,
}

/// The objects over the grid.
#[derive(Debug, Default)]
pub(crate) struct Objects {
    shares: Vec<Share>,
    number_of: BTreeMap<(ObjectId, BevClass), u32>,
    triangles: Vec<ShareTriangle>,
    bases: BTreeMap<ObjectId, Base>,
}

/// Adds triangles of one mesh of an object.
pub(crate) struct MeshShares<'a> {
    objects: &'a mut Objects,
    object: ObjectId,
    /// Number of the share of each class, once it has a triangle.
    numbers: [u32; BevClass::COUNT],
}

impl Objects {
    pub(crate) fn clear(&mut self) {
        self.shares.clear();
        self.number_of.clear();
        self.triangles.clear();
        self.bases.clear();
    }

    /// Notes where a mesh of an object stands.
    pub(crate) fn offer_base(&mut self, object: ObjectId, facts: &MeshFacts, to_grid: &Affine3A) {
        self.bases.entry(object).or_default().offer(facts, to_grid);
    }

    /// For the triangles of a mesh of an object.
    pub(crate) fn mesh(&mut self, object: ObjectId) -> MeshShares<'_> {
        MeshShares { objects: self, object, numbers: [NONE; BevClass::COUNT] }
    }

    fn number(&mut self, object: ObjectId, class: BevClass) -> u32 {
        let shares = &mut self.shares;
        *self.number_of.entry((object, class)).or_insert_with(|| {
            let (low, high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
            shares.push(Share { object, class, low, high, covers: false, shown: false });
            (shares.len() - 1) as u32
        })
    }

    /// Draws all that stands on the shown layer: calls with the cell, the class, the object and the height
    /// there of the surface that covers it.
    pub(crate) fn draw(
        &mut self,
        ground: &Ground,
        cells: usize,
        mut cell: impl FnMut(usize, BevClass, ObjectId, f32),
    ) {
        for share in &mut self.shares {
            share.shown = self.bases.get(&share.object).is_some_and(|base| base.stands(ground, cells));
        }
        let on_layer =
            |at: usize, z: [f32; 2]| z[1] >= ground.level(at) - BELOW_M && z[0] <= ground.level(at) + ABOVE_M;
        for ShareTriangle { share, triangle } in &self.triangles {
            let share = &mut self.shares[*share as usize];
            if !share.shown {
                continue;
            }
            let (z, height) = (triangle.z_range(), triangle.height());
            triangle.centres(cells, |row, columns| {
                share.covers = true;
                for column in columns {
                    let at = row * cells + column;
                    if on_layer(at, z) {
                        cell(at, share.class, share.object, height.at(row, column));
                    }
                }
            });
        }
        for share in self.shares.iter().filter(|share| share.shown && !share.covers) {
            let middle = 0.5 * (share.low + share.high);
            let inside = |v: f32| (0.0..cells as f32).contains(&v).then_some(v as usize);
            let (Some(column), Some(row)) = (inside(middle.x), inside(middle.y)) else { continue };
            let at = row * cells + column;
            if on_layer(at, [share.low.z, share.high.z]) {
                cell(at, share.class, share.object, share.high.z);
            }
        }
    }
}

impl MeshShares<'_> {
    /// Adds a triangle of a class.
    pub(crate) fn add(&mut self, class: BevClass, corners: [Vec3A; 3], cells: usize) {
        let [a, b, c] = corners;
        if !(a + b + c).is_finite() {
            return;
        }
        let number = &mut self.numbers[class as usize];
        if *number == NONE {
            *number = self.objects.number(self.object, class);
        }
        let share = &mut self.objects.shares[*number as usize];
        share.low = share.low.min(a).min(b).min(c);
        share.high = share.high.max(a).max(b).max(c);
        if let Some(triangle) = Triangle::new(corners, cells).filter(Triangle::may_cover_a_centre) {
            self.objects.triangles.push(ShareTriangle { share: *number, triangle });
        }
    }
}

/// Where an object stands, in the grid: the bottom of its largest part (wheels and limbs are parts of their
/// own).
#[derive(Clone, Copy, Debug, Default)]
struct Base {
    place: Vec3A,
    volume: f32,
    known: bool,
}

impl Base {
    fn offer(&mut self, facts: &MeshFacts, to_grid: &Affine3A) {
        if !self.known || facts.volume() > self.volume {
            *self = Self {
                place: to_grid.transform_point3a(facts.bottom()),
                volume: facts.volume(),
                known: true,
            };
        }
    }

    /// Whether it is on the shown layer at its own place.
    fn stands(&self, ground: &Ground, cells: usize) -> bool {
        let last = cells as f32 - 1.0;
        let (u, v) = (self.place.x.floor().clamp(0.0, last), self.place.y.floor().clamp(0.0, last));
        // Beyond the edge the ground is not known: what is known is at the edge.
        let beyond = (self.place.x - u - 0.5).abs().max((self.place.y - v - 0.5).abs()) - 0.5;
        let slack_m = EDGE_SLOPE * beyond.max(0.0) * ground.cell_m();
        let at = v as usize * cells + u as usize;
        let above = self.place.z - ground.level(at);
        // What is higher stands on another layer, if there is ground at all.
        let most = if ground.height(at).is_some() { LAYER_M } else { ABOVE_M };
        above >= -BELOW_M - slack_m && above <= most + slack_m
    }
}
