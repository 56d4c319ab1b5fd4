//! What stands before houses, beside their doors.

use random::Stream;

use super::candidates::{Placer, Thing, Wanted, beyond_edge_m, extent_m};
use super::doorways::HALF_WAY_M;
use super::kinds::FurniturePlace;
use super::street::street;
use crate::scenery::claims::Candidate;
use crate::scenery::lots::House;

/// Things stand so far from the middle of a door along the street at least, metres.
const ASIDE_M: f64 = 0.4;

/// Candidates before a building.
pub(super) fn beside(
    placer: &Placer<'_>,
    house: &Candidate<House<'_>>,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    let front = house.what.front;
    let (_, entity, number) = house.rank;
    for (index, kind) in placer.kinds() {
        let (FurniturePlace::Door(models) | FurniturePlace::Yard(models)) = kind.place else { continue };
        if !models.contains(&house.what.kind.model) {
            continue;
        }
        // One stream a building and kind: the number of the building stands for that of a scene.
        let mut random = Stream::new(placer.site.rules.seed, number + 1, kind.model, entity);
        let (chance, side, share) = (random.unit(), random.chance(0.5), random.unit());
        let variant = random.next_u32() % kind.variants;
        let Some(spot) = front.at(house.what.along_m) else { continue };
        if chance >= kind.often[street(&spot)] * placer.site.rules.density {
            continue;
        }
        let [_, width_m] = extent_m(kind, kind.front);
        let near_m = HALF_WAY_M + ASIDE_M + 0.5 * width_m;
        let far_m = (house.takes.half_m[1] - 0.5 * width_m).max(near_m);
        let aside_m = near_m + share * (far_m - near_m);
        let along_m = house.what.along_m + if side { aside_m } else { -aside_m };
        let Some(spot) = front.at(along_m).filter(|_| (0.0..front.length_m()).contains(&along_m)) else {
            continue;
        };
        let beyond_m = beyond_edge_m(kind);
        let wanted = Wanted { kind: (index, kind), front, along_m, beyond_m, variant, slot: number };
        candidates.extend(placer.candidate(&wanted, &spot));
    }
}
