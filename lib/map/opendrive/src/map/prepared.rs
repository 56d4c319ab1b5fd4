//! The prepared network itself, and its parts by their numbers.

use std::collections::BTreeMap;
use std::ops::Range;

use frames::{Object as ObjectFrame, Pose, World};
use nalgebra::Point3;

use super::graph::Graph;
use super::tree::LaneIndex;
use super::types::{Crosswalk, JunctionInfo, LaneId, LaneInfo, ObjectInfo, SignalGroup, SignalInfo, Stripe};
use crate::geometry::Surface;
use crate::model::{Network, Road};

/// A network with its surfaces, lanes, graph and spatial index, all computed once by [`Map::new`].
///
/// Questions about a lane, road or section that does not exist answer with nothing (`None`, an empty list).
#[derive(Debug)]
pub struct Map {
    pub(super) network: Network,
    pub(super) surfaces: Vec<Surface>,
    /// Index in `sections` of each road's first section, and the total at the end.
    pub(super) road_sections: Vec<usize>,
    pub(super) sections: Vec<SectionSpan>,
    pub(super) lanes: Vec<LaneInfo>,
    pub(super) graph: Graph,
    pub(super) index: LaneIndex,
    pub(super) drivable_index: LaneIndex,
    pub(super) stripes: Vec<Stripe>,
    /// Index in `stripes` of each section's first stripe, and the total at the end.
    pub(super) section_stripes: Vec<usize>,
    pub(super) objects: Vec<ObjectInfo>,
    pub(super) crosswalks: Vec<Crosswalk>,
    pub(super) junctions: Vec<JunctionInfo>,
    pub(super) signals: Vec<SignalInfo>,
    pub(super) lane_signals: BTreeMap<LaneId, Vec<usize>>,
    pub(super) signal_groups: Vec<SignalGroup>,
}

/// Where a lane section begins and ends, and which lanes it has.
#[derive(Debug)]
pub(super) struct SectionSpan {
    pub(super) s_start: f64,
    pub(super) s_end: f64,
    /// Its lanes in `Map::lanes`.
    pub(super) lanes: Range<usize>,
}

impl Map {
    /// The surfaces of a network alone; everything else is still empty.
    pub(super) fn bare(network: Network) -> Self {
        let surfaces = network.roads.iter().map(|road| Surface::new(road, &network.header.offset)).collect();
        Self {
            network,
            surfaces,
            road_sections: Vec::new(),
            sections: Vec::new(),
            lanes: Vec::new(),
            graph: Graph::default(),
            index: LaneIndex::default(),
            drivable_index: LaneIndex::default(),
            stripes: Vec::new(),
            section_stripes: Vec::new(),
            objects: Vec::new(),
            crosswalks: Vec::new(),
            junctions: Vec::new(),
            signals: Vec::new(),
            lane_signals: BTreeMap::new(),
            signal_groups: Vec::new(),
        }
    }

    /// The network as the file states it, but for lane sections made explicit (see [`Map::new`]).
    #[must_use]
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// All lanes but centre lanes, ascending by [`LaneId`].
    #[must_use]
    pub fn lanes(&self) -> &[LaneInfo] {
        &self.lanes
    }

    /// A lane's place in [`Map::lanes`].
    #[must_use]
    pub fn lane_number(&self, id: LaneId) -> Option<usize> {
        self.lane_index(id)
    }

    /// One lane.
    #[must_use]
    pub fn lane(&self, id: LaneId) -> Option<&LaneInfo> {
        self.lane_index(id).map(|i| &self.lanes[i])
    }

    /// The lanes of a section, from the right edge to the left edge (ascending lane id).
    #[must_use]
    pub fn lanes_of(&self, road: u32, section: u16) -> &[LaneInfo] {
        self.section(road, section).map_or(&[], |span| &self.lanes[span.lanes.clone()])
    }

    /// Number of lane sections of a road.
    #[must_use]
    pub fn section_count(&self, road: u32) -> usize {
        self.section_range(road).len()
    }

    /// First and last s of a section: it ends just before the next one begins.
    #[must_use]
    pub fn section_span(&self, road: u32, section: u16) -> Option<[f64; 2]> {
        self.section(road, section).map(|span| [span.s_start, span.s_end])
    }

    /// Length of a road's reference line, metres.
    #[must_use]
    pub fn road_length(&self, road: u32) -> Option<f64> {
        Some(self.surfaces.get(road as usize)?.length_m())
    }

    /// The pose of a road's surface at (s, t), `h_m` metres above it: x along s, y left, z normal to the
    /// surface. `s` is clamped to the road.
    #[must_use]
    pub fn road_pose(&self, road: u32, s: f64, t_m: f64, h_m: f64) -> Option<Pose<World, ObjectFrame>> {
        let surface = self.surfaces.get(road as usize)?;
        Some(surface.pose(s, t_m, h_m))
    }

    /// The point of a road's (endlessly wide) surface at (s, t), raised vertically by `up_m` metres.
    #[must_use]
    pub fn road_point(&self, road: u32, s: f64, t_m: f64, up_m: f64) -> Option<Point3<f64>> {
        let mut point = self.surfaces.get(road as usize)?.point(s, t_m);
        point.z += up_m;
        Some(point)
    }

    /// What is painted: all lines of all markings, by road, section and border.
    #[must_use]
    pub fn stripes(&self) -> &[Stripe] {
        &self.stripes
    }

    /// The lines of one section.
    #[must_use]
    pub fn stripes_of(&self, road: u32, section: u16) -> &[Stripe] {
        match self.section_index(road, section) {
            Some(i) => &self.stripes[self.section_stripes[i]..self.section_stripes[i + 1]],
            None => &[],
        }
    }

    /// Everything that stands or lies beside and on the roads, by road, then in file order; rows of copies
    /// are written out.
    #[must_use]
    pub fn objects(&self) -> &[ObjectInfo] {
        &self.objects
    }

    /// Pedestrian crossings, in the order of [`Map::objects`].
    #[must_use]
    pub fn crosswalks(&self) -> &[Crosswalk] {
        &self.crosswalks
    }

    /// Junctions, in file order.
    #[must_use]
    pub fn junctions(&self) -> &[JunctionInfo] {
        &self.junctions
    }

    /// The junction a lane is part of.
    #[must_use]
    pub fn junction_of(&self, id: LaneId) -> Option<&JunctionInfo> {
        self.junctions.get(self.lane(id)?.junction?)
    }

    /// Traffic lights and signs, by road, then in file order.
    #[must_use]
    pub fn signals(&self) -> &[SignalInfo] {
        &self.signals
    }

    /// Indices of the signals that control a lane, ascending.
    #[must_use]
    pub fn signals_of_lane(&self, id: LaneId) -> &[usize] {
        self.lane_signals.get(&id).map_or(&[], Vec::as_slice)
    }

    /// The signal programs, for each junction that has controllers.
    #[must_use]
    pub fn signal_groups(&self) -> &[SignalGroup] {
        &self.signal_groups
    }

    pub(super) fn road(&self, road: u32) -> &Road {
        &self.network.roads[road as usize]
    }

    pub(super) fn section_range(&self, road: u32) -> Range<usize> {
        match self.road_sections.get(road as usize..road as usize + 2) {
            Some(&[from, to]) => from..to,
            _ => 0..0,
        }
    }

    pub(super) fn section_index(&self, road: u32, section: u16) -> Option<usize> {
        let range = self.section_range(road);
        (usize::from(section) < range.len()).then_some(range.start + usize::from(section))
    }

    pub(super) fn section(&self, road: u32, section: u16) -> Option<&SectionSpan> {
        self.section_index(road, section).map(|i| &self.sections[i])
    }

    pub(super) fn lane_index(&self, id: LaneId) -> Option<usize> {
        let lanes = self.section(id.road, id.section)?.lanes.clone();
        let found = self.lanes[lanes.clone()].binary_search_by_key(&id.lane, |l| l.id.lane).ok()?;
        Some(lanes.start + found)
    }
}
