//! A sheet on a large scale in the making: what is drawn, by level and order.

use std::collections::{BTreeMap, BTreeSet};

use opendrive::Map;

use crate::page::Page;
use crate::picture::{Paint, Shape};
use crate::stretch::{Carrier, Stretch};
use crate::style::{Class, Key};

/// Painting order within a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Order {
    Shadow,
    Parapet,
    Surface(Class),
    Kerb,
    Sleeper,
    Rail,
    Mark,
    Crosswalk,
}

/// Shapes by level and order.
#[derive(Debug, Default)]
pub(crate) struct Layers(BTreeMap<(i8, Order), Vec<Shape>>);

impl Layers {
    /// Adds a chain to the shape of its paint.
    pub(crate) fn add(&mut self, level: i8, order: Order, chain: Vec<[f64; 2]>, closed: bool, paint: Paint) {
        let shapes = self.0.entry((level, order)).or_default();
        match shapes.iter_mut().find(|s| s.paint == paint && s.closed == closed) {
            Some(shape) => shape.chains.push(chain),
            None => shapes.push(Shape { chains: vec![chain], closed, paint }),
        }
    }

    /// The shapes in painting order.
    pub(crate) fn into_shapes(self) -> impl Iterator<Item = Shape> {
        self.0.into_values().flatten()
    }
}

/// What drawing needs to know everywhere.
pub(crate) struct Sheet<'m> {
    pub(crate) map: &'m Map,
    pub(crate) page: &'m Page,
    pub(crate) stretches: Vec<Stretch>,
    pub(crate) layers: Layers,
    pub(crate) legend: BTreeSet<Key>,
}

impl Sheet<'_> {
    /// Level of a road at an s; none where the road is underground.
    pub(crate) fn level_at(&self, road: u32, s: f64) -> Option<i8> {
        let from = self.stretches.partition_point(|t| t.road < road);
        let of_road = self.stretches[from..].iter().take_while(|t| t.road == road);
        let stretch = of_road.min_by(|a, b| a.distance_m(s).total_cmp(&b.distance_m(s)))?;
        let piece = stretch.piece_at(s)?;
        (piece.carrier != Carrier::Tunnel).then_some(piece.level)
    }
}

impl Stretch {
    /// How far an s is outside the stretch.
    fn distance_m(&self, s: f64) -> f64 {
        match (self.s.first(), self.s.last()) {
            (Some(first), Some(last)) => (first - s).max(s - last).max(0.0),
            _ => f64::INFINITY,
        }
    }
}
