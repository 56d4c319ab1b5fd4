//! Where traffic must stop: lines that the file states, and those it leaves out.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector2, Vector3};

use super::lanes::carries_vehicles;
use super::{LaneId, LanePos, Map, ObjectInfo, SignalInfo};

/// Width of a line whose width is not stated, metres.
const WIDTH_M: f64 = 0.4;
/// Derived lines lie this far before the stop point, metres of s.
const BACK_M: f64 = 0.5;
/// Stated widths below this are none (some files give 1e-16), metres.
const MIN_WIDTH_M: f64 = 0.05;
/// A lane is crossed by a line that ends at most this far short of its centre line, metres.
const OVERHANG_M: f64 = 0.5;
/// Lanes are looked for at most this far above or below a line, metres.
const STOREY_M: f64 = 2.0;
/// Lines stand at most this far beyond the end of the lane that they hold, metres.
const BEYOND_M: f64 = 2.0;
/// Lines this near to the beginning of a connecting lane hold the lane before it, metres.
const INTO_JUNCTION_M: f64 = 6.0;
/// A signal's stop point and a line that are nearer than this along the lanes belong together, metres.
const SERVED_M: f64 = 15.0;
/// How far ahead a junction is looked for to tell which way traffic is held, metres.
const LOOK_AHEAD_M: f64 = 500.0;
/// Lines cross lanes at a steeper angle than this: cosine of 45 degrees.
const STEEP: f64 = 0.707;

/// What says that there is a stop line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopLineSource {
    /// An object of the file: index into [`Map::objects`].
    Object(usize),
    /// A signal of the file that stands for paint: index into [`Map::signals`].
    Signal(usize),
    /// Nothing: a signal holds traffic here and the file has no line for it.
    Derived,
}

/// A line at which traffic must stop.
#[derive(Clone, Debug, PartialEq)]
pub struct StopLine {
    /// Its ends, on the road surface, left and right seen by the traffic it holds.
    pub ends: [Point3<f64>; 2],
    /// Its width along the lane, metres.
    pub width_m: f64,
    /// Where it crosses the lanes it holds (or the end of a lane that it lies just beyond), by lane.
    pub lanes: Vec<LanePos>,
    /// Lights and stop signs that hold traffic here: indices into [`Map::signals`], ascending.
    pub signals: Vec<usize>,
    /// What says so.
    pub source: StopLineSource,
}

impl SignalInfo {
    /// Whether it is a stop sign: 206 of the German catalogue (which CARLA's maps use), R1-1 of the North
    /// American.
    #[must_use]
    pub fn is_stop_sign(&self) -> bool {
        self.kind == "206" || self.kind.eq_ignore_ascii_case("R1-1")
    }

    /// Whether it stands for a painted stop line: 294 of the German catalogue, or by its name.
    fn is_stop_line(&self) -> bool {
        self.kind == "294" || says_stop_line(&self.name)
    }
}

fn says_stop_line(name: &str) -> bool {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).collect();
    plain.to_ascii_lowercase().contains("stopline")
}

impl Map {
    /// All stop lines: those that objects state, those that signals state, and those derived where a light or
    /// stop sign holds traffic and the file has none within 15 m (half a metre before the stop point). In the
    /// order of their sources, derived ones by lane.
    ///
    /// Computed anew by every call.
    #[must_use]
    pub fn stop_lines(&self) -> Vec<StopLine> {
        let mut lines: Vec<StopLine> = Vec::new();
        for (i, info) in self.objects.iter().enumerate() {
            let stated = self.network.roads.get(info.road as usize).and_then(|r| r.objects.get(info.index));
            let subtype = stated.map_or("", |o| &o.subtype);
            let painted = info.kind.eq_ignore_ascii_case("roadMark")
                && (subtype.eq_ignore_ascii_case("signalLines") || says_stop_line(subtype));
            if painted || says_stop_line(&info.name) {
                lines.extend(
                    segment_of(info)
                        .map(|(ends, width_m)| self.across(ends, width_m, StopLineSource::Object(i))),
                );
            }
        }
        for (i, info) in self.signals.iter().enumerate().filter(|(_, s)| s.is_stop_line()) {
            let width = info.size_m[1].unwrap_or(0.0);
            if !info.lanes.is_empty() {
                lines.extend(self.on_lanes(i, info));
            } else if width > MIN_WIDTH_M {
                let left = info.pose.rotate(Vector3::y()) * (0.5 * width);
                let ends = [info.on_surface + left, info.on_surface - left];
                lines.push(self.across(ends, WIDTH_M, StopLineSource::Signal(i)));
            }
        }
        self.attach_signals(&mut lines);
        lines
    }

    /// A stated segment as a stop line, with the lanes that it crosses.
    fn across(&self, mut ends: [Point3<f64>; 2], width_m: f64, source: StopLineSource) -> StopLine {
        ends.iter_mut().for_each(|end| self.lay_down(end));
        let middle = nalgebra::center(&ends[0], &ends[1]);
        let reach = 0.5 * (ends[1] - ends[0]).norm() + OVERHANG_M + BEYOND_M;
        let near = self.lanes_within(middle, reach, |lane| carries_vehicles(lane.lane_type));
        let mut lanes: Vec<LanePos> = near
            .iter()
            .filter_map(|hit| self.crossing(ends, hit.lane))
            .flat_map(|pos| self.before_junction(pos))
            .collect();
        lanes.sort_by(|a, b| a.lane.cmp(&b.lane).then(a.along_m.total_cmp(&b.along_m)));
        lanes.dedup_by_key(|p| p.lane);
        self.keep_one_lane_of_a_chain(&mut lanes);
        self.keep_one_direction(&mut lanes);
        if let Some(heading) = lanes.first().and_then(|p| self.point_at(*p)).map(|p| p.heading_rad) {
            // Left and right as the held traffic sees them.
            let (sin, cos) = frames::math::sin_cos(heading);
            let way = ends[1] - ends[0];
            if cos * way.y - sin * way.x > 0.0 {
                ends.reverse();
            }
        }
        StopLine { ends, width_m, lanes, signals: Vec::new(), source }
    }

    /// Where a segment crosses a lane's centre line, at or just beyond the lane's ends too.
    fn crossing(&self, ends: [Point3<f64>; 2], lane: LaneId) -> Option<LanePos> {
        let info = self.lane(lane)?;
        let way = (ends[1] - ends[0]).xy();
        let length = way.norm();
        if length <= 0.0 {
            return None;
        }
        let mut point = nalgebra::center(&ends[0], &ends[1]);
        // The lane's tangent meets the segment near the crossing; again from there, nearer still.
        for _ in 0..4 {
            let hit = self.project(lane, point)?;
            let place = self.lane_point(lane, hit.s, 0.0)?;
            let (sin, cos) = frames::math::sin_cos(place.heading_rad);
            let heading = Vector2::new(cos, sin);
            let turn = heading.perp(&way);
            if turn.abs() < STEEP * length {
                return None;
            }
            // How far along the segment the tangent meets it.
            let part = heading.perp(&(place.position - ends[0]).xy()) / turn;
            let over = (part - 0.5).abs() - 0.5;
            if over * length > OVERHANG_M {
                return None;
            }
            point = ends[0] + (ends[1] - ends[0]) * part;
            let along = (point - place.position).xy().dot(&heading);
            let beyond = along.abs() > BEYOND_M && (hit.s <= info.s_start || hit.s >= info.s_end);
            if beyond || (point.z - place.position.z).abs() > STOREY_M {
                return None;
            }
        }
        let s = self.project(lane, point)?.s;
        Some(LanePos { lane, along_m: info.along_of_s(s) })
    }

    /// A place just inside a junction as the ends of the lanes before it; any other as it is.
    fn before_junction(&self, pos: LanePos) -> Vec<LanePos> {
        let Some(info) =
            self.lane(pos.lane).filter(|l| l.junction.is_some() && pos.along_m <= INTO_JUNCTION_M)
        else {
            return vec![pos];
        };
        let before = self.predecessors(info.id).iter().filter_map(|id| self.lane(*id));
        let outside: Vec<LanePos> = before
            .filter(|b| b.junction.is_none())
            .map(|b| LanePos { lane: b.id, along_m: b.s_length() })
            .collect();
        if outside.is_empty() { vec![pos] } else { outside }
    }

    /// Of lanes that follow one another at a line, keeps the first.
    fn keep_one_lane_of_a_chain(&self, lanes: &mut Vec<LanePos>) {
        let all = lanes.clone();
        lanes.retain(|p| !self.predecessors(p.lane).iter().any(|b| all.iter().any(|other| other.lane == *b)));
    }

    /// A line across both directions of a road holds the one that has a junction ahead, or the nearer one.
    fn keep_one_direction(&self, lanes: &mut Vec<LanePos>) {
        let direction = |p: &LanePos| self.lane(p.lane).map_or(0.0, |l| l.direction);
        let both = lanes
            .iter()
            .any(|a| lanes.iter().any(|b| a.lane.road == b.lane.road && direction(a) != direction(b)));
        if !both {
            return;
        }
        let way = |p: &LanePos| self.junction_ahead(*p, LOOK_AHEAD_M).map_or(f64::INFINITY, |a| a.way_m);
        let mut nearest: BTreeMap<(u32, bool), f64> = BTreeMap::new();
        for p in lanes.iter() {
            let least = nearest.entry((p.lane.road, direction(p) > 0.0)).or_insert(f64::INFINITY);
            *least = least.min(way(p));
        }
        lanes.retain(|p| {
            let (road, along) = (p.lane.road, direction(p) > 0.0);
            match (nearest.get(&(road, along)), nearest.get(&(road, !along))) {
                (Some(own), Some(other)) => own <= other,
                _ => true,
            }
        });
    }

    /// A stop line stated as a signal, across all lanes it names.
    fn on_lanes(&self, signal: usize, info: &SignalInfo) -> Option<StopLine> {
        let mut lanes = Vec::new();
        let mut points = Vec::new();
        for id in &info.lanes {
            let lane = self.lane(*id)?;
            let s = info.s.clamp(lane.s_start, lane.s_end);
            let bounds = self.lane_bounds(*id, s)?;
            lanes.push(LanePos { lane: *id, along_m: lane.along_of_s(s) });
            points.push((bounds.left, bounds.right));
        }
        let (first, _) = points.first()?;
        // The leftmost of all left borders and the rightmost of all right ones.
        let (_, right) =
            points.iter().max_by(|a, b| (a.1 - first).norm().total_cmp(&(b.1 - first).norm()))?;
        let (left, _) = points.iter().max_by(|a, b| (a.0 - right).norm().total_cmp(&(b.0 - right).norm()))?;
        Some(StopLine {
            ends: [*left, *right],
            width_m: WIDTH_M,
            lanes,
            signals: Vec::new(),
            source: StopLineSource::Signal(signal),
        })
    }

    /// Gives lines the signals that hold traffic there, and adds lines for stop points that have none.
    fn attach_signals(&self, lines: &mut Vec<StopLine>) {
        let mut bare: BTreeMap<LaneId, (LanePos, Vec<usize>)> = BTreeMap::new();
        for (i, signal) in self.signals.iter().enumerate() {
            if !signal.dynamic && !signal.is_stop_sign() {
                continue;
            }
            for stop in self.stop_points(i) {
                let mut served = false;
                for line in lines.iter_mut().filter(|l| self.serves(l, stop)) {
                    line.signals.push(i);
                    served = true;
                }
                if !served {
                    bare.entry(stop.lane).or_insert_with(|| (stop, Vec::new())).1.push(i);
                }
            }
        }
        for line in lines.iter_mut() {
            line.signals.dedup();
        }
        for (stop, signals) in bare.into_values() {
            let pos = LanePos { lane: stop.lane, along_m: (stop.along_m - BACK_M).max(0.0) };
            let bounds = self.s_of(pos).and_then(|s| self.lane_bounds(pos.lane, s));
            lines.extend(bounds.map(|b| StopLine {
                ends: [b.left, b.right],
                width_m: WIDTH_M,
                lanes: vec![pos],
                signals,
                source: StopLineSource::Derived,
            }));
        }
    }

    /// Whether a line lies on the lanes just before a stop point, or near it on its lane.
    fn serves(&self, line: &StopLine, stop: LanePos) -> bool {
        let near = |p: &LanePos| {
            p.lane == stop.lane && (p.along_m - stop.along_m).abs() <= SERVED_M
                || self.distance_ahead(*p, stop, SERVED_M).is_some()
        };
        let Some(at) = self.point_at(stop).map(|p| p.position) else { return false };
        let middle = nalgebra::center(&line.ends[0], &line.ends[1]);
        let reach = SERVED_M + 0.5 * (line.ends[1] - line.ends[0]).norm();
        (middle - at).norm() <= reach && line.lanes.iter().any(near)
    }
}

/// An object as a segment and its width: the middle line of its outline, or of its length and width, along
/// its longer side.
fn segment_of(info: &ObjectInfo) -> Option<([Point3<f64>; 2], f64)> {
    let outline = info.outlines.iter().find(|o| o.base.len() >= 2);
    let corners: Vec<Point3<f64>> = match outline {
        Some(outline) => outline.base.clone(),
        None => {
            let half = info.size_m * 0.5;
            [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
                .map(|(x, y)| info.pose * Point3::new(x * half.x, y * half.y, 0.0))
                .to_vec()
        }
    };
    let edges = corners.iter().zip(corners.iter().skip(1));
    let longest = edges.map(|(a, b)| b - a).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let along = longest.xy().try_normalize(1e-6)?;
    let across = Vector2::new(-along.y, along.x);
    let start = corners[0];
    let range = |axis: Vector2<f64>| {
        let places = corners.iter().map(|c| (c - start).xy().dot(&axis));
        places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    };
    let ((u0, u1), (v0, v1)) = (range(along), range(across));
    let z = corners.iter().map(|c| c.z).sum::<f64>() / corners.len() as f64;
    let place = |u: f64| {
        let p = start.xy() + along * u + across * (0.5 * (v0 + v1));
        Point3::new(p.x, p.y, z)
    };
    let width = if v1 - v0 > MIN_WIDTH_M { v1 - v0 } else { WIDTH_M };
    Some(([place(u0), place(u1)], width))
}
