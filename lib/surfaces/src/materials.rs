//! What surfaces of several kinds look like.

use schema::Tag;
use schema::geometry::{Part, Surface};

/// Colour of grass, linear RGB.
const GRASS_RGB: [f32; 3] = [0.10, 0.17, 0.05];
/// Land, and the slopes beside roads.
pub(crate) const GRASS: Part = Part::new(Tag::Terrain, Surface::Grass, GRASS_RGB);
pub(crate) const ASPHALT: Part = Part::new(Tag::Road, Surface::Asphalt, [0.085, 0.085, 0.09]);
pub(crate) const PAVEMENT: Part = Part::new(Tag::Sidewalk, Surface::Concrete, [0.34, 0.33, 0.31]);
