//! Vector maps for learners: a road network as lines and polygons with its lane graph.
//!
//! [`rows`] turns a map into the rows of `maps/NAME.vector.parquet`
//! ([`VectorMapRow`]): plain values in and out, the same rows for the same map.
//!
//! ```
//! let map = testkit::straight(100.0);
//! let rows = labels::vector_map::rows(&map);
//! // Two driving lanes with a sidewalk beside each, one row a lane.
//! assert_eq!(rows.iter().filter(|row| row.kind == "lane_centreline").count(), 4);
//! assert!(rows.iter().zip(0..).all(|(row, number)| row.id == number));
//! ```

mod along;
mod ground;

use nalgebra::Point3;
use opendrive::{LaneId, Map};
use schema::tables::{VectorKind, VectorMapRow};

/// Chords stay within this of the true curves, metres.
const TOLERANCE_M: f64 = 0.02;

/// All elements of a map: lanes (in the order of [`Map::lanes`]), lane boundaries, signals, painted lines and
/// kerbs, crosswalks, stop lines, sidewalks, junctions. An element's number is its row.
#[must_use]
pub fn rows(map: &Map) -> Vec<VectorMapRow> {
    let table = Table::new(map);
    let mut rows = table.lanes();
    rows.extend(table.boundaries());
    rows.extend(table.signals());
    rows.extend(table.lines(VectorKind::Divider));
    rows.extend(table.lines(VectorKind::Kerb));
    rows.extend(table.crosswalks());
    rows.extend(table.stop_lines());
    rows.extend(table.sidewalks());
    rows.extend(table.junctions());
    for (i, row) in rows.iter_mut().enumerate() {
        row.id = i as u32;
    }
    rows
}

/// A map with the numbers that its elements get.
struct Table<'m> {
    map: &'m Map,
    /// For each road, the number of the first boundary of each of its sections.
    first_boundary: Vec<Vec<u32>>,
    first_signal: u32,
}

impl<'m> Table<'m> {
    fn new(map: &'m Map) -> Self {
        let mut next = map.lanes().len() as u32;
        let mut first_boundary = Vec::with_capacity(map.network().roads.len());
        for road in 0..map.network().roads.len() as u32 {
            let mut firsts = Vec::with_capacity(map.section_count(road));
            for section in 0..map.section_count(road) as u16 {
                firsts.push(next);
                next += boundary_count(map, road, section);
            }
            first_boundary.push(firsts);
        }
        Self { map, first_boundary, first_signal: next }
    }

    /// An element with nothing but its kind and the points of a line.
    fn line(kind: VectorKind, points: &[Point3<f64>]) -> VectorMapRow {
        let mut row = VectorMapRow { kind: kind.name().to_owned(), ..VectorMapRow::default() };
        push(&mut row, points);
        // A line of one point is none: what has no length gets its point twice.
        if points.len() == 1 && kind != VectorKind::Signal {
            push(&mut row, points);
        }
        row
    }

    /// Numbers of lanes, ascending.
    fn numbers<'a>(&self, lanes: impl IntoIterator<Item = &'a LaneId>) -> Vec<u32> {
        let mut numbers: Vec<u32> = lanes.into_iter().filter_map(|id| self.number(*id)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    fn number(&self, lane: LaneId) -> Option<u32> {
        self.map.lane_number(lane).map(|i| i as u32)
    }

    fn road_id(&self, road: u32) -> Option<String> {
        self.map.network().roads.get(road as usize).map(|r| r.id.clone())
    }

    /// Numbers of signals, given by their indices in the map.
    fn signal_numbers(&self, signals: &[usize]) -> Vec<u32> {
        signals.iter().map(|i| self.first_signal + *i as u32).collect()
    }
}

/// One more boundary than lanes; none where there are no lanes.
fn boundary_count(map: &Map, road: u32, section: u16) -> u32 {
    match map.lanes_of(road, section).len() as u32 {
        0 => 0,
        lanes => lanes + 1,
    }
}

/// Appends points to an element's geometry.
fn push(row: &mut VectorMapRow, points: &[Point3<f64>]) {
    row.x_m.extend(points.iter().map(|p| p.x));
    row.y_m.extend(points.iter().map(|p| p.y));
    row.z_m.extend(points.iter().map(|p| p.z));
}
