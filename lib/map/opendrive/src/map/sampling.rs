//! Chains of points along lanes, as fine as a tolerance asks for.

use nalgebra::Point3;

use super::{LaneId, LanePolyline, Map};
use crate::geometry::between;

/// Finest tolerance that is honoured, metres.
const MIN_TOLERANCE_M: f64 = 1e-4;
/// Share of the tolerance that is used up at the places looked at; the rest is for what lies between them.
const MARGIN: f64 = 0.9;
/// Deepest halving of one stretch between two records.
const MAX_DEPTH: u32 = 12;
/// Stretches shorter than this are not halved, metres: no road bends that sharply.
const MIN_STEP_M: f64 = 0.01;
/// Two records closer than this make one vertex.
const SLIVER_M: f64 = 1e-6;
/// Borders that move by more than this within a sliver jump: both sides get a vertex.
const JUMP_M: f64 = 1e-3;

impl Map {
    /// Values of s, ascending and both ends included, at which all lanes of a section should be sampled so
    /// that straight lines between the samples stay within `tolerance_m` of every lane border.
    ///
    /// That holds for roads as they are built (between two records, borders bend smoothly); where a width
    /// dips below zero, which counts as zero, the kink may be cut. Neighbouring lanes share these samples and
    /// so their vertices. Where the file lets borders jump sideways, two samples a hair apart stand for the
    /// two sides.
    #[must_use]
    pub fn section_samples(&self, road: u32, section: u16, tolerance_m: f64) -> Vec<f64> {
        let Some(span) = self.section(road, section) else { return Vec::new() };
        let tolerance = MARGIN * if tolerance_m > MIN_TOLERANCE_M { tolerance_m } else { MIN_TOLERANCE_M };
        let breaks = self.breaks(road, section);

        let mut sampler = Sampler { map: self, road, section, borders: Vec::new(), tolerance };
        let mut samples = vec![span.s_start];
        let mut last = (span.s_start, sampler.points(span.s_start));
        for s in breaks {
            let before = s.next_down().max(last.0);
            if before - last.0 > SLIVER_M {
                let end = (before, sampler.points(before));
                sampler.refine(&last, &end, 0, &mut samples);
                // One vertex stands for both sides unless the borders jump here.
                let here = sampler.points(s);
                if gap(&end.1, &here) > JUMP_M {
                    samples.push(before);
                }
                samples.push(s);
                last = (s, here);
            } else if s > last.0 {
                let here = sampler.points(s);
                if gap(&last.1, &here) > JUMP_M || s == span.s_end {
                    if gap(&last.1, &here) <= JUMP_M && samples.len() > 1 {
                        samples.pop();
                    }
                    samples.push(s);
                    last = (s, here);
                }
            }
        }
        samples
    }

    /// Every s strictly inside a section at which a record of the road's surface or of a lane's border
    /// begins, and the section's end; ascending. Between two of them everything is smooth.
    pub(super) fn breaks(&self, road: u32, section: u16) -> Vec<f64> {
        let Some(span) = self.section(road, section) else { return Vec::new() };
        let model = self.road(road);
        let lanes = &model.sections[usize::from(section)];
        let mut breaks: Vec<f64> = self.surfaces[road as usize].breaks(span.s_start, span.s_end).collect();
        breaks.extend(between(&model.lane_offset, span.s_start, span.s_end, |c| c.s));
        for lane in lanes.lanes() {
            breaks.extend(lane.widths.iter().chain(&lane.borders).map(|c| lanes.s + c.s));
        }
        breaks.retain(|s| *s > span.s_start && *s < span.s_end);
        breaks.push(span.s_end);
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    /// The borders of a section's lanes, from the rightmost to the leftmost (one more than it has lanes), at
    /// given values of s (of [`Map::section_samples`]); points run with s. The lanes' shared borders appear
    /// once.
    #[must_use]
    pub fn section_borders(&self, road: u32, section: u16, samples: &[f64]) -> Vec<Vec<Point3<f64>>> {
        if self.section(road, section).is_none() {
            return Vec::new();
        }
        let surface = &self.surfaces[road as usize];
        let mut lines = vec![Vec::with_capacity(samples.len()); self.lanes_of(road, section).len() + 1];
        let mut borders = Vec::new();
        for &s in samples {
            self.borders(road, section, s, &mut borders);
            let frame = surface.frame(s);
            for (line, (t, _)) in lines.iter_mut().zip(&borders) {
                line.push(surface.point_in(&frame, s, *t));
            }
        }
        lines
    }

    /// A lane sampled so that straight lines stay within `tolerance_m` of its borders; both ends included.
    #[must_use]
    pub fn lane_polyline(&self, id: LaneId, tolerance_m: f64) -> LanePolyline {
        self.lane_polyline_at(id, &self.section_samples(id.road, id.section, tolerance_m))
    }

    /// A lane at given values of s (of [`Map::section_samples`]).
    #[must_use]
    pub fn lane_polyline_at(&self, id: LaneId, samples: &[f64]) -> LanePolyline {
        let mut line = LanePolyline::default();
        let Some(surface) = self.surfaces.get(id.road as usize) else { return line };
        for &s in samples {
            let Some(profile) = self.profile(id, s) else { return LanePolyline::default() };
            let frame = surface.frame(s);
            let at = |t| surface.point_in(&frame, s, t);
            let (inner, outer) = (at(profile.inner.0), at(profile.outer.0));
            let (left, right) = if id.lane > 0 { (outer, inner) } else { (inner, outer) };
            line.s.push(s);
            line.left.push(left);
            line.centre.push(at(profile.centre().0));
            line.right.push(right);
        }
        line
    }
}

/// Largest distance between corresponding points.
fn gap(a: &[Point3<f64>], b: &[Point3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// A value of s with the border points there.
type Cut = (f64, Vec<Point3<f64>>);

struct Sampler<'m> {
    map: &'m Map,
    road: u32,
    section: u16,
    borders: Vec<(f64, f64)>,
    tolerance: f64,
}

impl Sampler<'_> {
    fn points(&mut self, s: f64) -> Vec<Point3<f64>> {
        self.map.borders(self.road, self.section, s, &mut self.borders);
        let surface = &self.map.surfaces[self.road as usize];
        let frame = surface.frame(s);
        self.borders.iter().map(|(t, _)| surface.point_in(&frame, s, *t)).collect()
    }

    /// Adds the samples strictly between two cuts.
    fn refine(&mut self, a: &Cut, b: &Cut, depth: u32, samples: &mut Vec<f64>) {
        if depth >= MAX_DEPTH || b.0 - a.0 < MIN_STEP_M {
            return;
        }
        let at = |part: f64| a.0 + (b.0 - a.0) * part;
        let middle = (at(0.5), self.points(at(0.5)));
        // The middle alone is blind to curves that are symmetric about it.
        let fine = self.fits(a, b, &middle.1) && {
            let (q1, q3) = (self.points(at(0.25)), self.points(at(0.75)));
            self.fits(a, b, &q1) && self.fits(a, b, &q3)
        };
        if fine {
            return;
        }
        self.refine(a, &middle, depth + 1, samples);
        samples.push(middle.0);
        self.refine(&middle, b, depth + 1, samples);
    }

    /// Whether the points lie within tolerance of the chords.
    fn fits(&self, a: &Cut, b: &Cut, points: &[Point3<f64>]) -> bool {
        a.1.iter().zip(&b.1).zip(points).all(|((a, b), p)| {
            let (chord, way) = (b - a, p - a);
            let length = chord.norm_squared();
            let part = if length > 0.0 { (way.dot(&chord) / length).clamp(0.0, 1.0) } else { 0.0 };
            (way - chord * part).norm() <= self.tolerance
        })
    }
}
