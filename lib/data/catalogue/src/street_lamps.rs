//! Which actors are street lamps, and which of them never burn.

use schema::ActorKind;
use schema::tables::ActorRow;

/// Bit of a street lamp's variant: it never burns.
const FAILED: u32 = 1 << 8;

/// Whether an actor is a street lamp.
#[must_use]
pub fn is_street_lamp(actor: &ActorRow) -> bool {
    actor.kind == ActorKind::Pole && actor.model == "pole.lamp"
}

/// Marks a street lamp as one that has failed: it never burns.
pub fn mark_failed(lamp: &mut ActorRow) {
    lamp.variant |= FAILED;
}

/// Whether an actor is a street lamp that never burns.
#[must_use]
pub fn has_failed(actor: &ActorRow) -> bool {
    is_street_lamp(actor) && actor.variant & FAILED != 0
}

/// The number that varies the shape of an actor: its variant, without what a street lamp's says of its light.
#[must_use]
pub fn shape_variant(actor: &ActorRow) -> u32 {
    if is_street_lamp(actor) { actor.variant & !FAILED } else { actor.variant }
}
