//! What follows a road: delineators, the poles of lines, guard rails.

use frames::OrientedRect;
use frames::math::atan2;
use nalgebra::Point3;

use super::candidates::{Placer, Thing, Wanted, street};
use super::kinds::{FurnitureKind, FurniturePlace};
use crate::scenery::claims::Candidate;
use crate::scenery::frontage::Frontage;
use crate::scenery::lots::HIGHWAY_MPS;
use crate::scenery::site::reach_m;
use crate::scenery::swept::is_swept;

/// No line along shorter sides of roads, metres.
const SHORTEST_M: f64 = 30.0;
/// Beside a sidewalk a line stands so far beyond it, metres.
const BEYOND_WALK_M: f64 = 0.7;
/// Pieces of rails have such a length, or a little more on the outside of a bend; the next step of theirs,
/// metres.
const PIECE_M: f64 = 4.0;
const STEP_OF_PIECES_M: f64 = 0.05;
/// The foot of a rail is at most so much lower or higher than the edge of the road, metres.
const STEP_M: f64 = 0.3;
/// Rails stand beside slower roads, too, from this limit on, m/s, where the land this far beyond the edge is
/// so much lower than that, metres.
const AT_DROPS_MPS: f64 = 11.0;
const DROP_BEYOND_M: f64 = 5.0;
const DROP_M: f64 = 1.2;
/// Neighbours may lie on each other by so much, metres.
const LAP_M: f64 = 0.3;

/// One thing after another at even distances along a side of a road.
pub(super) fn line(
    placer: &Placer<'_>,
    kind: (usize, &'static FurnitureKind),
    front: &Frontage,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    let FurniturePlace::Line { beyond_m, apart_m: [shortest_m, longest_m], both } = kind.1.place else {
        return;
    };
    if front.length_m() < SHORTEST_M || (!both && !front.entity.is_multiple_of(2)) {
        return;
    }
    // Both sides of a road have it, or none.
    let mut random = placer.stream(kind.1, front.entity / 2);
    let (chance, apart_m) = (random.unit(), random.uniform(shortest_m, longest_m));
    for slot in 0u32.. {
        let along_m = (0.5 + f64::from(slot)) * apart_m;
        let variant = random.next_u32() % kind.1.variants;
        if along_m >= front.length_m() {
            break;
        }
        let Some(spot) = front.at(along_m) else { break };
        if chance < kind.1.often[street(&spot)] {
            let beyond_m = if spot.walk_m > 0.0 { BEYOND_WALK_M } else { beyond_m };
            let wanted = Wanted { kind, front, along_m, beyond_m, variant, slot: slot.into() };
            candidates.extend(placer.candidate(&wanted, &spot));
        }
    }
}

/// Pieces of guard rails along a side of a fast road.
pub(super) fn rails(
    placer: &Placer<'_>,
    (number, kind): (usize, &'static FurnitureKind),
    beyond_m: f64,
    front: &Frontage,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    if front.speed_mps < AT_DROPS_MPS {
        return;
    }
    let pieces = (front.length_m() / PIECE_M).floor();
    let first_m = 0.5 * (front.length_m() - PIECE_M * pieces);
    for slot in 0..pieces as u64 {
        let along_m = first_m + (slot as f64 + 0.5) * PIECE_M;
        let ends = [-0.5, 0.5].map(|share| front.at(along_m + share * PIECE_M));
        let ([Some(from), Some(to)], Some(spot)) = (ends, front.at(along_m)) else { continue };
        if [&from, &to, &spot].iter().any(|spot| spot.walk_m > 0.0) {
            continue;
        }
        let [a, b] = [&from, &to].map(|spot| spot.beside(beyond_m, 0.0));
        let middle = nalgebra::center(&a, &b);
        if !placer.site.near(middle.x, middle.y, reach_m::FURNITURE) {
            continue;
        }
        let chord = (b - a).xy();
        let length_m = (chord.norm() / STEP_OF_PIECES_M).ceil() * STEP_OF_PIECES_M;
        if !(0.5 * PIECE_M..=1.15 * PIECE_M).contains(&length_m) {
            continue;
        }
        // It looks at the road, a quarter off the chord.
        let along = chord / chord.norm();
        let facing = [[along.y, -along.x], [-along.y, along.x]]
            .into_iter()
            .find(|[x, y]| x * spot.away.x + y * spot.away.y < 0.0)
            .unwrap_or([-spot.away.x, -spot.away.y]);
        let rect = OrientedRect {
            centre_m: [middle.x, middle.y],
            axis: facing,
            half_m: [0.5 * kind.size_m[0], 0.5 * length_m],
        };
        let height = |v: f64| {
            let [x, y] = rect.at(0.0, v);
            placer.height_m(front, along_m, &spot, [x, y])
        };
        // A road may be fast in a part of it alone, and another one may be nearer.
        let limit_mps = placer.site.map.speed_limit_at(middle).unwrap_or(0.0);
        let [right_m, left_m] = [height(-1.0), height(1.0)];
        // Seen from it, the frontage runs to the left or to the right.
        let runs_left = (b.y - a.y) * facing[0] - (b.x - a.x) * facing[1] > 0.0;
        let edges_m = if runs_left { [from.point.z, to.point.z] } else { [to.point.z, from.point.z] };
        let z_m = 0.5 * (right_m + left_m);
        let beyond = spot.beside(DROP_BEYOND_M, 0.0);
        let drop_m = spot.point.z - placer.site.levels().terrain.height(beyond.x, beyond.y);
        let good = (limit_mps > HIGHWAY_MPS || limit_mps >= AT_DROPS_MPS && drop_m > DROP_M)
            && [right_m, left_m].iter().zip(edges_m).all(|(z, edge)| (z - edge).abs() <= STEP_M)
            && placer.land.clear_of_posts(&rect)
            && placer.land.off_road(&rect)
            && placer.land.is_dry(&rect)
            && [-1.0, 0.0, 1.0].iter().all(|v| {
                let [x, y] = rect.at(1.0, *v);
                !is_swept(placer.site.map, Point3::new(x, y, spot.point.z), 0.05)
            });
        if !good {
            continue;
        }
        let wanted = Wanted { kind: (number, kind), front, along_m, beyond_m, variant: 0, slot };
        let needs = OrientedRect { half_m: [rect.half_m[0], rect.half_m[1] - LAP_M], ..rect };
        let what = Thing {
            kind,
            size_m: [kind.size_m[0], length_m, kind.size_m[2]],
            z_m,
            roll_rad: atan2(left_m - right_m, length_m),
            yaw_rad: atan2(facing[1], facing[0]),
            variant: 0,
        };
        candidates.push(Candidate { takes: rect, needs, rank: placer.rank(&wanted), what });
    }
}
