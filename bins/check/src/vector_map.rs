//! The vector map of a scene's map: lanes, walks and lines as polygons and chains of points.

use std::path::Path;

use crate::files::{Batch, Table, Unreadable};
use crate::space::V3;

/// Types of lanes that are no asphalt.
const UNPAVED: [&str; 8] = ["NONE", "Median", "Curb", "Sidewalk", "Walking", "Rail", "Tram", "Restricted"];
/// Types of lanes for pedestrians.
const WALKS: [&str; 2] = ["Sidewalk", "Walking"];

/// What of a map lies on the ground, in the world.
#[derive(Debug, Default)]
pub(crate) struct VectorMap {
    /// Paved lanes, piece by piece: from one point of their boundaries to the next, so that heights are those
    /// of the place.
    pub(crate) lanes: Vec<Shape>,
    /// The same of lanes for pedestrians.
    pub(crate) walks: Vec<Shape>,
    pub(crate) junctions: Vec<Shape>,
    pub(crate) sidewalks: Vec<Shape>,
    pub(crate) crosswalks: Vec<Shape>,
    pub(crate) dividers: Vec<Line>,
    pub(crate) stop_lines: Vec<Line>,
}

/// An area: rings of points, the outline and its holes.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) rings: Vec<Vec<V3>>,
    /// Least and greatest x and y.
    pub(crate) bounds: [[f64; 2]; 2],
}

/// A chain of points.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) points: Vec<V3>,
    pub(crate) bounds: [[f64; 2]; 2],
    /// Whether it is surely painted: beside a driving lane and in no junction, where others' asphalt may lie
    /// over it.
    pub(crate) is_certain: bool,
}

fn bounds<'a>(points: impl Iterator<Item = &'a V3>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

impl Shape {
    fn new(rings: Vec<Vec<V3>>) -> Self {
        let bounds = bounds(rings.iter().flatten());
        Self { rings, bounds }
    }
}

/// An element of the table.
struct Element {
    kind: String,
    points: Vec<V3>,
    rings: Vec<usize>,
    lane_type: String,
    boundaries: Vec<usize>,
    lanes: Vec<usize>,
    is_junction: bool,
}

impl VectorMap {
    /// Reads `maps/NAME.vector.parquet`.
    pub(crate) fn open(path: &Path) -> Result<Self, Unreadable> {
        let mut elements = Vec::new();
        for rows in Table::open(path)?.batches()? {
            read(&rows, &mut elements)?;
        }
        Self::of(&elements).ok_or_else(|| {
            Unreadable::new(
                path,
                "names elements that it has not, or lanes whose boundaries have unlike numbers of points",
            )
        })
    }

    fn of(elements: &[Element]) -> Option<Self> {
        let mut map = Self::default();
        for element in elements {
            match element.kind.as_str() {
                "lane_centreline" => {
                    let [left, right] = *element.boundaries.as_slice() else { continue };
                    let pieces = pieces(&elements.get(left)?.points, &elements.get(right)?.points)?;
                    if WALKS.contains(&element.lane_type.as_str()) {
                        map.walks.extend(pieces);
                    } else if !UNPAVED.contains(&element.lane_type.as_str()) {
                        map.lanes.extend(pieces);
                    }
                }
                "sidewalk" => map.sidewalks.push(element.shape()?),
                "crosswalk" => map.crosswalks.push(element.shape()?),
                "junction" => map.junctions.push(element.shape()?),
                "divider" => {
                    let drives =
                        |lane: &usize| elements.get(*lane).is_some_and(|lane| lane.lane_type == "Driving");
                    let is_certain = !element.is_junction && element.lanes.iter().any(drives);
                    map.dividers.push(element.line(is_certain));
                }
                "stop_line" => map.stop_lines.push(element.line(true)),
                _ => {}
            }
        }
        Some(map)
    }
}

/// The pieces between two boundaries of a section, whose points are at the same places along the road; none
/// if they are not.
fn pieces(left: &[V3], right: &[V3]) -> Option<Vec<Shape>> {
    let pairs = left.windows(2).zip(right.windows(2));
    let piece = |(left, right): (&[V3], &[V3])| Shape::new(vec![vec![left[0], left[1], right[1], right[0]]]);
    (left.len() == right.len()).then(|| pairs.map(piece).collect())
}

impl Element {
    fn shape(&self) -> Option<Shape> {
        let ends = self.rings.iter().skip(1).copied().chain([self.points.len()]);
        let rings = self.rings.iter().zip(ends).map(|(&from, to)| Some(self.points.get(from..to)?.to_vec()));
        Some(Shape::new(rings.collect::<Option<_>>()?))
    }

    fn line(&self, is_certain: bool) -> Line {
        Line { points: self.points.clone(), bounds: bounds(self.points.iter()), is_certain }
    }
}

fn read(rows: &Batch, elements: &mut Vec<Element>) -> Result<(), Unreadable> {
    let (kinds, lane_types) = (rows.texts("kind")?, rows.maybe_texts("lane_type")?);
    let (x, y, z) = (rows.real_lists("x_m")?, rows.real_lists("y_m")?, rows.real_lists("z_m")?);
    let numbers = |name: &str| -> Result<Vec<Vec<usize>>, Unreadable> {
        let lists = rows.int_lists(name)?.into_iter();
        Ok(lists.map(|list| list.into_iter().map(|n| usize::try_from(n).unwrap_or(0)).collect()).collect())
    };
    let (mut rings, mut boundaries, mut lanes) =
        (numbers("rings")?, numbers("boundaries")?, numbers("lanes")?);
    let is_junction = rows.flags("is_junction")?;
    for (k, (kind, lane_type)) in kinds.into_iter().zip(lane_types).enumerate() {
        let points = x[k].iter().zip(&y[k]).zip(&z[k]).map(|((x, y), z)| [*x, *y, *z]).collect();
        elements.push(Element {
            kind,
            points,
            rings: std::mem::take(&mut rings[k]),
            lane_type: lane_type.unwrap_or_default(),
            boundaries: std::mem::take(&mut boundaries[k]),
            lanes: std::mem::take(&mut lanes[k]),
            is_junction: is_junction[k],
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(kind: &str, points: &[V3]) -> Element {
        Element {
            kind: kind.into(),
            points: points.to_vec(),
            rings: Vec::new(),
            lane_type: String::new(),
            boundaries: Vec::new(),
            lanes: Vec::new(),
            is_junction: false,
        }
    }

    #[test]
    fn lanes_lie_between_their_boundaries_and_areas_have_holes() {
        let (a, b, c) = ([0.0, 0.0, 1.0], [9.0, 0.0, 1.0], [9.0, 3.0, 1.0]);
        let (left, right) = ([[0.0, 3.0, 1.0], [5.0, 3.0, 2.0], c], [a, [5.0, 0.0, 2.0], b]);
        let lane = |lane_type: &str| Element {
            lane_type: lane_type.into(),
            boundaries: vec![3, 4],
            ..element("lane_centreline", &[a, b])
        };
        let divider = |lanes: &[usize]| Element { lanes: lanes.to_vec(), ..element("divider", &[a, b]) };
        let mut elements = vec![lane("Driving"), lane("Sidewalk"), lane("Median")];
        elements.extend([left, right].map(|points| element("lane_boundary", &points)));
        elements.push(Element { rings: vec![0, 4], ..element("junction", &[a, b, c, a, a, c, b, a]) });
        elements.extend([divider(&[0, 1]), divider(&[1])]);
        let map = VectorMap::of(&elements).expect("is one");
        assert_eq!((map.lanes.len(), map.walks.len(), map.junctions.len()), (2, 2, 1));
        assert_eq!(map.lanes[1].rings, [vec![left[1], c, b, right[1]]]);
        assert_eq!(map.lanes[1].bounds, [[5.0, 0.0], [9.0, 3.0]]);
        assert_eq!(map.junctions[0].rings, [vec![a, b, c, a], vec![a, c, b, a]]);
        assert_eq!(map.dividers.iter().map(|line| line.is_certain).collect::<Vec<_>>(), [true, false]);
        elements[3].points.pop();
        assert!(VectorMap::of(&elements).is_none(), "boundaries of unlike length");
        elements[0].boundaries[1] = 99;
        assert!(VectorMap::of(&elements).is_none());
    }
}
