//! What surfaces of several kinds look like.

use schema::Tag;
use schema::geometry::{MeshPart, Paving, Surface};

/// Colour of grass, linear RGB.
const GRASS_RGB: [f32; 3] = [0.10, 0.17, 0.05];
/// Land, and the slopes beside roads.
pub(crate) const GRASS: MeshPart = MeshPart::new(Tag::Terrain, Surface::Grass, GRASS_RGB);
pub(crate) const ASPHALT: MeshPart = MeshPart::new(Tag::Road, Surface::Asphalt, [0.085, 0.085, 0.09]);
/// Sidewalks within such a square are paved alike, metres.
const DISTRICT_M: f64 = 190.0;
/// Of how many sixteenths of the squares, and their colour, linear RGB.
const PAVINGS: [(Paving, u32, [f32; 3]); 5] = [
    (Paving::Slabs, 6, [0.34, 0.33, 0.31]),
    (Paving::Tiles, 4, [0.33, 0.30, 0.27]),
    (Paving::Setts, 2, [0.24, 0.235, 0.23]),
    (Paving::Cast, 2, [0.36, 0.355, 0.34]),
    (Paving::Asphalt, 2, [0.11, 0.11, 0.112]),
];

/// What a sidewalk is paved with that begins at a place: by district, so that streets and the junctions
/// between them go on alike.
pub(crate) fn pavement(at: [f64; 2]) -> MeshPart {
    let [x, y] = at.map(|v| (v / DISTRICT_M).floor() as i64 as u64);
    // Mixes as splitmix64 does (Steele and others, 2014).
    let mut word = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    word = (word ^ word >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word = (word ^ word >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    let mut left = ((word ^ word >> 31) & 15) as u32;
    for (paving, share, rgb) in PAVINGS {
        if left < share {
            return MeshPart::new(Tag::Sidewalk, Surface::Paving(paving), rgb);
        }
        left -= share;
    }
    MeshPart::new(Tag::Sidewalk, Surface::Paving(Paving::Slabs), PAVINGS[0].2)
}
