//! Joins lanes, and answers which leads to which.

use std::collections::BTreeMap;

use super::graph::Graph;
use super::sections::sections_at;
use super::{LaneId, LaneInfo, LanePos, Map};
use crate::model::{Connection, ContactPoint, RoadLink, TrackDirection};

/// Most places that one step ahead or behind answers with.
const MAX_BRANCHES: usize = 1024;
/// Most lanes that one step ahead or behind looks at.
const MAX_VISITS: usize = 65_536;

/// The lanes that touch each end (0 start, 1 end of s) of each lane, with the end that touches.
struct Touches(Vec<[Vec<(usize, usize)>; 2]>);

impl Touches {
    fn join(&mut self, a: (usize, usize), b: (usize, usize)) {
        for (from, to) in [(a, b), (b, a)] {
            let list = &mut self.0[from.0][from.1];
            if !list.contains(&to) {
                list.push(to);
            }
        }
    }
}

fn end_index(contact: ContactPoint) -> usize {
    match contact {
        ContactPoint::Start => 0,
        ContactPoint::End => 1,
    }
}

/// Joins lane ends as junctions, road links and lane links say, then reads them in the direction of travel.
///
/// Lane links are symmetric facts about ends that touch; whether one may drive across follows from the
/// directions of the two lanes. So files that state a link on one side only are served, too.
pub(super) fn graph(map: &Map) -> Graph {
    let network = &map.network;
    let mut road_of: BTreeMap<&str, u32> = BTreeMap::new();
    for (i, road) in network.roads.iter().enumerate() {
        road_of.entry(&road.id).or_insert(i as u32);
    }
    let mut touches = Touches(vec![Default::default(); map.lanes.len()]);
    // Junctions first: their order of connections is the order of branches.
    for junction in &network.junctions {
        for connection in &junction.connections {
            join_connection(map, &road_of, &junction.id, connection, &mut touches);
        }
    }
    for (i, road) in network.roads.iter().enumerate() {
        let i = i as u32;
        for (k, pair) in road.sections.windows(2).enumerate() {
            let at = |section: usize, lane| map.lane_index(LaneId { road: i, section: section as u16, lane });
            let forward = pair[0].lanes().flat_map(|l| l.successors.iter().map(|to| (l.id, *to)));
            let backward = pair[1].lanes().flat_map(|l| l.predecessors.iter().map(|from| (*from, l.id)));
            for (from, to) in forward.chain(backward) {
                if let (Some(a), Some(b)) = (at(k, from), at(k + 1, to)) {
                    touches.join((a, 1), (b, 0));
                }
            }
        }
        for (link, end) in [(&road.predecessor, 0), (&road.successor, 1)] {
            let Some(place) = link.as_ref().and_then(|link| touched(map, &road_of, link, end)) else {
                continue;
            };
            let section = if end == 0 { road.sections.first() } else { road.sections.last() };
            for lane in section.iter().flat_map(|s| s.lanes()) {
                for to in if end == 0 { &lane.predecessors } else { &lane.successors } {
                    let (a, b) = (lane_at_end(map, i, end, lane.id), place.lane(map, *to));
                    if let (Some(a), Some(b)) = (a, b) {
                        touches.join((a, end), (b, place.end));
                    }
                }
            }
        }
    }
    directed(map, &touches)
}

/// Touching lane ends in the direction of travel.
fn directed(map: &Map, touches: &Touches) -> Graph {
    let entry = |lane: &LaneInfo| usize::from(lane.direction < 0.0);
    let mut graph = Graph::default();
    for (i, lane) in map.lanes.iter().enumerate() {
        let [first, last] = [&touches.0[i][entry(lane)], &touches.0[i][1 - entry(lane)]];
        let after = last.iter().filter(|(to, end)| entry(&map.lanes[*to]) == *end);
        let before = first.iter().filter(|(from, end)| 1 - entry(&map.lanes[*from]) == *end);
        let id = |(lane, _): &(usize, usize)| map.lanes[*lane].id;
        graph.push(before.map(id), after.map(id));
    }
    graph
}

fn lane_at_end(map: &Map, road: u32, end: usize, lane: i16) -> Option<usize> {
    let sections = map.section_count(road);
    let section = if end == 0 { 0 } else { sections.checked_sub(1)? };
    map.lane_index(LaneId { road, section: section as u16, lane })
}

fn join_connection(
    map: &Map,
    road_of: &BTreeMap<&str, u32>,
    junction: &str,
    connection: &Connection,
    touches: &mut Touches,
) {
    let find = |id: &String| road_of.get(id.as_str()).copied();
    let (Some(incoming), Some(connecting)) =
        (find(&connection.incoming_road), find(&connection.connecting_road))
    else {
        return;
    };
    let contact = end_index(connection.contact);
    let place = incoming_place(map, road_of, incoming, connecting, contact, junction);
    for link in &connection.lane_links {
        let from = place.lane(map, link.from);
        let to = lane_at_end(map, connecting, contact, link.to);
        if let (Some(from), Some(to)) = (from, to) {
            touches.join((from, place.end), (to, contact));
        }
    }
}

/// An end (0 start, 1 end) of a lane section.
#[derive(Clone, Copy, Debug)]
struct SectionEnd {
    road: u32,
    section: usize,
    end: usize,
}

impl SectionEnd {
    fn of_road(map: &Map, road: u32, end: usize) -> Self {
        let last = map.section_count(road).saturating_sub(1);
        Self { road, section: if end == 0 { 0 } else { last }, end }
    }

    fn lane(self, map: &Map, lane: i16) -> Option<usize> {
        map.lane_index(LaneId { road: self.road, section: self.section as u16, lane })
    }
}

/// What a link of an end (0 start, 1 end) of a road touches, if it is a road.
fn touched(map: &Map, road_of: &BTreeMap<&str, u32>, link: &RoadLink, end: usize) -> Option<SectionEnd> {
    match link {
        RoadLink::Road { id, contact } => {
            Some(SectionEnd::of_road(map, *road_of.get(id.as_str())?, end_index(*contact)))
        }
        RoadLink::Along { id, s, direction } => {
            let road = *road_of.get(id.as_str())?;
            let [begins, ends] = sections_at(map.road(road), *s);
            // Traffic that joins here drives on in the direction stated; traffic that left here came in it.
            let joins_section_that_begins = (*direction == TrackDirection::Along) == (end == 1);
            let (section, end) = if joins_section_that_begins { (begins?, 0) } else { (ends?, 1) };
            Some(SectionEnd { road, section, end })
        }
        RoadLink::Junction { .. } => None,
    }
}

/// Where the incoming road touches a connecting road: as the connecting road's own link says, else at the end
/// that is linked to the junction.
fn incoming_place(
    map: &Map,
    road_of: &BTreeMap<&str, u32>,
    incoming: u32,
    connecting: u32,
    contact: usize,
    junction: &str,
) -> SectionEnd {
    let (road, other) = (map.road(incoming), map.road(connecting));
    let link = if contact == 0 { &other.predecessor } else { &other.successor };
    if let Some(RoadLink::Road { id, .. } | RoadLink::Along { id, .. }) = link
        && *id == road.id
        && let Some(place) = link.as_ref().and_then(|link| touched(map, road_of, link, contact))
    {
        return SectionEnd { road: incoming, ..place };
    }
    let names_it =
        |link: &Option<RoadLink>| matches!(link, Some(RoadLink::Junction { id }) if id == junction);
    let end = usize::from(names_it(&road.successor) || !names_it(&road.predecessor));
    SectionEnd::of_road(map, incoming, end)
}

impl Map {
    /// Lanes that travel may go on to at a lane's end, in the order of the file's links.
    #[must_use]
    pub fn successors(&self, id: LaneId) -> &[LaneId] {
        self.lane_index(id).map_or(&[], |i| self.graph.successors(i))
    }

    /// Lanes that travel may come from at a lane's beginning.
    #[must_use]
    pub fn predecessors(&self, id: LaneId) -> &[LaneId] {
        self.lane_index(id).map_or(&[], |i| self.graph.predecessors(i))
    }

    /// The lane beside it, to the left of its direction of travel, of whatever type and direction.
    #[must_use]
    pub fn left_of(&self, id: LaneId) -> Option<LaneId> {
        self.beside(id, 1)
    }

    /// The lane beside it, to the right of its direction of travel, of whatever type and direction.
    #[must_use]
    pub fn right_of(&self, id: LaneId) -> Option<LaneId> {
        self.beside(id, -1)
    }

    /// Whether two lanes of one road are travelled in the same direction.
    #[must_use]
    pub fn same_direction(&self, a: LaneId, b: LaneId) -> bool {
        match (self.lane(a), self.lane(b)) {
            (Some(x), Some(y)) => a.road == b.road && x.direction * y.direction > 0.0,
            _ => false,
        }
    }

    fn beside(&self, id: LaneId, side: i16) -> Option<LaneId> {
        let i = self.lane_index(id)?;
        // Lanes of a section are stored from right to left.
        let step = if self.lanes[i].direction > 0.0 { side } else { -side };
        let neighbour = self.lanes.get(i.checked_add_signed(isize::from(step))?)?.id;
        (neighbour.road == id.road && neighbour.section == id.section).then_some(neighbour)
    }

    /// Every place reached by travelling `distance_m` metres of s onwards, over all branches, in the order of
    /// the links (the first element follows the first link everywhere). Branches that end sooner are missing.
    #[must_use]
    pub fn ahead(&self, pos: LanePos, distance_m: f64) -> Vec<LanePos> {
        self.step(pos, distance_m, Graph::successors, |along, length| (along, length))
    }

    /// Every place from which travelling `distance_m` metres of s leads here, over all branches, in the order
    /// of the links.
    #[must_use]
    pub fn behind(&self, pos: LanePos, distance_m: f64) -> Vec<LanePos> {
        self.step(pos, distance_m, Graph::predecessors, |along, length| (length - along, length))
    }

    /// Walks `distance` from `pos`. `orient` turns along-travel coordinates into walked ones and back (it is
    /// its own inverse).
    fn step(
        &self,
        pos: LanePos,
        distance: f64,
        next: fn(&Graph, usize) -> &[LaneId],
        orient: fn(f64, f64) -> (f64, f64),
    ) -> Vec<LanePos> {
        let mut found = Vec::new();
        let Some(start) = self.lane_index(pos.lane) else { return found };
        if distance.is_nan() || pos.along_m.is_nan() {
            return found;
        }
        let length = self.lanes[start].s_length();
        // Depth first with an explicit stack: distances still to go, measured from each lane's walked
        // beginning.
        let mut stack = vec![(start, orient(pos.along_m.clamp(0.0, length), length).0 + distance.max(0.0))];
        let mut visits = 0;
        while let Some((lane, walked)) = stack.pop() {
            visits += 1;
            if visits > MAX_VISITS || found.len() >= MAX_BRANCHES {
                break;
            }
            let info = &self.lanes[lane];
            let length = info.s_length();
            if walked <= length {
                found.push(LanePos { lane: info.id, along_m: orient(walked, length).0 });
                continue;
            }
            // Reversed, so that the first link is popped first.
            let onward = next(&self.graph, lane).iter().rev().filter_map(|id| self.lane_index(*id));
            stack.extend(onward.map(|i| (i, walked - length)));
        }
        found
    }
}
