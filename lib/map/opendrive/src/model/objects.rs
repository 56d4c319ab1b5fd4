//! Objects beside and on the road, as the file states them.

use super::{BoxSide, Element, LaneType, LaneValidity, MarkColour, Orientation};

/// Anything beside or on the road.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Object {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// `crosswalk`, `pole`, `parkingSpace`, ... or empty.
    pub kind: String,
    /// Subtype.
    pub subtype: String,
    /// Metres along the road.
    pub s: f64,
    /// Metres to the left of the reference line (the lane offset has no part in it).
    pub t: f64,
    /// Metres above the road surface.
    pub z_offset_m: f64,
    /// Heading relative to the road, radians.
    pub hdg_rad: f64,
    /// Pitch, radians.
    pub pitch_rad: f64,
    /// Roll, radians.
    pub roll_rad: f64,
    /// Traffic it is for.
    pub orientation: Orientation,
    /// Length along its own x, metres.
    pub length_m: Option<f64>,
    /// Width along its own y, metres.
    pub width_m: Option<f64>,
    /// Height, metres.
    pub height_m: Option<f64>,
    /// Radius, for round things, metres.
    pub radius_m: Option<f64>,
    /// Outlines.
    pub outlines: Vec<Outline>,
    /// Rows of copies.
    pub repeats: Vec<Repeat>,
    /// Lanes it applies to.
    pub validity: Vec<LaneValidity>,
    /// Length along the road over which it matters, metres, if stated.
    pub valid_length_m: Option<f64>,
    /// Whether it has parts that move.
    pub dynamic: bool,
    /// Whether it stands at a right angle to the road's surface (then its pitch and roll do not count).
    pub perpendicular: bool,
    /// What a parking space is for.
    pub parking: Option<ParkingSpace>,
    /// What it is made of.
    pub materials: Vec<ObjectMaterial>,
    /// Frames along its outlines.
    pub borders: Vec<ObjectBorder>,
    /// Lines painted along its sides or outlines.
    pub markings: Vec<ObjectMarking>,
    /// Its inner form, as chains of thick points (revision 1.8).
    pub skeleton: Vec<SkeletonLine>,
    /// Other elements of it (CRG surface, ...), kept as they are.
    pub kept: Vec<Element>,
}

/// What a parking space is for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParkingSpace {
    /// `all`, `car`, `women`, `handicapped`, `bus`, `truck`, `electric`, `residents`, as written.
    pub access: String,
    /// Restrictions in free words.
    pub restrictions: String,
}

/// What an object is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectMaterial {
    /// Code of the material, as the maker of the file has it.
    pub surface: String,
    /// Coefficient of friction, if stated.
    pub friction: Option<f64>,
    /// Roughness, if stated.
    pub roughness: Option<f64>,
    /// Colour, where the object is paint (revision 1.8).
    pub paint: Option<MarkColour>,
}

/// A corner of one of an object's outlines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CornerReference {
    /// Index of the outline in [`Object::outlines`].
    pub outline: usize,
    /// Index of the corner in [`Outline::corners`].
    pub corner: usize,
}

/// A frame along an outline of an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectBorder {
    /// `concrete`, `curb`, `paint`, as written.
    pub kind: String,
    /// Width, metres.
    pub width_m: f64,
    /// Index of the outline in [`Object::outlines`].
    pub outline: usize,
    /// Whether it runs along all of the outline; else along the corners.
    pub complete: bool,
    /// The corners it runs along.
    pub corners: Vec<CornerReference>,
}

/// A line painted along a side or an outline of an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectMarking {
    /// Side of the bounding box; none where it runs along corners.
    pub side: Option<BoxSide>,
    /// Corners it runs along.
    pub corners: Vec<CornerReference>,
    /// Colour.
    pub colour: MarkColour,
    /// Bold instead of ordinary weight.
    pub bold: bool,
    /// Width, metres, if stated.
    pub width_m: Option<f64>,
    /// Thickness of the paint, metres.
    pub z_offset_m: f64,
    /// Visible stretch, metres.
    pub line_m: f64,
    /// Gap between two stretches, metres; 0 is continuous.
    pub space_m: f64,
    /// Metres left out at the beginning.
    pub start_offset_m: f64,
    /// Metres left out at the end.
    pub stop_offset_m: f64,
}

/// A chain of thick points inside an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkeletonLine {
    /// Its points.
    pub vertices: Vec<SkeletonVertex>,
}

/// A point of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkeletonVertex {
    /// Where it is (without height there).
    pub place: Corner,
    /// Radius across the chain, metres, if stated.
    pub radius_m: Option<f64>,
    /// Whether the object meets the ground here.
    pub on_ground: bool,
}

/// Says that an object of another road matters to this one, too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectReference {
    /// Id of the object.
    pub id: String,
    /// Metres along this road.
    pub s: f64,
    /// Metres to the left.
    pub t: f64,
    /// Metres above the road, if stated.
    pub z_offset_m: Option<f64>,
    /// Length over which it matters, metres, if stated.
    pub valid_length_m: Option<f64>,
    /// Traffic it matters to.
    pub orientation: Orientation,
    /// Lanes it matters to.
    pub validity: Vec<LaneValidity>,
}

/// A ring or chain of corners.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Whether the last corner joins the first.
    pub closed: bool,
    /// Corners as written (some writers repeat the first at the end).
    pub corners: Vec<Corner>,
    /// Whether it is the object's outer outline, not one of a part inside.
    pub outer: bool,
    /// What fills it: `grass`, `concrete`, `asphalt`, `paint`, ..., as written, or empty.
    pub fill: String,
    /// Kind of lane that the area counts as.
    pub lane_type: Option<LaneType>,
}

impl Default for Outline {
    fn default() -> Self {
        Self { closed: true, corners: Vec::new(), outer: true, fill: String::new(), lane_type: None }
    }
}

/// A corner of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corner {
    /// In the object's own coordinates.
    Local {
        /// Metres along its x.
        u_m: f64,
        /// Metres along its y.
        v_m: f64,
        /// Metres along its z.
        z_m: f64,
        /// Height of the object here, metres.
        height_m: f64,
    },
    /// In road coordinates.
    Road {
        /// Metres along the road.
        s: f64,
        /// Metres to the left of the reference line.
        t: f64,
        /// Metres above the road surface.
        dz_m: f64,
        /// Height of the object here, metres.
        height_m: f64,
    },
}

/// A row of copies of an object, or with `distance_m` 0 one object stretched along the road.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Repeat {
    /// Start of the row, metres along the road.
    pub s: f64,
    /// Length of the row, metres.
    pub length_m: f64,
    /// Between two copies, metres.
    pub distance_m: f64,
    /// Lateral position at the start and at the end, metres to the left.
    pub t_m: [f64; 2],
    /// Coefficients of d, d^2 and d^3 of the lateral position d metres after the start, where it is a cubic.
    pub t_cubic: Option<[f64; 3]>,
    /// Height above the road at the start and at the end, metres.
    pub z_offset_m: [f64; 2],
    /// Height of the object at the start and at the end, if stated, metres.
    pub height_m: Option<[f64; 2]>,
    /// Width of the object at the start and at the end, if stated, metres.
    pub width_m: Option<[f64; 2]>,
    /// Length of the object at the start and at the end, if stated, metres.
    pub object_length_m: Option<[f64; 2]>,
    /// Radius of the object at the start and at the end, if stated, metres.
    pub radius_m: Option<[f64; 2]>,
    /// Whether the row runs straight from its start to its end, whatever the road does.
    pub detached: bool,
}

impl Repeat {
    /// Most copies that a row is written out to; also most points of a stretched object.
    pub const MAX_COPIES: usize = 10_000;

    /// How many copies there are room for.
    pub(crate) fn room(&self) -> f64 {
        if self.distance_m > 0.0 { (self.length_m.max(0.0) / self.distance_m).floor() + 1.0 } else { 1.0 }
    }

    /// Lateral position `d` metres after the start, metres to the left.
    #[must_use]
    pub fn t_at(&self, d: f64) -> f64 {
        match self.t_cubic {
            Some([b, c, cubic]) => self.t_m[0] + d * (b + d * (c + d * cubic)),
            None => mix(self.t_m, self.part(d)),
        }
    }

    /// Height above the road `d` metres after the start, metres.
    #[must_use]
    pub fn z_offset_at(&self, d: f64) -> f64 {
        mix(self.z_offset_m, self.part(d))
    }

    /// A size given at start and end, `d` metres after the start.
    #[must_use]
    pub(crate) fn size_at(&self, pair: Option<[f64; 2]>, d: f64) -> Option<f64> {
        pair.map(|pair| mix(pair, self.part(d)))
    }

    fn part(&self, d: f64) -> f64 {
        if self.length_m > 0.0 { (d / self.length_m).clamp(0.0, 1.0) } else { 0.0 }
    }
}

fn mix(pair: [f64; 2], part: f64) -> f64 {
    pair[0] + (pair[1] - pair[0]) * part
}
