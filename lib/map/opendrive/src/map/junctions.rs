//! Junctions in the world.

use nalgebra::Point3;

use super::{JunctionInfo, LaneId, Map};
use crate::model::RoadLink;

/// Sampling tolerance for the bounding box, metres.
const TOLERANCE_M: f64 = 0.05;

impl Map {
    /// Collects lanes, ways in, and bounds of all junctions.
    pub(super) fn build_junctions(&mut self) {
        let mut found: Vec<JunctionInfo> = (self.network.junctions.iter().enumerate())
            .map(|(index, junction)| JunctionInfo {
                id: junction.id.clone(),
                index,
                roads: Vec::new(),
                lanes: Vec::new(),
                incoming: Vec::new(),
                centre: Point3::origin(),
                bounds: [Point3::origin(); 2],
                signals: Vec::new(),
            })
            .collect();
        for (i, lane) in self.lanes.iter().enumerate() {
            let Some(j) = lane.junction else { continue };
            let junction = &mut found[j];
            if junction.roads.last() != Some(&lane.id.road) {
                junction.roads.push(lane.id.road);
            }
            junction.lanes.push(lane.id);
            for before in self.graph.predecessors(i) {
                if self.lane(*before).is_some_and(|b| b.junction != Some(j) && b.lane_type.is_drivable()) {
                    junction.incoming.push(*before);
                }
            }
        }
        for junction in &mut found {
            junction.incoming.sort();
            junction.incoming.dedup();
            let mut points = Vec::new();
            for id in &junction.lanes {
                let line = self.lane_polyline(*id, TOLERANCE_M);
                points.extend(line.left);
                points.extend(line.right);
            }
            if points.is_empty() {
                points = self.ends_at(&junction.id);
            }
            if let Some(first) = points.first() {
                let (mut min, mut max) = (*first, *first);
                for point in &points {
                    (min, max) = (min.inf(point), max.sup(point));
                }
                junction.bounds = [min, max];
                junction.centre = nalgebra::center(&min, &max);
            }
        }
        self.junctions = found;
    }

    /// The ends of the roads that are linked to a junction: all there is of a direct junction.
    fn ends_at(&self, junction: &str) -> Vec<Point3<f64>> {
        let mut points = Vec::new();
        for (road, surface) in self.network.roads.iter().zip(&self.surfaces) {
            for (link, s) in [(&road.predecessor, 0.0), (&road.successor, road.length_m)] {
                if matches!(link, Some(RoadLink::Junction { id }) if id == junction) {
                    points.push(surface.point(s, 0.0));
                }
            }
        }
        points
    }

    /// Drivable lanes of a junction that traffic enters it by: each follows one of its incoming lanes.
    #[must_use]
    pub fn entry_lanes(&self, junction: usize) -> Vec<LaneId> {
        let Some(info) = self.junctions.get(junction) else { return Vec::new() };
        let enters =
            |id: &&LaneId| self.predecessors(**id).iter().any(|b| info.incoming.binary_search(b).is_ok());
        info.lanes.iter().filter(enters).copied().collect()
    }
}
