//! What no lane of a junction covers: pavement beside turns, before medians and inside turning
//! circles, and slits between the halves of a median.

use frames::math::sin_cos;
use opendrive::{Cubic, Curve, Lane, LaneType, Road};

use crate::arm::Arm;
use crate::marks;
use crate::path::{Path, Pose2};
use crate::profile::Profile;

/// Distance between the places of a road from which gaps are looked for, metres.
const CROSS_SECTION_M: f64 = 0.25;
/// Steps in which is looked for the far side of a gap, and the widest gap, metres.
const STEP_M: f64 = 0.2;
const WIDEST_M: f64 = 30.0;
/// How often the last step is halved.
const HALVINGS: u32 = 5;
/// Narrower gaps are left; a strip whose gaps are all narrower than the second figure is not worth a lane,
/// metres.
const LEAST_M: f64 = 0.01;
const WORTH_M: f64 = 0.08;
/// Pavement reaches this far under the lanes on the other side, metres.
const UNDER_M: f64 = 0.25;
/// Wider gaps between the directions of a seam are land, metres.
const SLIT_M: f64 = 1.0;
/// So many cross sections beyond the ends of a gap are paved, too: next to a tangent, gaps below the least
/// one are long.
const BEYOND: usize = 2;
/// A width is left out where a straight line between its neighbours tells as much, metres.
const TOLERANCE_M: f64 = 0.08;
/// Streets reach this far beyond their kerbs, metres.
const BEYOND_KERB_M: f64 = 8.0;
/// Ground is judged to lie inside or outside the kerbs so far from a road's edge, metres.
const ASIDE_M: f64 = 0.3;
/// Nothing is looked at nearer than this to the end of a connecting road, metres.
const END_M: f64 = 0.05;
/// Share of the radius of a turn up to which its inside may be paved.
const TURN_SHARE: f64 = 0.99;

/// A side of a road: +1 is the left one, -1 the right one.
type Hand = f64;
const LEFT: Hand = 1.0;
const RIGHT: Hand = -1.0;

/// Adds beside connecting roads a paved strip where nothing else paves the ground up to the next road.
///
/// `order`: roads in the order in which they get their turn, first with their left sides, then with their
/// right ones. What has more than driving lanes on that side already gets nothing, and neither does ground
/// outside the kerbs.
pub(crate) fn fill(roads: &mut [Road], order: &[usize], arms: &[Arm]) {
    let mut strips: Vec<Strip> = roads.iter().map(Strip::new).collect();
    let streets: Vec<Street> = arms.iter().map(Street::new).collect();
    let kerbs: Vec<usize> = (0..roads.len()).filter(|i| has_kerb(&roads[*i])).collect();
    let turns = order.iter().map(|i| (*i, LEFT)).chain(order.iter().map(|i| (*i, RIGHT)));
    for (i, hand) in turns {
        let Some(section) = roads[i].sections.first_mut() else { continue };
        let (lanes, id) = if hand == LEFT {
            (&mut section.left, 1)
        } else {
            let id = -(section.right.len() as i16 + 1);
            (&mut section.right, id)
        };
        let bare = match lanes.last() {
            None => hand == LEFT,
            Some(last) => hand == RIGHT && last.lane_type == LaneType::Driving,
        };
        let gaps = if bare { gaps(&strips, i, hand, &streets, &kerbs) } else { Vec::new() };
        if gaps.iter().all(|gap| *gap < WORTH_M) {
            continue;
        }
        let widths = lines(&simpler(&strips[i].widths(&gaps, hand)));
        let (lane_type, marks) = (LaneType::Shoulder, vec![marks::none()]);
        lanes.push(Lane { id, lane_type, widths, marks, ..Lane::default() });
        strips[i] = Strip::new(&roads[i]);
    }
}

/// Widens what lies innermost on the left of roads at a seam where a slit stays open to the other direction:
/// on a bend their halves of a median do not quite meet.
pub(crate) fn close(roads: &mut [Road], arms: &[Arm]) {
    let mut strips: Vec<Strip> = roads.iter().map(Strip::new).collect();
    let streets: Vec<Street> = arms.iter().map(Street::new).collect();
    for (i, road) in roads.iter_mut().enumerate() {
        let Some(lane) = road.sections.first_mut().and_then(|section| section.left.last_mut()) else {
            continue;
        };
        let gaps = gaps(&strips, i, LEFT, &streets, &[]);
        if gaps.iter().all(|gap| *gap == 0.0) || gaps.iter().any(|gap| *gap > SLIT_M) {
            continue;
        }
        let width = Profile::of(&lane.widths);
        // Both ends stay as the streets have them.
        let last = gaps.len().saturating_sub(1);
        let add = |(k, (s, more)): (usize, (f64, f64))| {
            (s, width.at(s) + if k == 0 || k == last { 0.0 } else { more })
        };
        let widths: Vec<(f64, f64)> =
            strips[i].widths(&gaps, LEFT).into_iter().enumerate().map(add).collect();
        lane.widths = lines(&simpler(&widths));
        strips[i] = Strip::new(road);
    }
}

/// Whether a road leads along a kerb: on its right is more than driving lanes.
fn has_kerb(road: &Road) -> bool {
    let outermost = road.sections.first().and_then(|section| section.right.last());
    outermost.is_some_and(|lane| lane.lane_type != LaneType::Driving)
}

/// How far the ground beside a road is open at each of its cross sections, metres: 0 where it is not, where
/// nothing ends the gap, and where it lies outside the kerbs, which a turn may cut.
fn gaps(strips: &[Strip], own: usize, hand: Hand, streets: &[Street], kerbs: &[usize]) -> Vec<f64> {
    // The road itself may lie on the other side, too: round a turning circle.
    let covered = |[x, y]: [f64; 2]| {
        streets.iter().any(|street| street.covers(x, y)) || strips.iter().any(|strip| strip.covers(x, y))
    };
    let last = strips[own].cross_sections.len().saturating_sub(1);
    let gap = |(i, here): (usize, &CrossSection)| {
        // At its ends a road looks from just inside, where the ground is the junction's.
        let inside_m = match i {
            0 => END_M,
            i if i == last => -END_M,
            _ => 0.0,
        };
        let from = here.pose.moved(inside_m, here.edge_m(hand));
        let [dx, dy] = left_of(from).map(|v| hand * v);
        let paved = |d: f64| covered([from.x_m + d * dx, from.y_m + d * dy]);
        let steps = (WIDEST_M / STEP_M) as u32;
        let far = (1..=steps).map(|k| f64::from(k) * STEP_M).find(|d| paved(*d)).map(|far| {
            let halved = |[a, b]: [f64; 2]| {
                let middle = 0.5 * (a + b);
                if paved(middle) { [a, middle] } else { [middle, b] }
            };
            (0..HALVINGS).fold([far - STEP_M, far], |range, _| halved(range))[1]
        });
        let beside = [from.x_m + ASIDE_M * dx, from.y_m + ASIDE_M * dy];
        let outside = || kerbs.iter().any(|kerb| strips[*kerb].is_left_behind(beside));
        far.filter(|d| *d > LEAST_M && !outside()).unwrap_or(0.0)
    };
    strips[own].cross_sections.iter().enumerate().map(gap).collect()
}

/// The direction to the left.
fn left_of(pose: Pose2) -> [f64; 2] {
    let (sin, cos) = sin_cos(pose.heading_rad);
    [-sin, cos]
}

/// The street of an arm, behind its end.
struct Street {
    end: Pose2,
    left: [f64; 2],
    /// How far it reaches to the left and to the right, metres.
    sides_m: [f64; 2],
}

impl Street {
    fn new(arm: &Arm) -> Self {
        let sides_m = arm.paved().map(|side| side + BEYOND_KERB_M);
        Self { end: arm.outward, left: left_of(arm.outward), sides_m }
    }

    fn covers(&self, x: f64, y: f64) -> bool {
        let (dx, dy) = (x - self.end.x_m, y - self.end.y_m);
        let (ahead, left) = (dx * self.left[1] - dy * self.left[0], dx * self.left[0] + dy * self.left[1]);
        ahead > 0.0 && left < self.sides_m[0] && left > -self.sides_m[1]
    }
}

/// A connecting road, cut across at a place of its reference line.
struct CrossSection {
    s: f64,
    pose: Pose2,
    /// Of the reference line, 1/m, positive to the left.
    curvature: f64,
    /// From the reference line to the right and to the left edge of its lanes, metres, positive to the left.
    edges_m: [f64; 2],
}

impl CrossSection {
    fn edge_m(&self, hand: Hand) -> f64 {
        self.edges_m[usize::from(hand == LEFT)]
    }

    /// How wide a strip beside the road may be here, metres: before the middle of a bend it ends.
    fn widest_m(&self, hand: Hand) -> f64 {
        let bend = hand * self.curvature;
        if bend > 0.0 { (TURN_SHARE / bend - hand * self.edge_m(hand)).max(0.0) } else { f64::INFINITY }
    }
}

/// The surface of a connecting road.
struct Strip {
    cross_sections: Vec<CrossSection>,
    /// The borders of its lanes there, from right to left.
    borders: Vec<Vec<[f64; 2]>>,
    /// West, south, east, north; of the whole, and between neighbouring cross sections.
    bounds: [f64; 4],
    parts: Vec<[f64; 4]>,
}

impl Strip {
    fn new(road: &Road) -> Self {
        let path = Path::of(road);
        // Widths from the inside out, on either side.
        let sides = road.sections.first().map_or([Vec::new(), Vec::new()], |section| {
            [&section.left, &section.right]
                .map(|lanes| lanes.iter().map(|lane| Profile::of(&lane.widths)).collect())
        });
        let count = (path.length_m / CROSS_SECTION_M).ceil().max(1.0) as u32;
        let lefts = |s: f64| {
            let mut lefts = vec![0.0];
            for (side, sign) in sides.iter().zip([LEFT, RIGHT]) {
                let mut at = 0.0;
                for width in side {
                    at += sign * width.at(s);
                    lefts.push(at);
                }
            }
            lefts.sort_by(f64::total_cmp);
            lefts
        };
        let at = |i: u32| {
            let s = path.length_m * f64::from(i) / f64::from(count);
            let bend = path.pieces.iter().rev().find(|piece| piece.s <= s).map(|piece| &piece.curve);
            let curvature = if let Some(Curve::Arc { curvature }) = bend { *curvature } else { 0.0 };
            let lefts = lefts(s);
            let edges_m = [lefts.first(), lefts.last()].map(|left| left.copied().unwrap_or(0.0));
            let pose = path.pose_at(s);
            let place = |left: &f64| {
                let p = pose.moved(0.0, *left);
                [p.x_m, p.y_m]
            };
            (CrossSection { s, pose, curvature, edges_m }, lefts.iter().map(place).collect())
        };
        let (cross_sections, borders): (Vec<CrossSection>, Vec<Vec<[f64; 2]>>) = (0..=count).map(at).unzip();
        let bounds = bounds_of(borders.iter().flatten());
        let parts = borders.windows(2).map(|pair| bounds_of(pair.iter().flatten())).collect();
        Self { cross_sections, borders, bounds, parts }
    }

    /// Widths of a strip that covers gaps, by s, both in metres.
    fn widths(&self, gaps: &[f64], hand: Hand) -> Vec<(f64, f64)> {
        let width = |(i, here): (usize, &CrossSection)| {
            let near = gaps.iter().skip(i.saturating_sub(BEYOND)).take(i.min(BEYOND) + 1 + BEYOND);
            let open = near.into_iter().any(|gap| *gap > 0.0);
            let gap = gaps.get(i).copied().unwrap_or(0.0);
            (here.s, if open { (gap + UNDER_M).min(here.widest_m(hand)) } else { 0.0 })
        };
        self.cross_sections.iter().enumerate().map(width).collect()
    }

    /// Whether a point lies beside the road and beyond its right edge.
    fn is_left_behind(&self, [x, y]: [f64; 2]) -> bool {
        let off = |here: &CrossSection| {
            let [dx, dy] = [x - here.pose.x_m, y - here.pose.y_m];
            (dx * dx + dy * dy, [dx, dy])
        };
        let nearest = self.cross_sections.iter().min_by(|a, b| off(a).0.total_cmp(&off(b).0));
        nearest.is_some_and(|here| {
            let ([lx, ly], [dx, dy]) = (left_of(here.pose), off(here).1);
            let (ahead, left) = (dx * ly - dy * lx, dx * lx + dy * ly);
            ahead.abs() < CROSS_SECTION_M && left < here.edges_m[0]
        })
    }

    fn covers(&self, x: f64, y: f64) -> bool {
        let near = |[west, south, east, north]: [f64; 4]| x >= west && x <= east && y >= south && y <= north;
        if !near(self.bounds) {
            return false;
        }
        let inside = |ring: [[f64; 2]; 4]| {
            let hand = |k: usize| {
                let (a, b) = (ring[k], ring[(k + 1) % 4]);
                (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
            };
            // Inside where every side has it on the same hand; beyond the centre of a turn that is the other
            // one.
            (0..4).all(|k| hand(k) >= 0.0) || (0..4).all(|k| hand(k) <= 0.0)
        };
        self.borders.windows(2).zip(&self.parts).filter(|(_, part)| near(**part)).any(|(pair, _)| {
            let rings = pair[0].windows(2).zip(pair[1].windows(2));
            rings.into_iter().any(|(a, b)| inside([a[0], b[0], b[1], a[1]]))
        })
    }
}

/// West, south, east and north of points.
fn bounds_of<'p>(points: impl Iterator<Item = &'p [f64; 2]>) -> [f64; 4] {
    let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
    points
        .fold([high, high, low, low], |b, p| [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])])
}

/// The same polyline with fewer points (Ramer, Douglas and Peucker, by the difference in width).
fn simpler(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let off = |p: &(f64, f64)| {
        let share = (p.0 - first.0) / (last.0 - first.0).max(1e-9);
        (p.1 - first.1 - share * (last.1 - first.1)).abs()
    };
    let worst = (1..points.len() - 1).max_by(|a, b| off(&points[*a]).total_cmp(&off(&points[*b])));
    match worst {
        Some(at) if off(&points[at]) > TOLERANCE_M => {
            let mut kept = simpler(&points[..=at]);
            kept.pop();
            kept.extend(simpler(&points[at..]));
            kept
        }
        _ => vec![*first, *last],
    }
}

/// Width records through points.
fn lines(points: &[(f64, f64)]) -> Vec<Cubic> {
    points
        .windows(2)
        .map(|p| Cubic { s: p[0].0, a: p[0].1, b: (p[1].1 - p[0].1) / (p[1].0 - p[0].0), c: 0.0, d: 0.0 })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_points_tell_the_same() {
        let points: Vec<(f64, f64)> =
            (0..=40).map(|i| f64::from(i) * 0.5).map(|s| (s, (s - 5.0).clamp(0.0, 6.0))).collect();
        let few = simpler(&points);
        assert_eq!(few, [(0.0, 0.0), (5.0, 0.0), (11.0, 6.0), (20.0, 6.0)]);
        let width = Profile::of(&lines(&few));
        assert!(points.iter().all(|(s, w)| (width.at(*s) - w).abs() < 1e-9));
    }
}
