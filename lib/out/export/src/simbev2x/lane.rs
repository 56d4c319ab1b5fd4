//! The lane of an agent as a record of the layout.

use std::collections::BTreeMap;

use schema::tables::{HdMapRow, VectorMapRow};

use super::pytext::Node;

schema::columns! {
    /// Which number a lane has.
    LaneNumber of VectorMapRow {
        id: u32, kind: String, road_id: Option<String>, section_id: Option<i32>, lane_id: Option<i32>,
    }
}

/// Numbers of lanes by road, section and OpenDRIVE id.
#[derive(Default)]
pub(super) struct LaneNumbers(BTreeMap<(String, i32, i32), u32>);

impl LaneNumbers {
    /// Of the rows of a map's elements.
    pub(super) fn new(rows: Vec<LaneNumber>) -> Self {
        let lanes = rows.into_iter().filter(|row| row.kind == "lane_centreline");
        let named = lanes.filter_map(|row| Some(((row.road_id?, row.section_id?, row.lane_id?), row.id)));
        Self(named.collect())
    }

    /// The record of a row.
    pub(super) fn record(&self, row: &HdMapRow) -> Node {
        let [x, y, z] = row.xyz_m;
        let [roll, pitch, yaw] = row.rpy_rad.map(frames::to_deg);
        let marking = |kind: &str, width: f64, color: &str, change: &str| {
            Node::object([
                ("type", Node::text(kind)),
                ("width", Node::Float(width)),
                ("color", Node::text(color)),
                ("lane_change", Node::text(change)),
            ])
        };
        let beside = |id: Option<i32>, kind: &Option<String>, width: Option<f64>, change: &Option<String>| {
            let Some(lane_id) = id else { return Node::object::<&str>([]) };
            let key = (row.road_id.clone(), row.section_id as i32, lane_id);
            Node::object([
                ("id", Node::from(self.0.get(&key).copied())),
                ("s", Node::Float(row.s_m)),
                ("road_id", number(&row.road_id)),
                ("section_id", Node::from(row.section_id)),
                ("lane_id", Node::Int(i128::from(lane_id))),
                ("lane_type", Node::text(kind.as_deref().unwrap_or("NONE"))),
                ("lane_width", Node::Float(width.unwrap_or(0.0))),
                ("lane_change", Node::text(change.as_deref().unwrap_or("NONE"))),
            ])
        };
        let transform = [("x", x), ("y", y), ("z", z), ("roll", roll), ("pitch", pitch), ("yaw", yaw)];
        let left = (&row.left_lane_type, row.left_lane_width_m, &row.left_lane_change);
        let right = (&row.right_lane_type, row.right_lane_width_m, &row.right_lane_change);
        Node::object([
            ("id", Node::from(row.lane)),
            ("s", Node::Float(row.s_m)),
            ("road_id", number(&row.road_id)),
            ("section_id", Node::from(row.section_id)),
            ("lane_id", Node::Int(i128::from(row.lane_id))),
            ("lane_type", Node::text(&row.lane_type)),
            ("lane_width", Node::Float(row.lane_width_m)),
            ("lane_change", Node::text(&row.lane_change)),
            ("is_junction", Node::from(row.is_junction)),
            (
                "junction_id",
                row.junction_id.as_deref().filter(|_| row.is_junction).map_or(Node::Null, number),
            ),
            ("is_intersection", Node::from(row.is_junction)),
            ("transform", Node::object(transform.map(|(key, value)| (key, Node::Float(value))))),
            (
                "left_lane_marking",
                marking(
                    &row.left_marking_type,
                    row.left_marking_width_m,
                    &row.left_marking_color,
                    &row.left_marking_lane_change,
                ),
            ),
            ("left_lane", beside(row.left_lane_id, left.0, left.1, left.2)),
            (
                "right_lane_marking",
                marking(
                    &row.right_marking_type,
                    row.right_marking_width_m,
                    &row.right_marking_color,
                    &row.right_marking_lane_change,
                ),
            ),
            ("right_lane", beside(row.right_lane_id, right.0, right.1, right.2)),
        ])
    }
}

/// An OpenDRIVE id: a number in the layout; text where the map's is none.
fn number(id: &str) -> Node {
    id.parse().map_or_else(|_| Node::text(id), Node::Int)
}
