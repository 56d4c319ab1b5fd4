//! What follows a road at even distances: delineators.

use super::candidates::{Placer, Thing, Wanted};
use super::kinds::{FurnitureKind, FurniturePlace};
use super::street::street;
use crate::scenery::claims::Candidate;
use crate::scenery::frontage::Frontage;

/// No line along shorter sides of roads, metres.
const SHORTEST_M: f64 = 30.0;

/// One thing after another at even distances along a side of a road.
pub(super) fn line(
    placer: &Placer<'_>,
    kind: (usize, &'static FurnitureKind),
    front: &Frontage,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    let FurniturePlace::Line { beyond_m, apart_m } = kind.1.place else { return };
    if front.length_m() < SHORTEST_M {
        return;
    }
    // Both sides of a road have it, or none.
    let mut random = placer.stream(kind.1, front.entity / 2);
    let chance = random.unit();
    for slot in 0u32.. {
        let along_m = (0.5 + f64::from(slot)) * apart_m;
        let variant = random.next_u32() % kind.1.variants;
        if along_m >= front.length_m() {
            break;
        }
        let Some(spot) = front.at(along_m) else { break };
        if chance < kind.1.often[street(&spot)] {
            let wanted = Wanted { kind, front, along_m, beyond_m, variant, slot: slot.into() };
            candidates.extend(placer.candidate(&wanted, &spot));
        }
    }
}
