//! Which classes are filled in which order, and their chunks.

use schema::Tag;

use crate::bits::Bits;

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

/// Index in [`ORDER`] of every label, 255 where it is never filled.
pub(crate) const CLASS_OF: [u8; 256] = {
    let mut class = [255_u8; 256];
    let mut at = 0;
    while at < ORDER.len() {
        class[ORDER[at].0 as usize] = at as u8;
        at += 1;
    }
    class
};

/// The bits of one chunk's layers.
pub(crate) fn layer_chunks<const W: usize>(layers: usize, chunk: usize) -> Vec<Bits<W>> {
    (0..layers).step_by(chunk).map(|start| Bits::range(start, (start + chunk).min(layers))).collect()
}
