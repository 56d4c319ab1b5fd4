//! Signs that roads have besides those of the map, beside the road and facing its traffic.

use crate::surfaces::Ground;
use frames::{OrientedRect, wrap_pi};
use nalgebra::Point3;

use super::codes::Meaning;
use super::given::{GivenSign, board};
use super::rules::{Painted, RoadsidePosition, SignRequest, wishes};
use crate::scenery::claims::{Candidate, rank, settle};
use crate::scenery::draft::Draft;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::swept::is_swept;

/// From the kerb to a pole on a sidewalk, and from the edge of a road without one, metres.
const ON_WALK_M: f64 = 0.5;
const BESIDE_M: f64 = 1.1;
/// Signs of the map keep others with a limit away so far, metres.
const REPEATED_M: f64 = 70.0;
/// The ground is at most so much lower or higher than the road, metres.
const STEP_M: f64 = 1.0;

/// A sign that would stand somewhere.
struct CandidateSign {
    foot: Point3<f64>,
    yaw_rad: f64,
    meaning: Meaning,
}

/// Puts them where nothing else stands, off every lane and clear of long vehicles.
pub(crate) fn roadside(
    site: &Site<'_>,
    fronts: &[Frontage],
    given: &[GivenSign],
    land: &mut Land<'_>,
    drafts: &mut Vec<Draft>,
) {
    let mut candidates = Vec::new();
    let paint = Painted::near(site, given);
    for front in fronts {
        for wish in wishes(site, front, &paint) {
            let Some(spot) = front.at(wish.along_m) else { continue };
            let Some(foot) = foot(site, &spot, &wish, land) else { continue };
            if repeats(&wish, spot.facing_traffic_rad(front), &foot, given) {
                continue;
            }
            let away = if wish.to_traffic { 0.0 } else { std::f64::consts::PI };
            let what =
                CandidateSign { foot, yaw_rad: spot.facing_traffic_rad(front) + away, meaning: wish.meaning };
            let takes = OrientedRect::square([foot.x, foot.y], FOOT_M);
            let rank = rank(site.rules.seed, "world/signs/rank", front.entity, wish.slot);
            candidates.push(Candidate { takes, needs: takes, rank, what });
        }
    }
    for Candidate { what: CandidateSign { foot, yaw_rad, meaning }, .. } in settle(candidates, land) {
        if site.holds(foot.x, foot.y) {
            drafts.push(board(site, foot, yaw_rad, meaning));
        }
    }
}

/// Whether the map says a limit for the same traffic nearby.
fn repeats(wish: &SignRequest, yaw_rad: f64, foot: &Point3<f64>, given: &[GivenSign]) -> bool {
    let is_limit = |word: &str| word.starts_with("speed_limit");
    is_limit(wish.meaning.sign_type)
        && given.iter().filter(|sign| is_limit(sign.sign_type)).any(|sign| {
            let near = (sign.foot - foot).xy().norm() < REPEATED_M;
            near && wrap_pi(sign.yaw_rad - yaw_rad).abs() < 1.0
        })
}

/// Where the pole of a sign would stand; none where it must not.
fn foot(site: &Site<'_>, spot: &Spot, wish: &SignRequest, land: &Land<'_>) -> Option<Point3<f64>> {
    let (foot, on) = match wish.place {
        RoadsidePosition::Median => (spot.median?, Some(Ground::Median)),
        RoadsidePosition::Side if spot.walk_m > 0.9 => {
            (spot.beside(ON_WALK_M - spot.walk_m, 0.0), Some(Ground::Walk))
        }
        RoadsidePosition::Side => (spot.beside(BESIDE_M, 0.0), None),
    };
    let takes = OrientedRect::square([foot.x, foot.y], FOOT_M);
    if !site.near(foot.x, foot.y, reach_m::SIGNS) || !land.unused(&takes) {
        return None;
    }
    let mut levels = site.levels().cover.at(foot.x, foot.y).filter(|(_, z)| (z - foot.z).abs() < 2.5);
    let fits = match on {
        // On its own strip, and on no other's lanes.
        Some(_) => levels.all(|(facet, _)| facet.ground != Ground::Paved),
        None => levels.next().is_none() && land.is_dry(&takes),
    };
    let z = site.levels().height(foot.x, foot.y, spot.point.z);
    let level = (z - spot.point.z).abs() <= STEP_M;
    let swept = || is_swept(site.map, Point3::new(foot.x, foot.y, spot.point.z), POLE_M);
    (fits && level && !swept()).then_some(Point3::new(foot.x, foot.y, z))
}
