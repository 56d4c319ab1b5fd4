//! The ends of streets at a junction.

use frames::wrap_pi;
use opendrive::{ContactPoint, Orientation};
use std::f64::consts::{PI, TAU};

use crate::path::Pose2;
use crate::section::{CrossSection, EndLanes, EndStrip, Turn, Use, paved_m};

/// Two arms within this angle of a straight line go straight on, radians.
pub(crate) const STRAIGHT_RAD: f64 = 0.7;

/// The end of a street at a junction.
#[derive(Clone, Debug)]
pub(crate) struct Arm {
    /// Index of the street among the edges.
    pub(crate) edge: usize,
    /// Id of the street.
    pub(crate) road: String,
    /// Length of the street, metres.
    pub(crate) length_m: f64,
    /// Which end of it.
    pub(crate) contact: ContactPoint,
    /// Where its reference line ends, facing away from the junction.
    pub(crate) outward: Pose2,
    /// Height there, metres.
    pub(crate) z_m: f64,
    /// Slope of the street away from the junction.
    pub(crate) slope: f64,
    /// Its lanes there.
    pub(crate) lanes: EndLanes,
    pub(crate) shape: CrossSection,
    /// Metres beyond the street's end that stay straight, with room for the crosswalk if there is one.
    pub(crate) lead_m: f64,
    /// Whether pedestrians may cross it.
    pub(crate) crosswalk: bool,
}

impl Arm {
    /// Turn from entering by this arm to leaving by another, radians, positive to the left.
    pub(crate) fn turn_to(&self, other: &Self) -> f64 {
        wrap_pi(other.outward.heading_rad - self.outward.heading_rad - PI)
    }

    /// Whether it is a railway.
    pub(crate) fn is_rail(&self) -> bool {
        self.shape.left.tracks + self.shape.right.tracks > 0
    }

    /// Sign of the ids of the lanes that enter.
    pub(crate) fn sign_in(&self) -> i16 {
        if self.contact == ContactPoint::End { -1 } else { 1 }
    }

    /// s at a distance before the end of its street, and the direction of its entering traffic.
    pub(crate) fn before_end(&self, distance_m: f64) -> (f64, Orientation) {
        match self.contact {
            ContactPoint::End => (self.length_m - distance_m, Orientation::Along),
            ContactPoint::Start => (distance_m, Orientation::Against),
        }
    }

    /// What each entering driving lane (or track) is for, from the inside out.
    pub(crate) fn entering(&self) -> Vec<Turn> {
        self.lanes
            .entering
            .iter()
            .filter_map(|s| match s.kind {
                Use::Lane(turn) => Some(turn),
                Use::Rail => Some(Turn::Any),
                _ => None,
            })
            .collect()
    }

    /// Number of leaving driving lanes (or tracks).
    pub(crate) fn leaving(&self) -> u8 {
        runs(&self.lanes.leaving).count() as u8
    }

    /// From the axis to the outer edge of the carriageway on the entering and the leaving side, metres.
    pub(crate) fn paved(&self) -> [f64; 2] {
        [paved_m(&self.lanes.entering), paved_m(&self.lanes.leaving)]
    }
}

/// The strips that run through junctions, from the inside out.
pub(crate) fn runs(strips: &[EndStrip]) -> impl Iterator<Item = &EndStrip> {
    strips.iter().filter(|s| s.kind.runs())
}

/// From the axis to the inner border of a driving lane, or of what lies beyond the last one, metres.
pub(crate) fn inner_m(strips: &[EndStrip], index: u8) -> f64 {
    match runs(strips).nth(index.into()) {
        Some(strip) => strip.inner_m,
        None => match (runs(strips).last(), strips.first()) {
            (Some(last), _) => last.inner_m + last.width_m,
            (None, Some(first)) => first.inner_m,
            (None, None) => 0.0,
        },
    }
}

/// The arm that goes straight on from each arm.
pub(crate) fn opposite(arms: &[Arm], from: usize) -> Option<usize> {
    let turn = |to: &usize| arms[from].turn_to(&arms[*to]).abs();
    (0..arms.len())
        .filter(|to| *to != from && arms[*to].is_rail() == arms[from].is_rail())
        .min_by(|a, b| turn(a).total_cmp(&turn(b)))
        .filter(|to| turn(to) < STRAIGHT_RAD)
}

/// Pairs of arms that face each other, and single arms, in the order of their first members.
pub(crate) fn pairs(arms: &[Arm]) -> Vec<(usize, Option<usize>)> {
    let mutual = |a: usize| opposite(arms, a).filter(|b| opposite(arms, *b) == Some(a));
    (0..arms.len())
        .filter_map(|a| match mutual(a) {
            Some(b) if b < a => None,
            other => Some((a, other)),
        })
        .collect()
}

/// The major street of a junction: see [`Control`](crate::layout::Control). Empty where nothing faces
/// anything.
pub(crate) fn major(arms: &[Arm]) -> Vec<usize> {
    let rank = |(a, b): &(usize, usize)| {
        let of =
            |i: usize| (arms[i].shape.limit_kmh, arms[i].entering().len() + usize::from(arms[i].leaving()));
        let (a, b) = (of(*a), of(*b));
        (a.0 + b.0, (a.1 + b.1) as f64)
    };
    let mut best: Option<(usize, usize)> = None;
    for (a, b) in pairs(arms) {
        let Some(b) = b else { continue };
        let better = |old: (usize, usize)| {
            let (new, old) = (rank(&(a, b)), rank(&old));
            new.0 > old.0 || (new.0 == old.0 && new.1 > old.1)
        };
        if best.is_none_or(better) {
            best = Some((a, b));
        }
    }
    best.map_or(Vec::new(), |(a, b)| vec![a, b])
}

/// The arm that follows counter-clockwise: the one round the corner to the right.
pub(crate) fn next_to_the_right(arms: &[Arm], from: usize) -> Option<usize> {
    let angle = |to: &usize| counter_clockwise(arms[from].outward.heading_rad, arms[*to].outward.heading_rad);
    (0..arms.len()).filter(|to| *to != from).min_by(|a, b| angle(a).total_cmp(&angle(b)))
}

/// Angle from one heading counter-clockwise to another, in (0, 2 pi].
pub(crate) fn counter_clockwise(from_rad: f64, to_rad: f64) -> f64 {
    let angle = wrap_pi(to_rad - from_rad);
    if angle <= 0.0 { angle + TAU } else { angle }
}
