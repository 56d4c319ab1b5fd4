//! What covers open land: patches of meadow, shrubs and crops that fill a square each.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};
use settings::Season;

use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::Site;
use crate::scenery::uses::{PLOT_M, Use, Uses};

/// Patches keep this far from lanes, metres.
const CLEAR_M: f64 = 1.5;
/// Their plants stand this deep in the ground, and the ground under one differs from a plane by so much at
/// most, metres.
const ROOT_M: f64 = 0.05;
const FLAT_M: f64 = 0.09;
/// The steepest ground under one, rise over run.
const STEEPEST: f64 = 0.4;
/// So many patches of a kind and size differ in shape, and fields and meadows in colour.
const SHAPES: u32 = 4;
const COLOURS: u32 = 4;

/// A kind of patch.
struct Kind {
    model: &'static str,
    /// Heights that it may have: few, so that patches share meshes.
    heights_m: &'static [f64],
    /// Lengths along rows that are tried, from the largest on, and how wide a patch is at the most.
    sides_m: &'static [f64],
    widest_m: f64,
}

const MEADOW: Kind =
    Kind { model: "plant.meadow", heights_m: &[0.3, 0.45, 0.6], sides_m: &[8.0, 4.0], widest_m: 8.0 };
const SHORT_MEADOW: Kind = Kind { heights_m: &[0.2, 0.3], ..MEADOW };
const SHRUBS: Kind =
    Kind { model: "plant.shrubs", heights_m: &[1.25, 1.75, 2.25], sides_m: &[4.0], widest_m: 4.0 };
const MAIZE: Kind = Kind { model: "plant.maize", heights_m: &[2.2], sides_m: &[8.0, 4.0], widest_m: 8.0 };
const WHEAT: Kind = Kind { model: "plant.wheat", heights_m: &[0.8], sides_m: &[8.0, 4.0], widest_m: 8.0 };
/// A patch of vines is one row.
const VINES: Kind = Kind { model: "plant.vines", heights_m: &[1.8], sides_m: &[8.0, 4.0], widest_m: 2.0 };

/// Covers the open land of the area. Patches take no ground: what is put there later stands in them.
pub(crate) fn patches(site: &Site<'_>, uses: &Uses, land: &Land<'_>, drafts: &mut Vec<Draft>) {
    let [[i0, j0], [i1, j1]] =
        [site.ground.area.min, site.ground.area.max].map(|p| p.map(|v| (v / PLOT_M).round() as i32));
    let is_winter = site.rules.season == Season::Winter;
    for (i, j) in (j0..j1).flat_map(|j| (i0..i1).map(move |i| (i, j))) {
        let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) * PLOT_M);
        let Some(of_land) = uses.at(x, y) else { continue };
        let mut random = uses.stream("world/patches", i, j);
        // Drawn for every piece of land, so that nothing hangs on what is there.
        let (wanted, second) = (random.unit(), random.unit());
        let density = site.rules.density;
        let mut cover = Cover { site, uses, land, drafts, random };
        match of_land {
            Use::Meadow if is_winter && wanted < density => cover.square(&SHORT_MEADOW, [x, y], PLOT_M, None),
            Use::Meadow if wanted < density => cover.square(&MEADOW, [x, y], PLOT_M, None),
            Use::Shrubs => {
                for share in [wanted, second] {
                    if share < 0.75 * density {
                        cover.quarter(&SHRUBS, [x, y]);
                    }
                }
            }
            Use::Wood => {
                let beside = [(PLOT_M, 0.0), (-PLOT_M, 0.0), (0.0, PLOT_M), (0.0, -PLOT_M)];
                let is_edge = beside.into_iter().any(|(dx, dy)| uses.at(x + dx, y + dy) != Some(Use::Wood));
                let shares = if is_edge { [0.95, 0.8] } else { [0.35, 0.0] };
                for (share, drawn) in shares.into_iter().zip([wanted, second]) {
                    if drawn < share * density {
                        cover.quarter(&SHRUBS, [x, y]);
                    }
                }
            }
            Use::Maize | Use::Wheat | Use::Vines
                if density > 0.0 && !(is_winter && of_land != Use::Vines) =>
            {
                let kind = match of_land {
                    Use::Maize => &MAIZE,
                    Use::Wheat => &WHEAT,
                    _ => &VINES,
                };
                cover.square(kind, [x, y], PLOT_M, Some(uses.rows_rad(x, y)));
            }
            _ => {}
        }
    }
}

/// Patches in the making.
struct Cover<'a, 's> {
    site: &'a Site<'s>,
    uses: &'a Uses,
    land: &'a Land<'s>,
    drafts: &'a mut Vec<Draft>,
    random: Stream,
}

impl Cover<'_, '_> {
    /// Patches over a square, or smaller ones over its quarters where that does not fit.
    fn square(&mut self, kind: &Kind, [x, y]: [f64; 2], side_m: f64, rows_rad: Option<f64>) {
        let wide_m = side_m.min(kind.widest_m);
        let rows = (side_m / wide_m).round() as usize;
        let (sin, cos) = frames::math::sin_cos(rows_rad.unwrap_or(0.0));
        let middle_of = |k: usize| {
            let left_m = (k as f64 + 0.5) * wide_m - 0.5 * side_m;
            [x - left_m * sin, y + left_m * cos]
        };
        if kind.sides_m.contains(&side_m)
            && (0..rows).all(|k| self.fits(&rect(middle_of(k), [side_m, wide_m], rows_rad)))
        {
            (0..rows).for_each(|k| self.put(kind, &rect(middle_of(k), [side_m, wide_m], rows_rad)));
            return;
        }
        let half_m = 0.5 * side_m;
        if kind.sides_m.iter().any(|side_m| *side_m <= half_m) {
            for (u, v) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
                self.square(kind, [x + u * half_m, y + v * half_m], half_m, rows_rad);
            }
        }
    }

    /// A patch on one of the quarters of a piece of land.
    fn quarter(&mut self, kind: &Kind, [x, y]: [f64; 2]) {
        let [u, v] = [0, 1].map(|_| if self.random.chance(0.5) { 0.25 } else { -0.25 });
        let turns = f64::from(self.random.next_u32() % 4);
        let rect = rect(
            [x + u * PLOT_M, y + v * PLOT_M],
            [0.5 * PLOT_M; 2],
            Some(turns * std::f64::consts::FRAC_PI_2),
        );
        if self.fits(&rect) {
            self.put(kind, &rect);
        }
    }

    /// Whether there is room, and the ground is even.
    fn fits(&self, rect: &OrientedRect) -> bool {
        let is_free =
            self.land.unused(rect) && self.land.off_road(&rect.grown(CLEAR_M)) && self.land.is_dry(rect);
        is_free && plane(self.site, rect).is_some()
    }

    /// Puts a patch on some ground.
    fn put(&mut self, kind: &Kind, rect: &OrientedRect) {
        let height_m = self.random.choose(kind.heights_m).copied().unwrap_or(0.5);
        let [x, y] = rect.centre_m;
        // Patches of one field are of one colour.
        let colour = self.uses.colour(x, y) % COLOURS;
        let variant = self.random.next_u32() % SHAPES + SHAPES * colour;
        self.drafts.extend(lie(self.site, rect, (kind.model, height_m, variant)));
    }
}

/// Plants of a model, a height and a variant that fill a rectangle and lie on its ground; none where that is
/// uneven.
pub(crate) fn lie(
    site: &Site<'_>,
    rect: &OrientedRect,
    (model, height_m, variant): (&str, f64, u32),
) -> Option<Draft> {
    let (z_m, [ahead, left]) = plane(site, rect)?;
    let [cos, sin] = rect.axis;
    let [x, y] = rect.centre_m;
    let pitch_rad = -frames::math::atan2(ahead, 1.0);
    let roll_rad = frames::math::atan2(left * frames::math::sin_cos(pitch_rad).1, 1.0);
    let yaw_rad = frames::math::atan2(sin, cos);
    let size_m = [2.0 * rect.half_m[0], 2.0 * rect.half_m[1], height_m];
    let xyz = [x, y, z_m - ROOT_M];
    let mut draft = Draft::new(ActorKind::Vegetation, model, Tag::Vegetation, size_m, xyz, yaw_rad);
    draft.rpy_rad = [roll_rad, pitch_rad, yaw_rad];
    draft.variant = variant;
    Some(draft)
}

/// Height of the land in the middle of a rectangle, and its rise along its sides; none where it is
/// uneven.
fn plane(site: &Site<'_>, rect: &OrientedRect) -> Option<(f64, [f64; 2])> {
    let terrain = &site.levels().terrain;
    let at = |u: f64, v: f64| {
        let [x, y] = rect.at(u, v);
        terrain.height(x, y)
    };
    let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(u, v)| at(u, v));
    let middle_m = 0.25 * (a + b + c + d);
    let [half_x, half_y] = rect.half_m;
    let [ahead, left] = [(b - a + d - c) / (4.0 * half_x), (c - a + d - b) / (4.0 * half_y)];
    let is_even = (-2..=2).all(|i| {
        (-2..=2).all(|j| {
            let (u, v) = (0.5 * f64::from(i), 0.5 * f64::from(j));
            let plane = middle_m + half_x * u * ahead + half_y * v * left;
            (at(u, v) - plane).abs() <= FLAT_M
        })
    });
    (is_even && ahead * ahead + left * left < STEEPEST * STEEPEST).then_some((middle_m, [ahead, left]))
}

/// The ground of a patch of some length and width; its rows run along its length.
fn rect(centre_m: [f64; 2], size_m: [f64; 2], rows_rad: Option<f64>) -> OrientedRect {
    OrientedRect::new(centre_m, rows_rad.unwrap_or(0.0), size_m.map(|v| 0.5 * v))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{FLAT_M, ROOT_M};
    use crate::scenery::tests::{all_by, footprint, meets_lanes, town_map};
    use crate::surfaces::{Atlas, Region};
    use frames::{Object, Pose, World};
    use nalgebra::Point3;
    use settings::{SceneryRules, Season};

    #[test]
    fn patches_lie_on_open_land() {
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        for name in ["convoy/demo", "convoy/07", "convoy/11"] {
            let map = town_map(name);
            let (corner, side) = ([-384.0, -384.0], 768.0);
            let objects = all_by(&SceneryRules::default(), &map, corner, side);
            let atlas = Atlas::new(&map);
            let ground = atlas.ground(&Region { min: corner, max: corner.map(|v| v + side) });
            let solid = |model: &str| model.starts_with("building.") || model.starts_with("car.");
            let solids: Vec<_> = objects.iter().filter(|o| solid(&o.model)).map(footprint).collect();
            // Creepers are on walls.
            let lies = |model: &str| model.starts_with("plant.") && model != "plant.climber";
            for patch in objects.iter().filter(|o| lies(&o.model)) {
                *seen.entry(patch.model.clone()).or_default() += 1;
                let rect = footprint(patch);
                assert!(!meets_lanes(&map, &rect, patch.xyz_m[2]), "{name}: {:?}", patch.xyz_m);
                assert!(
                    !solids.iter().any(|solid| solid.meets(&rect)),
                    "{name}: {} {:?}",
                    patch.model,
                    patch.xyz_m
                );
                // Its corners and sides lie on the land.
                let world_from_patch = Pose::<World, Object>::from_xyz_wxyz(patch.xyz_m, patch.quaternion);
                for (u, v) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (0.0, 1.0), (1.0, 0.0)] {
                    let own = Point3::new(0.5 * u * patch.length_m, 0.5 * v * patch.width_m, ROOT_M);
                    let at = world_from_patch.isometry() * own;
                    let land_m = ground.levels.terrain.height(at.x, at.y);
                    // A square's sides are a little shorter where it is turned up.
                    assert!((at.z - land_m).abs() < FLAT_M + 0.03, "{name}: {at} over {land_m}");
                }
            }
        }
        for model in ["meadow", "shrubs", "maize", "wheat", "vines", "flowers"] {
            assert!(seen.get(&format!("plant.{model}")).is_some_and(|n| *n > 10), "{model}: {seen:?}");
        }
    }

    #[test]
    fn density_and_season_say_what_grows() {
        let map = town_map("convoy/07");
        let count = |density: f64, season: Season| {
            let rules = SceneryRules { density, season, ..SceneryRules::default() };
            let mut seen: BTreeMap<String, usize> = BTreeMap::new();
            for object in all_by(&rules, &map, [-256.0, -256.0], 512.0) {
                *seen.entry(object.model).or_default() += 1;
            }
            seen
        };
        let (none, some, twice) =
            (count(0.0, Season::Summer), count(1.0, Season::Summer), count(2.0, Season::Summer));
        let new = |model: &&String| {
            model.starts_with("plant.")
                || ["prop.boards", "prop.wire", "prop.forecourt"].contains(&model.as_str())
        };
        assert!(none.keys().find(new).is_none(), "{none:?}");
        let shrubs = |seen: &BTreeMap<String, usize>| seen.get("plant.shrubs").copied().unwrap_or(0);
        assert!(shrubs(&twice) > shrubs(&some) && shrubs(&some) > 0, "{some:?} {twice:?}");
        let winter = count(1.0, Season::Winter);
        let with_leaves = |model: &&String| model.starts_with("tree.") && !model.ends_with(".bare");
        let evergreens = ["tree.spruce", "tree.pine", "tree.palm"];
        assert!(winter.keys().filter(with_leaves).all(|m| evergreens.contains(&m.as_str())), "{winter:?}");
        assert!(winter.contains_key("tree.oak.bare") && some.contains_key("tree.oak"), "{winter:?}");
        assert!(
            ["plant.maize", "plant.wheat"].iter().all(|m| some.contains_key(*m) && !winter.contains_key(*m))
        );
    }
}
