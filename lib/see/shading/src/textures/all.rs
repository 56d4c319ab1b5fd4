//! All textures.

use std::sync::OnceLock;

use crate::textures::texture::Texture;
use crate::textures::{laid, plants, stone, wear};

/// All textures.
#[derive(Debug)]
pub struct Textures {
    /// Crushed stone in bitumen. No tint.
    pub asphalt: Texture,
    /// What roads go through in 32 m: sealed cracks (tint above 0), patches and stains.
    pub wear: Texture,
    /// Cast concrete with pores. No tint.
    pub concrete: Texture,
    /// Slabs of 0.5 by 0.5 m in half bond; joints have a tint above 0.
    pub slabs: Texture,
    /// Tiles of 0.25 m, light and dark in turn; joints have a tint above 0.
    pub tiles: Texture,
    /// Cobbles of 125 mm; joints have a tint above 0.
    pub setts: Texture,
    /// Bricks of 250 mm in courses of 77 mm; mortar has a tint above 0.
    pub brick: Texture,
    /// Ashlar: stones of about 0.5 by 0.25 m; joints have a tint above 0.
    pub ashlar: Texture,
    /// Rendered walls. No tint.
    pub plaster: Texture,
    /// Tiles of 250 by 333 mm that overlap downwards. No tint.
    pub roof: Texture,
    /// Pebbles of 3 cm. No tint.
    pub gravel: Texture,
    /// Blades; dry ones have a tint above 0.
    pub grass: Texture,
    /// Bark in upright ridges. No tint.
    pub bark: Texture,
    /// Leaves that overlap; yellower ones have a tint above 0.
    pub leaves: Texture,
}

impl Textures {
    /// The textures; made at the first call.
    #[must_use]
    pub fn get() -> &'static Self {
        static ALL: OnceLock<Textures> = OnceLock::new();
        ALL.get_or_init(Self::new)
    }

    fn new() -> Self {
        Self {
            asphalt: stone::asphalt(),
            wear: wear::wear(),
            concrete: stone::concrete(),
            slabs: laid::slabs(),
            tiles: laid::tiles(),
            setts: laid::setts(),
            brick: laid::brick(),
            ashlar: laid::ashlar(),
            plaster: stone::plaster(),
            roof: laid::roof(),
            gravel: stone::gravel(),
            grass: plants::grass(),
            bark: plants::bark(),
            leaves: plants::leaves(),
        }
    }

    /// Each with its name.
    #[must_use]
    pub fn all(&self) -> [(&'static str, &Texture); 14] {
        [
            ("asphalt", &self.asphalt),
            ("wear", &self.wear),
            ("concrete", &self.concrete),
            ("slabs", &self.slabs),
            ("tiles", &self.tiles),
            ("setts", &self.setts),
            ("brick", &self.brick),
            ("ashlar", &self.ashlar),
            ("plaster", &self.plaster),
            ("roof", &self.roof),
            ("gravel", &self.gravel),
            ("grass", &self.grass),
            ("bark", &self.bark),
            ("leaves", &self.leaves),
        ]
    }
}
