//! What buildings look like.

use schema::Tag;
use schema::geometry::{MeshPart, Surface, Wall};

/// All of a building.
pub(super) const TAG: Tag = Tag::Building;

/// Walls: what they are made of, and their colours, linear RGB.
const WALLS: [(Wall, [f32; 3]); 10] = [
    (Wall::Ashlar, [0.52, 0.45, 0.35]),
    (Wall::Brick, [0.36, 0.15, 0.10]),
    (Wall::Plaster, [0.60, 0.58, 0.54]),
    (Wall::Panels, [0.30, 0.31, 0.33]),
    (Wall::Plaster, [0.55, 0.50, 0.30]),
    (Wall::Brick, [0.42, 0.33, 0.26]),
    (Wall::Brick, [0.25, 0.20, 0.17]),
    (Wall::Ashlar, [0.48, 0.42, 0.42]),
    (Wall::Curtain, [0.40, 0.46, 0.50]),
    (Wall::Plaster, [0.65, 0.62, 0.50]),
];

/// What a building's parts look like.
pub(super) struct BuildingStyle {
    pub(super) wall_rgb: [f32; 3],
    pub(super) wall: MeshPart,
    pub(super) base: MeshPart,
    pub(super) trim: MeshPart,
    pub(super) flat_roof: MeshPart,
    pub(super) tiles: MeshPart,
}

impl BuildingStyle {
    pub(super) fn of(kind: &str, variant: u32) -> Self {
        let (mut made_of, wall_rgb) = WALLS[variant as usize % WALLS.len()];
        match (kind, made_of) {
            // Nobody lives behind a glass front; every second tower has one.
            ("house", Wall::Curtain | Wall::Panels) => made_of = Wall::Plaster,
            ("tower", Wall::Plaster | Wall::Brick) => made_of = Wall::Curtain,
            _ => {}
        }
        let tile_rgb =
            [[0.25, 0.07, 0.04], [0.09, 0.08, 0.08], [0.18, 0.10, 0.07]][variant as usize / 10 % 3];
        Self {
            wall_rgb,
            wall: MeshPart::new(TAG, Surface::Facade(made_of), wall_rgb),
            base: MeshPart::new(TAG, Surface::Concrete, wall_rgb.map(|c| 0.55 * c)),
            trim: MeshPart::new(TAG, Surface::Concrete, wall_rgb.map(|c| (1.25 * c).min(0.8))),
            flat_roof: MeshPart::new(TAG, Surface::Gravel, [0.12, 0.12, 0.12]),
            tiles: MeshPart::new(TAG, Surface::RoofTiles, tile_rgb),
        }
    }
}
