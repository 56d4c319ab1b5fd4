//! Where lanes are: borders, centre lines, widths; the lane list.

use frames::math::atan2;
use nalgebra::Point3;

use super::prepared::SectionSpan;
use super::{LaneBounds, LaneId, LaneInfo, LanePoint, LanePos, Map};
use crate::geometry::{RoadFrame, lane_width, record_at, value_and_slope};
use crate::model::{Lane, LaneSection, LaneType, Road, TrafficRule, TravelDirection};

/// Steps of s shorter than this end the search for a place's road coordinates, metres.
const INVERSE_M: f64 = 1e-10;

/// The two borders of a lane at some s: t of each, and its change per metre of s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile {
    pub(super) inner: (f64, f64),
    pub(super) outer: (f64, f64),
}

impl Profile {
    pub(super) fn width(&self) -> f64 {
        (self.outer.0 - self.inner.0).abs()
    }

    pub(super) fn centre(&self) -> (f64, f64) {
        (0.5 * (self.inner.0 + self.outer.0), 0.5 * (self.inner.1 + self.outer.1))
    }
}

/// t and slope of every border of a section at s, from the rightmost to the leftmost, into `borders`.
fn section_borders(road: &Road, section: &LaneSection, s: f64, borders: &mut Vec<(f64, f64)>) {
    let ds = s - section.s;
    let offset = value_and_slope(&road.lane_offset, s);
    borders.clear();
    let mut inside = (0.0, 0.0);
    for lane in &section.right {
        let width = lane_width(lane, ds, inside);
        inside = (inside.0 + width.0, inside.1 + width.1);
        borders.push((offset.0 - inside.0, offset.1 - inside.1));
    }
    borders.reverse();
    borders.push(offset);
    let mut inside = (0.0, 0.0);
    for lane in &section.left {
        let width = lane_width(lane, ds, inside);
        inside = (inside.0 + width.0, inside.1 + width.1);
        borders.push((offset.0 + inside.0, offset.1 + inside.1));
    }
}

/// Direction of travel: +1 along s, -1 against; and whether both.
fn direction(rule: TrafficRule, lane: &Lane) -> (f64, bool) {
    let along = (lane.id < 0) == (rule == TrafficRule::Right);
    let sign = if along { 1.0 } else { -1.0 };
    match lane.direction {
        TravelDirection::Standard => (sign, lane.lane_type == LaneType::Bidirectional),
        TravelDirection::Reversed => (-sign, false),
        TravelDirection::Both => (sign, true),
    }
}

/// Whether signals and crossings concern a lane of this type: those of motor traffic, of whatever kind.
pub(super) fn carries_vehicles(lane_type: LaneType) -> bool {
    lane_type.is_drivable()
        || matches!(lane_type, LaneType::Bidirectional | LaneType::Bus | LaneType::Taxi | LaneType::Hov)
}

impl Map {
    /// Fills in sections and lanes (lengths and widths follow with the spatial index).
    pub(super) fn build_lanes(&mut self) {
        let junction_of: std::collections::BTreeMap<&str, usize> =
            self.network.junctions.iter().enumerate().rev().map(|(i, j)| (j.id.as_str(), i)).collect();
        for (road_index, road) in self.network.roads.iter().enumerate() {
            self.road_sections.push(self.sections.len());
            let junction = road.junction.as_deref().and_then(|id| junction_of.get(id).copied());
            for (i, section) in road.sections.iter().enumerate() {
                let s_start = section.s.clamp(0.0, road.length_m);
                let s_end = match road.sections.get(i + 1) {
                    Some(next) => next.s.clamp(0.0, road.length_m).next_down().max(s_start),
                    None => road.length_m,
                };
                let first = self.lanes.len();
                for lane in section.lanes() {
                    let (direction, both_ways) = direction(road.rule, lane);
                    let id = LaneId { road: road_index as u32, section: i as u16, lane: lane.id };
                    self.lanes.push(LaneInfo {
                        id,
                        lane_type: lane.lane_type,
                        s_start,
                        s_end,
                        length_m: 0.0,
                        direction,
                        both_ways,
                        junction,
                        speed_limit_mps: stated_limit(road, section, lane, 0.5 * (s_start + s_end)),
                        width_range_m: [0.0; 2],
                    });
                }
                self.sections.push(SectionSpan { s_start, s_end, lanes: first..self.lanes.len() });
            }
        }
        self.road_sections.push(self.sections.len());
    }

    /// Gives connecting roads without a speed limit that of the lane before them.
    pub(super) fn inherit_speed_limits(&mut self) {
        // A connecting road of several sections hands the limit on from section to section.
        for _ in 0..4 {
            let mut changed = false;
            for i in 0..self.lanes.len() {
                let lane = &self.lanes[i];
                if lane.junction.is_none() || lane.speed_limit_mps.is_some() {
                    continue;
                }
                let before = self.graph.predecessors(i);
                let limit = before.iter().find_map(|id| self.lane(*id).and_then(|l| l.speed_limit_mps));
                changed |= limit.is_some();
                self.lanes[i].speed_limit_mps = limit;
            }
            if !changed {
                break;
            }
        }
    }

    /// Borders of a lane at s. None where there is no such lane.
    pub(super) fn profile(&self, id: LaneId, s: f64) -> Option<Profile> {
        let road = self.network.roads.get(id.road as usize)?;
        let section = road.sections.get(usize::from(id.section))?;
        let offset = value_and_slope(&road.lane_offset, s);
        let ds = s - section.s;
        let (lanes, sign) = if id.lane > 0 { (&section.left, 1.0) } else { (&section.right, -1.0) };
        let mut inside = (0.0, 0.0);
        for lane in lanes {
            let width = lane_width(lane, ds, inside);
            let outside = (inside.0 + width.0, inside.1 + width.1);
            if lane.id == id.lane {
                let place = |d: (f64, f64)| (offset.0 + sign * d.0, offset.1 + sign * d.1);
                return Some(Profile { inner: place(inside), outer: place(outside) });
            }
            inside = outside;
        }
        None
    }

    /// t of every border of a section at s, from right to left: one more than it has lanes.
    pub(super) fn borders(&self, road: u32, section: u16, s: f64, borders: &mut Vec<(f64, f64)>) {
        let road = self.road(road);
        section_borders(road, &road.sections[usize::from(section)], s, borders);
    }

    /// The place `offset_m` to the left (seen in the direction of travel) of a lane's centre line at road
    /// coordinate `s`, which is clamped to the lane. The offset runs along the road's cross-section; the
    /// heading is that of the centre line.
    #[must_use]
    pub fn lane_point(&self, id: LaneId, s: f64, offset_m: f64) -> Option<LanePoint> {
        let info = self.lane(id)?;
        let s = s.clamp(info.s_start, info.s_end);
        let profile = self.profile(id, s)?;
        let surface = &self.surfaces[id.road as usize];
        let frame = surface.frame(s);
        let (centre, slope) = profile.centre();
        let t = centre + offset_m * info.direction;
        let axes = surface.axes(&frame, s, centre);
        let forward = axes.along + axes.across * slope;
        let travel = forward * info.direction;
        let left = axes.across * info.direction;
        let flat = (travel.x * travel.x + travel.y * travel.y).sqrt();
        Some(LanePoint {
            position: surface.point_in(&frame, s, t),
            heading_rad: atan2(travel.y, travel.x),
            pitch_rad: -atan2(travel.z, flat),
            roll_rad: atan2(left.z, (left.x * left.x + left.y * left.y).sqrt()),
            width_m: profile.width(),
            metres_per_s: forward.norm(),
        })
    }

    /// The road coordinate s and the offset from the lane's centre line (to the left in the direction of
    /// travel) of a place: the inverse of [`Map::lane_point`], also for places above or under the surface
    /// (along its normal) and beside the lane.
    ///
    /// None where no cross-section of the lane's stretch of road goes through the place.
    #[must_use]
    pub fn lane_coordinates(&self, id: LaneId, point: Point3<f64>) -> Option<(f64, f64)> {
        let info = self.lane(id)?;
        let surface = self.surfaces.get(id.road as usize)?;
        let mut s = self.project(id, point)?.s;
        // The cross-section is normal to the tangent: Newton's method on what is left along it.
        for _ in 0..50 {
            let frame = surface.frame(s);
            let offset = point - frame.origin;
            let t = offset.dot(&frame.left);
            let rate = frame.tangent.dot(&frame.tangent(t, 0.0));
            if rate <= 0.0 {
                return None;
            }
            let step = offset.dot(&frame.tangent) / rate;
            let next = (s + step).clamp(info.s_start, info.s_end);
            if step.abs() < INVERSE_M {
                let centre = self.profile(id, s)?.centre().0;
                return Some((s, (t - centre) * info.direction));
            }
            if next == s {
                return None;
            }
            s = next;
        }
        None
    }

    /// The place on the centre line of a lane.
    #[must_use]
    pub fn point_at(&self, pos: LanePos) -> Option<LanePoint> {
        self.lane_point(pos.lane, self.s_of(pos)?, 0.0)
    }

    /// The road coordinate s of a place on a lane.
    #[must_use]
    pub fn s_of(&self, pos: LanePos) -> Option<f64> {
        self.lane(pos.lane).map(|info| info.s_of_along(pos.along_m))
    }

    /// The borders of a lane at `s`, which is clamped to the lane.
    #[must_use]
    pub fn lane_bounds(&self, id: LaneId, s: f64) -> Option<LaneBounds> {
        let info = self.lane(id)?;
        let s = s.clamp(info.s_start, info.s_end);
        let profile = self.profile(id, s)?;
        let surface = &self.surfaces[id.road as usize];
        let frame = surface.frame(s);
        let inner = surface.point_in(&frame, s, profile.inner.0);
        let outer = surface.point_in(&frame, s, profile.outer.0);
        let left_is_outer = (id.lane > 0) == (info.direction > 0.0);
        let (left, right) = if left_is_outer { (outer, inner) } else { (inner, outer) };
        Some(LaneBounds { inner, outer, left, right })
    }

    /// Width of a lane at `s`, metres.
    #[must_use]
    pub fn lane_width(&self, id: LaneId, s: f64) -> Option<f64> {
        let info = self.lane(id)?;
        self.profile(id, s.clamp(info.s_start, info.s_end)).map(|p| p.width())
    }

    /// How far a lane's inner and outer border are raised over the road surface at `s`, metres (kerbs).
    #[must_use]
    pub fn lane_height(&self, id: LaneId, s: f64) -> Option<[f64; 2]> {
        let section = self.network.roads.get(id.road as usize)?.sections.get(usize::from(id.section))?;
        let record = record_at(&section.lane(id.lane)?.heights, s - section.s, |h| h.s_offset);
        Some(record.map_or([0.0; 2], |h| [h.inner_m, h.outer_m]))
    }

    /// Speed limit at `s`, m/s: the lane's own, else the road's, else (on a connecting road) that of the lane
    /// before. None where nothing is stated, or no limit.
    #[must_use]
    pub fn speed_limit(&self, id: LaneId, s: f64) -> Option<f64> {
        let info = self.lane(id)?;
        let road = self.road(id.road);
        let section = &road.sections[usize::from(id.section)];
        let stated = section.lane(id.lane).and_then(|lane| stated_limit(road, section, lane, s));
        stated.or(info.speed_limit_mps.filter(|_| info.junction.is_some()))
    }

    /// Speed limit at a place, m/s: that of the nearest lane for motor traffic there ([`Map::speed_limit`]),
    /// the deck that the place is on being told by its height. None where the nearest lane has none.
    #[must_use]
    pub fn speed_limit_at(&self, point: Point3<f64>) -> Option<f64> {
        let hit = self.nearest_driving_lane(point)?;
        self.speed_limit(hit.lane, hit.s)
    }

    /// Point, tangent and left vector of a lane's centre line; for refinement, so `s` must lie in the lane.
    pub(super) fn centre_at(
        &self,
        id: LaneId,
        s: f64,
    ) -> Option<(Point3<f64>, nalgebra::Vector3<f64>, RoadFrame, f64)> {
        let profile = self.profile(id, s)?;
        let surface = &self.surfaces[id.road as usize];
        let mut frame = surface.frame(s);
        let (t, slope) = profile.centre();
        let axes = surface.axes(&frame, s, t);
        let point = surface.point_in(&frame, s, t);
        frame.left = axes.across.normalize();
        Some((point, axes.along + axes.across * slope, frame, profile.width()))
    }
}

/// The limit that the file states for a lane at s.
fn stated_limit(road: &Road, section: &LaneSection, lane: &Lane, s: f64) -> Option<f64> {
    let own = record_at(&lane.speeds, s - section.s, |r| r.s_offset).map(|r| r.speed);
    let limit = own.or_else(|| record_at(&road.types, s, |r| r.s).and_then(|r| r.speed))?;
    Some(limit.mps()).filter(|mps| mps.is_finite() && *mps > 0.0)
}
