//! The ground of the world, made from the map: roads, paint, sidewalks, islands, land, bridges, rails, water.
//!
//! [`sections`] and [`levels`] say what lies where and how high; that is what scenery is placed by. [`build`] makes the
//! triangles, in tiles of a [`Layer`] each. Actor rows of kind `surface` name the areas of a scene: [`areas`] reads them.
//!
//! ```
//! use surfaces::{Region, levels, sections};
//!
//! let map = testkit::straight(100.0);
//! let region = Region { min: [0.0, -20.0], max: [100.0, 20.0] };
//! let ground = levels(&map, &sections(&map, &region), &region);
//! // The sidewalk begins 3.5 m beside the middle and has a kerb.
//! assert_eq!(ground.height(50.0, -2.0, 0.0), 0.0);
//! assert!((ground.height(50.0, -5.0, 0.0) - 0.12).abs() < 1e-9);
//! ```

mod area;
mod bridges;
mod cover;
mod ground;
mod holes;
mod lanes;
mod layer;
mod marks;
mod materials;
mod raster;
mod region;
mod sections;
mod terrain;
mod tiles;
mod tracks;
mod water;

use opendrive::Map;

pub use area::{Area, AreaError, areas};
pub use cover::{Cover, Facet};
pub use ground::GroundLevels;
pub use layer::Layer;
pub use raster::Raster;
pub use region::Region;
pub use sections::{Edge, Ground, Section, Strip, sections};
pub use tiles::TileMesh;
pub use water::Water;

use terrain::Terrain;
use tiles::Tiles;

/// Heights of all that lies on the ground of a region, from its [`sections`].
#[must_use]
pub fn levels(map: &Map, sections: &[Section], region: &Region) -> GroundLevels {
    let mut cover = lanes::cover(sections, region);
    let patches = holes::patches(map, region, &cover);
    let waters = water::waters(map, region);
    let terrain = Terrain::new(sections, &patches, &waters, region);
    patches.into_iter().for_each(|facet| cover.add(facet));
    GroundLevels { cover, terrain, waters }
}

/// The triangles of everything that lies on the ground of a region: tiles by layer and place.
#[must_use]
pub fn build(map: &Map, region: &Region) -> Vec<TileMesh> {
    let sections = sections(map, region);
    let ground = levels(map, &sections, region);
    let mut tiles = Tiles::default();
    lanes::build(&sections, region, &ground, &mut tiles);
    holes::build(&ground.cover, &mut tiles);
    marks::build(map, &sections, region, &ground.cover, &mut tiles);
    bridges::build(&sections, region, &ground, &mut tiles);
    tracks::build(&sections, region, &ground, &mut tiles);
    ground.terrain.build(&mut tiles);
    ground.terrain.build_waters(&ground.waters, &mut tiles);
    tiles.finish()
}
