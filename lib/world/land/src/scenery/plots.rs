//! Fences, walls and hedges around the plots of buildings.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, Rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::draw::draw;
use crate::scenery::land::Land;
use crate::scenery::lots::{AROUND_M, House};
use crate::scenery::site::{Site, reach_m};

/// What stands along the border of a plot.
#[derive(Clone, Copy)]
struct Border {
    model: &'static str,
    tag: Tag,
    width_m: f64,
    height_m: f64,
    /// So many of them differ.
    variants: u32,
}

const fn border(model: &'static str, tag: Tag, width_m: f64, height_m: f64, variants: u32) -> Border {
    Border { model, tag, width_m, height_m, variants }
}

/// Towards the street.
const FENCE: Border = border("prop.fence", Tag::Fence, 0.10, 1.1, 30);
const WALL: Border = border("prop.wall", Tag::Wall, 0.30, 1.4, 30);
const HEDGE: Border = border("bush.hedge", Tag::Vegetation, 0.80, 1.2, 30);
/// Between plots: boards, wire, a wall, a hedge, nothing.
const BETWEEN: [Option<Border>; 5] = [
    Some(border("prop.boards", Tag::Fence, 0.10, 1.75, 3)),
    Some(border("prop.wire", Tag::Fence, 0.08, 1.5, 2)),
    Some(border("prop.wall", Tag::Wall, 0.25, 1.8, 3)),
    Some(border("bush.hedge", Tag::Vegetation, 0.90, 1.6, 3)),
    None,
];
/// Shares of these at houses in town, in the country, and at halls.
const IN_TOWN: [f64; 5] = [0.22, 0.08, 0.28, 0.33, 0.09];
const IN_THE_COUNTRY: [f64; 5] = [0.22, 0.10, 0.12, 0.44, 0.12];
const AT_HALLS: [f64; 5] = [0.0, 0.62, 0.26, 0.04, 0.08];
/// Depth of the yard behind a building, and width of the strip beside it: fewest and most metres, in town and
/// in the country.
const YARD_M: [[f64; 2]; 2] = [[4.0, 9.0], [8.0, 16.0]];
const STRIP_M: [[f64; 2]; 2] = [[0.9, 2.0], [2.5, 6.0]];
/// Length of a piece between plots, metres: all are alike, so that they share meshes.
const PIECE_M: f64 = 4.5;
/// Two borders side by side are nearer than this: one of them is left out, metres.
const DOUBLE_M: f64 = 1.6;

/// A piece of a fence, wall or hedge.
struct Piece {
    border: Border,
    length_m: f64,
    near_z_m: f64,
    yaw_rad: f64,
    variant: u32,
}

/// Fences, walls and hedges around buildings, in pieces: towards the street along its edge, and between plots
/// straight on.
pub(crate) fn borders(
    site: &Site<'_>,
    houses: &[Candidate<House<'_>>],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let mut candidates = Vec::new();
    for house in houses {
        let fits = |at: [f64; 2], rect: &OrientedRect| {
            site.near(at[0], at[1], reach_m::FENCES) && land.free(&rect.grown(0.05))
        };
        candidates.extend(to_the_street(house).into_iter().filter(|c| fits(c.takes.centre_m, &c.takes)));
        candidates.extend(between(site, house).into_iter().filter(|c| fits(c.takes.centre_m, &c.takes)));
    }
    for Candidate { takes, what: piece, .. } in settle(candidates, land) {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            let z = [-1.0, 0.0, 1.0].map(|u| {
                let [x, y] = takes.at(u, 0.0);
                site.levels().height(x, y, piece.near_z_m)
            });
            let low = z.into_iter().fold(f64::INFINITY, f64::min);
            let Piece { border, length_m, yaw_rad, variant, .. } = piece;
            let kind = if border.tag == Tag::Vegetation { ActorKind::Vegetation } else { ActorKind::Prop };
            let size_m = [length_m, border.width_m, border.height_m];
            let mut draft = Draft::new(kind, border.model, border.tag, size_m, [x, y, low], yaw_rad);
            draft.variant = variant;
            drafts.push(draft);
        }
    }
}

/// The rank of a piece of a house's border.
fn rank_of((priority, entity, slot): Rank, piece: u64) -> Rank {
    (priority ^ piece as u32, entity, slot << 8 | piece)
}

/// What a building has towards the street.
fn before(house: &House<'_>) -> Option<Border> {
    match house.fence {
        _ if house.setback_m <= 3.6 => None,
        pick if pick < 0.22 => Some(FENCE),
        pick if pick < 0.38 => Some(WALL),
        pick if pick < 0.55 => Some(HEDGE),
        _ => None,
    }
}

/// Whether nothing is between a building and its street.
pub(crate) fn is_open_to_the_street(house: &House<'_>) -> bool {
    before(house).is_none()
}

/// The border towards the street, which follows its edge.
fn to_the_street(house: &Candidate<House<'_>>) -> Vec<Candidate<Piece>> {
    let House { front, along_m, variant, .. } = house.what;
    let Some(border) = before(&house.what) else { return Vec::new() };
    let length_m = 2.0 * (house.takes.half_m[1] - AROUND_M);
    let pieces = (length_m / 6.0).ceil().max(1.0) as usize;
    let piece_m = length_m / pieces as f64;
    // The way in stays open.
    let wanted = (0..pieces).filter(|i| pieces <= 2 || *i != pieces / 2);
    let piece = |i: usize| {
        let spot = front.at(along_m - 0.5 * length_m + (i as f64 + 0.5) * piece_m)?;
        let at = spot.beside(0.9, 0.0);
        let half_m = [0.5 * piece_m, 0.5 * border.width_m];
        let rect = OrientedRect { centre_m: [at.x, at.y], axis: [-spot.away.y, spot.away.x], half_m };
        let yaw_rad = frames::math::atan2(spot.away.x, -spot.away.y);
        let what = Piece { border, length_m: piece_m, near_z_m: spot.point.z, yaw_rad, variant };
        // Pieces side by side touch.
        let needs = OrientedRect { half_m: [0.5 * piece_m - 0.3, half_m[1]], ..rect };
        Some(Candidate { takes: rect, needs, rank: rank_of(house.rank, i as u64), what })
    };
    wanted.filter_map(piece).collect()
}

/// The borders to the neighbours: on both sides of the building, and behind its yard.
fn between(site: &Site<'_>, house: &Candidate<House<'_>>) -> Vec<Candidate<Piece>> {
    let House { kind, is_in_town, near_z_m, .. } = house.what;
    let (_, entity, slot) = house.rank;
    let mut random = Stream::new(site.rules.seed, slot, "world/plots", entity);
    let country = usize::from(!is_in_town);
    let shares = match kind.model {
        "building.hall" => &AT_HALLS,
        "building.tower" => return Vec::new(),
        _ if is_in_town => &IN_TOWN,
        _ => &IN_THE_COUNTRY,
    };
    let chosen = BETWEEN[draw(&mut random, shares)];
    let variant = random.next_u32();
    let [yard_m, strip_m] =
        [YARD_M, STRIP_M].map(|ranges| random.uniform(ranges[country][0], ranges[country][1]));
    let wanted = random.chance(site.rules.density);
    let Some(border) = chosen.filter(|_| wanted) else { return Vec::new() };
    let half = house.takes.half_m.map(|h| h - AROUND_M);
    // Whole pieces, from the front wall to behind the yard, and from side to side.
    let whole = |length_m: f64| (length_m / PIECE_M).ceil().max(1.0);
    let (along, across) = (whole(2.0 * half[0] + yard_m), whole(2.0 * (half[1] + strip_m)));
    let side_m = 0.5 * across * PIECE_M;
    let [ax, ay] = house.takes.axis;
    let [cx, cy] = house.takes.centre_m;
    // In the frame of the house: x towards the street, y to the left of that.
    let place = |x: f64, y: f64| [cx + x * ax - y * ay, cy + x * ay + y * ax];
    let at_side =
        |side: f64, i: usize| (place(half[0] - (i as f64 + 0.5) * PIECE_M, side * side_m), [ax, ay]);
    let behind =
        |i: usize| (place(half[0] - along * PIECE_M, (i as f64 + 0.5) * PIECE_M - side_m), [-ay, ax]);
    let sides = (0..along as usize).flat_map(|i| [at_side(-1.0, i), at_side(1.0, i)]);
    let all = sides.chain((0..across as usize).map(behind));
    let piece = |(k, (centre_m, axis)): (u64, ([f64; 2], [f64; 2]))| {
        let half_m = [0.5 * PIECE_M, 0.5 * border.width_m];
        let rect = OrientedRect { centre_m, axis, half_m };
        let needs = OrientedRect { half_m: [0.5 * PIECE_M - 0.9, half_m[1] + 0.5 * DOUBLE_M], ..rect };
        let yaw_rad = frames::math::atan2(axis[1], axis[0]);
        let variant = variant % border.variants;
        let what = Piece { border, length_m: PIECE_M, near_z_m, yaw_rad, variant };
        Candidate { takes: rect, needs, rank: rank_of(house.rank, 32 + k), what }
    };
    (0..).zip(all).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::{DOUBLE_M, PIECE_M};
    use crate::scenery::tests::{all_by, footprint, meets_lanes, town_map};
    use schema::tables::TileObjectRow;
    use settings::SceneryRules;

    fn is_border(object: &TileObjectRow) -> bool {
        ["prop.fence", "prop.boards", "prop.wire", "prop.wall", "bush.hedge"].contains(&object.model.as_str())
    }

    #[test]
    fn borders_keep_off_lanes_houses_and_one_another() {
        for (name, least) in [("convoy/demo", 200), ("convoy/07", 60)] {
            let map = town_map(name);
            let objects = all_by(&SceneryRules::default(), &map, [-384.0, -384.0], 768.0);
            let borders: Vec<_> = objects.iter().filter(|o| is_border(o)).collect();
            let between: Vec<_> = borders.iter().filter(|o| o.length_m == PIECE_M).collect();
            assert!(between.len() > least, "{name}: {}", between.len());
            let houses: Vec<_> = objects.iter().filter(|o| o.model.starts_with("building.")).collect();
            for border in &borders {
                let ground = footprint(border);
                assert!(!meets_lanes(&map, &ground, border.xyz_m[2]), "{name}: {:?}", border.xyz_m);
                assert!(!houses.iter().any(|h| footprint(h).meets(&ground)), "{name}: {:?}", border.xyz_m);
            }
            // No two run side by side.
            for (i, one) in between.iter().enumerate() {
                let thin = frames::OrientedRect { half_m: [0.3, 0.25 * DOUBLE_M], ..footprint(one) };
                let along = |o: &TileObjectRow| footprint(o).axis;
                let is_parallel = |other: &TileObjectRow| {
                    let ([a, b], [c, d]) = (along(one), along(other));
                    (a * c + b * d).abs() > 0.9
                };
                let beside =
                    between[..i].iter().find(|other| is_parallel(other) && footprint(other).meets(&thin));
                assert!(beside.is_none(), "{name}: {:?} {:?}", one.xyz_m, beside.map(|o| o.xyz_m));
            }
        }
    }
}
