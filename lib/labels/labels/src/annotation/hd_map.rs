//! HD-map records: the lane an agent is in, and what lies ahead of it.

use std::collections::BTreeMap;

use frames::{Agent, Pose, World, wrap_pi};
use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, LanePos, Map};
use schema::AgentId;
use schema::tables::HdMapRow;

/// How far ahead junctions, stop lines and crosswalks are looked for, metres of way.
const AHEAD_M: f64 = 500.0;
/// How far away sidewalks are looked for, metres.
const SIDEWALK_M: f64 = 50.0;

/// A map with what its records need at hand.
#[derive(Debug)]
pub struct HdMap<'m> {
    map: &'m Map,
    /// On each lane, places where lights or signs hold traffic (metres of s from its beginning, ascending),
    /// and those signals.
    stops: BTreeMap<LaneId, Vec<(f64, Vec<usize>)>>,
    /// On each lane, the stretches under crosswalks, and which one.
    crossings: BTreeMap<LaneId, Vec<([f64; 2], usize)>>,
}

impl<'m> HdMap<'m> {
    /// Finds the stop lines and crossings of a map.
    #[must_use]
    pub fn new(map: &'m Map) -> Self {
        let mut stops: BTreeMap<LaneId, Vec<(f64, Vec<usize>)>> = BTreeMap::new();
        for line in map.stop_lines().into_iter().filter(|l| !l.signals.is_empty()) {
            for pos in &line.lanes {
                stops.entry(pos.lane).or_default().push((pos.along_m, line.signals.clone()));
            }
        }
        stops.values_mut().for_each(|list| list.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let mut crossings: BTreeMap<LaneId, Vec<([f64; 2], usize)>> = BTreeMap::new();
        for span in map.crosswalk_spans() {
            crossings.entry(span.lane).or_default().push((span.along_m, span.crosswalk));
        }
        crossings.values_mut().for_each(|list| list.sort_by(|a, b| a.0[0].total_cmp(&b.0[0])));
        Self { map, stops, crossings }
    }

    /// The record of the driving lane nearest to an agent's origin (in three dimensions, so that decks are
    /// told apart). None only on a map without driving lanes.
    ///
    /// Left and right are seen in the lane's direction of travel; neighbours are the adjacent lanes of any
    /// type.
    #[must_use]
    pub fn record(
        &self,
        frame: u32,
        agent: AgentId,
        world_from_agent: &Pose<World, Agent>,
    ) -> Option<HdMapRow> {
        let map = self.map;
        let origin = Point3::from(world_from_agent.translation());
        let hit = map.nearest_driving_lane(origin)?;
        let (id, s) = (hit.lane, hit.s);
        let lane = map.lane(id)?;
        let point = map.lane_point(id, s, 0.0)?;
        let road = map.network().roads.get(id.road as usize)?;
        let (left_mark, right_mark) = (map.left_marking(id, s), map.right_marking(id, s));
        let left = map.left_of(id).and_then(|id| Neighbour::new(map, id, s));
        let right = map.right_of(id).and_then(|id| Neighbour::new(map, id, s));
        let pos = LanePos { lane: id, along_m: lane.along_of_s(s) };
        let junction = map.junction_ahead(pos, AHEAD_M);
        let stop = map.first_ahead(pos, AHEAD_M, |id, along| {
            let (place, signals) = self.stops.get(&id)?.iter().find(|(place, _)| *place >= along)?;
            Some((*place, signals))
        });
        let crossing = map.first_ahead(pos, AHEAD_M, |id, along| {
            let (span, crosswalk) = self.crossings.get(&id)?.iter().find(|(span, _)| span[1] >= along)?;
            Some((span[0].max(along), *crosswalk))
        });
        let signal_ids = stop.iter().flat_map(|stop| stop.what).filter_map(|i| map.signals().get(*i));
        Some(HdMapRow {
            frame,
            agent: agent.to_string(),
            lane: map.lane_number(id)? as u32,
            road_id: road.id.clone(),
            section_id: u32::from(id.section),
            lane_id: i32::from(id.lane),
            s_m: s,
            lane_type: lane.lane_type.as_str().to_owned(),
            lane_width_m: hit.width_m,
            lane_change: map.lane_change(id, s).as_str().to_owned(),
            is_junction: lane.junction.is_some(),
            junction_id: map.junction_of(id).map(|junction| junction.id.clone()),
            speed_limit_mps: map.speed_limit(id, s),
            xyz_m: point.position.coords.into(),
            rpy_rad: [point.roll_rad, point.pitch_rad, wrap_pi(point.heading_rad)],
            left_marking_type: left_mark.mark_type.as_str().to_owned(),
            left_marking_width_m: left_mark.width_m,
            left_marking_color: left_mark.colour.as_str().to_owned(),
            left_marking_lane_change: left_mark.lane_change.as_str().to_owned(),
            right_marking_type: right_mark.mark_type.as_str().to_owned(),
            right_marking_width_m: right_mark.width_m,
            right_marking_color: right_mark.colour.as_str().to_owned(),
            right_marking_lane_change: right_mark.lane_change.as_str().to_owned(),
            left_lane_id: left.as_ref().map(|n| n.lane_id),
            left_lane_type: left.as_ref().map(|n| n.lane_type.to_owned()),
            left_lane_width_m: left.as_ref().and_then(|n| n.width_m),
            left_lane_change: left.as_ref().map(|n| n.lane_change.to_owned()),
            right_lane_id: right.as_ref().map(|n| n.lane_id),
            right_lane_type: right.as_ref().map(|n| n.lane_type.to_owned()),
            right_lane_width_m: right.as_ref().and_then(|n| n.width_m),
            right_lane_change: right.as_ref().map(|n| n.lane_change.to_owned()),
            lane_offset_m: hit.t_m,
            next_junction_id: junction.as_ref().map(|a| map.junctions()[a.what].id.clone()),
            next_junction_m: junction.as_ref().map(|a| a.way_m),
            signal_ids: signal_ids.map(|signal| signal.id.clone()).collect(),
            stop_line_m: stop.as_ref().map(|a| a.way_m),
            crosswalk_id: crossing.as_ref().map(|a| map.crosswalks()[a.what].id.clone()),
            crosswalk_m: crossing.as_ref().map(|a| a.way_m),
            sidewalk_m: self.sidewalk_m(origin),
        })
    }

    /// Distance to the border of the nearest sidewalk.
    fn sidewalk_m(&self, origin: Point3<f64>) -> Option<f64> {
        let walkable = |lane: &LaneInfo| lane.lane_type.is_walkable();
        let hits = self.map.lanes_within(origin, SIDEWALK_M, walkable);
        hits.iter().map(|hit| (hit.distance_m - 0.5 * hit.width_m).max(0.0)).min_by(f64::total_cmp)
    }
}

/// A lane beside the agent's.
struct Neighbour {
    lane_id: i32,
    lane_type: &'static str,
    width_m: Option<f64>,
    lane_change: &'static str,
}

impl Neighbour {
    fn new(map: &Map, id: LaneId, s: f64) -> Option<Self> {
        Some(Self {
            lane_id: i32::from(id.lane),
            lane_type: map.lane(id)?.lane_type.as_str(),
            width_m: map.lane_width(id, s),
            lane_change: map.lane_change(id, s).as_str(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opendrive::Network;

    /// A road to the east, 100 m, with a driving lane and a sidewalk on each side; another 6 m above it.
    const MAP: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="7"/>
        <road id="7" length="100" junction="-1">
          <planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
          <elevationProfile><elevation s="0" a="0" b="0" c="0" d="0"/></elevationProfile>
          <lanes><laneSection s="0">
            <left>
              <lane id="2" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane>
              <lane id="1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left>
            <center><lane id="0" type="none"><roadMark sOffset="0" type="broken" color="yellow" width="0.15" laneChange="both"/></lane></center>
            <right>
              <lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>
                <roadMark sOffset="0" type="solid" color="standard" width="0.12" laneChange="none"/></lane>
              <lane id="-2" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane></right>
          </laneSection></lanes>
        </road>
        <road id="9" length="100" junction="-1">
          <planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
          <elevationProfile><elevation s="0" a="6" b="0" c="0" d="0"/></elevationProfile>
          <lanes><laneSection s="0">
            <center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right>
          </laneSection></lanes>
        </road></OpenDRIVE>"#;

    fn record_at(xyz_m: [f64; 3]) -> HdMapRow {
        let map = Map::new(Network::parse(MAP).expect("a sound map"));
        HdMap::new(&map)
            .record(3, AgentId::vehicle(1), &Pose::from_xyz_rpy(xyz_m, [0.0; 3]))
            .expect("there are driving lanes")
    }

    #[test]
    fn the_right_lane_in_its_own_direction() {
        let row = record_at([30.0, -1.0, 0.2]);
        assert_eq!((row.frame, row.agent.as_str()), (3, "vehicle_1"));
        assert_eq!((row.road_id.as_str(), row.section_id, row.lane_id), ("7", 0, -1));
        assert!((row.s_m - 30.0).abs() < 1e-6 && (row.lane_width_m - 3.5).abs() < 1e-9);
        assert!((row.xyz_m[1] + 1.75).abs() < 1e-6 && row.rpy_rad[2].abs() < 1e-9);
        assert_eq!((row.left_marking_type.as_str(), row.left_marking_color.as_str()), ("Broken", "Yellow"));
        assert_eq!((row.right_marking_type.as_str(), row.right_marking_color.as_str()), ("Solid", "White"));
        assert_eq!((row.left_lane_id, row.right_lane_id), (Some(1), Some(-2)));
        assert_eq!(row.right_lane_type.as_deref(), Some("Sidewalk"));
        assert_eq!((row.is_junction, row.junction_id), (false, None));
    }

    #[test]
    fn an_oncoming_lane_has_its_own_left() {
        let row = record_at([30.0, 1.0, 0.2]);
        assert_eq!((row.lane_id, row.left_lane_id, row.right_lane_id), (1, Some(-1), Some(2)));
        assert!((row.rpy_rad[2].abs() - std::f64::consts::PI).abs() < 1e-9);
        assert_eq!(row.left_marking_type, "Broken");
    }

    #[test]
    fn decks_are_told_apart_by_height() {
        assert_eq!(record_at([50.0, -1.5, 5.5]).road_id, "9");
        assert_eq!(record_at([50.0, -1.5, 0.5]).road_id, "7");
    }

    /// A road of 100 m to the east with a sidewalk on its right and a crosswalk at 90 m, a junction of 20 m
    /// with a light for its one lane, and a road of 50 m behind it.
    const CROSSING: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="7"/>
        <road id="in" length="100" junction="-1">
          <link><successor elementType="junction" elementId="j"/></link>
          <planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
          <lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
            <right>
              <lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane>
              <lane id="-2" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane></right>
          </laneSection></lanes>
          <objects><object id="zebra" type="crosswalk" s="90" t="-2" hdg="0"><outline>
            <cornerLocal u="-2" v="-3" z="0"/><cornerLocal u="2" v="-3" z="0"/>
            <cornerLocal u="2" v="3" z="0"/><cornerLocal u="-2" v="3" z="0"/></outline></object></objects>
        </road>
        <road id="via" length="20" junction="j">
          <link><predecessor elementType="road" elementId="in" contactPoint="end"/>
            <successor elementType="road" elementId="out" contactPoint="start"/></link>
          <planView><geometry s="0" x="100" y="0" hdg="0" length="20"><line/></geometry></planView>
          <lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><link><predecessor id="-1"/><successor id="-1"/></link>
              <width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right>
          </laneSection></lanes>
          <signals><signal id="lamp" s="1" t="-5" orientation="+" dynamic="yes" type="1000001"/></signals>
        </road>
        <road id="out" length="50" junction="-1">
          <link><predecessor elementType="junction" elementId="j"/></link>
          <planView><geometry s="0" x="120" y="0" hdg="0" length="50"><line/></geometry></planView>
          <lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right>
          </laneSection></lanes>
        </road>
        <junction id="j"><connection id="0" incomingRoad="in" connectingRoad="via" contactPoint="start">
          <laneLink from="-1" to="-1"/></connection></junction></OpenDRIVE>"#;

    #[test]
    fn what_lies_ahead_is_told_with_its_distance() {
        let map = Map::new(Network::parse(CROSSING).expect("a sound map"));
        let hd_map = HdMap::new(&map);
        let record = |x: f64| {
            let pose = Pose::from_xyz_rpy([x, -1.5, 0.0], [0.0; 3]);
            hd_map.record(0, AgentId::vehicle(0), &pose).expect("there are driving lanes")
        };
        let near = |found: Option<f64>, want: f64| {
            assert!(found.is_some_and(|f| (f - want).abs() < 1e-3), "{found:?} is not {want}");
        };
        let far = record(30.0);
        assert_eq!((far.lane, far.road_id.as_str()), (1, "in"));
        assert!((far.lane_offset_m - 0.5).abs() < 1e-9);
        assert_eq!(
            (far.next_junction_id.as_deref(), far.crosswalk_id.as_deref()),
            (Some("j"), Some("zebra"))
        );
        assert_eq!(far.signal_ids, ["lamp"]);
        near(far.next_junction_m, 70.0);
        // A derived line lies half a metre before the junction.
        near(far.stop_line_m, 69.5);
        near(far.crosswalk_m, 58.0);
        // The sidewalk's border is at y = -4.
        near(far.sidewalk_m, 2.5);
        near(record(90.5).crosswalk_m, 0.0);
        assert_eq!(record(93.0).crosswalk_m, None);
        // Inside the junction and behind it nothing is ahead.
        for x in [110.0, 130.0] {
            let behind = record(x);
            assert_eq!((behind.next_junction_id, behind.stop_line_m), (None, None));
            assert!(behind.signal_ids.is_empty());
            assert_eq!(behind.is_junction, x < 120.0);
        }
        assert_eq!(record(165.0).sidewalk_m, None);
    }
}
