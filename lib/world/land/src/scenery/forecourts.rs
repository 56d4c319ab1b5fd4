//! Paved ground between a sidewalk and the houses in town that have no fence before them.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::Candidate;
use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::lots::{AROUND_M, House};
use crate::scenery::plots::is_open_to_the_street;
use crate::scenery::site::{Site, reach_m};

/// The largest distance from the sidewalk to the house, metres.
const DEEPEST_M: f64 = 8.0;
/// The sidewalk's edge is so near the slab's, and the slab's middle is so near the line between its ends,
/// metres.
const STRAIGHT_M: f64 = 0.35;
const EVEN_M: f64 = 0.05;
/// The steepest slab along the street, rise over run.
const SLOPE: f64 = 0.08;
/// The slab reaches this far into the land, and is so thick at most, metres.
const INTO_M: f64 = 0.15;
const THICKEST_M: f64 = 1.2;
/// Ways to pave.
const PAVINGS: u32 = 4;

/// The forecourts of an area, and around it.
pub(crate) struct Forecourts(Vec<Forecourt>);

struct Forecourt {
    rect: OrientedRect,
    /// Height in its middle, metres, and rise along its second side.
    z_m: f64,
    slope: f64,
}

impl Forecourts {
    /// Takes their ground.
    pub(crate) fn take(&self, land: &mut Land<'_>) {
        self.0.iter().for_each(|court| land.take(court.rect));
    }

    /// Height of the paving over a place of the plan, metres.
    pub(crate) fn height(&self, x: f64, y: f64) -> Option<f64> {
        let place = OrientedRect::square([x, y], 0.0);
        self.0.iter().find(|court| court.rect.meets(&place)).map(|court| {
            let [dx, dy] = [x - court.rect.centre_m[0], y - court.rect.centre_m[1]];
            let [ax, ay] = court.rect.axis;
            court.z_m + court.slope * (dy * ax - dx * ay)
        })
    }
}

/// Paves the ground before houses.
pub(crate) fn forecourts(
    site: &Site<'_>,
    houses: &[Candidate<House<'_>>],
    land: &Land<'_>,
    drafts: &mut Vec<Draft>,
) -> Forecourts {
    let mut paved = Vec::new();
    for house in houses {
        let (_, entity, slot) = house.rank;
        let mut random = Stream::new(site.rules.seed, slot, "world/forecourts", entity);
        let wanted = random.chance(site.rules.density);
        let variant = random.next_u32() % PAVINGS;
        if !wanted || !house.what.is_in_town || !is_open_to_the_street(&house.what) {
            continue;
        }
        let Some((court, thick_m)) = court(site, house, land) else { continue };
        let [x, y] = court.rect.centre_m;
        if site.holds(x, y) {
            let [ax, ay] = court.rect.axis;
            let size_m = [2.0 * court.rect.half_m[0], 2.0 * court.rect.half_m[1], thick_m];
            let (xyz, yaw_rad) = ([x, y, court.z_m - thick_m], frames::math::atan2(ay, ax));
            let mut draft =
                Draft::new(ActorKind::Prop, "prop.forecourt", Tag::Sidewalk, size_m, xyz, yaw_rad);
            draft.rpy_rad = [frames::math::atan2(court.slope, 1.0), 0.0, yaw_rad];
            draft.variant = variant;
            drafts.push(draft);
        }
        paved.push(court);
    }
    Forecourts(paved)
}

/// The slab before a house and its thickness, if its ground is straight, even and free.
fn court(site: &Site<'_>, house: &Candidate<House<'_>>, land: &Land<'_>) -> Option<(Forecourt, f64)> {
    let House { front, along_m, setback_m, .. } = house.what;
    if setback_m > DEEPEST_M || !site.near(house.takes.centre_m[0], house.takes.centre_m[1], reach_m::BUILT) {
        return None;
    }
    // The ground beside it that the house keeps free is paved, too.
    let half = [house.takes.half_m[0] - AROUND_M, house.takes.half_m[1] - 0.05];
    let edge = [-1.0, 0.0, 1.0].map(|u| front.at(along_m + u * half[1]).map(|spot| spot.point));
    let [Some(a), Some(middle), Some(b)] = edge else { return None };
    let ([ax, ay], [cx, cy]) = (house.takes.axis, house.takes.centre_m);
    // How far a point is from the house's front wall, and to its left.
    let of_house = |p: nalgebra::Point3<f64>| {
        let (dx, dy) = (p.x - cx, p.y - cy);
        [dx * ax + dy * ay - half[0], dy * ax - dx * ay]
    };
    let [pa, pm, pb] = [a, middle, b].map(of_house);
    let depth_m = pa[0].min(pm[0]).min(pb[0]) - 0.01;
    let is_straight = [pa, pm, pb].iter().all(|p| p[0] - depth_m < STRAIGHT_M);
    let slope = (b.z - a.z) / (pb[1] - pa[1]);
    if !is_straight
        || depth_m < 1.0
        || slope.is_nan()
        || slope.abs() > SLOPE
        || (0.5 * (a.z + b.z) - middle.z).abs() > EVEN_M
    {
        return None;
    }
    // Under awnings and balconies to the wall.
    let recess_m = house.what.kind.recess_m;
    let out_m = half[0] + 0.5 * (depth_m - recess_m);
    let rect = OrientedRect {
        centre_m: [cx + out_m * ax, cy + out_m * ay],
        axis: [ax, ay],
        half_m: [0.5 * (depth_m + recess_m), half[1]],
    };
    // Near the wall the house itself has taken the ground, with what it keeps free.
    let taken_m = recess_m + AROUND_M + 0.05;
    let before = OrientedRect {
        centre_m: [rect.centre_m[0] + 0.5 * taken_m * ax, rect.centre_m[1] + 0.5 * taken_m * ay],
        half_m: [rect.half_m[0] - 0.5 * taken_m, rect.half_m[1]],
        ..rect
    };
    if before.half_m[0] <= 0.0 || !land.free(&before) || !land.off_road(&rect) {
        return None;
    }
    let z_m = middle.z - slope * pm[1];
    let ground = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (0.0, 0.0)].map(|(u, v)| {
        let [x, y] = rect.at(u, v);
        site.levels().terrain.height(x, y) - slope * v * half[1]
    });
    let low = ground.into_iter().fold(f64::INFINITY, f64::min);
    let high = ground.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let thick_m = (20.0 * (z_m - low + INTO_M)).ceil() / 20.0;
    (high < z_m && thick_m <= THICKEST_M).then_some((Forecourt { rect, z_m, slope }, thick_m))
}

#[cfg(test)]
mod tests {
    use crate::scenery::tests::{all_by, footprint, meets_lanes, town_map};
    use crate::surfaces::{Atlas, Region};
    use opendrive::LaneType;
    use settings::SceneryRules;

    #[test]
    fn forecourts_go_on_where_the_sidewalk_ends() {
        let map = town_map("convoy/demo");
        let objects = all_by(&SceneryRules::default(), &map, [-256.0, -256.0], 512.0);
        let courts: Vec<_> = objects.iter().filter(|o| o.model == "prop.forecourt").collect();
        let area = Region { min: [-256.0; 2], max: [256.0; 2] };
        let atlas = Atlas::new(&map);
        let ground = atlas.ground(&area);
        assert!(courts.len() > 20, "{}", courts.len());
        for court in &courts {
            let rect = footprint(court);
            let [x, y, z] = court.xyz_m;
            assert!(!meets_lanes(&map, &rect, z), "at {x} {y}");
            for other in objects.iter().filter(|o| o.model != "prop.forecourt" && o.xyz_m != court.xyz_m) {
                // It ends at the wall, which stands back in the house's box.
                let by = if other.model.starts_with("building.") { -0.85 } else { -0.05 };
                let is_beside = by < -0.5 || other.model.starts_with("plant.");
                assert!(!is_beside || !footprint(other).meets(&rect.grown(by)), "{} at {x} {y}", other.model);
            }
            // The sidewalk's height beside the middle of its front.
            let [x, y] = rect.at(1.0, 0.0);
            let before = nalgebra::Point3::new(x, y, z + court.height_m);
            let walk = map.nearest_lane(before, |lane| lane.lane_type == LaneType::Sidewalk).expect("is one");
            assert!(
                walk.t_m.abs() - 0.5 * walk.width_m < 0.3,
                "{} m off",
                walk.t_m.abs() - 0.5 * walk.width_m
            );
            let inside =
                map.lane_point(walk.lane, walk.s, 0.4 * walk.width_m * walk.t_m.signum()).expect("is on it");
            let [x, y] = [inside.position.x, inside.position.y];
            let walk_m = ground.levels.height(x, y, inside.position.z);
            let top_m = z + court.height_m;
            assert!((top_m - walk_m).abs() < 0.05, "{top_m} {walk_m}");
        }
    }
}
