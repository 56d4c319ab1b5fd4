//! What a [`Map`](super::Map) answers with.

use frames::{Object as ObjectFrame, Pose, World};
use nalgebra::{Point3, Vector3};

use crate::model::{LaneChange, LaneType, MarkColour, MarkType, Orientation};

/// Names a lane: the index of its road in [`Network::roads`](crate::Network::roads), the index of its
/// section, and its id there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LaneId {
    /// Index of the road.
    pub road: u32,
    /// Index of the lane section.
    pub section: u16,
    /// Id of the lane; never 0 (the centre lane has no surface).
    pub lane: i16,
}

/// The lasting facts of a lane.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneInfo {
    /// Its name.
    pub id: LaneId,
    /// What it is for.
    pub lane_type: LaneType,
    /// First s of its section, metres along the road.
    pub s_start: f64,
    /// Last s of its section: the largest number below the next section's start, or the road's length.
    pub s_end: f64,
    /// Length along the lane's centre line in three dimensions, metres (sampled to a centimetre).
    pub length_m: f64,
    /// Direction of travel: +1.0 along s, -1.0 against.
    pub direction: f64,
    /// Whether it is travelled both ways (then `direction` is the one its side suggests).
    pub both_ways: bool,
    /// Index of the junction its road belongs to.
    pub junction: Option<usize>,
    /// Speed limit at the middle of the lane, m/s; a connecting road without one takes that of the lane
    /// before it.
    pub speed_limit_mps: Option<f64>,
    /// Smallest and largest width over the samples of the lane, metres.
    pub width_range_m: [f64; 2],
}

impl LaneInfo {
    /// Length of the s interval, metres: the largest `along_m` of a [`LanePos`] on this lane.
    #[must_use]
    pub fn s_length(&self) -> f64 {
        self.s_end - self.s_start
    }

    /// The s that lies `along_m` after the lane's beginning in the direction of travel.
    #[must_use]
    pub fn s_of_along(&self, along_m: f64) -> f64 {
        if self.direction > 0.0 {
            (self.s_start + along_m).min(self.s_end)
        } else {
            (self.s_end - along_m).max(self.s_start)
        }
    }

    /// How far an s lies after the lane's beginning in the direction of travel, metres of s.
    #[must_use]
    pub fn along_of_s(&self, s: f64) -> f64 {
        if self.direction > 0.0 { s - self.s_start } else { self.s_end - s }
    }
}

/// A place on a lane, by its way from the lane's beginning.
///
/// `along_m` counts metres **of the reference line's s** from where travel enters the lane. On a curve
/// the lane's own arc length differs from it; see [`LanePoint::metres_per_s`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LanePos {
    /// The lane.
    pub lane: LaneId,
    /// Metres of s from the lane's beginning, in the direction of travel.
    pub along_m: f64,
}

/// A point of a lane's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LanePoint {
    /// In the world.
    pub position: Point3<f64>,
    /// Direction of travel, radians from east, counter-clockwise.
    pub heading_rad: f64,
    /// Pitch in the direction of travel, radians, positive nose down (as [`Pose::from_xyz_rpy`] takes it).
    pub pitch_rad: f64,
    /// Roll about the direction of travel, radians, positive right side down.
    pub roll_rad: f64,
    /// Width of the lane here, metres.
    pub width_m: f64,
    /// Metres of way along the lane per metre of s here.
    pub metres_per_s: f64,
}

impl LanePoint {
    /// The pose of a body that stands here, facing the direction of travel.
    #[must_use]
    pub fn pose(&self) -> Pose<World, ObjectFrame> {
        Pose::from_xyz_rpy(self.position.coords.into(), [self.roll_rad, self.pitch_rad, self.heading_rad])
    }
}

/// The two borders of a lane at some s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneBounds {
    /// Nearer to the centre lane.
    pub inner: Point3<f64>,
    /// Farther from it.
    pub outer: Point3<f64>,
    /// Left of the direction of travel (one of the two).
    pub left: Point3<f64>,
    /// Right of the direction of travel.
    pub right: Point3<f64>,
}

/// The nearest place of a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneHit {
    /// The lane.
    pub lane: LaneId,
    /// Where along its road, metres.
    pub s: f64,
    /// The query point's offset from the lane's centre, metres, positive to the left of the direction of
    /// travel.
    pub t_m: f64,
    /// Distance from the query point to the lane's centre line, metres, in three dimensions.
    pub distance_m: f64,
    /// Width of the lane there, metres.
    pub width_m: f64,
}

impl LaneHit {
    /// Whether the query point is over (or under) the lane's surface.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        self.t_m.abs() <= 0.5 * self.width_m
    }
}

/// A lane sampled along its length.
///
/// `left` and `right` are seen in the direction of **increasing s** (left: larger t), and samples run with s,
/// so that neighbouring strips of a section share their vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LanePolyline {
    /// s of the samples, ascending.
    pub s: Vec<f64>,
    /// Border with the larger t.
    pub left: Vec<Point3<f64>>,
    /// Middle.
    pub centre: Vec<Point3<f64>>,
    /// Border with the smaller t.
    pub right: Vec<Point3<f64>>,
}

/// A marking beside a lane, as an HD-map record names it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Marking {
    /// Its kind.
    pub mark_type: MarkType,
    /// Its colour.
    pub colour: MarkColour,
    /// Width of a line, metres (0 where nothing is painted).
    pub width_m: f64,
    /// Which crossings of it are allowed, left and right seen in the lane's direction of travel.
    pub lane_change: LaneChange,
}

/// One painted line of a marking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripe {
    /// Index of the road.
    pub road: u32,
    /// Index of the section.
    pub section: u16,
    /// The lane whose outer border carries it; 0 is the centre lane.
    pub border_of: i16,
    /// First s, metres along the road.
    pub s_start: f64,
    /// Last s.
    pub s_end: f64,
    /// Kind of the marking the line belongs to.
    pub mark_type: MarkType,
    /// Colour.
    pub colour: MarkColour,
    /// Width of this line, metres.
    pub width_m: f64,
    /// Middle of the line, metres to the left of the border (looking along s).
    pub t_offset_m: f64,
    /// Painted and unpainted metres for a dashed line; none for a continuous one.
    pub dash: Option<[f64; 2]>,
}

/// A painted area: a strip between two chains of equally many points that run with s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripeStrip {
    /// Edge with the larger t.
    pub left: Vec<Point3<f64>>,
    /// Edge with the smaller t.
    pub right: Vec<Point3<f64>>,
}

impl StripeStrip {
    /// Its outline, counter-clockwise seen from above; the first point is not repeated.
    #[must_use]
    pub fn polygon(&self) -> Vec<Point3<f64>> {
        self.right.iter().chain(self.left.iter().rev()).copied().collect()
    }
}

/// A pedestrian crossing.
#[derive(Clone, Debug, PartialEq)]
pub struct Crosswalk {
    /// Index into [`Map::objects`](super::Map::objects).
    pub object: usize,
    /// Its id in the file.
    pub id: String,
    /// Index of the road it is given on.
    pub road: u32,
    /// Metres along that road.
    pub s: f64,
    /// Corners, each once, on the road surface.
    pub polygon: Vec<Point3<f64>>,
}

/// An outline of an object, in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutlineInfo {
    /// Whether the last corner joins the first.
    pub closed: bool,
    /// Bottom corners, each once.
    pub base: Vec<Point3<f64>>,
    /// Height of the object at each corner, metres.
    pub height_m: Vec<f64>,
}

/// Areas with more corners than this are not told: to cut them to triangles takes time by the square.
const MOST_CORNERS: usize = 2000;

/// An object, in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectInfo {
    /// Its id in the file.
    pub id: String,
    /// Name.
    pub name: String,
    /// Type as written: `crosswalk`, `pole`, `parkingSpace`, `-1`, ...
    pub kind: String,
    /// Index of its road.
    pub road: u32,
    /// Index in [`Road::objects`](crate::Road::objects).
    pub index: usize,
    /// Metres along the road.
    pub s: f64,
    /// Metres to the left of the reference line.
    pub t: f64,
    /// Where it stands: middle of its base, its x along its own heading.
    pub pose: Pose<World, ObjectFrame>,
    /// Length, width, height in metres, 0 where the file gives none (a radius counts as half of length and
    /// width).
    pub size_m: Vector3<f64>,
    /// Traffic it is for.
    pub orientation: Orientation,
    /// Its outlines.
    pub outlines: Vec<OutlineInfo>,
}

impl ObjectInfo {
    /// Whether it is water. OpenDRIVE has no type for it: type or name contain `water`, `river`, `lake`,
    /// `pond` or `canal`.
    #[must_use]
    pub fn is_water(&self) -> bool {
        let (kind, name) = (self.kind.to_ascii_lowercase(), self.name.to_ascii_lowercase());
        ["water", "river", "lake", "pond", "canal"].iter().any(|w| kind.contains(w) || name.contains(w))
    }

    /// Whether it is an arrow painted on the road: of type `roadMark`, with `arrow` in its name.
    #[must_use]
    pub fn is_arrow(&self) -> bool {
        self.kind.eq_ignore_ascii_case("roadMark") && self.name.to_ascii_lowercase().contains("arrow")
    }

    /// The areas that it covers on the ground, corners each once: its outlines (those of up to 2,000 corners:
    /// nothing that is painted has more), or the rectangle of its length and width where it has no outline.
    #[must_use]
    pub fn areas(&self) -> Vec<Vec<Point3<f64>>> {
        let rings = self.outlines.iter().map(|outline| &outline.base);
        let mut areas: Vec<Vec<Point3<f64>>> =
            rings.filter(|r| (3..=MOST_CORNERS).contains(&r.len())).cloned().collect();
        if self.outlines.iter().all(|outline| outline.base.len() < 3) {
            let (x, y) = (0.5 * self.size_m.x, 0.5 * self.size_m.y);
            let corner = |[x, y]: [f64; 2]| self.pose * Point3::new(x, y, 0.0);
            areas.push([[x, y], [-x, y], [-x, -y], [x, -y]].map(corner).to_vec());
        }
        areas
    }
}

/// A traffic light or sign, in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalInfo {
    /// Its id in the file.
    pub id: String,
    /// Name.
    pub name: String,
    /// Index of the road it stands at.
    pub road: u32,
    /// Index in [`Road::signals`](crate::Road::signals).
    pub index: usize,
    /// Metres along the road.
    pub s: f64,
    /// Metres to the left of the reference line.
    pub t: f64,
    /// Origin: at (s, t), raised by the file's vertical offset. Its x axis is the direction of the traffic it
    /// is for; lamps and faces look the other way. Upright (roll and pitch of the file are left out).
    pub pose: Pose<World, ObjectFrame>,
    /// The point of the road's (extended) surface under it.
    pub on_surface: Point3<f64>,
    /// Whether its state changes.
    pub dynamic: bool,
    /// Type in the catalogue of its country.
    pub kind: String,
    /// Subtype.
    pub subtype: String,
    /// Value, if stated.
    pub value: Option<f64>,
    /// Height and width in metres, where stated.
    pub size_m: [Option<f64>; 2],
    /// Lanes it controls, sorted.
    pub lanes: Vec<LaneId>,
    /// Index of the junction it belongs to: that of a lane it controls, or of its controller.
    pub junction: Option<usize>,
}

/// The signal program of a junction: which signals show the same, and in which order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalGroup {
    /// Index of the junction.
    pub junction: usize,
    /// Its controllers, by sequence, then in file order.
    pub controllers: Vec<GroupController>,
}

/// Signals that always show the same.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupController {
    /// Id of the controller in the file.
    pub id: String,
    /// Name.
    pub name: String,
    /// Place in the cycle, if stated.
    pub sequence: Option<u32>,
    /// Indices into [`Map::signals`](super::Map::signals), ascending.
    pub signals: Vec<usize>,
}

/// A junction, in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct JunctionInfo {
    /// Its id in the file.
    pub id: String,
    /// Index in [`Network::junctions`](crate::Network::junctions).
    pub index: usize,
    /// Indices of its connecting roads, ascending.
    pub roads: Vec<u32>,
    /// All lanes of its connecting roads, ascending.
    pub lanes: Vec<LaneId>,
    /// Drivable lanes outside it that lead into it, ascending.
    pub incoming: Vec<LaneId>,
    /// Middle of the bounding box of its lanes' surfaces.
    pub centre: Point3<f64>,
    /// Corners of that box.
    pub bounds: [Point3<f64>; 2],
    /// Indices of the signals that control its lanes, ascending.
    pub signals: Vec<usize>,
}
