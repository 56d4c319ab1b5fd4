//! Which classes are filled in which order, and their chunks.

use schema::Tag;

use crate::fill::bits::Bits;

/// Classes in the order in which they are filled, with the cells of a chunk along x, y, z at 0.1 m.
pub const ORDER: [(Tag, [usize; 3]); 20] = {
    use Tag::*;
    const SMALL: [usize; 3] = [8, 8, 8];
    const MEDIUM: [usize; 3] = [16, 16, 16];
    const LARGE: [usize; 3] = [32, 32, 40];
    const TALL: [usize; 3] = [64, 64, 80];
    [
        (Building, [320, 320, 80]),
        (Pole, SMALL),
        (Vegetation, SMALL),
        (Static, LARGE),
        (Dynamic, LARGE),
        (Bridge, TALL),
        (RailTrack, TALL),
        (GuardRail, MEDIUM),
        (Rock, SMALL),
        (TrafficLight, SMALL),
        (TrafficSign, SMALL),
        (TrafficCone, SMALL),
        (Barrier, SMALL),
        (Truck, LARGE),
        (Bus, LARGE),
        (Car, MEDIUM),
        (Motorcycle, SMALL),
        (Bicycle, SMALL),
        (Pedestrian, SMALL),
        (Rider, SMALL),
    ]
};

/// The classes that are filled one by one.
#[derive(Debug)]
pub(crate) struct Classes {
    /// Number of every label's class, 255 where it has none.
    pub(crate) of: [u8; 256],
    pub(crate) count: usize,
}

/// Those of [`ORDER`], in its order.
pub(crate) const ORDERED: Classes = {
    let mut of = [255_u8; 256];
    let mut at = 0;
    while at < ORDER.len() {
        of[ORDER[at].0 as usize] = at as u8;
        at += 1;
    }
    Classes { of, count: ORDER.len() }
};

/// All labels but free space: the class of a label is one less.
pub(crate) const EVERY: Classes = {
    let mut of = [255_u8; 256];
    let mut label = 1;
    while label < Tag::COUNT {
        of[label] = label as u8 - 1;
        label += 1;
    }
    Classes { of, count: Tag::COUNT - 1 }
};

/// The bits of one chunk's layers.
pub(crate) fn layer_chunks<const W: usize>(layers: usize, chunk: usize) -> Vec<Bits<W>> {
    (0..layers).step_by(chunk).map(|start| Bits::range(start, (start + chunk).min(layers))).collect()
}
