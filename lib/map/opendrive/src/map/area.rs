//! Areas: the ground that lanes cover, as polygons with holes.

use nalgebra::{Point2, Point3};

use super::tree::Heights;
use super::union::union;
use super::{LaneId, LaneInfo, Map};
use crate::model::LaneType;

/// Chords stay this near to the true borders, metres.
const TOLERANCE_M: f64 = 0.01;

/// A piece of ground: a polygon whose points have heights. Rings do not cross themselves or one another;
/// their first point is not repeated at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Area {
    /// The outline, counter-clockwise seen from above.
    pub outline: Vec<Point3<f64>>,
    /// Holes (islands), clockwise.
    pub holes: Vec<Vec<Point3<f64>>>,
}

impl Area {
    /// All rings, the outline first.
    pub fn rings(&self) -> impl Iterator<Item = &[Point3<f64>]> {
        std::iter::once(self.outline.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Whether a place in plan is on it.
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        self.rings().fold(false, |odd, ring| odd != ring_contains(ring, x, y))
    }

    /// Size in plan, square metres.
    #[must_use]
    pub fn size_m2(&self) -> f64 {
        self.rings().map(signed_area_m2).sum()
    }
}

/// Whether a place in plan is inside a ring.
pub(super) fn ring_contains(ring: &[Point3<f64>], x: f64, y: f64) -> bool {
    edges(ring).fold(false, |odd, (a, b)| {
        odd != ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y))
    })
}

/// Size of a ring in plan, square metres; negative where it runs clockwise.
fn signed_area_m2(ring: &[Point3<f64>]) -> f64 {
    // Seen from its first corner, so that far from the origin no digits are lost.
    let Some(o) = ring.first() else { return 0.0 };
    0.5 * edges(ring).map(|(a, b)| (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y)).sum::<f64>()
}

/// The edges of a ring, the one that closes it last.
fn edges(ring: &[Point3<f64>]) -> impl Iterator<Item = (&Point3<f64>, &Point3<f64>)> {
    ring.iter().zip(ring.iter().cycle().skip(1))
}

/// A walk for pedestrians along a road.
#[derive(Clone, Debug, PartialEq)]
pub struct Sidewalk {
    /// Index of the road.
    pub road: u32,
    /// Its lanes, ascending.
    pub lanes: Vec<LaneId>,
    /// The ground they cover.
    pub area: Area,
}

impl LaneInfo {
    /// Whether vehicles can drive on it, lawfully or not: all but walks, kerbs, medians and lanes without
    /// use.
    #[must_use]
    pub fn is_paved(&self) -> bool {
        let unpaved = matches!(self.lane_type, LaneType::None | LaneType::Median | LaneType::Curb);
        !unpaved && !self.lane_type.is_walkable()
    }
}

impl Map {
    /// The ground that some lanes cover together, in plan; heights are those of the nearest lane border.
    ///
    /// Vertices lie within 1 cm of the true borders. Cracks of up to 6 cm between lanes are closed, and holes
    /// smaller than 10 cm by 10 cm are filled. Decks that lie over one another become one area. Computed anew
    /// by every call.
    #[must_use]
    pub fn lanes_area(&self, lanes: &[LaneId]) -> Vec<Area> {
        let mut pieces = Vec::new();
        let mut borders = Vec::new();
        for id in lanes {
            let line = self.lane_polyline(*id, TOLERANCE_M);
            for k in 1..line.s.len() {
                let corners = [line.right[k - 1], line.right[k], line.left[k], line.left[k - 1]];
                pieces.push(corners.map(|p| p.xy()));
                borders.push([line.left[k - 1], line.left[k]]);
                borders.push([line.right[k - 1], line.right[k]]);
            }
        }
        let Some(origin) = pieces.first().map(|p| p[0].map(f64::round)) else { return Vec::new() };
        let heights = Heights::new(borders);
        let lift = |ring: Vec<Point2<f64>>| {
            ring.into_iter().map(|p| Point3::new(p.x, p.y, heights.at(p.x, p.y))).collect()
        };
        let areas = union(&pieces, origin).into_iter().filter_map(|rings| {
            let mut rings = rings.into_iter().map(lift);
            Some(Area { outline: rings.next()?, holes: rings.collect() })
        });
        areas.collect()
    }

    /// The paved ground of a junction: all lanes of its connecting roads but sidewalks, kerbs, medians and
    /// lanes without use. What they enclose without covering it (islands) is a hole. Empty for a junction
    /// without connecting roads. [`Map::lanes_area`] says how exact it is.
    #[must_use]
    pub fn junction_area(&self, junction: usize) -> Vec<Area> {
        let Some(info) = self.junctions.get(junction) else { return Vec::new() };
        let paved = |id: &LaneId| self.lane(*id).is_some_and(LaneInfo::is_paved);
        self.lanes_area(&info.lanes.iter().copied().filter(paved).collect::<Vec<_>>())
    }

    /// The sidewalks of a road, those of its sections joined where they go on from one section to the next;
    /// by their first lane. Heights are those of the road's surface ([`Map::lane_height`] tells of kerbs).
    #[must_use]
    pub fn sidewalks(&self, road: u32) -> Vec<Sidewalk> {
        let mut groups: Vec<Vec<LaneId>> = Vec::new();
        for section in 0..self.section_count(road) as u16 {
            for lane in self.lanes_of(road, section).iter().filter(|l| l.lane_type.is_walkable()) {
                let (joined, others): (Vec<_>, Vec<_>) =
                    groups.into_iter().partition(|g| g.iter().any(|other| self.goes_on(*other, lane.id)));
                groups = others;
                let whole = joined.into_iter().flatten().chain([lane.id]).collect();
                groups.push(whole);
            }
        }
        for group in &mut groups {
            group.sort();
        }
        groups.sort();
        let areas = groups.into_iter().flat_map(|lanes| {
            let areas = self.lanes_area(&lanes);
            areas.into_iter().map(move |area| Sidewalk { road, lanes: lanes.clone(), area })
        });
        areas.collect()
    }

    /// Whether two lanes of one road lie side by side in one section, or touch where their sections meet.
    fn goes_on(&self, a: LaneId, b: LaneId) -> bool {
        if a.section == b.section {
            return self.left_of(a) == Some(b) || self.right_of(a) == Some(b);
        }
        if a.section + 1 != b.section {
            return false;
        }
        let end = |id: LaneId, at_end: bool| {
            let info = self.lane(id)?;
            let profile = self.profile(id, if at_end { info.s_end } else { info.s_start })?;
            let (inner, outer) = (profile.inner.0, profile.outer.0);
            Some([inner.min(outer), inner.max(outer)])
        };
        match (end(a, true), end(b, false)) {
            (Some(a), Some(b)) => a[1].min(b[1]) - a[0].max(b[0]) > 0.0,
            _ => false,
        }
    }
}
