//! Trees, bushes, hedges and patches of low plants, in levels of detail that keep the area of their leaves.

mod crown;
mod leaves;
mod levels;
mod low;
mod palm;
mod patch;
mod species;
#[cfg(test)]
mod tests;
mod tree;
mod wood;

use glam::Vec3;

use crate::actors::pieces::ActorMesh;
use species::Species;

/// A plant by name; it fills its box, a patch of low plants less exactly.
pub(crate) fn plant(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<ActorMesh> {
    match (family, kind) {
        ("tree", "palm") => Some(palm::palm(size, variant)),
        ("tree", _) => match kind.strip_suffix(".bare") {
            Some(kind) => Species::named(kind).and_then(|species| tree::bare(species, size, variant)),
            None => Species::named(kind).map(|species| tree::tree(species, size, variant)),
        },
        ("bush", "hedge") => Some(low::hedge(size, variant)),
        ("bush", _) => Some(low::bush(size, variant)),
        ("plant", _) => patch::patch(kind, size, variant),
        _ => None,
    }
}
