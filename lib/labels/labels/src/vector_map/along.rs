//! What runs along the road: lanes, their boundaries, painted lines, kerbs.

use opendrive::{LaneId, LaneInfo, MarkType, Stripe};
use schema::tables::{VectorKind, VectorMapRow};

use crate::vector_map::{TOLERANCE_M, Table, boundary_count};

impl Table<'_> {
    /// All lanes, in the order of the map's list.
    pub(crate) fn lanes(&self) -> Vec<VectorMapRow> {
        self.map.lanes().iter().map(|lane| self.lane(lane)).collect()
    }

    fn lane(&self, lane: &LaneInfo) -> VectorMapRow {
        let (map, id) = (self.map, lane.id);
        let mut line = map.lane_polyline(id, TOLERANCE_M);
        let width_m = mean_width(self, lane, &line.s);
        if lane.direction < 0.0 {
            line.s.reverse();
            line.centre.reverse();
        }
        let one = |lane: Option<LaneId>| lane.and_then(|id| self.number(id)).into_iter().collect();
        let travel = match (lane.both_ways, lane.direction > 0.0) {
            (true, _) => "both",
            (false, true) => "forward",
            (false, false) => "backward",
        };
        VectorMapRow {
            lane_type: Some(lane.lane_type.as_str().to_owned()),
            travel: Some(travel.to_owned()),
            width_m,
            speed_limit_mps: lane.speed_limit_mps,
            successors: map.successors(id).iter().filter_map(|id| self.number(*id)).collect(),
            predecessors: map.predecessors(id).iter().filter_map(|id| self.number(*id)).collect(),
            left: one(map.left_of(id)),
            right: one(map.right_of(id)),
            boundaries: self.boundaries_of(lane),
            signals: self.signal_numbers(map.signals_of_lane(id)),
            ..self.place(VectorKind::LaneCentreline, id, &line.centre, line.s)
        }
    }

    /// Numbers of a lane's left and right boundary in the direction of travel.
    fn boundaries_of(&self, lane: &LaneInfo) -> Vec<u32> {
        let first = self.first_boundary.get(lane.id.road as usize);
        let first = first.and_then(|sections| sections.get(usize::from(lane.id.section)));
        let place = self.map.lanes_of(lane.id.road, lane.id.section).iter().position(|l| l.id == lane.id);
        // Boundaries are counted from right to left looking along s, like lanes.
        match (first, place) {
            (Some(first), Some(place)) => {
                let right = first + place as u32;
                if lane.direction > 0.0 { vec![right + 1, right] } else { vec![right, right + 1] }
            }
            _ => Vec::new(),
        }
    }

    /// An element of a section, with the given points and their s.
    fn place(
        &self,
        kind: VectorKind,
        id: LaneId,
        points: &[nalgebra::Point3<f64>],
        mut s_m: Vec<f64>,
    ) -> VectorMapRow {
        // The centre line (lane 0) has no entry of its own; its neighbours know the junction.
        let any = self.map.lane(id).or_else(|| self.map.lanes_of(id.road, id.section).first());
        let junction = any.and_then(|l| self.map.junction_of(l.id));
        if let [only] = s_m[..] {
            s_m.push(only);
        }
        VectorMapRow {
            road_id: self.road_id(id.road),
            section_id: Some(i32::from(id.section)),
            lane_id: Some(i32::from(id.lane)),
            s_m,
            is_junction: junction.is_some(),
            junction_id: junction.map(|j| j.id.clone()),
            ..Self::line(kind, points)
        }
    }

    /// The borders of all sections' lanes, from right to left.
    pub(crate) fn boundaries(&self) -> Vec<VectorMapRow> {
        let mut rows = Vec::new();
        for road in 0..self.map.network().roads.len() as u32 {
            for section in 0..self.map.section_count(road) as u16 {
                if boundary_count(self.map, road, section) > 0 {
                    self.section_boundaries(road, section, &mut rows);
                }
            }
        }
        rows
    }

    fn section_boundaries(&self, road: u32, section: u16, rows: &mut Vec<VectorMapRow>) {
        let lanes = self.map.lanes_of(road, section);
        let samples = self.map.section_samples(road, section, TOLERANCE_M);
        for (k, points) in self.map.section_borders(road, section, &samples).iter().enumerate() {
            // Looking along s, lane k lies to the left of border k.
            let right = k.checked_sub(1).and_then(|i| lanes.get(i));
            let left = lanes.get(k);
            // The lane on the far side from the centre line owns the border.
            let owner = match (right, left) {
                (_, Some(left)) if left.id.lane < 0 => left.id.lane,
                (Some(right), _) if right.id.lane > 0 => right.id.lane,
                _ => 0,
            };
            let mark = right.map(|r| (r, true)).or(left.map(|l| (l, false))).map(|(lane, on_left)| {
                let middle = 0.5 * (lane.s_start + lane.s_end);
                // Left along s is left for travel along s, right for travel against it.
                if on_left == (lane.direction > 0.0) {
                    self.map.left_marking(lane.id, middle)
                } else {
                    self.map.right_marking(lane.id, middle)
                }
            });
            let beside = [right, left].into_iter().flatten();
            let paved = beside.clone().filter(|l| l.is_paved()).count();
            let id = LaneId { road, section, lane: owner };
            let row = self.place(VectorKind::LaneBoundary, id, points, samples.clone());
            rows.push(VectorMapRow {
                lanes: self.numbers(beside.map(|l| &l.id)),
                mark_type: mark.map(|m| m.mark_type.as_str().to_owned()),
                mark_color: mark.map(|m| m.colour.as_str().to_owned()),
                is_edge: paved == 1 && !row.is_junction,
                ..row
            });
        }
    }

    /// Painted lines, or the kerbs that the map states as markings.
    pub(crate) fn lines(&self, kind: VectorKind) -> Vec<VectorMapRow> {
        let kerbs = kind == VectorKind::Kerb;
        let stripes = self.map.stripes().iter().filter(|s| (s.mark_type == MarkType::Curb) == kerbs);
        stripes.map(|stripe| self.stripe(kind, stripe)).collect()
    }

    fn stripe(&self, kind: VectorKind, stripe: &Stripe) -> VectorMapRow {
        let id = LaneId { road: stripe.road, section: stripe.section, lane: stripe.border_of };
        let (s_m, points) = self.map.stripe_line(stripe, TOLERANCE_M);
        let outwards = if stripe.border_of > 0 { 1 } else { -1 };
        let (own, other) = match stripe.border_of {
            0 => (-1, 1),
            lane => (lane, lane.saturating_add(outwards)),
        };
        let beside = [own, other].map(|lane| LaneId { lane, ..id });
        VectorMapRow {
            width_m: Some(stripe.width_m),
            lanes: self.numbers(&beside),
            mark_type: Some(stripe.mark_type.as_str().to_owned()),
            mark_color: Some(stripe.colour.as_str().to_owned()),
            dash_m: stripe.dash.map_or_else(Vec::new, |d| d.to_vec()),
            ..self.place(kind, id, &points, s_m)
        }
    }
}

/// Mean width over a lane's samples, metres.
fn mean_width(table: &Table<'_>, lane: &LaneInfo, samples: &[f64]) -> Option<f64> {
    let width = |s: f64| table.map.lane_width(lane.id, s).unwrap_or(0.0);
    let length = lane.s_length();
    if length <= 0.0 {
        return table.map.lane_width(lane.id, lane.s_start);
    }
    let sum: f64 = samples.windows(2).map(|w| 0.5 * (width(w[0]) + width(w[1])) * (w[1] - w[0])).sum();
    Some(sum / length)
}
