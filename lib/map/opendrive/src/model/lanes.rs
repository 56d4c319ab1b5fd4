//! Lane sections, lanes and road markings, as the file states them.

use super::{
    AccessRule, Cubic, Element, LaneAdvisory, LaneType, LineRule, MarkChange, MarkColour, MarkType, Speed,
    TravelDirection,
};

/// A stretch of road with a fixed set of lanes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneSection {
    /// Start, metres along the road.
    pub s: f64,
    /// Whether it speaks of one side only, and the other side's section goes on.
    pub single_side: bool,
    /// Lanes left of the centre, from the inside out: ids 1, 2, 3, ...
    pub left: Vec<Lane>,
    /// The centre lane, id 0, without width; only its markings matter.
    pub centre: Lane,
    /// Lanes right of the centre, from the inside out: ids -1, -2, -3, ...
    pub right: Vec<Lane>,
}

impl LaneSection {
    /// All lanes but the centre, by ascending id (from the right edge to the left edge).
    pub fn lanes(&self) -> impl Iterator<Item = &Lane> {
        self.right.iter().rev().chain(&self.left)
    }

    /// The lane with an id (0 is the centre lane).
    #[must_use]
    pub fn lane(&self, id: i16) -> Option<&Lane> {
        match id {
            0 => Some(&self.centre),
            1.. => self.left.iter().find(|l| l.id == id),
            _ => self.right.iter().find(|l| l.id == id),
        }
    }
}

/// One lane of a section.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lane {
    /// Positive left of the centre, negative right, counted outwards.
    pub id: i16,
    /// What it is for.
    pub lane_type: LaneType,
    /// Whether it stays level where the road is superelevated.
    pub level: bool,
    /// Direction of travel (revision 1.8).
    pub direction: TravelDirection,
    /// From where it may be used as an advisory lane (revision 1.8).
    pub advisory: LaneAdvisory,
    /// Whether signals may change its type (revision 1.8).
    pub dynamic_type: bool,
    /// Whether signals may change its direction (revision 1.8).
    pub dynamic_direction: bool,
    /// Whether there are road works on it (revision 1.8).
    pub road_works: bool,
    /// Width in metres, by offset from the section's start.
    pub widths: Vec<Cubic>,
    /// Outer border in metres from the centre lane, used where there are no widths.
    pub borders: Vec<Cubic>,
    /// Markings on the outer border (centre lane: on itself), by offset.
    pub marks: Vec<RoadMark>,
    /// Speed limits, by offset.
    pub speeds: Vec<LaneSpeed>,
    /// Height over the road surface, by offset (kerbs).
    pub heights: Vec<LaneHeight>,
    /// Ids of the lanes that touch it at the section's start (in the section or road before).
    pub predecessors: Vec<i16>,
    /// Ids of the lanes that touch it at the section's end.
    pub successors: Vec<i16>,
    /// What its surface is made of, by offset.
    pub materials: Vec<LaneMaterial>,
    /// Which traffic may use it, by offset; records with one offset hold together.
    pub accesses: Vec<LaneAccess>,
    /// Rules as the maker of the file has them, by offset.
    pub rules: Vec<LaneRule>,
    /// Other elements of it, kept as they are.
    pub kept: Vec<Element>,
}

/// What a lane's surface is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneMaterial {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// Code of the material, as the maker of the file has it.
    pub surface: String,
    /// Coefficient of friction, if stated.
    pub friction: Option<f64>,
    /// Roughness, if stated.
    pub roughness: Option<f64>,
}

/// Which traffic may use a lane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneAccess {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// Whether those named are the only ones, or the ones kept out.
    pub rule: AccessRule,
    /// Those named, as written: `bus`, `bicycle`, `passengerCar`, `trucks`, ...
    pub restrictions: Vec<String>,
}

impl Lane {
    /// Whether a kind of road user (spelled as in [`LaneAccess::restrictions`], letter case aside) may use
    /// the lane `s_offset` metres after the section's start: nobody forbids it and, where some are allowed by
    /// name, it is among them.
    #[must_use]
    pub fn admits(&self, user: &str, s_offset: f64) -> bool {
        let Some(last) = self.accesses.iter().rev().find(|a| a.s_offset <= s_offset) else { return true };
        let here = self.accesses.iter().filter(|a| a.s_offset == last.s_offset);
        let named = |access: &LaneAccess| access.restrictions.iter().any(|r| r.eq_ignore_ascii_case(user));
        let (mut limited, mut allowed) = (false, false);
        for access in here.filter(|a| !a.restrictions.is_empty()) {
            match access.rule {
                AccessRule::Deny if named(access) => return false,
                AccessRule::Deny => {}
                AccessRule::Allow => {
                    limited = true;
                    allowed |= named(access);
                }
            }
        }
        !limited || allowed
    }
}

/// A rule of a lane in free words (`no stopping at any time`, ...).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneRule {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// The rule as written.
    pub value: String,
}

/// A lane's own speed limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneSpeed {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// The limit.
    pub speed: Speed,
}

/// How far a lane is raised over the road surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneHeight {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// At the border near the centre, metres.
    pub inner_m: f64,
    /// At the other border, metres.
    pub outer_m: f64,
}

/// A marking along a lane's outer border.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadMark {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// Its kind.
    pub mark_type: MarkType,
    /// Its colour.
    pub colour: MarkColour,
    /// Bold instead of ordinary weight.
    pub bold: bool,
    /// Width of a line, metres, if stated.
    pub width_m: Option<f64>,
    /// Height over the road, metres, if stated.
    pub height_m: Option<f64>,
    /// Lane changes across it, if stated.
    pub lane_change: Option<MarkChange>,
    /// Material, as written.
    pub material: String,
    /// Lines it consists of, if stated; each goes on until the next marking.
    pub lines: Vec<MarkLine>,
    /// Single strokes it consists of, if stated.
    pub strokes: Vec<MarkStroke>,
    /// Sideways wandering in metres to the left, by offset from the marking's start.
    pub sway: Vec<Cubic>,
}

/// One line of a detailed marking.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkLine {
    /// Visible stretch, metres.
    pub length_m: f64,
    /// Gap between two stretches, metres; 0 is continuous.
    pub space_m: f64,
    /// Shift to the left from the border, metres.
    pub t_offset_m: f64,
    /// Start after the marking's start, metres.
    pub s_offset: f64,
    /// Width, metres, if stated.
    pub width_m: Option<f64>,
    /// Colour, if stated.
    pub colour: Option<MarkColour>,
    /// What it tells drivers.
    pub rule: LineRule,
}

/// One stroke of an irregular marking.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkStroke {
    /// Start after the marking's start, metres.
    pub s_offset: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Shift to the left from the border, metres.
    pub t_offset_m: f64,
    /// Width, metres, if stated.
    pub width_m: Option<f64>,
    /// What it tells drivers.
    pub rule: LineRule,
}
