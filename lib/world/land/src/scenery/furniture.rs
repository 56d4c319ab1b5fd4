//! Street lamps, benches and bins.

use frames::OrientedRect;
use nalgebra::Point3;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::swept::is_swept;
use crate::surfaces::{Ground, beside_edge};

const LAMP_M: [f64; 3] = [2.4, 0.28, 7.5];

/// A street lamp: its foot's place and the middle of its box.
struct Lamp {
    middle: Point3<f64>,
    z_m: f64,
    yaw_rad: f64,
}

/// Street lamps at the kerb of sidewalks, their heads over the road; beside fast roads without sidewalks,
/// too.
pub(crate) fn lamps(site: &Site<'_>, fronts: &[Frontage], land: &mut Land<'_>, drafts: &mut Vec<Draft>) {
    let spacing = site.rules.lamp_spacing_m.max(5.0);
    let mut candidates = Vec::new();
    for front in fronts.iter().filter(|f| !f.track) {
        // Lamps of the two sides stand in turn.
        let first = if front.entity % 2 == 0 { 0.25 } else { 0.75 } * spacing;
        for slot in 0u32.. {
            let along = first + f64::from(slot) * spacing;
            if along >= front.length_m() - 2.0 {
                break;
            }
            let Some(spot) = front.at(along) else { break };
            if let Some(lamp) = lamp_at(site, &spot, land) {
                let rank = rank(site.rules.seed, "world/lamps/rank", front.entity, slot.into());
                let foot = OrientedRect::square([spot.foot().x, spot.foot().y], FOOT_M);
                candidates.push(Candidate { takes: foot, needs: foot, rank, what: lamp });
            }
        }
    }
    for Candidate { takes, what: Lamp { middle, z_m, yaw_rad }, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            let xyz = [middle.x, middle.y, z_m];
            drafts.push(Draft::new(ActorKind::Pole, "pole.lamp", Tag::Pole, LAMP_M, xyz, yaw_rad));
        }
    }
}

fn lamp_at(site: &Site<'_>, spot: &Spot, land: &Land<'_>) -> Option<Lamp> {
    let foot = spot.foot();
    if !site.near(foot.x, foot.y, reach_m::LAMPS) {
        return None;
    }
    let on_lane = site.levels().cover.at(foot.x, foot.y).any(|(f, _)| f.ground == Ground::Paved);
    let swept = || is_swept(site.map, Point3::new(foot.x, foot.y, spot.point.z), POLE_M);
    if on_lane || !land.unused(&OrientedRect::square([foot.x, foot.y], FOOT_M)) || swept() {
        return None;
    }
    let z_m = site.levels().height(foot.x, foot.y, spot.point.z);
    // The pole stands at the rear end of the lamp's box.
    let middle = spot.beside(spot.pole_m() - 0.5 * LAMP_M[0] + 0.13, 0.0);
    // Beside a bridge the ground is too low for a lamp to light the deck.
    ((z_m - spot.point.z).abs() <= 1.0).then_some(Lamp { middle, z_m, yaw_rad: spot.facing_yaw() })
}

impl Spot {
    /// How far the pole of a lamp stands beyond the edge, metres: just inside the kerb, or beside the road.
    fn pole_m(&self) -> f64 {
        if self.walk_m > 0.9 { 0.35 - self.walk_m } else { 0.6 }
    }

    fn foot(&self) -> Point3<f64> {
        self.beside(self.pole_m(), 0.0)
    }
}

/// Benches and bins stand so far beyond the sidewalk's edge, metres.
const BESIDE_M: f64 = 0.5;

/// A bench or bin; `near_z_m` is the height of that edge.
struct Small {
    model: &'static str,
    size_m: [f64; 3],
    variant: u32,
    near_z_m: f64,
    yaw_rad: f64,
}

/// Benches and bins along the outer edge of sidewalks.
pub(crate) fn small_things(
    site: &Site<'_>,
    fronts: &[Frontage],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let mut candidates = Vec::new();
    for front in fronts {
        let mut random = Stream::new(site.rules.seed, 0, "world/furniture", front.entity);
        let mut along = random.uniform(6.0, 30.0);
        let mut slot = 0;
        while along < front.length_m() - 3.0 {
            let bench = random.chance(0.6);
            let variant = random.next_u32() % 3;
            let Some(spot) = front.at(along) else { break };
            along += random.uniform(14.0, 45.0);
            slot += 2;
            if spot.walk_m <= 0.0 {
                continue;
            }
            let mut add = |model: &'static str, size_m: [f64; 3], sideways: f64, slot: u64| {
                let at = spot.beside(BESIDE_M, sideways);
                let rect = OrientedRect {
                    centre_m: [at.x, at.y],
                    axis: [-spot.away.x, -spot.away.y],
                    half_m: [0.5 * size_m[0], 0.5 * size_m[1]],
                };
                if site.near(at.x, at.y, reach_m::SMALL) && land.free(&rect) {
                    let (near_z_m, yaw_rad) = (spot.point.z, spot.facing_yaw());
                    let rank = rank(site.rules.seed, "world/furniture/rank", front.entity, slot);
                    let what = Small { model, size_m, variant, near_z_m, yaw_rad };
                    candidates.push(Candidate { takes: rect, needs: rect, rank, what });
                }
            };
            if bench {
                add("prop.bench", [0.55, 1.70, 0.85], 0.0, slot);
            }
            add("prop.bin", [0.42, 0.42, 0.95], 1.6, slot + 1);
        }
    }
    for Candidate { takes, what: thing, .. } in settle(candidates, land) {
        let [x, y] = takes.centre_m;
        if site.holds(x, y) {
            let land_m = site.levels().height(x, y, thing.near_z_m);
            let xyz = [x, y, beside_edge(land_m, thing.near_z_m, BESIDE_M)];
            let mut draft =
                Draft::new(ActorKind::Prop, thing.model, Tag::Static, thing.size_m, xyz, thing.yaw_rad);
            draft.variant = thing.variant;
            drafts.push(draft);
        }
    }
}
