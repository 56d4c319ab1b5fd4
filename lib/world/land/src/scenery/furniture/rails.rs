//! Guard rails: beside fast roads, at drops, outside of bends, and on medians.

use frames::OrientedRect;
use frames::math::atan2;
use nalgebra::{Point3, Vector3};

use super::candidates::{Placer, Thing, Wanted};
use super::kinds::FurnitureKind;
use crate::scenery::claims::Candidate;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::lots::HIGHWAY_MPS;
use crate::scenery::site::reach_m;
use crate::scenery::swept::is_swept;
use crate::surfaces::Ground;

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
/// And outside of bends whose radius is less than this, taken over so much road before and behind, metres.
const BEND_M: f64 = 200.0;
const BEND_OVER_M: f64 = 15.0;
/// Neighbours may lie on each other by so much, metres.
const LAP_M: f64 = 0.3;
/// Between a rail on a median and what is driven on, metres.
const MEDIAN_FREE_M: f64 = 0.15;
/// Numbers of pieces on medians begin here.
const ON_MEDIAN: u64 = 1 << 24;

/// A piece before it is known whether it fits.
struct Piece {
    slot: u64,
    along_m: f64,
    /// Its ends, and the height of what they should be level with, metres.
    ends: [Point3<f64>; 2],
    levels_m: [f64; 2],
    /// About where it looks.
    towards: Vector3<f64>,
}

/// Pieces of guard rails along a side of a road.
pub(super) fn rails(
    placer: &Placer<'_>,
    kind: (usize, &'static FurnitureKind),
    beyond_m: f64,
    front: &Frontage,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    if front.speed_mps < AT_DROPS_MPS {
        return;
    }
    for (slot, along_m, [from, spot, to]) in pieces(front) {
        if [&from, &to, &spot].iter().any(|spot| spot.walk_m > 0.0) {
            continue;
        }
        let ends = [&from, &to].map(|spot| spot.beside(beyond_m, 0.0));
        let levels_m = [from.point.z, to.point.z];
        let piece = Piece { slot, along_m, ends, levels_m, towards: -spot.away };
        let height = |at: [f64; 2]| placer.height_m(front, along_m, &spot, at);
        let Some(candidate) = piece.candidate(placer, kind, front, height) else { continue };
        let middle = nalgebra::center(&ends[0], &ends[1]);
        // A road may be fast in a part of it alone, and another one may be nearer.
        let limit_mps = placer.site.map.speed_limit_at(middle).unwrap_or(0.0);
        let wanted = || limit_mps >= AT_DROPS_MPS && (drops(placer, &spot) || is_outside(front, along_m));
        let rect = &candidate.takes;
        if (limit_mps > HIGHWAY_MPS || wanted()) && placer.land.off_road(rect) && placer.land.is_dry(rect) {
            candidates.push(candidate);
        }
    }
}

/// Pieces on the median, which look at the traffic of a side of a fast road.
pub(super) fn on_median(
    placer: &Placer<'_>,
    kind: (usize, &'static FurnitureKind),
    front: &Frontage,
    candidates: &mut Vec<Candidate<Thing>>,
) {
    if front.speed_mps <= HIGHWAY_MPS {
        return;
    }
    for (number, along_m, [from, spot, to]) in pieces(front) {
        let (Some(a), Some(b)) = (from.median, to.median) else { continue };
        let slot = ON_MEDIAN | number;
        let piece = Piece { slot, along_m, ends: [a, b], levels_m: [a.z, b.z], towards: spot.away };
        let near_m = 0.5 * (a.z + b.z);
        let height = |[x, y]: [f64; 2]| placer.site.levels().height(x, y, near_m);
        let Some(candidate) = piece.candidate(placer, kind, front, height) else { continue };
        let around = candidate.takes.grown(MEDIAN_FREE_M);
        let is_free = [-1.0, 0.0, 1.0]
            .into_iter()
            .flat_map(|u| [-1.0, -0.5, 0.0, 0.5, 1.0].map(|v| (u, v)))
            .all(|(u, v)| {
                let [x, y] = around.at(u, v);
                let mut here = placer.site.levels().cover.at(x, y).filter(|(_, z)| (z - near_m).abs() < 2.5);
                here.all(|(facet, _)| facet.ground == Ground::Median)
            });
        let limit_mps = placer.site.map.speed_limit_at(nalgebra::center(&a, &b)).unwrap_or(0.0);
        if is_free && limit_mps > HIGHWAY_MPS {
            candidates.push(candidate);
        }
    }
}

/// Number and place along a side of all pieces that it has room for, with the spots at their beginning,
/// middle and end.
fn pieces(front: &Frontage) -> impl Iterator<Item = (u64, f64, [Spot; 3])> {
    let count = (front.length_m() / PIECE_M).floor();
    let first_m = 0.5 * (front.length_m() - PIECE_M * count);
    (0..count as u64).filter_map(move |slot| {
        let along_m = first_m + (slot as f64 + 0.5) * PIECE_M;
        let [from, spot, to] = [-0.5, 0.0, 0.5].map(|share| front.at(along_m + share * PIECE_M));
        Some((slot, along_m, [from?, spot?, to?]))
    })
}

/// Whether the land falls beside a road.
fn drops(placer: &Placer<'_>, spot: &Spot) -> bool {
    let beyond = spot.beside(DROP_BEYOND_M, 0.0);
    spot.point.z - placer.site.levels().terrain.height(beyond.x, beyond.y) > DROP_M
}

/// Whether a place is on the outside of a sharp bend.
fn is_outside(front: &Frontage, along_m: f64) -> bool {
    let around = [-BEND_OVER_M, BEND_OVER_M].map(|by| front.at(along_m + by));
    let [Some(before), Some(after)] = around else { return false };
    let way = after.point - before.point;
    // Outside, what leads away from the road spreads.
    let spread = (after.away - before.away).dot(&way);
    spread > 0.0 && (after.away - before.away).norm() > way.norm() / BEND_M
}

impl Piece {
    /// The piece, if it is of a good length on level ground, and nothing is in its way.
    fn candidate(
        &self,
        placer: &Placer<'_>,
        (number, kind): (usize, &'static FurnitureKind),
        front: &Frontage,
        height: impl Fn([f64; 2]) -> f64,
    ) -> Option<Candidate<Thing>> {
        let [a, b] = self.ends;
        let middle = nalgebra::center(&a, &b);
        if !placer.site.near(middle.x, middle.y, reach_m::FURNITURE) {
            return None;
        }
        let chord = (b - a).xy();
        let length_m = (chord.norm() / STEP_OF_PIECES_M).ceil() * STEP_OF_PIECES_M;
        if !(0.5 * PIECE_M..=1.15 * PIECE_M).contains(&length_m) {
            return None;
        }
        // It looks a quarter off the chord.
        let along = chord / chord.norm();
        let facing = [[along.y, -along.x], [-along.y, along.x]]
            .into_iter()
            .find(|[x, y]| x * self.towards.x + y * self.towards.y > 0.0)
            .unwrap_or([self.towards.x, self.towards.y]);
        let rect = OrientedRect {
            centre_m: [middle.x, middle.y],
            axis: facing,
            half_m: [0.5 * kind.size_m[0], 0.5 * length_m],
        };
        let [right_m, left_m] = [-1.0, 1.0].map(|v| height(rect.at(0.0, v)));
        // Seen from it, the frontage runs to the left or to the right.
        let runs_left = (b.y - a.y) * facing[0] - (b.x - a.x) * facing[1] > 0.0;
        let [first_m, last_m] = self.levels_m;
        let levels_m = if runs_left { [first_m, last_m] } else { [last_m, first_m] };
        let near_z = 0.5 * (first_m + last_m);
        let good = [right_m, left_m].iter().zip(levels_m).all(|(z, level)| (z - level).abs() <= STEP_M)
            && placer.land.clear_of_posts(&rect)
            && [-1.0, 0.0, 1.0].iter().all(|v| {
                let [x, y] = rect.at(1.0, *v);
                !is_swept(placer.site.map, Point3::new(x, y, near_z), 0.05)
            });
        if !good {
            return None;
        }
        let Self { slot, along_m, .. } = *self;
        let wanted = Wanted { kind: (number, kind), front, along_m, beyond_m: 0.0, variant: 0, slot };
        let needs = OrientedRect { half_m: [rect.half_m[0], rect.half_m[1] - LAP_M], ..rect };
        let what = Thing {
            kind,
            size_m: [kind.size_m[0], length_m, kind.size_m[2]],
            z_m: 0.5 * (right_m + left_m),
            roll_rad: atan2(left_m - right_m, length_m),
            yaw_rad: atan2(facing[1], facing[0]),
            variant: 0,
        };
        Some(Candidate { takes: rect, needs, rank: placer.rank(&wanted), what })
    }
}
