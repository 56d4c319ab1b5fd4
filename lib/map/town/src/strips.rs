//! The strips of a street along its length: where each begins and ends, and how wide it is.

use opendrive::ContactPoint;

use crate::TownError;
use crate::profile::Profile;
use crate::section::{CrossSection, Ending, Side, Turn, Use};

/// Length of the stretch at each end that keeps the junction's lanes, metres.
const APPROACH_M: f64 = 10.0;
/// Way on which a gutter widens to a parking lane, metres.
pub(crate) const PARKING_TAPER_M: f64 = 6.0;
/// Way on which a median or a splitter island opens, metres.
const MEDIAN_TAPER_M: f64 = 15.0;
/// Stretch at the junction on which a splitter island keeps its width, metres.
const SPLITTER_M: f64 = 8.0;
/// Least length of a stretch with medians or parking lanes, metres; shorter streets keep the junction's
/// lanes.
const MIDDLE_MIN_M: f64 = 20.0;
const _: () = assert!(MIDDLE_MIN_M > 2.0 * PARKING_TAPER_M, "both tapers of a parking lane have room");
/// Pockets may shrink to this share of their wished length where a street is short.
const LEAST_SHARE: f64 = 0.4;

/// One strip of a street.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strip {
    /// From where to where it exists (metres along the road), and as what. Ascending.
    pub(crate) spans: Vec<(f64, f64, Use)>,
    pub(crate) width: Profile,
}

impl Strip {
    fn whole(kind: Use, width_m: f64, length_m: f64) -> Self {
        Self { spans: vec![(0.0, length_m, kind)], width: Profile::constant(width_m) }
    }

    /// What it is at a place.
    pub(crate) fn kind_at(&self, s: f64) -> Option<Use> {
        self.spans.iter().find(|(from, to, _)| s >= *from && s <= *to).map(|span| span.2)
    }
}

/// All strips of a street.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strips {
    /// Left of the centre, from the inside out.
    pub(crate) left: Vec<Strip>,
    /// Right of it.
    pub(crate) right: Vec<Strip>,
    /// Where the centre lane lies, metres to the left of the reference line.
    pub(crate) offset: Profile,
}

/// The stretch at an end of a road on which it changes, as distances from that end, metres: level up to
/// `full`, changed back at `free`.
#[derive(Clone, Copy, Debug)]
struct Zone {
    full: f64,
    free: f64,
}

/// The zones of an end: of the middle (medians, left pockets), and of the right pocket.
fn zones(shape: &CrossSection, ending: &Ending) -> [Zone; 2] {
    let none = Zone { full: 0.0, free: 0.0 };
    let of = |pocket: crate::section::Pocket| Zone {
        full: pocket.length_m,
        free: pocket.length_m + pocket.taper_m,
    };
    let mut middle = ending.left.map_or(none, of);
    if ending.splitter_m > 0.0 {
        let free = SPLITTER_M + MEDIAN_TAPER_M.max(5.0 * ending.splitter_m);
        middle = Zone { full: middle.full.max(SPLITTER_M), free: middle.free.max(free) };
    }
    if shape.median.width_m > 0.0 && !shape.median.through && middle.free == 0.0 {
        middle = Zone { full: APPROACH_M, free: APPROACH_M + MEDIAN_TAPER_M };
    }
    [middle, ending.right.map_or(none, of)]
}

impl Strips {
    /// The strips of a street of a given length; `endings` are those of its start and its end.
    pub(crate) fn new(
        name: &str,
        shape: &CrossSection,
        endings: &[Ending; 2],
        length_m: f64,
    ) -> Result<Self, TownError> {
        let mut shape = *shape;
        let mut zones = endings.map(|ending| zones(&shape, &ending));
        let needs = |zones: &[[Zone; 2]; 2]| zones.iter().map(|z| z[0].free.max(z[1].free)).sum::<f64>();
        // A median that closes before the junctions is left out of short streets.
        if !shape.median.through && shape.median.width_m > 0.0 && needs(&zones) + MIDDLE_MIN_M > length_m {
            shape.median.width_m = 0.0;
            zones = endings.map(|ending| self::zones(&shape, &ending));
        }
        let (needed_m, room) = (needs(&zones), length_m - 2.0);
        if needed_m > room {
            let share = room / needed_m;
            if share < LEAST_SHARE {
                return Err(TownError::TooTight {
                    street: name.to_owned(),
                    left_m: length_m,
                    needed_m: LEAST_SHARE * needed_m + 2.0,
                });
            }
            for zone in zones.iter_mut().flatten() {
                *zone = Zone { full: zone.full * share, free: zone.free * share };
            }
        }

        let build = Builder { shape: &shape, endings, zones, length_m };
        let (left, right) = (build.side(false), build.side(true));
        // The centre lies in the middle between the innermost ordinary lanes; on one-way roads these stay in
        // place.
        let inner = |side: &[Strip]| {
            let is_inner = |s: &&Strip| {
                matches!(s.spans.first(), Some((_, _, Use::Median { .. } | Use::Lane(Turn::Left))))
            };
            side.iter().filter(is_inner).fold(Profile::constant(0.0), |sum, s| sum.plus(&s.width, 1.0))
        };
        let offset = inner(&right).plus(&inner(&left), -1.0);
        let offset = if shape.is_one_way() { offset } else { offset.times(0.5) };
        Ok(Self { left, right, offset })
    }

    /// Where the strips begin and end, ascending, from 0 to the road's length.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let spans = self.left.iter().chain(&self.right).flat_map(|s| &s.spans);
        let mut breaks: Vec<f64> = spans.flat_map(|(from, to, _)| [*from, *to]).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    /// The lateral middle of a strip at a place, metres to the left of the reference line.
    pub(crate) fn centre_t(&self, right: bool, index: usize, s: f64) -> f64 {
        let side = if right { &self.right } else { &self.left };
        let width = |strip: &Strip| if strip.kind_at(s).is_some() { strip.width.at(s) } else { 0.0 };
        let out = side.iter().take(index).map(width).sum::<f64>() + 0.5 * side.get(index).map_or(0.0, width);
        self.offset.at(s) + if right { -out } else { out }
    }
}

struct Builder<'a> {
    shape: &'a CrossSection,
    endings: &'a [Ending; 2],
    zones: [[Zone; 2]; 2],
    length_m: f64,
}

impl Builder<'_> {
    fn side(&self, right: bool) -> Vec<Strip> {
        let side = if right { &self.shape.right } else { &self.shape.left };
        let length = self.length_m;
        // The end at which this side's traffic enters a junction: 0 start, 1 end.
        let ahead = usize::from(right);
        let mut strips: Vec<Strip> = Vec::new();
        strips.extend(self.median());
        let ending = &self.endings[ahead];
        for _ in 0..ending.left.map_or(0, |p| p.lanes) {
            strips.push(self.pocket(side, ahead, self.zones[ahead][0], Turn::Left));
        }
        strips.extend((0..side.lanes).map(|_| Strip::whole(Use::Lane(Turn::Any), side.lane_m, length)));
        strips.extend((0..side.tracks).map(|_| Strip::whole(Use::Rail, side.lane_m, length)));
        for _ in 0..ending.right.map_or(0, |p| p.lanes) {
            strips.push(self.pocket(side, ahead, self.zones[ahead][1], Turn::Right));
        }
        if side.bike_m > 0.0 {
            strips.push(Strip::whole(Use::Bike, side.bike_m, length));
        }
        strips.extend(self.edge(side, ahead));
        if side.verge_m > 0.0 {
            strips.push(Strip::whole(Use::Verge, side.verge_m, length));
        }
        if side.sidewalk_m > 0.0 {
            strips.push(Strip::whole(Use::Sidewalk, side.sidewalk_m, length));
        }
        strips
    }

    /// s at a distance from an end.
    fn s(&self, end: usize, distance_m: f64) -> f64 {
        if end == 0 { distance_m } else { self.length_m - distance_m }
    }

    /// Half of the median: the same on both sides.
    fn median(&self) -> Option<Strip> {
        if self.shape.is_one_way() {
            return None;
        }
        let at_end = |end: usize| {
            let contact = if end == 0 { ContactPoint::Start } else { ContactPoint::End };
            self.shape.middle(&self.endings[end], contact).half_median_m
        };
        let (ends, usual) = ([at_end(0), at_end(1)], 0.5 * self.shape.median.width_m);
        if ends == [0.0; 2] && usual == 0.0 {
            return None;
        }
        let splitter = self.endings.iter().any(|e| e.splitter_m > 0.0);
        let kind = Use::Median { raised: self.shape.median.raised || splitter };
        let mut knots: Vec<(f64, f64)> = Vec::new();
        let mut spans: Vec<(f64, f64, Use)> = Vec::new();
        let zone = [self.zones[0][0], self.zones[1][0]];
        for (distance, value) in [(zone[0].full, ends[0]), (zone[0].free, usual)] {
            knots.push((distance, value));
        }
        for (distance, value) in [(zone[1].free, usual), (zone[1].full, ends[1])] {
            knots.push((self.s(1, distance), value));
        }
        if usual > 0.0 {
            let from = if ends[0] > 0.0 { 0.0 } else { zone[0].full };
            let to = self.s(1, if ends[1] > 0.0 { 0.0 } else { zone[1].full });
            spans.push((from, to, kind));
        } else {
            if ends[0] > 0.0 {
                spans.push((0.0, zone[0].free, kind));
            }
            if ends[1] > 0.0 {
                spans.push((self.s(1, zone[1].free), self.length_m, kind));
            }
        }
        knots.dedup();
        Some(Strip { spans, width: Profile::steps(&knots) })
    }

    fn pocket(&self, side: &Side, end: usize, zone: Zone, turn: Turn) -> Strip {
        let (full, free) = (self.s(end, zone.full), self.s(end, zone.free));
        let kind = Use::Lane(turn);
        if end == 0 {
            let width = Profile::steps(&[(full, side.lane_m), (free, 0.0)]);
            Strip { spans: vec![(0.0, free, kind)], width }
        } else {
            let width = Profile::steps(&[(free, 0.0), (full, side.lane_m)]);
            Strip { spans: vec![(free, self.length_m, kind)], width }
        }
    }

    /// Gutter or shoulder, with the parking lane in its place where there is room.
    fn edge(&self, side: &Side, ahead: usize) -> Option<Strip> {
        if side.edge_m <= 0.0 && side.parking_m <= 0.0 {
            return None;
        }
        let length = self.length_m;
        let clear = |end: usize| {
            let pockets = self.endings[end].left.is_some() || self.endings[end].right.is_some();
            let zone = self.zones[end][0].free.max(self.zones[end][1].free);
            if end == ahead && pockets { zone + PARKING_TAPER_M } else { APPROACH_M }
        };
        let (from, to) = (clear(0), length - clear(1));
        if side.parking_m <= 0.0 || to - from < MIDDLE_MIN_M {
            return (side.edge_m > 0.0).then(|| Strip::whole(Use::Edge, side.edge_m, length));
        }
        let mut spans = vec![(from, to, Use::Parking)];
        if side.edge_m > 0.0 {
            spans = vec![(0.0, from, Use::Edge), (from, to, Use::Parking), (to, length, Use::Edge)];
        }
        let knots = [
            (from, side.edge_m),
            (from + PARKING_TAPER_M, side.parking_m),
            (to - PARKING_TAPER_M, side.parking_m),
            (to, side.edge_m),
        ];
        Some(Strip { spans, width: Profile::steps(&knots) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::{Median, Pocket};

    fn width_at(strips: &[Strip], s: f64) -> f64 {
        strips.iter().filter(|x| x.kind_at(s).is_some()).map(|x| x.width.at(s)).sum()
    }

    #[test]
    fn ends_are_what_the_cross_section_says() {
        let side = Side::town(2, 3.25).with_parking(2.2).with_sidewalk(2.5).with_bike(1.5);
        let pocket = Ending { left: Some(Pocket::one(40.0, 20.0)), ..Ending::default() };
        let right = Ending { right: Some(Pocket::one(30.0, 15.0)), splitter_m: 4.0, ..Ending::default() };
        for median in [Median::NONE, Median::raised(2.0), Median::raised(6.0)] {
            let shape = CrossSection::both_ways(side, 50.0).with_median(median);
            for endings in [[pocket, right], [right, pocket], [Ending::default(), pocket]] {
                let strips = Strips::new("a", &shape, &endings, 260.0).expect("fits");
                for (end, contact, s) in [(0, ContactPoint::Start, 0.0), (1, ContactPoint::End, 260.0)] {
                    let lanes = shape.end_lanes(&endings[end], contact);
                    let sides =
                        if end == 1 { [&strips.right, &strips.left] } else { [&strips.left, &strips.right] };
                    for (want, got) in [&lanes.entering, &lanes.leaving].into_iter().zip(sides) {
                        let here: Vec<&Strip> = got.iter().filter(|x| x.kind_at(s).is_some()).collect();
                        assert_eq!(here.len(), want.len(), "{want:?}");
                        for (want, got) in want.iter().zip(here) {
                            assert_eq!(got.kind_at(s), Some(want.kind));
                            assert!((got.width.at(s) - want.width_m).abs() < 1e-12, "{want:?}");
                        }
                    }
                    let shift = shape.middle(&endings[end], contact).shift_m;
                    let offset = if end == 1 { shift } else { -shift };
                    assert!((strips.offset.at(s) - offset).abs() < 1e-12);
                }
                // What goes straight on stays symmetrical all along.
                for i in 0..=26 {
                    let s = 10.0 * f64::from(i);
                    let outer = |strips: &[Strip]| {
                        let at = strips.iter().position(|x| x.kind_at(s) == Some(Use::Lane(Turn::Any)));
                        width_at(&strips[..at.expect("lanes")], s)
                    };
                    let (l, r) = (
                        outer(&strips.left) + strips.offset.at(s),
                        outer(&strips.right) - strips.offset.at(s),
                    );
                    assert!((l - r).abs() < 1e-9, "{s}: {l} {r}");
                }
            }
        }
    }

    #[test]
    fn streets_too_short_for_their_pockets_are_refused() {
        let shape = CrossSection::both_ways(Side::town(1, 3.5), 50.0);
        let pocket = Ending { left: Some(Pocket::one(60.0, 30.0)), ..Ending::default() };
        assert!(Strips::new("a", &shape, &[pocket, pocket], 120.0).is_ok());
        assert!(matches!(Strips::new("a", &shape, &[pocket, pocket], 50.0), Err(TownError::TooTight { .. })));
    }
}
