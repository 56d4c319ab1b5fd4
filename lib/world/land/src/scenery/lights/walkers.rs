//! Lights for people who cross: at both ends of each crosswalk whose traffic lights hold, on the pole of such
//! a light or on a post.

use frames::OrientedRect;
use frames::math::atan2;
use nalgebra::{Point3, Vector3};
use opendrive::CrosswalkAxis;
use schema::footprint::LightMount;

use super::head::{BEHIND_M as BEHIND_POLE_M, WALKERS, head};
use crate::scenery::draft::Draft;
use crate::scenery::land::Land;
use crate::scenery::site::{FOOT_M, POLE_M, Site, reach_m};
use crate::scenery::swept::is_swept;
use crate::surfaces::Ground;

/// Bottom of a head over the ground, metres.
const BOTTOM_M: f64 = 2.1;
/// A post stands this far behind the kerb, at the first of these places that is free: at the kerb, or where
/// the sidewalk ends; and so far beside the crosswalk, metres.
const BEHIND_M: [f64; 7] = [0.4, 0.7, 1.9, 2.3, 2.7, 3.2, 3.8];
const BESIDE_M: [f64; 2] = [0.45, 1.0];
/// A pole as near as this to such a place is as good, metres.
const SHARED_M: f64 = 3.0;
/// Of a sidewalk so much stays free beside a post, metres; how thick that is.
const CLEAR_M: f64 = 1.5;
const POST_M: f64 = 0.06;
/// Sidewalks are looked for within this distance, metres.
const WIDEST_M: f64 = 4.0;
/// Posts that decide about one another are nearer than this, metres.
const CLUSTER_M: f64 = 40.0;

/// Puts them up. `poles` are those of all lights that are near, and get the new ones.
pub(super) fn walkers(
    site: &Site<'_>,
    land: &mut Land<'_>,
    poles: &mut Vec<Point3<f64>>,
    drafts: &mut Vec<Draft>,
) {
    let crosswalks = site.map.crosswalks();
    for (number, crosswalk) in crosswalks.iter().enumerate() {
        let Some(axis) = crosswalk.axis() else { continue };
        let near = |p: &Point3<f64>| site.near(p.x, p.y, reach_m::GIVEN + CLUSTER_M);
        if !axis.ends.iter().any(near) || site.map.crosswalk_signals(number).is_empty() {
            continue;
        }
        let name = crosswalk.light_name();
        // Of two crosswalks of one name nobody could tell whose light is meant.
        if crosswalks[..number].iter().any(|other| other.light_name() == name) {
            continue;
        }
        for side in 0..2 {
            let Some((foot, hangs)) = foot(site, &axis, side, land, poles) else { continue };
            if !hangs {
                poles.push(foot);
                land.take(OrientedRect::square([foot.x, foot.y], FOOT_M));
            }
            if site.holds(foot.x, foot.y) {
                let over = axis.ends[1 - side] - axis.ends[side];
                let mount = LightMount { height_m: BOTTOM_M as f32, arm_m: 0.0, pole_right: true, hangs };
                drafts.push(head(site, &WALKERS, &name, (foot, atan2(over.y, over.x)), mount));
            }
        }
    }
}

/// The pole at an end of a crosswalk, and whether it is there already.
fn foot(
    site: &Site<'_>,
    axis: &CrosswalkAxis,
    side: usize,
    land: &Land<'_>,
    poles: &[Point3<f64>],
) -> Option<(Point3<f64>, bool)> {
    let end = axis.ends[side];
    let out = (end - axis.ends[1 - side]).xy().try_normalize(1e-6)?.push(0.0);
    let aside = Vector3::new(-out.y, out.x, 0.0);
    let corner = |behind_m: f64, beside_m: f64, side: f64| {
        end + out * behind_m + aside * (side * (axis.half_width_m + beside_m))
    };
    let corners = [-1.0, 1.0].map(|side| corner(BEHIND_M[0], BESIDE_M[0], side));
    let off = |pole: &Point3<f64>| {
        corners.iter().map(|corner| (corner - pole).xy().norm()).fold(f64::INFINITY, f64::min)
    };
    // One in the middle of the road is before the other end as well.
    let beyond = |pole: &&Point3<f64>| (*pole - end).dot(&out) > -0.2 && (pole.z - end.z).abs() < 1.0;
    let is_free =
        |pole: &&Point3<f64>| !is_on_lane(site, &(*pole - out * (BEHIND_POLE_M + WALKERS.size_m[0])));
    let nearest = poles.iter().filter(beyond).filter(is_free).min_by(|a, b| off(a).total_cmp(&off(b)));
    if let Some(pole) = nearest.filter(|pole| off(pole) < SHARED_M) {
        return Some((*pole, true));
    }
    let mut places = BEHIND_M.into_iter().flat_map(|behind_m| {
        BESIDE_M.into_iter().flat_map(move |beside_m| [-1.0, 1.0].map(|side| (behind_m, beside_m, side)))
    });
    places.find_map(|(behind_m, beside_m, side)| {
        let place = corner(behind_m, beside_m, side);
        stands(site, land, &place).then_some((place, false))
    })
}

fn is_on_lane(site: &Site<'_>, place: &Point3<f64>) -> bool {
    site.levels().cover.at(place.x, place.y).any(|(facet, _)| facet.ground == Ground::Paved)
}

/// Whether a post may stand at a place.
fn stands(site: &Site<'_>, land: &Land<'_>, foot: &Point3<f64>) -> bool {
    let [x, y] = [foot.x, foot.y];
    let in_the_way = site.map.lanes_within(*foot, WIDEST_M, |lane| lane.lane_type.is_walkable());
    let leaves_room = in_the_way
        .iter()
        .filter(|hit| hit.is_inside())
        .all(|hit| 0.5 * hit.width_m + hit.t_m.abs() - POST_M >= CLEAR_M);
    let crossed = site.map.crosswalks().iter().filter_map(|crosswalk| crosswalk.axis());
    let mut ways = crossed.map(|CrosswalkAxis { ends: [a, b], half_width_m }| {
        let way = (b - a).xy();
        let off = (foot - a).xy();
        let length_m = way.norm();
        let (along, aside) = (off.dot(&way) / length_m, off.perp(&way).abs() / length_m);
        // People walk straight on at both ends.
        (-1.5..length_m + 1.5).contains(&along) && aside < half_width_m + 0.2
    });
    !is_on_lane(site, foot)
        && leaves_room
        && land.unused(&OrientedRect::square([x, y], FOOT_M))
        && !is_swept(site.map, *foot, POLE_M)
        && !ways.any(|is_on| is_on)
}
