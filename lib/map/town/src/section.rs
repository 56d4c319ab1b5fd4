//! Cross-sections: what lies beside what on a street, from its middle outwards.

use opendrive::ContactPoint;

/// Least median that stays beside a turn pocket, metres.
const NOSE_M: f64 = 1.0;

/// Whom a driving lane is for at the junction ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Whatever the junction offers.
    Any,
    /// A pocket for turns to the left (and U-turns).
    Left,
    /// A pocket for turns to the right, or a deceleration lane.
    Right,
}

/// What a strip of a street is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Half of what separates the directions.
    Median {
        /// Kerbed, or merely painted.
        raised: bool,
    },
    /// Motor traffic.
    Lane(Turn),
    /// Trains.
    Rail,
    /// Cyclists.
    Bike,
    /// Gutter or shoulder: paved, beyond the lanes.
    Edge,
    /// Parked vehicles; takes the place of the gutter.
    Parking,
    /// Grass between kerb and sidewalk.
    Verge,
    /// Pedestrians.
    Sidewalk,
}

impl Use {
    /// Whether it runs through junctions on its own: driving lanes and tracks.
    pub(crate) fn runs(self) -> bool {
        matches!(self, Self::Lane(_) | Self::Rail)
    }

    /// Place in the order beyond the driving lanes; none for what lies inside.
    pub(crate) fn outer_order(self) -> Option<u8> {
        match self {
            Self::Bike => Some(0),
            Self::Edge | Self::Parking => Some(1),
            Self::Verge => Some(2),
            Self::Sidewalk => Some(3),
            _ => None,
        }
    }
}

/// One side of a street, from the median outwards: driving lanes (or tracks), bike lane, gutter or shoulder
/// (or a parking lane in its place), kerb, verge, sidewalk. Widths in metres; 0 leaves a strip out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side {
    /// Driving lanes; all travel in this side's direction.
    pub(crate) lanes: u8,
    /// Railway tracks instead of lanes.
    pub(crate) tracks: u8,
    /// Width of each lane or track.
    pub(crate) lane_m: f64,
    pub(crate) bike_m: f64,
    /// Gutter or shoulder between the lanes and the kerb (or the end of the pavement).
    pub(crate) edge_m: f64,
    /// Parking lane that takes the gutter's place away from junctions.
    pub(crate) parking_m: f64,
    /// Whether a kerb stone ends the carriageway.
    pub(crate) kerb: bool,
    pub(crate) verge_m: f64,
    pub(crate) sidewalk_m: f64,
}

impl Side {
    /// A side with driving lanes and a gutter, and nothing beyond the kerb.
    pub(crate) fn town(lanes: u8, lane_m: f64) -> Self {
        Self {
            lanes,
            tracks: 0,
            lane_m,
            bike_m: 0.0,
            edge_m: 0.5,
            parking_m: 0.0,
            kerb: true,
            verge_m: 0.0,
            sidewalk_m: 0.0,
        }
    }

    /// A side without kerb, with a paved shoulder.
    pub(crate) fn open(lanes: u8, lane_m: f64, shoulder_m: f64) -> Self {
        Self { edge_m: shoulder_m, kerb: false, ..Self::town(lanes, lane_m) }
    }

    /// The same with a sidewalk.
    pub(crate) fn with_sidewalk(self, sidewalk_m: f64) -> Self {
        Self { sidewalk_m, ..self }
    }

    /// The same with a parking lane.
    pub(crate) fn with_parking(self, parking_m: f64) -> Self {
        Self { parking_m, ..self }
    }

    /// The same with a bike lane.
    pub(crate) fn with_bike(self, bike_m: f64) -> Self {
        Self { bike_m, ..self }
    }

    /// The same with grass between kerb and sidewalk.
    pub(crate) fn with_verge(self, verge_m: f64) -> Self {
        Self { verge_m, ..self }
    }

    /// Driving lanes and tracks.
    pub(crate) fn runs(&self) -> u8 {
        self.lanes + self.tracks
    }

    /// Width of all strips but medians and pockets, metres; with parking where it is widest.
    pub(crate) fn reach_m(&self) -> f64 {
        f64::from(self.runs()) * self.lane_m
            + self.bike_m
            + self.edge_m.max(self.parking_m)
            + self.verge_m
            + self.sidewalk_m
    }

    /// Width of what lies beyond the kerb, metres.
    pub(crate) fn beyond_kerb_m(&self) -> f64 {
        self.verge_m + self.sidewalk_m
    }
}

/// What separates the two directions of a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Median {
    /// Width, metres; 0 for a painted line only.
    pub(crate) width_m: f64,
    /// Kerbed, or merely painted.
    pub(crate) raised: bool,
    /// Whether it reaches up to the junctions, or closes before them.
    pub(crate) through: bool,
}

impl Median {
    /// No median.
    pub(crate) const NONE: Self = Self { width_m: 0.0, raised: false, through: false };

    /// A kerbed one that reaches up to the junctions.
    pub(crate) fn raised(width_m: f64) -> Self {
        Self { width_m, raised: true, through: true }
    }
}

/// What kind of road it is, for its type record and its markings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RoadKind {
    Town,
    Rural,
    Motorway,
    Rail,
}

/// A street's cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CrossSection {
    pub(crate) kind: RoadKind,
    /// Left of the reference line: travel against it.
    pub(crate) left: Side,
    /// Right of the reference line: travel along it.
    pub(crate) right: Side,
    pub(crate) median: Median,
    /// Speed limit, km/h.
    pub(crate) limit_kmh: f64,
    /// Steepest slope, rise over run.
    pub(crate) max_grade: f64,
    /// Whether curves are banked.
    pub(crate) banked: bool,
}

impl CrossSection {
    /// The same side both ways, no median; for towns.
    pub(crate) fn both_ways(side: Side, limit_kmh: f64) -> Self {
        Self {
            kind: RoadKind::Town,
            left: side,
            right: side,
            median: Median::NONE,
            limit_kmh,
            max_grade: 0.10,
            banked: false,
        }
    }

    /// A road in the country.
    pub(crate) fn rural(side: Side, limit_kmh: f64) -> Self {
        Self { kind: RoadKind::Rural, max_grade: 0.09, banked: true, ..Self::both_ways(side, limit_kmh) }
    }

    /// Two carriageways with a median between them.
    pub(crate) fn motorway(side: Side, median_m: f64, limit_kmh: f64) -> Self {
        Self {
            kind: RoadKind::Motorway,
            median: Median::raised(median_m),
            max_grade: 0.06,
            banked: true,
            ..Self::both_ways(side, limit_kmh)
        }
    }

    /// Traffic along the reference line only. `beyond_left_m` is the paved strip left of the lanes.
    pub(crate) fn one_way(side: Side, beyond_left_m: f64, limit_kmh: f64) -> Self {
        let left = Side { lanes: 0, tracks: 0, bike_m: 0.0, parking_m: 0.0, edge_m: beyond_left_m, ..side };
        Self { left, ..Self::both_ways(side, limit_kmh) }
    }

    /// A ramp of a motorway: one way, with shoulders.
    pub(crate) fn ramp(lanes: u8, lane_m: f64, limit_kmh: f64) -> Self {
        Self {
            kind: RoadKind::Motorway,
            max_grade: 0.07,
            ..Self::one_way(Side::open(lanes, lane_m, 1.5), 1.0, limit_kmh)
        }
    }

    /// A railway of one track each way (`both`), or a single track.
    pub(crate) fn railway(both: bool) -> Self {
        let side = Side { tracks: 1, ..Side::open(0, 4.0, 0.0) };
        let left = if both { side } else { Side { tracks: 0, ..side } };
        Self { kind: RoadKind::Rail, left, max_grade: 0.03, ..Self::both_ways(side, 80.0) }
    }

    /// The same with a median.
    pub(crate) fn with_median(self, median: Median) -> Self {
        Self { median, ..self }
    }

    /// Whether only one side carries traffic.
    pub(crate) fn is_one_way(&self) -> bool {
        (self.left.runs() == 0) != (self.right.runs() == 0)
    }

    /// Distance from the reference line to the farthest edge of the street, metres, pockets left out.
    pub(crate) fn reach_m(&self) -> f64 {
        self.left.reach_m().max(self.right.reach_m()) + 0.5 * self.median.width_m
    }

    /// The side whose traffic enters the junction at an end of the street.
    pub(crate) fn entering(&self, contact: ContactPoint) -> &Side {
        match contact {
            ContactPoint::End => &self.right,
            ContactPoint::Start => &self.left,
        }
    }

    /// The side whose traffic leaves the junction.
    pub(crate) fn leaving(&self, contact: ContactPoint) -> &Side {
        match contact {
            ContactPoint::End => &self.left,
            ContactPoint::Start => &self.right,
        }
    }
}

/// Extra lanes before a junction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pocket {
    /// How many.
    pub(crate) lanes: u8,
    /// Metres of full width.
    pub(crate) length_m: f64,
    /// Metres on which they open.
    pub(crate) taper_m: f64,
}

impl Pocket {
    /// One lane.
    pub(crate) fn one(length_m: f64, taper_m: f64) -> Self {
        Self { lanes: 1, length_m, taper_m }
    }
}

/// What is special about an end of a street; pockets belong to the traffic that enters the junction there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ending {
    /// Lanes for turns to the left, inside the others.
    pub(crate) left: Option<Pocket>,
    /// Lanes for turns to the right, or for leaving a motorway, outside the others.
    pub(crate) right: Option<Pocket>,
    /// Width of an island between the directions that opens towards the junction (0: none), metres.
    pub(crate) splitter_m: f64,
}

/// A strip at an end of a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EndStrip {
    pub(crate) kind: Use,
    pub(crate) width_m: f64,
    /// From the reference line to the strip's inner border, metres, to the right of the side's traffic.
    pub(crate) inner_m: f64,
    /// Id of its lane.
    pub(crate) lane: i16,
}

/// Both sides of a street at one of its ends, from the inside out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EndLanes {
    /// The side whose traffic enters the junction.
    pub(crate) entering: Vec<EndStrip>,
    /// The side whose traffic leaves it.
    pub(crate) leaving: Vec<EndStrip>,
}

/// The middle of a street at one of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Middle {
    /// Width of the median on either side of the centre lane, metres.
    pub(crate) half_median_m: f64,
    /// Width of all left pocket lanes, metres.
    pub(crate) pocket_m: f64,
    /// How far the centre lane lies from the reference line, towards the leaving side, metres.
    pub(crate) shift_m: f64,
}

impl CrossSection {
    /// The middle at an end.
    pub(crate) fn middle(&self, ending: &Ending, contact: ContactPoint) -> Middle {
        let pocket_m = ending.left.map_or(0.0, |p| f64::from(p.lanes) * self.entering(contact).lane_m);
        if self.is_one_way() {
            // The other lanes stay where they are: the pocket lies beyond the reference line.
            return Middle { half_median_m: 0.0, pocket_m, shift_m: pocket_m };
        }
        let median = if self.median.through { self.median.width_m } else { 0.0 }.max(ending.splitter_m);
        let rest = if pocket_m > 0.0 { (median - pocket_m).max(NOSE_M.min(median)) } else { median };
        Middle { half_median_m: 0.5 * rest, pocket_m, shift_m: 0.5 * pocket_m }
    }

    /// The strips at an end.
    pub(crate) fn end_lanes(&self, ending: &Ending, contact: ContactPoint) -> EndLanes {
        let middle = self.middle(ending, contact);
        let (sign_in, sign_out) = if contact == ContactPoint::End { (-1, 1) } else { (1, -1) };
        let raised = self.median.raised || ending.splitter_m > 0.0;
        let list = |side: &Side, entering: bool, sign: i16| {
            let mut kinds: Vec<(Use, f64)> = vec![(Use::Median { raised }, middle.half_median_m)];
            let pocket = |p: Option<Pocket>| if entering { p.map_or(0, |p| p.lanes) } else { 0 };
            kinds.extend((0..pocket(ending.left)).map(|_| (Use::Lane(Turn::Left), side.lane_m)));
            kinds.extend((0..side.lanes).map(|_| (Use::Lane(Turn::Any), side.lane_m)));
            kinds.extend((0..side.tracks).map(|_| (Use::Rail, side.lane_m)));
            kinds.extend((0..pocket(ending.right)).map(|_| (Use::Lane(Turn::Right), side.lane_m)));
            kinds.push((Use::Bike, side.bike_m));
            kinds.push((Use::Edge, side.edge_m));
            kinds.push((Use::Verge, side.verge_m));
            kinds.push((Use::Sidewalk, side.sidewalk_m));
            let mut inner_m = if entering { -middle.shift_m } else { middle.shift_m };
            let mut strips: Vec<EndStrip> = Vec::new();
            for (kind, width_m) in kinds.into_iter().filter(|(_, width)| *width > 0.0) {
                let lane = sign * (strips.len() as i16 + 1);
                strips.push(EndStrip { kind, width_m, inner_m, lane });
                inner_m += width_m;
            }
            strips
        };
        EndLanes {
            entering: list(self.entering(contact), true, sign_in),
            leaving: list(self.leaving(contact), false, sign_out),
        }
    }
}

/// From the reference line to the outer edge of the carriageway (the kerb, where there is one), metres.
pub(crate) fn paved_m(strips: &[EndStrip]) -> f64 {
    strips
        .iter()
        .filter(|s| !matches!(s.kind, Use::Verge | Use::Sidewalk))
        .map(|s| s.inner_m + s.width_m)
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pocket_leaves_the_other_lanes_in_line() {
        let side = Side::town(2, 3.5);
        let shape = CrossSection::both_ways(side, 50.0).with_median(Median::raised(5.0));
        let plain = shape.end_lanes(&Ending::default(), ContactPoint::Start);
        let pocket = Ending { left: Some(Pocket::one(40.0, 20.0)), ..Ending::default() };
        let with = shape.end_lanes(&pocket, ContactPoint::End);
        let lanes = |strips: &[EndStrip]| -> Vec<f64> {
            strips.iter().filter(|s| s.kind == Use::Lane(Turn::Any)).map(|s| s.inner_m).collect()
        };
        // The median has room for the pocket: what goes straight on keeps its distance from the axis.
        for strips in [&plain.entering, &plain.leaving, &with.entering, &with.leaving] {
            assert_eq!(lanes(strips), [2.5, 6.0]);
        }
        let median: f64 = with.entering[0].width_m + with.leaving[0].width_m;
        assert!((median - 1.5).abs() < 1e-12);
        // Without a median both directions move out by half the pocket.
        let shape = CrossSection::both_ways(side, 50.0);
        let with = shape.end_lanes(&pocket, ContactPoint::End);
        assert_eq!(lanes(&with.entering), [1.75, 5.25]);
        assert_eq!(lanes(&with.leaving), [1.75, 5.25]);
        assert_eq!(
            with.entering[0],
            EndStrip { kind: Use::Lane(Turn::Left), width_m: 3.5, inner_m: -1.75, lane: -1 }
        );
    }
}
