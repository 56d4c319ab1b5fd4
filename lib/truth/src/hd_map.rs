//! HD-map records: the lane an agent is in.

use frames::{Agent, Pose, World, wrap_pi};
use nalgebra::Point3;
use opendrive::{LaneId, Map};
use schema::AgentId;
use schema::tables::HdMapRow;

/// The record of the driving lane nearest to an agent's origin (in three dimensions, so that decks are told
/// apart). None only on a map without driving lanes.
///
/// Left and right are seen in the lane's direction of travel; neighbours are the adjacent lanes of any type.
#[must_use]
pub fn record(
    map: &Map,
    frame: u32,
    agent: AgentId,
    world_from_agent: &Pose<World, Agent>,
) -> Option<HdMapRow> {
    let hit = map.nearest_driving_lane(Point3::from(world_from_agent.translation()))?;
    let (id, s) = (hit.lane, hit.s);
    let lane = map.lane(id)?;
    let point = map.lane_point(id, s, 0.0)?;
    let road = map.network().roads.get(id.road as usize)?;
    let (left_mark, right_mark) = (map.left_marking(id, s), map.right_marking(id, s));
    let left = map.left_of(id).and_then(|id| Neighbour::new(map, id, s));
    let right = map.right_of(id).and_then(|id| Neighbour::new(map, id, s));
    Some(HdMapRow {
        frame,
        agent: agent.to_string(),
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
    })
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
        record(&map, 3, AgentId::vehicle(1), &Pose::from_xyz_rpy(xyz_m, [0.0; 3]))
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
}
