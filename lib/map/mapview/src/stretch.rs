//! Lane sections sampled for drawing, cut into pieces short enough to lie above or below each other.

use std::ops::Range;

use nalgebra::Point3;
use opendrive::{LaneInfo, LanePolyline, LaneType, Map, Road};

use crate::page::Page;
use crate::style::Class;

/// Longest piece, metres.
const PIECE_M: f64 = 16.0;
/// Bands narrower than this are not drawn, metres.
const THIN_M: f64 = 0.03;

/// What carries a piece of road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Carrier {
    #[default]
    Ground,
    Bridge,
    Tunnel,
}

/// One lane of a stretch.
#[derive(Debug)]
pub(crate) struct Band {
    pub(crate) lane: i16,
    pub(crate) class: Class,
    pub(crate) line: LanePolyline,
}

/// A lane section.
#[derive(Debug)]
pub(crate) struct Stretch {
    pub(crate) road: u32,
    pub(crate) section: u16,
    pub(crate) in_junction: bool,
    /// Samples, ascending.
    pub(crate) s: Vec<f64>,
    /// Samples that the shape needs; the others only separate pieces.
    needed: Vec<bool>,
    /// From right to left, looking along s.
    pub(crate) bands: Vec<Band>,
    /// Pieces, as ranges of samples that share their ends.
    pub(crate) pieces: Vec<Piece>,
}

/// A piece of a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// First and last sample.
    pub(crate) samples: [usize; 2],
    pub(crate) carrier: Carrier,
    /// Painting order: larger is above.
    pub(crate) level: i8,
}

/// All stretches of a map, by road and section.
pub(crate) fn stretches(map: &Map, page: &Page) -> Vec<Stretch> {
    let lanes = map.lanes();
    lanes
        .chunk_by(|a, b| (a.id.road, a.id.section) == (b.id.road, b.id.section))
        .filter_map(|lanes| {
            let first = lanes.first()?;
            let road = map.network().roads.get(first.id.road as usize)?;
            let exact = map.section_samples(first.id.road, first.id.section, page.tolerance_m());
            let (s, needed) = subdivided(&exact);
            let in_junction = first.junction.is_some();
            let bands = lanes.iter().map(|lane| Band {
                lane: lane.id.lane,
                class: if in_junction && is_mere_paving(road, lane) {
                    Class::Junction
                } else {
                    Class::of(lane.lane_type, in_junction)
                },
                line: map.lane_polyline_at(lane.id, &s),
            });
            let mut stretch = Stretch {
                road: first.id.road,
                section: first.id.section,
                in_junction,
                bands: bands.filter(|b| b.line.s.len() == s.len() && s.len() > 1).collect(),
                s,
                needed,
                pieces: Vec::new(),
            };
            stretch.cut(road);
            (!stretch.bands.is_empty()).then_some(stretch)
        })
        .collect()
}

/// Whether a lane of a connecting road is a shoulder of no road: pavement between the ways through a
/// junction.
fn is_mere_paving(road: &Road, lane: &LaneInfo) -> bool {
    let section = road.sections.get(usize::from(lane.id.section));
    let mut lanes = section.into_iter().flat_map(|section| section.left.iter().chain(&section.right));
    let own = lanes.find(|l| l.id == lane.id.lane);
    lane.lane_type == LaneType::Shoulder
        && own.is_some_and(|l| l.predecessors.is_empty() && l.successors.is_empty())
}

/// Samples no farther apart than [`PIECE_M`], and which of them were there before.
fn subdivided(exact: &[f64]) -> (Vec<f64>, Vec<bool>) {
    let (mut s, mut needed) = (Vec::new(), Vec::new());
    for (i, at) in exact.iter().enumerate() {
        if let Some(last) = i.checked_sub(1).and_then(|i| exact.get(i)) {
            let parts = ((at - last) / PIECE_M).ceil().clamp(1.0, 100_000.0) as usize;
            for part in 1..parts {
                s.push(last + (at - last) * part as f64 / parts as f64);
                needed.push(false);
            }
        }
        s.push(*at);
        needed.push(true);
    }
    (s, needed)
}

fn carrier_at(road: &Road, s: f64) -> Carrier {
    let within = |from: f64, length_m: f64| s >= from && s <= from + length_m;
    if road.tunnels.iter().any(|t| within(t.s, t.length_m)) {
        Carrier::Tunnel
    } else if road.bridges.iter().any(|b| within(b.s, b.length_m)) {
        Carrier::Bridge
    } else {
        Carrier::Ground
    }
}

impl Stretch {
    fn cut(&mut self, road: &Road) {
        let mut first = 0;
        for i in 1..self.s.len() {
            let whole = self.s[i] - self.s[first] >= 0.99 * PIECE_M;
            if whole || i + 1 == self.s.len() {
                let carrier = carrier_at(road, 0.5 * (self.s[first] + self.s[i]));
                let level = if carrier == Carrier::Tunnel { -1 } else { 0 };
                self.pieces.push(Piece { samples: [first, i], carrier, level });
                first = i;
            }
        }
    }

    /// Right and left edge.
    pub(crate) fn edges(&self) -> Option<[&[Point3<f64>]; 2]> {
        Some([&self.bands.first()?.line.right, &self.bands.last()?.line.left])
    }

    /// The piece at an s.
    pub(crate) fn piece_at(&self, s: f64) -> Option<&Piece> {
        let found = self.pieces.partition_point(|p| self.s[p.samples[1]] < s);
        self.pieces.get(found.min(self.pieces.len().checked_sub(1)?))
    }

    /// Runs of pieces that are painted alike.
    pub(crate) fn runs(&self) -> impl Iterator<Item = Piece> {
        self.pieces.chunk_by(|a, b| (a.level, a.carrier) == (b.level, b.carrier)).filter_map(|run| {
            let (first, last) = (run.first()?, run.last()?);
            Some(Piece { samples: [first.samples[0], last.samples[1]], ..*first })
        })
    }

    /// Samples of a run that its shape needs.
    pub(crate) fn shape_samples(&self, run: &Piece) -> Vec<usize> {
        let [from, to] = run.samples;
        (from..=to).filter(|i| *i == from || *i == to || self.needed[*i]).collect()
    }

    /// Neighbouring bands of one class, as ranges of [`Stretch::bands`].
    pub(crate) fn groups(&self) -> Vec<Range<usize>> {
        let mut groups: Vec<Range<usize>> = Vec::new();
        for (i, band) in self.bands.iter().enumerate() {
            match groups.last_mut() {
                Some(group) if self.bands[group.start].class == band.class => group.end = i + 1,
                _ => groups.push(i..i + 1),
            }
        }
        groups
    }

    /// Rings around neighbouring bands over some samples; stretches without width are left out.
    pub(crate) fn rings(&self, bands: &Range<usize>, samples: &[usize]) -> Vec<Vec<Point3<f64>>> {
        let (Some(first), Some(last)) =
            (self.bands.get(bands.start), bands.end.checked_sub(1).and_then(|i| self.bands.get(i)))
        else {
            return Vec::new();
        };
        let (right, left) = (&first.line.right, &last.line.left);
        let thin = |i: usize| (left[i] - right[i]).norm() < THIN_M;
        let mut rings = Vec::new();
        let mut part: Vec<usize> = Vec::new();
        let mut finish = |part: &mut Vec<usize>| {
            if part.len() > 1 {
                let back = part.iter().rev().map(|i| right[*i]);
                rings.push(part.iter().map(|i| left[*i]).chain(back).collect());
            }
            part.clear();
        };
        for &i in samples {
            let narrow = thin(i);
            if narrow && part.last().is_none_or(|last| thin(*last)) {
                finish(&mut part);
            }
            part.push(i);
        }
        finish(&mut part);
        rings
    }

    /// A chain of points cut out of one over all samples, between two values of s.
    pub(crate) fn along(&self, chain: &[Point3<f64>], from: f64, to: f64) -> Vec<Point3<f64>> {
        let at = |s: f64| {
            let after = self.s.partition_point(|v| *v <= s).clamp(1, self.s.len() - 1);
            let (a, b) = (self.s[after - 1], self.s[after]);
            let part = if b > a { ((s - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
            chain[after - 1] + (chain[after] - chain[after - 1]) * part
        };
        let mut points = vec![at(from)];
        let inside = (0..self.s.len()).filter(|i| self.needed[*i] && self.s[*i] > from && self.s[*i] < to);
        points.extend(inside.map(|i| chain[i]));
        points.push(at(to));
        points
    }
}
