//! What stands about in streets: lamps, benches and bins, and the kinds of a table.

mod candidates;
mod doors;
mod doorways;
mod kinds;
mod lamps;
mod lines;
mod rails;
mod small;
mod street;
#[cfg(test)]
mod tests;
mod utility;

pub use kinds::{FURNITURE, FurnitureFront, FurnitureKind, FurniturePlace};

pub(crate) use lamps::lamps;
pub(crate) use small::small_things;
pub(crate) use utility::utility;

use crate::scenery::claims::{Candidate, settle};
use crate::scenery::draft::Draft;
use crate::scenery::forecourts::Forecourts;
use crate::scenery::frontage::Frontage;
use crate::scenery::land::Land;
use crate::scenery::lots::House;
use crate::scenery::site::Site;
use candidates::{Placer, Thing};

/// Puts all kinds of the table where nothing else stands. They are the last things that are placed, so that
/// nothing else depends on them.
pub(crate) fn things(
    site: &Site<'_>,
    fronts: &[Frontage],
    (houses, paved): (&[Candidate<House<'_>>], &Forecourts),
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    if site.rules.density <= 0.0 {
        return;
    }
    let mut candidates: Vec<Candidate<Thing>> = Vec::new();
    let placer = Placer::new(site, (houses, paved), land);
    for front in fronts.iter().filter(|front| !front.track) {
        for (number, kind) in placer.kinds() {
            match kind.place {
                FurniturePlace::Door(_) | FurniturePlace::Yard(_) | FurniturePlace::Wired { .. } => {}
                FurniturePlace::Line { .. } => lines::line(&placer, (number, kind), front, &mut candidates),
                FurniturePlace::Rail(beyond_m) => {
                    rails::rails(&placer, (number, kind), beyond_m, front, &mut candidates);
                    rails::on_median(&placer, (number, kind), front, &mut candidates);
                }
                _ => placer.along((number, kind), front, &mut candidates),
            }
        }
    }
    for house in houses {
        doors::beside(&placer, house, &mut candidates);
    }
    for Candidate { takes, what: thing, .. } in settle(candidates, land) {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            drafts.push(thing.draft([x, y]));
        }
    }
}
