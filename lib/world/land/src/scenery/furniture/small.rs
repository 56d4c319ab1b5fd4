//! Benches and bins.

use frames::OrientedRect;
use random::Stream;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::Frontage;
use crate::scenery::land::Land;
use crate::scenery::site::{Site, reach_m};
use crate::surfaces::beside_edge;

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
