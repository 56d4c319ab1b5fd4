//! Plants at buildings: creepers on side walls, and flower beds beside the doors of those with a lawn before
//! them.

use frames::OrientedRect;
use frames::math::atan2;
use random::Stream;
use schema::{ActorKind, Tag};
use settings::Season;

use crate::scenery::claims::Candidate;
use crate::scenery::draft::Draft;
use crate::scenery::forecourts::Forecourts;
use crate::scenery::land::Land;
use crate::scenery::lots::{AROUND_M, House};
use crate::scenery::patches::lie;
use crate::scenery::site::{Site, reach_m};

/// Models of buildings with creepers and beds, how far their side walls stand back in their boxes, how high
/// creepers climb there, metres, and the share of those that have one.
const WALLS: [(&str, f64, f64, f64); 2] =
    [("building.house", 0.32, 3.5, 0.18), ("building.block", 0.24, 5.5, 0.10)];
/// A creeper is so thick and has one of these lengths, metres.
const THICK_M: f64 = 0.25;
const LONG_M: [f64; 3] = [3.0, 4.0, 5.0];
/// Length, width and height of a bed; where its middle is beside a door, and its near side before the wall,
/// metres.
const BED_M: [f64; 3] = [3.0, 1.0, 0.35];
const BESIDE_M: f64 = 3.1;
const BEFORE_M: f64 = AROUND_M + 0.05;
/// Share of doors' sides with one, and how many beds and creepers differ.
const BEDS: f64 = 0.5;
const VARIANTS: u32 = 16;
/// A creeper's foot is this deep in the ground, metres.
const ROOT_M: f64 = 0.1;

/// Plants them. Beds take their ground.
pub(crate) fn gardens(
    site: &Site<'_>,
    houses: &[Candidate<House<'_>>],
    paved: &Forecourts,
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let is_winter = site.rules.season == Season::Winter;
    for house in houses {
        let [x, y] = house.takes.centre_m;
        let Some((_, inset_m, high_m, share)) =
            WALLS.into_iter().find(|(model, ..)| *model == house.what.kind.model)
        else {
            continue;
        };
        if !site.near(x, y, reach_m::BUILT) {
            continue;
        }
        let (_, entity, slot) = house.rank;
        let mut random = Stream::new(site.rules.seed, slot, "world/gardens", entity);
        let density = site.rules.density;
        let (has_creeper, left) = (random.chance(share * density), random.chance(0.5));
        let (long_m, variant) =
            (LONG_M[random.next_u32() as usize % LONG_M.len()], random.next_u32() % VARIANTS);
        if has_creeper && !is_winter {
            let creeper =
                creeper(site, house, [inset_m, long_m, high_m], if left { 1.0 } else { -1.0 }, variant);
            drafts.extend(Some(creeper).filter(|creeper| site.holds(creeper.xyz_m[0], creeper.xyz_m[1])));
        }
        for side in [-1.0, 1.0] {
            let (wanted, variant) = (random.chance(BEDS * density), random.next_u32() % VARIANTS);
            let rect = bed(house, side);
            if wanted && !is_winter && house.what.is_in_town && is_free(site, paved, land, house, &rect) {
                land.take(rect);
                let [x, y] = rect.centre_m;
                let bed = lie(site, &rect, ("plant.flowers", BED_M[2], variant));
                drafts.extend(bed.filter(|_| site.holds(x, y)));
            }
        }
    }
}

/// A creeper on the rear part of a side wall: on the left one, or at -1 on the right one.
fn creeper(
    site: &Site<'_>,
    house: &Candidate<House<'_>>,
    [inset_m, long_m, high_m]: [f64; 3],
    side: f64,
    variant: u32,
) -> Draft {
    let half = house.takes.half_m.map(|half| half - AROUND_M);
    let [ax, ay] = house.takes.axis;
    let [cx, cy] = house.takes.centre_m;
    let out = [-ay * side, ax * side];
    let (along_m, out_m) = (0.6 + 0.5 * long_m - half[0], half[1] - inset_m + 0.5 * THICK_M);
    let [x, y] = [cx + along_m * ax + out_m * out[0], cy + along_m * ay + out_m * out[1]];
    let ground_m = [-0.5, 0.5]
        .map(|by| site.levels().height(x + by * long_m * ax, y + by * long_m * ay, house.what.near_z_m));
    let z = ground_m[0].min(ground_m[1]) - ROOT_M;
    // Leaves look along its y axis.
    let yaw_rad = atan2(-out[0], out[1]);
    let size_m = [long_m, THICK_M, high_m];
    let mut draft =
        Draft::new(ActorKind::Vegetation, "plant.climber", Tag::Vegetation, size_m, [x, y, z], yaw_rad);
    draft.variant = variant;
    draft
}

/// The ground of a bed left of a door, or at -1 right of it.
fn bed(house: &Candidate<House<'_>>, side: f64) -> OrientedRect {
    let [ax, ay] = house.takes.axis;
    let [cx, cy] = house.takes.centre_m;
    let ahead_m = house.takes.half_m[0] - AROUND_M + BEFORE_M + 0.5 * BED_M[1];
    let aside_m = house.what.door_m() + side * BESIDE_M;
    let centre_m = [cx + ahead_m * ax - aside_m * ay, cy + ahead_m * ay + aside_m * ax];
    OrientedRect { centre_m, axis: [-ay, ax], half_m: [0.5 * BED_M[0], 0.5 * BED_M[1]] }
}

/// Whether a bed has room on the lawn before its building.
fn is_free(
    site: &Site<'_>,
    paved: &Forecourts,
    land: &Land<'_>,
    house: &Candidate<House<'_>>,
    rect: &OrientedRect,
) -> bool {
    let is_before = BESIDE_M + 0.5 * BED_M[0] < house.takes.half_m[1] - AROUND_M - house.what.door_m().abs();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]];
    is_before
        && land.free(rect)
        && corners.into_iter().all(|[u, v]| {
            let [x, y] = rect.at(u, v);
            paved.height(x, y).is_none()
        })
        && lie(site, rect, ("plant.flowers", BED_M[2], 0)).is_some()
}

#[cfg(test)]
mod tests {
    use super::THICK_M;
    use crate::scenery::tests::{all_by, footprint, town_map};
    use settings::{SceneryRules, Season};

    #[test]
    fn creepers_are_on_walls_and_beds_before_them() {
        let map = town_map("convoy/demo");
        let of = |season: Season| {
            all_by(&SceneryRules { season, ..SceneryRules::default() }, &map, [-384.0, -384.0], 768.0)
        };
        let objects = of(Season::Summer);
        let houses: Vec<_> =
            objects.iter().filter(|o| o.model.starts_with("building.")).map(footprint).collect();
        let mut counts = [0; 2];
        for plant in &objects {
            let rect = footprint(plant);
            match plant.model.as_str() {
                "plant.climber" => {
                    counts[0] += 1;
                    // Its rear is in a building's box, and its front looks out of that.
                    let behind = frames::OrientedRect::square(rect.at(0.0, -0.6), 0.5 * THICK_M);
                    let before = frames::OrientedRect::square(rect.at(0.0, 4.0), 0.1);
                    assert!(houses.iter().any(|house| house.meets(&behind)), "{:?}", plant.xyz_m);
                    assert!(!houses.iter().any(|house| house.meets(&before)), "{:?}", plant.xyz_m);
                }
                "plant.flowers" => {
                    counts[1] += 1;
                    assert!(!houses.iter().any(|house| house.meets(&rect)), "{:?}", plant.xyz_m);
                    let near = rect.grown(0.8);
                    assert!(houses.iter().any(|house| house.meets(&near)), "{:?}", plant.xyz_m);
                }
                _ => {}
            }
        }
        assert!(counts[0] > 3 && counts[1] > 8, "{counts:?}");
        let grows = |model: &str| ["plant.climber", "plant.flowers"].contains(&model);
        assert!(!of(Season::Winter).iter().any(|o| grows(&o.model)));
    }
}
