//! Elements on the ground or at a point: signals, crosswalks, stop lines, sidewalks, junctions.

use nalgebra::Point3;
use opendrive::{Area, LaneInfo, SignalInfo, StopLineSource};
use schema::tables::{VectorKind, VectorMapRow};

use crate::vector_map::{Table, push};

/// Yield signs: 205 of the German catalogue (which CARLA's maps use), R1-2 of the North American.
const YIELD: [&str; 2] = ["205", "R1-2"];

impl Table<'_> {
    /// Traffic lights and signs, in the order of the map's list.
    pub(crate) fn signals(&self) -> Vec<VectorMapRow> {
        let rows = self.map.signals().iter().map(|signal| {
            let junction = signal.junction.and_then(|j| self.map.junctions().get(j));
            VectorMapRow {
                road_id: self.road_id(signal.road),
                opendrive_id: Some(signal.id.clone()),
                junction_id: junction.map(|j| j.id.clone()),
                lanes: self.numbers(&signal.lanes),
                signal_type: Some(signal_type(signal).to_owned()),
                heading_rad: Some(signal.pose.rpy()[2]),
                ..Self::line(VectorKind::Signal, &[Point3::from(signal.pose.translation())])
            }
        });
        rows.collect()
    }

    pub(crate) fn crosswalks(&self) -> Vec<VectorMapRow> {
        let spans = self.map.crosswalk_spans();
        let rows = self.map.crosswalks().iter().enumerate().map(|(i, crosswalk)| {
            let under = spans.iter().filter(|s| s.crosswalk == i).map(|s| &s.lane);
            let mut area = Area { outline: crosswalk.polygon.clone(), holes: Vec::new() };
            if area.size_m2() < 0.0 {
                area.outline.reverse();
            }
            VectorMapRow {
                road_id: self.road_id(crosswalk.road),
                opendrive_id: Some(crosswalk.id.clone()),
                lanes: self.numbers(under),
                ..polygon(VectorKind::Crosswalk, &area)
            }
        });
        rows.collect()
    }

    pub(crate) fn stop_lines(&self) -> Vec<VectorMapRow> {
        let rows = self.map.stop_lines().into_iter().map(|line| {
            let stated = match line.source {
                StopLineSource::Object(i) => self.map.objects().get(i).map(|o| (o.road, &o.id)),
                StopLineSource::Signal(i) => self.map.signals().get(i).map(|s| (s.road, &s.id)),
                StopLineSource::Derived => None,
            };
            let road = stated.map(|(road, _)| road).or(line.lanes.first().map(|p| p.lane.road));
            VectorMapRow {
                road_id: road.and_then(|road| self.road_id(road)),
                opendrive_id: stated.map(|(_, id)| id.clone()),
                width_m: Some(line.width_m),
                lanes: self.numbers(line.lanes.iter().map(|p| &p.lane)),
                signals: self.signal_numbers(&line.signals),
                is_derived: line.source == StopLineSource::Derived,
                ..Self::line(VectorKind::StopLine, &line.ends)
            }
        });
        rows.collect()
    }

    pub(crate) fn sidewalks(&self) -> Vec<VectorMapRow> {
        let roads = 0..self.map.network().roads.len() as u32;
        let rows = roads.flat_map(|road| self.map.sidewalks(road)).map(|walk| {
            let junction = walk.lanes.first().and_then(|id| self.map.junction_of(*id));
            VectorMapRow {
                road_id: self.road_id(walk.road),
                is_junction: junction.is_some(),
                junction_id: junction.map(|j| j.id.clone()),
                lanes: self.numbers(&walk.lanes),
                ..polygon(VectorKind::Sidewalk, &walk.area)
            }
        });
        rows.collect()
    }

    /// Paved ground of the junctions; a junction whose ground lies apart has several rows.
    pub(crate) fn junctions(&self) -> Vec<VectorMapRow> {
        let mut rows = Vec::new();
        for (i, junction) in self.map.junctions().iter().enumerate() {
            let lanes: Vec<&LaneInfo> = junction.lanes.iter().filter_map(|id| self.map.lane(*id)).collect();
            for area in self.map.junction_area(i) {
                let on_it = |lane: &&&LaneInfo| {
                    let middle = self.map.lane_point(lane.id, 0.5 * (lane.s_start + lane.s_end), 0.0);
                    lane.is_paved() && middle.is_some_and(|m| area.contains(m.position.x, m.position.y))
                };
                rows.push(VectorMapRow {
                    opendrive_id: Some(junction.id.clone()),
                    is_junction: true,
                    junction_id: Some(junction.id.clone()),
                    lanes: self.numbers(lanes.iter().filter(on_it).map(|l| &l.id)),
                    ..polygon(VectorKind::Junction, &area)
                });
            }
        }
        rows
    }
}

fn signal_type(signal: &SignalInfo) -> &str {
    if signal.dynamic {
        "traffic_light"
    } else if signal.is_stop_sign() {
        "stop"
    } else if YIELD.contains(&signal.kind.as_str()) {
        "yield"
    } else {
        &signal.kind
    }
}

/// An element with the rings of an area, each closed.
fn polygon(kind: VectorKind, area: &Area) -> VectorMapRow {
    let mut row = VectorMapRow { kind: kind.name().to_owned(), ..VectorMapRow::default() };
    for ring in area.rings() {
        row.rings.push(row.x_m.len() as u32);
        push(&mut row, ring);
        push(&mut row, &ring[..ring.len().min(1)]);
    }
    row
}
