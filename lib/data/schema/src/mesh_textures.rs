//! Pictures on meshes: what models of packs bring along, and the faces of signs.

use std::sync::Arc;

use glam::Vec2;

/// How a part with a skin sends light back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PbrFactors {
    /// Which coat of its mesh lies on it; none: the part's colour all over.
    pub texture_set: Option<u8>,
    /// 0 mirror, 1 dull: its mean.
    pub roughness: f32,
    /// 0 paint, plastic or cloth, 1 bare metal: its mean.
    pub metallic: f32,
}

/// The pictures of a part, which lie on it in the same places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextureSet {
    /// Colour; none: the part's.
    pub colour: Option<Arc<Image>>,
    /// Roughness in green and metalness in blue; none: the finish's.
    pub specular: Option<Arc<Image>>,
    /// Which way the surface leans.
    pub relief: Option<Relief>,
    /// Light of its own.
    pub glow: Option<Glow>,
}

/// Normals in a picture, as glTF has them: red to its right, green up it, blue outwards, 0 to 255 for -1 to
/// 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    /// The normals.
    pub image: Arc<Image>,
    /// What red and green are multiplied by.
    pub strength: f32,
}

/// Light of a surface's own, as a share of what the film shows as white.
#[derive(Clone, Debug, PartialEq)]
pub enum Glow {
    /// The same all over, linear RGB.
    Even([f32; 3]),
    /// As a picture shows it.
    Picture(Arc<Image>),
}

/// The pictures of a mesh, and where they lie on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshTextures {
    /// Places in the pictures of the corners of each triangle, in widths to the right and heights downwards.
    pub corners: Vec<[Vec2; 3]>,
    /// The pictures by coat.
    pub sets: Vec<TextureSet>,
}

/// What is seen beyond an edge of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// Its edge.
    Clamp,
}

impl Wrap {
    /// The texel of `n` that is seen at a place, which may lie beyond the edges.
    #[must_use]
    #[inline]
    pub fn texel(self, at: i32, n: u32) -> u32 {
        let n = n.max(1) as i32;
        let at = match self {
            Self::Repeat => at.rem_euclid(n),
            Self::Clamp => at.clamp(0, n - 1),
            Self::Mirror => {
                let turn = at.rem_euclid(2 * n);
                turn.min(2 * n - 1 - turn)
            }
        };
        at as u32
    }
}

/// A picture with coarser copies.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The picture, then copies of half its width and height each (rounded up), to one texel.
    pub levels: Vec<Level>,
    /// What is beyond its sides, and beyond top and bottom.
    pub wrap: [Wrap; 2],
}

/// A copy of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, row by row from the top: sRGB where they are colour or light.
    pub texels: Vec<[u8; 3]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_beyond_the_edges_are_folded_back() {
        let seen = |wrap: Wrap| (-4..8).map(|at| wrap.texel(at, 3)).collect::<Vec<_>>();
        assert_eq!(seen(Wrap::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1]);
        assert_eq!(seen(Wrap::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
        assert_eq!(seen(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2]);
        assert_eq!(Wrap::Mirror.texel(i32::MIN, 0), 0);
    }
}
