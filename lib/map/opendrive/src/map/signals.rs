//! Signals in the world, the lanes they control, and their programs.

use std::collections::BTreeMap;

use frames::Pose;
use frames::math::atan2;
use nalgebra::Point3;

use super::lanes::carries_vehicles;
use super::{GroupController, LaneId, LanePos, Map, SignalGroup, SignalInfo};
use crate::geometry::{Surface, record_at};
use crate::model::{LaneValidity, Orientation, Signal, SignalPosition};

/// Most lanes looked at on the way back from a controlled lane to its stop point.
const MAX_STEPS_BACK: usize = 1000;

impl Map {
    /// Places all signals and finds what they control.
    pub(super) fn build_signals(&mut self) {
        let mut by_id: BTreeMap<&str, usize> = BTreeMap::new();
        let mut found = Vec::new();
        for (r, road) in self.network.roads.iter().enumerate() {
            let surface = &self.surfaces[r];
            for (index, signal) in road.signals.iter().enumerate() {
                by_id.entry(&signal.id).or_insert(found.len());
                let (on_surface, up_m) = self.stand(surface, signal);
                let tangent = surface.frame(signal.s).tangent;
                let turned =
                    if signal.orientation == Orientation::Against { std::f64::consts::PI } else { 0.0 };
                let heading = atan2(tangent.y, tangent.x) + turned + signal.h_offset_rad;
                let origin = [on_surface.x, on_surface.y, on_surface.z + up_m];
                found.push(SignalInfo {
                    id: signal.id.clone(),
                    name: signal.name.clone(),
                    road: r as u32,
                    index,
                    s: signal.s,
                    t: signal.t,
                    pose: Pose::from_xyz_rpy(origin, [0.0, 0.0, heading]),
                    on_surface,
                    dynamic: signal.dynamic,
                    kind: signal.kind.clone(),
                    subtype: signal.subtype.clone(),
                    value: signal.value,
                    size_m: [signal.height_m, signal.width_m],
                    lanes: self.lanes_of_signal(r as u32, signal.s, signal.orientation, &signal.validity),
                    junction: None,
                });
            }
        }
        // References name a signal of any road; where an id is repeated, the first signal is meant.
        for (r, road) in self.network.roads.iter().enumerate() {
            for reference in &road.signal_references {
                if let Some(&signal) = by_id.get(reference.id.as_str()) {
                    let lanes = self.lanes_of_signal(
                        r as u32,
                        reference.s,
                        reference.orientation,
                        &reference.validity,
                    );
                    found[signal].lanes.extend(lanes);
                }
            }
        }
        for signal in &mut found {
            signal.lanes.sort();
            signal.lanes.dedup();
            signal.junction = signal.lanes.iter().find_map(|id| self.lane(*id)?.junction);
        }
        let groups = self.groups(&by_id);
        for group in &groups {
            for signal in group.controllers.iter().flat_map(|c| &c.signals) {
                found[*signal].junction.get_or_insert(group.junction);
            }
        }
        for (i, signal) in found.iter().enumerate() {
            for id in &signal.lanes {
                self.lane_signals.entry(*id).or_default().push(i);
            }
            if let Some(junction) = signal.junction {
                self.junctions[junction].signals.push(i);
            }
        }
        self.signals = found;
        self.signal_groups = groups;
    }

    /// Lanes for traffic that a signal at s of a road applies to. Stated ranges decide; without any, the
    /// orientation does.
    fn lanes_of_signal(
        &self,
        road: u32,
        s: f64,
        orientation: Orientation,
        ranges: &[LaneValidity],
    ) -> Vec<LaneId> {
        let sections = &self.road(road).sections;
        let at = record_at(sections, s, |section| section.s).or(sections.first());
        let Some(section) = at.and_then(|found| sections.iter().position(|x| std::ptr::eq(x, found))) else {
            return Vec::new();
        };
        let lanes = self.lanes_of(road, section as u16).iter().filter(|lane| {
            let meant = if ranges.is_empty() {
                match orientation {
                    Orientation::Along => lane.direction > 0.0 || lane.both_ways,
                    Orientation::Against => lane.direction < 0.0 || lane.both_ways,
                    Orientation::Both => true,
                }
            } else {
                ranges.iter().any(|range| range.contains(lane.id.lane))
            };
            carries_vehicles(lane.lane_type) && meant
        });
        lanes.map(|lane| lane.id).collect()
    }

    /// The point of a road's surface that a signal stands over, and how far. A physical position that the
    /// file gives apart counts; the heading does not change with it, as the traffic that the signal is for
    /// does not, either.
    fn stand(&self, surface: &Surface, signal: &Signal) -> (Point3<f64>, f64) {
        let at = surface.point(signal.s, signal.t);
        match &signal.position {
            None => (at, signal.z_offset_m),
            Some(SignalPosition::Inertial { xyz_m, .. }) => {
                let place = self.network.header.offset.apply(*xyz_m);
                (Point3::new(place.x, place.y, at.z), place.z - at.z)
            }
            Some(SignalPosition::Road { road, s, t, z_offset_m, .. }) => {
                match self.network.roads.iter().position(|r| r.id == *road) {
                    Some(r) => (self.surfaces[r].point(*s, *t), *z_offset_m),
                    None => (at, signal.z_offset_m),
                }
            }
        }
    }

    fn groups(&self, by_id: &BTreeMap<&str, usize>) -> Vec<SignalGroup> {
        let mut controllers = BTreeMap::new();
        for controller in &self.network.controllers {
            controllers.entry(controller.id.as_str()).or_insert(controller);
        }
        let mut groups = Vec::new();
        for (junction, info) in self.network.junctions.iter().enumerate() {
            let mut members: Vec<GroupController> = Vec::new();
            for entry in &info.controllers {
                let Some(controller) = controllers.get(entry.id.as_str()) else { continue };
                let mut signals: Vec<usize> =
                    controller.signals.iter().filter_map(|id| by_id.get(id.as_str()).copied()).collect();
                signals.sort_unstable();
                signals.dedup();
                members.push(GroupController {
                    id: controller.id.clone(),
                    name: controller.name.clone(),
                    sequence: entry.sequence.or(controller.sequence),
                    signals,
                });
            }
            members.sort_by_key(|c| c.sequence.unwrap_or(u32::MAX));
            if !members.is_empty() {
                groups.push(SignalGroup { junction, controllers: members });
            }
        }
        groups
    }

    /// Where traffic bound for the lanes of a signal must stop: the ends of the lanes before the junction, or
    /// the signal's own place on a lane outside a junction. Sorted by lane.
    #[must_use]
    pub fn stop_points(&self, signal: usize) -> Vec<LanePos> {
        let Some(info) = self.signals.get(signal) else { return Vec::new() };
        let mut found: Vec<LanePos> =
            info.lanes.iter().flat_map(|id| self.stop_points_before(*id, info.s)).collect();
        found.sort_by(|a, b| a.lane.cmp(&b.lane).then(a.along_m.total_cmp(&b.along_m)));
        found.dedup_by_key(|p| p.lane);
        found
    }

    fn stop_points_before(&self, lane: LaneId, s: f64) -> Vec<LanePos> {
        let Some(info) = self.lane(lane) else { return Vec::new() };
        if info.junction.is_none() {
            let s = s.clamp(info.s_start, info.s_end);
            return vec![LanePos { lane, along_m: info.along_of_s(s) }];
        }
        let (mut found, mut stack) = (Vec::new(), vec![lane]);
        for _ in 0..MAX_STEPS_BACK {
            let Some(at) = stack.pop() else { break };
            for before in self.predecessors(at) {
                match self.lane(*before) {
                    Some(b) if b.junction.is_none() => {
                        found.push(LanePos { lane: *before, along_m: b.s_length() })
                    }
                    Some(b) if b.junction == info.junction => stack.push(*before),
                    _ => {}
                }
            }
        }
        found
    }
}
