//! Cloth, skin, hair: what the parts of a body are made of.

use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::people::appearance::{Appearance, Top};

/// What somebody's parts are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stuffs {
    pub(crate) tag: Tag,
    pub(crate) top: MeshPart,
    pub(crate) bottom: MeshPart,
    pub(crate) skin: MeshPart,
    pub(crate) hair: MeshPart,
    pub(crate) shoe: MeshPart,
    pub(crate) extra: MeshPart,
    /// The top where it is hemmed, ribbed or sewn on: a little darker.
    pub(crate) trim: MeshPart,
    /// What stands out from the top: a tie, what is worn below a jacket.
    pub(crate) accent: MeshPart,
}

impl Stuffs {
    pub(crate) fn new(look: &Appearance, tag: Tag) -> Self {
        let cloth = |rgb: [f32; 3]| MeshPart::new(tag, Surface::Cloth, rgb);
        let clothes = |weave, rgb: [f32; 3]| MeshPart::new(tag, Surface::Clothes(weave), rgb);
        Self {
            tag,
            top: clothes(look.top_weave, look.top_rgb),
            bottom: match look.top {
                Top::Dress => clothes(look.top_weave, look.top_rgb),
                _ => clothes(look.bottom_weave, look.bottom_rgb),
            },
            skin: cloth(look.skin_rgb),
            hair: cloth(look.hair_rgb),
            shoe: MeshPart::new(tag, Surface::Rubber, look.shoe_rgb),
            extra: cloth(look.extra_rgb),
            trim: cloth(look.top_rgb.map(|c| 0.78 * c)),
            accent: cloth(look.accent_rgb),
        }
    }

    pub(crate) fn cloth(&self, rgb: [f32; 3]) -> MeshPart {
        MeshPart::new(self.tag, Surface::Cloth, rgb)
    }
}
