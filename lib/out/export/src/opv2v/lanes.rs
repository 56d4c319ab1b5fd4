//! Lane boundaries of a map.

use schema::tables::VectorMapRow;
use store::{Scope, Store, keys};

use crate::ExportError;

/// Lanes of ordinary traffic.
const DRIVEN: [&str; 6] = ["Driving", "Bidirectional", "Entry", "Exit", "OnRamp", "OffRamp"];

schema::columns! {
    /// Boundaries, and what the lanes beside them are.
    MapLine of VectorMapRow {
        kind: String,
        x_m: Vec<f64>,
        y_m: Vec<f64>,
        z_m: Vec<f64>,
        lane_type: Option<String>,
        is_junction: bool,
        lanes: Vec<u32>,
    }
}

/// The boundaries of the lanes of ordinary traffic, outside of junctions.
#[derive(Clone, Debug, Default)]
pub(super) struct LaneLines(Vec<Line>);

#[derive(Clone, Debug)]
struct Line {
    points_m: Vec<[f64; 3]>,
    /// West, south, east, north.
    bounds_m: [f64; 4],
}

impl LaneLines {
    /// Those of a map of the store; none where the store has not its lines.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(super) fn read(store: &Store, map: &str) -> Result<Option<Self>, ExportError> {
        let key = keys::vector_map(map);
        let Some(plan) = store.manifest(Scope::Plan, <VectorMapRow as schema::table::Row>::STAGE)? else {
            return Ok(None);
        };
        if plan.output(&key).is_none() {
            return Ok(None);
        }
        Ok(Some(Self::of(&store.read_rows::<MapLine>(&plan, &key)?)))
    }

    fn of(rows: &[MapLine]) -> Self {
        let is_driven = |lane: &u32| {
            let lane_type = rows.get(*lane as usize).and_then(|row| row.lane_type.as_deref());
            lane_type.is_some_and(|lane_type| DRIVEN.contains(&lane_type))
        };
        let lines = rows
            .iter()
            .filter(|row| row.kind == "lane_boundary" && !row.is_junction && row.lanes.iter().any(is_driven));
        Self(lines.map(Line::of).collect())
    }

    /// Those that come within a distance of a point.
    pub(super) fn near(&self, [x, y, _]: [f64; 3], reach_m: f64) -> impl Iterator<Item = &[[f64; 3]]> {
        let meets = move |[west, south, east, north]: [f64; 4]| {
            west - reach_m < x && x < east + reach_m && south - reach_m < y && y < north + reach_m
        };
        self.0.iter().filter(move |line| meets(line.bounds_m)).map(|line| line.points_m.as_slice())
    }
}

impl Line {
    fn of(row: &MapLine) -> Self {
        let points_m = row.x_m.iter().zip(&row.y_m).zip(&row.z_m).map(|((x, y), z)| [*x, *y, *z]).collect();
        let ends = |values: &[f64]| {
            values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
        };
        let ((west, east), (south, north)) = (ends(&row.x_m), ends(&row.y_m));
        Self { points_m, bounds_m: [west, south, east, north] }
    }
}

#[cfg(test)]
mod tests {
    use frames::Pose;

    use super::*;
    use crate::opv2v::bev::{Mask, lane_picture, place};

    fn line(kind: &str, lanes: Vec<u32>, x_m: Vec<f64>, z: f64) -> MapLine {
        let y_m = vec![3.0; x_m.len()];
        MapLine { kind: kind.into(), z_m: vec![z; x_m.len()], x_m, y_m, lanes, ..MapLine::default() }
    }

    #[test]
    fn boundaries_of_driven_lanes_outside_of_junctions() {
        let lane = |lane_type: &str| MapLine { lane_type: Some(lane_type.into()), ..MapLine::default() };
        let boundary = |lanes| line("lane_boundary", lanes, vec![0.0, 10.0], 0.0);
        let inside = MapLine { is_junction: true, ..boundary(vec![0]) };
        let divider = line("divider", vec![0], vec![0.0, 10.0], 0.0);
        let rows = [
            lane("Driving"),
            lane("Sidewalk"),
            boundary(vec![0, 1]),
            boundary(vec![1]),
            inside,
            divider,
            boundary(vec![9]),
        ];
        let lines = LaneLines::of(&rows);
        assert_eq!(lines.0.len(), 1);
        assert_eq!(lines.near([5.0, 0.0, 0.0], 3.5).count(), 1);
        assert_eq!(lines.near([5.0, 0.0, 0.0], 2.5).count() + lines.near([-3.0, 3.0, 0.0], 2.5).count(), 0);
    }

    #[test]
    fn roads_above_are_not_drawn() {
        let lane = MapLine { lane_type: Some("Driving".into()), ..MapLine::default() };
        let points: Vec<f64> = (0..20).map(f64::from).collect();
        let at = |z| LaneLines::of(&[lane.clone(), line("lane_boundary", vec![0], points.clone(), z)]);
        let agent = Pose::from_xyz_rpy([0.0, 0.0, 10.0], [0.0; 3]);
        assert_eq!(lane_picture(&at(15.0), &agent), Mask::new());
        let mut expected = Mask::new();
        expected.line(place(&agent, [0.0, 3.0, 0.0]), place(&agent, [19.0, 3.0, 0.0]));
        assert_eq!(lane_picture(&at(10.5), &agent), expected);
    }
}
