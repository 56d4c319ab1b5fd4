//! Patches of low plants: each fills a rectangle of ground, or a piece of wall, and stands beside others.

mod crops;
mod garden;
mod grown;
mod meadow;
#[cfg(test)]
mod tests;

use glam::Vec3;

use crate::actors::ActorMesh;
use grown::Look;

/// So many of a kind differ in where their leaves are, and in so many ways are they coloured.
const VARIANTS: u32 = 4;

/// The kinds of patches.
#[cfg(test)]
pub(super) const KINDS: [&str; 8] =
    ["meadow", "reed", "flowers", "maize", "wheat", "vines", "shrubs", "climber"];

/// A patch of a kind in its box. Of a variant, the remainder by four says where its leaves are, and how often
/// four is in it how it is coloured: patches of one field have the latter in common.
pub(super) fn patch(kind: &str, size: Vec3, variant: u32) -> Option<ActorMesh> {
    let look = Look { shape: variant % VARIANTS, colour: (variant / VARIANTS % VARIANTS) as usize };
    let made = match kind {
        "meadow" => meadow::meadow(size, look),
        "reed" => meadow::reed(size, look),
        "flowers" => garden::flowers(size, look),
        "maize" => crops::maize(size, look),
        "wheat" => crops::wheat(size, look),
        "vines" => crops::vines(size, look),
        "shrubs" => garden::shrubs(size, look),
        "climber" => garden::climber(size, look),
        _ => return None,
    };
    Some(made)
}
