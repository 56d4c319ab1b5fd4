//! Quantities along a road: piecewise cubics without jumps.

use opendrive::Cubic;

/// Values this small are rounding, not geometry.
const NOTHING: f64 = 1e-12;

/// A continuous piecewise cubic of s: heights, widths, lane offsets, banking.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile(Vec<Cubic>);

impl Profile {
    /// The same value everywhere.
    pub(crate) fn constant(value: f64) -> Self {
        Self(vec![Cubic::constant(value)])
    }

    /// Smooth steps from knot to knot `(s, value)`, level at every knot and constant before the first and
    /// after the last. Knots ascend by s.
    pub(crate) fn steps(knots: &[(f64, f64)]) -> Self {
        let Some(first) = knots.first() else { return Self::constant(0.0) };
        let mut pieces: Vec<Cubic> = Vec::new();
        if first.0 > 0.0 {
            pieces.push(Cubic::constant(first.1));
        }
        for pair in knots.windows(2) {
            let ((s0, a), (s1, b)) = (pair[0], pair[1]);
            if s1 > s0 {
                pieces.push(ramp(s0, a, s1 - s0, b));
            }
        }
        if let Some((s, value)) = knots.last() {
            pieces.push(Cubic { s: *s, ..Cubic::constant(*value) });
        }
        Self(merged(pieces))
    }

    /// The cubics through nodes `[s, value, slope]`, ascending by s.
    pub(crate) fn hermite(nodes: &[[f64; 3]]) -> Self {
        let piece = |p: &[[f64; 3]]| {
            let ([s, z0, m0], [s1, z1, m1]) = (p[0], p[1]);
            hermite(s, z0, m0, s1 - s, z1, m1)
        };
        let pieces: Vec<Cubic> = nodes.windows(2).filter(|p| p[1][0] > p[0][0]).map(piece).collect();
        match (pieces.is_empty(), nodes.first()) {
            (true, Some([_, value, _])) => Self::constant(*value),
            (true, None) => Self::constant(0.0),
            _ => Self(merged(pieces)),
        }
    }

    /// Records as a road states them.
    pub(crate) fn of(records: &[Cubic]) -> Self {
        Self(records.to_vec())
    }

    fn piece(&self, s: f64) -> Cubic {
        let after = self.0.partition_point(|c| c.s <= s);
        self.0.get(after.saturating_sub(1)).copied().unwrap_or_default()
    }

    /// Its value.
    pub(crate) fn at(&self, s: f64) -> f64 {
        moved(&self.piece(s), s).a
    }

    /// Its slope, from the right at a knot.
    #[cfg(test)]
    pub(crate) fn slope(&self, s: f64) -> f64 {
        moved(&self.piece(s), s).b
    }

    /// `self + factor * other`.
    pub(crate) fn plus(&self, other: &Self, factor: f64) -> Self {
        let mut knots: Vec<f64> = self.0.iter().chain(&other.0).map(|c| c.s).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        let sum = |s: &f64| {
            let (a, b) = (moved(&self.piece(*s), *s), moved(&other.piece(*s), *s));
            clean(Cubic {
                s: *s,
                a: a.a + factor * b.a,
                b: a.b + factor * b.b,
                c: a.c + factor * b.c,
                d: a.d + factor * b.d,
            })
        };
        Self(merged(knots.iter().map(sum).collect()))
    }

    /// The same times a factor.
    pub(crate) fn times(&self, factor: f64) -> Self {
        Self::constant(0.0).plus(self, factor)
    }

    /// The records that hold on `[start, end)`, with s counted from `start`.
    pub(crate) fn clipped(&self, start: f64, end: f64) -> Vec<Cubic> {
        let first = clean(Cubic { s: 0.0, ..moved(&self.piece(start), start) });
        let rest = self.0.iter().filter(|c| c.s > start && c.s < end);
        std::iter::once(first).chain(rest.map(|c| Cubic { s: c.s - start, ..*c })).collect()
    }

    /// All records, for the whole road; none where the value is 0 everywhere.
    pub(crate) fn records(&self) -> Vec<Cubic> {
        if self.0.iter().all(|c| c.a == 0.0 && c.b == 0.0 && c.c == 0.0 && c.d == 0.0) {
            return Vec::new();
        }
        self.0.clone()
    }

    /// Largest absolute slope on `[0, length]`: at knots, and inside where the second derivative vanishes.
    pub(crate) fn steepest(&self, length_m: f64) -> f64 {
        let mut most = 0.0f64;
        for (i, c) in self.0.iter().enumerate() {
            let end = self.0.get(i + 1).map_or(length_m, |n| n.s) - c.s;
            let slope = |d: f64| (c.b + d * (2.0 * c.c + 3.0 * c.d * d)).abs();
            most = most.max(slope(0.0)).max(slope(end));
            let turning = -c.c / (3.0 * c.d);
            if turning > 0.0 && turning < end {
                most = most.max(slope(turning));
            }
        }
        most
    }
}

/// The cubic from one value to another over `length`, level at both ends.
pub(crate) fn ramp(s: f64, from: f64, length: f64, to: f64) -> Cubic {
    hermite(s, from, 0.0, length, to, 0.0)
}

/// From one value to another as two equal arcs swing aside: a parabola each.
pub(crate) fn swing(from: f64, length: f64, to: f64) -> Vec<Cubic> {
    if from == to {
        return vec![Cubic::constant(from)];
    }
    let rise = to - from;
    let c = 2.0 * rise / (length * length);
    let half = Cubic { s: 0.5 * length, a: from + 0.5 * rise, b: 2.0 * rise / length, c: -c, d: 0.0 };
    vec![Cubic { c, ..Cubic::constant(from) }, half]
}

/// The cubic with the given values and slopes at its ends.
pub(crate) fn hermite(s: f64, z0: f64, m0: f64, length: f64, z1: f64, m1: f64) -> Cubic {
    let mean = (z1 - z0) / length;
    clean(Cubic {
        s,
        a: z0,
        b: m0,
        c: (3.0 * mean - 2.0 * m0 - m1) / length,
        d: (m0 + m1 - 2.0 * mean) / (length * length),
    })
}

/// The same cubic written from another s on.
fn moved(c: &Cubic, s: f64) -> Cubic {
    let h = s - c.s;
    Cubic {
        s,
        a: c.a + h * (c.b + h * (c.c + h * c.d)),
        b: c.b + h * (2.0 * c.c + 3.0 * h * c.d),
        c: c.c + 3.0 * h * c.d,
        d: c.d,
    }
}

/// Takes the rounding out of what should be 0, so that widths end at 0 and never below.
fn clean(c: Cubic) -> Cubic {
    let tidy = |v: f64| if v.abs() < NOTHING { 0.0 } else { v };
    Cubic { s: c.s, a: tidy(c.a), b: tidy(c.b), c: tidy(c.c), d: tidy(c.d) }
}

/// Leaves out constants that go on from one piece to the next.
fn merged(pieces: Vec<Cubic>) -> Vec<Cubic> {
    let flat = |c: &Cubic| c.b == 0.0 && c.c == 0.0 && c.d == 0.0;
    let mut kept: Vec<Cubic> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        match kept.last() {
            Some(last) if flat(last) && flat(&piece) && last.a == piece.a => {}
            _ => kept.push(piece),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_level_at_their_knots() {
        let width = Profile::steps(&[(10.0, 0.0), (40.0, 3.0), (60.0, 3.0), (70.0, 1.0)]);
        for (s, want) in
            [(0.0, 0.0), (10.0, 0.0), (25.0, 1.5), (40.0, 3.0), (55.0, 3.0), (65.0, 2.0), (90.0, 1.0)]
        {
            assert!((width.at(s) - want).abs() < 1e-12, "{s}: {}", width.at(s));
        }
        for s in [0.0, 10.0, 40.0, 50.0, 60.0, 70.0, 80.0] {
            assert!(width.slope(s).abs() < 1e-12);
        }
        // The middle of a smooth step is half as steep again as its chord.
        assert!((width.steepest(100.0) - 1.5 * 2.0 / 10.0).abs() < 1e-12);
    }

    #[test]
    fn sums_and_cuts_keep_the_values() {
        let a = Profile::steps(&[(10.0, 0.0), (40.0, 3.0)]);
        let b = Profile::hermite(&[[0.0, 1.0, 0.1], [25.0, 2.0, -0.2], [80.0, 0.0, 0.0]]);
        let sum = a.plus(&b, -0.5);
        for i in 0..=160 {
            let s = 0.5 * f64::from(i);
            assert!((sum.at(s) - (a.at(s) - 0.5 * b.at(s))).abs() < 1e-12);
        }
        for c in sum.clipped(17.0, 60.0) {
            assert!((c.a - sum.at(17.0 + c.s)).abs() < 1e-12 && c.s < 43.0);
        }
        assert!(a.plus(&a, -1.0).records().is_empty());
    }
}
