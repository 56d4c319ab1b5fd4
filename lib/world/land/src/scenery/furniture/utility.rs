//! Lines of poles along one side of roads, and the wires from pole to pole.
//!
//! They come before all that grows or is built beside buildings, so that a wire's two poles are known from
//! afar: whatever tile is made, both stand or neither.

use std::collections::BTreeMap;

use frames::math::{atan2, cos, sin, sin_cos};
use frames::{OrientedRect, wrap_pi};
use nalgebra::{Point3, Vector3};
use schema::{ActorKind, Tag};

use super::doorways::doorway;
use super::kinds::{FURNITURE, FurnitureKind, FurniturePlace};
use super::street::street;
use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::Frontage;
use crate::scenery::land::Land;
use crate::scenery::lots::House;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::style::FurnitureStyle;
use crate::scenery::swept::is_swept;

/// No line along shorter sides of roads, and none so near to their ends, metres.
const SHORTEST_M: f64 = 45.0;
const END_M: f64 = 4.0;
/// Beside a sidewalk a line stands so far beyond it, metres.
const BEYOND_WALK_M: f64 = 0.7;
/// A foot is at most so much lower or higher than the edge of the road, metres.
const STEP_M: f64 = 1.2;
/// European towns have fewer lines by this factor: their cables are in the ground.
const IN_EUROPE: f64 = 0.7;
/// No wire is longer than this, metres: what is looked at around an area follows from it.
const LONGEST_M: f64 = 54.0;
/// Wires are so far above every road that they cross, metres.
const CLEAR_M: f64 = 6.0;
/// A wire hangs down by this share of its length.
const SAG: f64 = 0.014;
/// Where wires hang on a pole: as a share of its height and above that, and off its axis to the rear, metres.
const HELD: f64 = 0.93;
const OVER_M: f64 = 0.20;
const REAR_M: f64 = 0.10;
/// Room around the ends of wires in their box, metres.
const ROOM_M: f64 = 0.05;

/// The model of wires: four from the arm of one pole to that of the next one.
pub(crate) const WIRES: &str = "pole.wires";

struct Pole {
    foot: Point3<f64>,
    yaw_rad: f64,
    variant: u32,
}

/// Puts up lines of poles where nothing stands yet, and hangs their wires.
pub(crate) fn utility(
    site: &Site<'_>,
    fronts: &[Frontage],
    houses: &[Candidate<House<'_>>],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    if site.rules.density <= 0.0 {
        return;
    }
    let (mut built, mut ways) = (land.without_things(), land.without_things());
    for house in houses {
        built.take(house.takes);
        ways.take(doorway(house));
    }
    for kind in &FURNITURE {
        let FurniturePlace::Wired { beyond_m, apart_m } = kind.place else { continue };
        let mut candidates = Vec::new();
        for front in fronts.iter().filter(|front| !front.track) {
            line(site, (kind, beyond_m, apart_m), front, [&built, &ways, land], &mut candidates);
        }
        let standing: BTreeMap<(u64, u64), Pole> = settle(candidates, land)
            .into_iter()
            .map(|Candidate { rank: (_, entity, slot), what, .. }| ((entity, slot), what))
            .collect();
        for (&(entity, slot), pole) in &standing {
            let next =
                standing.get(&(entity, slot + 1)).and_then(|next| wires(site, kind, &built, [pole, next]));
            let before = slot.checked_sub(1).and_then(|slot| standing.get(&(entity, slot)));
            let is_held = next.is_some()
                || before.is_some_and(|before| wires(site, kind, &built, [before, pole]).is_some());
            // A pole that holds nothing is none.
            let [x, y, z] = pole.foot.into();
            if is_held && site.holds(x, y) {
                let mut draft =
                    Draft::new(kind.actor_kind(), kind.model, kind.tag, kind.size_m, [x, y, z], pole.yaw_rad);
                draft.variant = pole.variant;
                drafts.push(draft);
            }
            drafts.extend(next.filter(|wires| site.holds(wires.xyz_m[0], wires.xyz_m[1])));
        }
    }
}

/// The poles along a side of a road.
fn line(
    site: &Site<'_>,
    (kind, beyond_m, [shortest_m, longest_m]): (&'static FurnitureKind, f64, [f64; 2]),
    front: &Frontage,
    [built, ways, land]: [&Land<'_>; 3],
    candidates: &mut Vec<Candidate<Pole>>,
) {
    if front.length_m() < SHORTEST_M || !front.entity.is_multiple_of(2) {
        return;
    }
    let mut random = random::Stream::new(site.rules.seed, 0, kind.model, front.entity / 2);
    let chance = random.unit() / if site.style() == FurnitureStyle::European { IN_EUROPE } else { 1.0 };
    // Poles from end to end, so far apart.
    let room_m = front.length_m() - 2.0 * END_M;
    let count = (room_m / random.uniform(shortest_m, longest_m)).round().max(1.0);
    let apart_m = room_m / count;
    for slot in 0..=count as u64 {
        let variant = random.next_u32() % kind.variants;
        let along_m = END_M + slot as f64 * apart_m;
        let Some(spot) = front.at(along_m) else { break };
        if chance >= kind.often[street(&spot)] {
            continue;
        }
        let foot = spot.beside(if spot.walk_m > 0.0 { BEYOND_WALK_M } else { beyond_m }, 0.0);
        let near = site.near(foot.x, foot.y, reach_m::UTILITY);
        let takes = OrientedRect::new([foot.x, foot.y], spot.facing_yaw(), [FOOT_M; 2]);
        let arms = OrientedRect { half_m: [0.5 * kind.size_m[0], 0.5 * kind.size_m[1]], ..takes };
        let stands = || land.free(&takes) && built.unused(&arms) && ways.unused(&takes);
        if !near || !stands() || is_swept(site.map, foot, POLE_M) {
            continue;
        }
        let z_m = site.levels().height(foot.x, foot.y, spot.point.z);
        if (z_m - spot.point.z).abs() > STEP_M {
            continue;
        }
        let rank = rank(site.rules.seed, "world/furniture/utility/rank", front.entity, slot);
        let what = Pole { foot: Point3::new(foot.x, foot.y, z_m), yaw_rad: spot.facing_yaw(), variant };
        candidates.push(Candidate { takes, needs: takes, rank, what });
    }
}

/// The wires between two poles; none where they would be too long, hang in a building or near a road over
/// which they do not pass.
fn wires(site: &Site<'_>, kind: &FurnitureKind, built: &Land<'_>, [from, to]: [&Pole; 2]) -> Option<Draft> {
    let high = |pole: &Pole| {
        let (s, c) = sin_cos(pole.yaw_rad);
        pole.foot + Vector3::new(-s * REAR_M, c * REAR_M, HELD * kind.size_m[2] + OVER_M)
    };
    let (a, b) = (high(from), high(to));
    let way = b - a;
    let flat_m = way.xy().norm();
    // Whole centimetres, so that spans that are alike share a mesh.
    let length_m = (100.0 * way.norm()).round() / 100.0;
    if !(5.0..=LONGEST_M).contains(&length_m) {
        return None;
    }
    let middle = nalgebra::center(&a, &b);
    let yaw_rad = atan2(way.y, way.x);
    let width_m = kind.size_m[0] + 0.1;
    let under = OrientedRect::new([middle.x, middle.y], yaw_rad, [0.5 * length_m, 0.5 * width_m]);
    let low_m = middle.z.min(a.z).min(b.z) - SAG * length_m - CLEAR_M;
    let steps = (length_m / 2.0).ceil() as i32;
    let mut below =
        (-steps..=steps).flat_map(|k| [-1.0, 0.0, 1.0].map(|v| under.at(f64::from(k) / f64::from(steps), v)));
    if !built.unused(&under) || below.any(|[x, y]| site.levels().cover.at(x, y).any(|(_, z)| z > low_m)) {
        return None;
    }
    let height_m = (100.0 * SAG * length_m).round() / 100.0 + 2.0 * ROOM_M;
    let pitch_rad = -atan2(way.z, flat_m);
    // From the middle of the ends to the bottom of the box.
    let down_m = height_m - ROOM_M;
    let (sp, cp) = (sin(pitch_rad), cos(pitch_rad));
    let (sy, cy) = sin_cos(yaw_rad);
    let xyz = middle - Vector3::new(sp * cy, sp * sy, cp) * down_m;
    let mut draft =
        Draft::new(ActorKind::Pole, WIRES, Tag::Other, [length_m, width_m, height_m], xyz.into(), yaw_rad);
    draft.rpy_rad = [0.0, pitch_rad, yaw_rad];
    // How the arms are turned against the wires, whole degrees.
    let turn = |pole: &Pole| (wrap_pi(pole.yaw_rad - yaw_rad).to_degrees().round() as i32 + 180) as u32;
    draft.variant = turn(from) | turn(to) << 9;
    Some(draft)
}
