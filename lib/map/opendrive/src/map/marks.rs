//! Road markings: what is painted where, and what it allows.

use nalgebra::Point3;

use super::{LaneId, Map, Marking, Stripe, StripeStrip};
use crate::geometry::{self, record_at};
use crate::model::{Lane, LaneChange, MarkChange, MarkColour, MarkType, RoadMark};

/// Width of a line that states none, metres: ordinary and bold.
const LINE_WIDTH_M: [f64; 2] = [0.12, 0.25];
/// Painted and unpainted metres of a dashed line that states none: 3 and 6 where traffic is slow, 3 and 9
/// from `FAST_MPS` on.
const DASH_M: ([f64; 2], [f64; 2]) = ([3.0, 6.0], [3.0, 9.0]);
/// Limits above this make a fast road (70 km/h), m/s.
const FAST_MPS: f64 = 70.0 / 3.6;
/// Most dashes of one stripe.
const MAX_DASHES: usize = 100_000;

impl RoadMark {
    /// Width of one of its lines, metres.
    fn line_width_m(&self) -> f64 {
        self.width_m.filter(|w| *w > 0.0).unwrap_or(LINE_WIDTH_M[usize::from(self.bold)])
    }

    /// Lane changes across it; where the file is silent, dashed lines and unmarked borders allow, others
    /// forbid.
    fn change(&self) -> MarkChange {
        self.lane_change.unwrap_or(match self.mark_type {
            MarkType::Broken | MarkType::BrokenBroken | MarkType::None => MarkChange::Both,
            _ => MarkChange::None,
        })
    }
}

impl Map {
    /// Turns all markings into single lines.
    pub(super) fn build_stripes(&mut self) {
        for (r, road) in self.network.roads.iter().enumerate() {
            for (k, section) in road.sections.iter().enumerate() {
                self.section_stripes.push(self.stripes.len());
                let Some(span) = self.section(r as u32, k as u16) else { continue };
                let fast = self.lanes[span.lanes.clone()]
                    .iter()
                    .any(|l| l.speed_limit_mps.is_some_and(|v| v > FAST_MPS));
                let dash = if fast { DASH_M.1 } else { DASH_M.0 };
                let mut found = Vec::new();
                let lanes = section.right.iter().rev().chain([&section.centre]).chain(&section.left);
                for lane in lanes {
                    for (i, mark) in lane.marks.iter().enumerate() {
                        let end = lane.marks.get(i + 1).map_or(span.s_end, |next| section.s + next.s_offset);
                        let base = Stripe {
                            road: r as u32,
                            section: k as u16,
                            border_of: lane.id,
                            s_start: (section.s + mark.s_offset).clamp(span.s_start, span.s_end),
                            s_end: end.clamp(span.s_start, span.s_end),
                            mark_type: mark.mark_type,
                            colour: mark.colour,
                            width_m: mark.line_width_m(),
                            t_offset_m: 0.0,
                            dash: None,
                        };
                        if base.s_end > base.s_start {
                            lines_of(mark, &base, dash, lane, &mut found);
                        }
                    }
                }
                self.stripes.extend(found);
            }
        }
        self.section_stripes.push(self.stripes.len());
    }

    /// The middle of a stripe, dashes and gaps alike: values of s, ascending, and the points there.
    #[must_use]
    pub fn stripe_line(&self, stripe: &Stripe, tolerance_m: f64) -> (Vec<f64>, Vec<Point3<f64>>) {
        let samples = self.section_samples(stripe.road, stripe.section, tolerance_m);
        let cut = between(&samples, stripe.s_start, stripe.s_end);
        cut.into_iter().filter_map(|s| Some((s, self.stripe_point(stripe, s, 0.0)?))).unzip()
    }

    /// The painted areas of a stripe: one strip for a continuous line, one per dash for a dashed one. Dashes
    /// count from the stripe's start.
    #[must_use]
    pub fn stripe_strips(&self, stripe: &Stripe, tolerance_m: f64) -> Vec<StripeStrip> {
        let samples = self.section_samples(stripe.road, stripe.section, tolerance_m);
        let strip = |from: f64, to: f64| {
            let mut strip = StripeStrip::default();
            for s in between(&samples, from, to) {
                let edges = [0.5, -0.5].map(|side| self.stripe_point(stripe, s, side * stripe.width_m));
                if let [Some(left), Some(right)] = edges {
                    strip.left.push(left);
                    strip.right.push(right);
                }
            }
            strip
        };
        match stripe.dash {
            Some([line, gap]) if line > 0.0 && gap > 0.0 => {
                let count = ((stripe.s_end - stripe.s_start) / (line + gap))
                    .ceil()
                    .clamp(0.0, MAX_DASHES as f64) as usize;
                let starts = (0..count).map(|i| stripe.s_start + i as f64 * (line + gap));
                starts.filter(|s| *s < stripe.s_end).map(|s| strip(s, (s + line).min(stripe.s_end))).collect()
            }
            _ => vec![strip(stripe.s_start, stripe.s_end)],
        }
    }

    /// A point of a stripe's cross-section, `side_m` to the left of its middle.
    fn stripe_point(&self, stripe: &Stripe, s: f64, side_m: f64) -> Option<Point3<f64>> {
        let t = if stripe.border_of == 0 {
            let road = self.network.roads.get(stripe.road as usize)?;
            geometry::value_and_slope(&road.lane_offset, s).0
        } else {
            let lane = LaneId { road: stripe.road, section: stripe.section, lane: stripe.border_of };
            self.profile(lane, s)?.outer.0
        };
        let surface = self.surfaces.get(stripe.road as usize)?;
        Some(surface.point(s, t + stripe.t_offset_m + side_m))
    }

    /// The marking on the left border of a lane, seen in its direction of travel.
    #[must_use]
    pub fn left_marking(&self, id: LaneId, s: f64) -> Marking {
        self.marking(id, s, 1.0)
    }

    /// The marking on the right border of a lane, seen in its direction of travel.
    #[must_use]
    pub fn right_marking(&self, id: LaneId, s: f64) -> Marking {
        self.marking(id, s, -1.0)
    }

    /// Lane changes that the markings beside a lane allow. Whether there is a lane to change to, and which
    /// way it runs, is another question.
    #[must_use]
    pub fn lane_change(&self, id: LaneId, s: f64) -> LaneChange {
        let (left, right) = (self.left_marking(id, s), self.right_marking(id, s));
        LaneChange::from_flags(left.lane_change.to_left(), right.lane_change.to_right())
    }

    fn marking(&self, id: LaneId, s: f64, side: f64) -> Marking {
        let nothing = Marking::default();
        let Some(info) = self.lane(id) else { return nothing };
        let section = &self.road(id.road).sections[usize::from(id.section)];
        // A border belongs to the lane on its inside; a lane's inner border to the next lane inwards.
        let towards_larger_ids = side * info.direction > 0.0;
        let owner = if towards_larger_ids == (id.lane > 0) {
            id.lane
        } else {
            let inside = if id.lane > 0 {
                section.left.iter().rev().find(|l| l.id < id.lane)
            } else {
                section.right.iter().rev().find(|l| l.id > id.lane)
            };
            inside.map_or(0, |l| l.id)
        };
        let mark = section.lane(owner).and_then(|lane| record_at(&lane.marks, s - section.s, |m| m.s_offset));
        let Some(mark) = mark else { return nothing };
        // Larger ids lie to the left looking along s.
        let (up, down) = match mark.change() {
            MarkChange::None => (false, false),
            MarkChange::Increase => (true, false),
            MarkChange::Decrease => (false, true),
            MarkChange::Both => (true, true),
        };
        let (left, right) = if info.direction > 0.0 { (up, down) } else { (down, up) };
        Marking {
            mark_type: mark.mark_type,
            colour: mark.colour,
            width_m: if mark.mark_type == MarkType::None { 0.0 } else { mark.line_width_m() },
            lane_change: LaneChange::from_flags(left, right),
        }
    }
}

/// The single lines of a marking.
fn lines_of(mark: &RoadMark, base: &Stripe, dash: [f64; 2], lane: &Lane, found: &mut Vec<Stripe>) {
    if !mark.mark_type.is_painted() {
        // Kerbs are kept, with their type, for those who build them; grass and nothing are not lines.
        if mark.mark_type == MarkType::Curb {
            found.push(*base);
        }
        return;
    }
    if !mark.lines.is_empty() || !mark.strokes.is_empty() {
        for stroke in &mark.strokes {
            let s_start = (base.s_start + stroke.s_offset.max(0.0)).min(base.s_end);
            let s_end = (s_start + stroke.length_m.max(0.0)).min(base.s_end);
            if s_end <= s_start {
                continue;
            }
            found.push(Stripe {
                s_start,
                s_end,
                width_m: stroke.width_m.filter(|w| *w > 0.0).unwrap_or(base.width_m),
                t_offset_m: stroke.t_offset_m,
                ..*base
            });
        }
        for line in &mark.lines {
            found.push(Stripe {
                s_start: (base.s_start + line.s_offset.max(0.0)).min(base.s_end),
                colour: line.colour.filter(|c| *c != MarkColour::Standard).unwrap_or(base.colour),
                width_m: line.width_m.filter(|w| *w > 0.0).unwrap_or(base.width_m),
                t_offset_m: line.t_offset_m,
                dash: (line.space_m > 0.0 && line.length_m > 0.0).then_some([line.length_m, line.space_m]),
                ..*base
            });
        }
        return;
    }
    let [first, second] = match mark.mark_type {
        MarkType::Broken => [Some(true), None],
        MarkType::SolidSolid => [Some(false); 2],
        MarkType::SolidBroken => [Some(false), Some(true)],
        MarkType::BrokenSolid => [Some(true), Some(false)],
        MarkType::BrokenBroken => [Some(true); 2],
        _ => [Some(false), None],
    };
    let line = |broken: bool, t_offset_m: f64| Stripe { t_offset_m, dash: broken.then_some(dash), ..*base };
    match (first, second) {
        (Some(first), Some(second)) => {
            // Names run from the inside out, on the centre lane from left to right; the gap is one line wide.
            let outwards = if lane.id > 0 { 1.0 } else { -1.0 };
            found.push(line(first, -outwards * base.width_m));
            found.push(line(second, outwards * base.width_m));
        }
        _ => found.push(line(first == Some(true), 0.0)),
    }
}

/// The samples strictly between two ends, with the ends.
fn between(samples: &[f64], from: f64, to: f64) -> Vec<f64> {
    let inside = geometry::between(samples, from, to, |s| *s);
    std::iter::once(from).chain(inside).chain(std::iter::once(to)).collect()
}
