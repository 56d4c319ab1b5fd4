//! Street lamps.

use frames::OrientedRect;
use nalgebra::Point3;
use schema::{ActorKind, Tag};

use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::land::Land;
use crate::scenery::lots::HIGHWAY_MPS;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::swept::is_swept;
use crate::surfaces::Ground;

/// Length with its arm, width and height of a lamp, and of one beside several lanes or a fast road, metres.
const LAMP_M: [f64; 3] = [2.4, 0.28, 7.5];
const TALL_LAMP_M: [f64; 3] = [2.8, 0.36, 9.5];
/// As many lanes to one side have tall lamps.
const TALL_LANES: usize = 2;

/// A street lamp: its foot's place and the middle of its box.
struct Lamp {
    size_m: [f64; 3],
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
        let fast = front.speed_mps > HIGHWAY_MPS;
        // Lamps of the two sides stand in turn.
        let first = if front.entity % 2 == 0 { 0.25 } else { 0.75 } * spacing;
        for slot in 0u32.. {
            let along = first + f64::from(slot) * spacing;
            if along >= front.length_m() - 2.0 {
                break;
            }
            let Some(spot) = front.at(along) else { break };
            let size_m = if fast || front.traffic.lanes >= TALL_LANES { TALL_LAMP_M } else { LAMP_M };
            if let Some(lamp) = lamp_at(site, &spot, (fast, size_m), land) {
                let rank = rank(site.rules.seed, "world/lamps/rank", front.entity, slot.into());
                let foot = spot.foot(fast);
                let foot = OrientedRect::square([foot.x, foot.y], FOOT_M);
                candidates.push(Candidate { takes: foot, needs: foot, rank, what: lamp });
            }
        }
    }
    for Candidate { takes, what: Lamp { size_m, middle, z_m, yaw_rad }, .. } in settle(candidates, land) {
        if site.holds(takes.centre_m[0], takes.centre_m[1]) {
            let xyz = [middle.x, middle.y, z_m];
            drafts.push(Draft::new(ActorKind::Pole, "pole.lamp", Tag::Pole, size_m, xyz, yaw_rad));
        }
    }
}

fn lamp_at(site: &Site<'_>, spot: &Spot, (fast, size_m): (bool, [f64; 3]), land: &Land<'_>) -> Option<Lamp> {
    let foot = spot.foot(fast);
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
    let middle = spot.beside(spot.pole_m(fast) - 0.5 * size_m[0] + 0.13, 0.0);
    // Beside a bridge the ground is too low for a lamp to light the deck.
    ((z_m - spot.point.z).abs() <= 1.0).then_some(Lamp { size_m, middle, z_m, yaw_rad: spot.facing_yaw() })
}

impl Spot {
    /// How far the pole of a lamp stands beyond the edge, metres: just inside the kerb, beside the road, or
    /// behind the guard rail of a fast one.
    fn pole_m(&self, fast: bool) -> f64 {
        if self.walk_m > 0.9 {
            0.35 - self.walk_m
        } else if fast {
            1.1
        } else {
            0.6
        }
    }

    fn foot(&self, fast: bool) -> Point3<f64> {
        self.beside(self.pole_m(fast), 0.0)
    }
}
