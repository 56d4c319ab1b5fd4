//! The lane of an agent.

use frames::{Pose, World, deg};
use nalgebra::Point3;
use schema::tables::HdMapRow;

use crate::error::SourceFault;
use crate::value::Value;

/// A row of `hd_map` of a record of the layout.
///
/// # Errors
/// The key that is missing or of another type.
pub(crate) fn row(
    record: &Value,
    (frame, agent): (u32, &str),
    agent_xyz_m: [f64; 3],
) -> Result<HdMapRow, SourceFault> {
    let wrong = |key: &str| format!("has no such `{key}` as a store can hold");
    let number = |of: &Value, key: &str| {
        of.get(key).and_then(Value::number).filter(|v| v.is_finite()).ok_or_else(|| wrong(key))
    };
    let word = |of: &Value, key: &str| {
        of.get(key).and_then(Value::text).map(str::to_owned).ok_or_else(|| wrong(key))
    };
    let id = |key: &str| match record.get(key) {
        Some(Value::Text(text)) => Some(text.clone()),
        Some(Value::Int(number)) => Some(number.to_string()),
        _ => None,
    };
    let whole = |of: &Value, key: &str| of.get(key).and_then(Value::whole::<i32>).ok_or_else(|| wrong(key));
    let place = record.get("transform").ok_or_else(|| wrong("transform"))?;
    let xyz_m = [number(place, "x")?, number(place, "y")?, number(place, "z")?];
    let rpy_rad = [number(place, "roll")?, number(place, "pitch")?, number(place, "yaw")?].map(deg);
    let mut row = HdMapRow {
        frame,
        agent: agent.to_owned(),
        lane: record.get("id").and_then(Value::whole).unwrap_or(0),
        road_id: id("road_id").ok_or_else(|| wrong("road_id"))?,
        section_id: record.get("section_id").and_then(Value::whole).ok_or_else(|| wrong("section_id"))?,
        lane_id: whole(record, "lane_id")?,
        s_m: number(record, "s")?,
        lane_type: word(record, "lane_type")?,
        lane_width_m: number(record, "lane_width")?,
        lane_change: word(record, "lane_change")?,
        is_junction: record.get("is_junction").and_then(Value::flag).ok_or_else(|| wrong("is_junction"))?,
        junction_id: id("junction_id"),
        xyz_m,
        rpy_rad,
        lane_offset_m: offset_m(xyz_m, rpy_rad, agent_xyz_m),
        ..HdMapRow::default()
    };
    for (is_left, name) in [(true, "left_lane_marking"), (false, "right_lane_marking")] {
        let mark = record.get(name).ok_or_else(|| wrong(name))?;
        let (kind, width) = (word(mark, "type")?, number(mark, "width")?);
        let (color, change) = (word(mark, "color")?, word(mark, "lane_change")?);
        if is_left {
            (row.left_marking_type, row.left_marking_width_m) = (kind, width);
            (row.left_marking_color, row.left_marking_lane_change) = (color, change);
        } else {
            (row.right_marking_type, row.right_marking_width_m) = (kind, width);
            (row.right_marking_color, row.right_marking_lane_change) = (color, change);
        }
    }
    for (is_left, name) in [(true, "left_lane"), (false, "right_lane")] {
        let lane = record.get(name).ok_or_else(|| wrong(name))?;
        if matches!(lane, Value::Dict(entries) if entries.is_empty()) {
            continue;
        }
        let (id, kind) = (Some(whole(lane, "lane_id")?), Some(word(lane, "lane_type")?));
        let (width, change) = (Some(number(lane, "lane_width")?), Some(word(lane, "lane_change")?));
        if is_left {
            (row.left_lane_id, row.left_lane_type) = (id, kind);
            (row.left_lane_width_m, row.left_lane_change) = (width, change);
        } else {
            (row.right_lane_id, row.right_lane_type) = (id, kind);
            (row.right_lane_width_m, row.right_lane_change) = (width, change);
        }
    }
    Ok(row)
}

/// How far the agent is to the left of the lane's centre.
fn offset_m(lane_xyz_m: [f64; 3], lane_rpy_rad: [f64; 3], agent_xyz_m: [f64; 3]) -> f64 {
    let lane = Pose::<World, frames::Object>::from_xyz_rpy(lane_xyz_m, lane_rpy_rad).inverse();
    let [x, y, z] = agent_xyz_m;
    (lane * Point3::new(x, y, z)).y
}
