//! Cubic records along s.

use crate::model::Cubic;

/// How far before its first record a list is still served by it: files round s.
const SLACK_M: f64 = 1e-6;

/// The record that holds at `s`: the last one that begins at or before it, by plain comparison. A
/// tolerance here would be wrong: files place jumps of metres 1e-14 m after a round number.
pub(crate) fn record_at<T>(records: &[T], s: f64, s_of: impl Fn(&T) -> f64) -> Option<&T> {
    let after = records.partition_point(|r| s_of(r) <= s);
    records.get(after.wrapping_sub(1))
}

/// Starts of the records, in order of s, that begin between two places.
pub(crate) fn between<'a, T>(
    records: &'a [T],
    from: f64,
    to: f64,
    s_of: impl Fn(&T) -> f64 + 'a,
) -> impl Iterator<Item = f64> + 'a {
    let first = records.partition_point(|r| s_of(r) <= from);
    let last = records.partition_point(|r| s_of(r) < to);
    records.get(first..last).unwrap_or_default().iter().map(s_of)
}

/// Value and first derivative at `s`; zero where no record holds.
pub(crate) fn value_and_slope(records: &[Cubic], s: f64) -> (f64, f64) {
    let (value, slope, _) = value_and_derivatives(records, s);
    (value, slope)
}

/// Value, first and second derivative at `s`; zero where no record holds.
pub(crate) fn value_and_derivatives(records: &[Cubic], s: f64) -> (f64, f64, f64) {
    // Nearly all lists are short, and most have one record.
    let record = match record_at(records, s, |r| r.s) {
        Some(record) => record,
        None => match records.first() {
            Some(first) if first.s - s < SLACK_M => return (first.a, first.b, 2.0 * first.c),
            _ => return (0.0, 0.0, 0.0),
        },
    };
    record.derivatives(s - record.s)
}

impl Cubic {
    /// Whether it is 0 everywhere.
    pub(crate) fn is_zero(&self) -> bool {
        self.a == 0.0 && self.b == 0.0 && self.c == 0.0 && self.d == 0.0
    }

    /// Value, first and second derivative, `d` metres after the record's start.
    pub(crate) fn derivatives(&self, d: f64) -> (f64, f64, f64) {
        (
            self.a + d * (self.b + d * (self.c + d * self.d)),
            self.b + d * (2.0 * self.c + d * 3.0 * self.d),
            2.0 * self.c + 6.0 * self.d * d,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_change_exactly_at_their_start() {
        let records =
            [Cubic::constant(1.0), Cubic { s: 2.000_000_000_000_028_4, a: 15.0, ..Cubic::default() }];
        assert_eq!(value_and_slope(&records, 2.0).0, 1.0);
        assert_eq!(value_and_slope(&records, 2.000_000_000_000_028_4).0, 15.0);
        assert_eq!(value_and_slope(&records, 2.000_000_000_000_028_4_f64.next_down()).0, 1.0);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let cubic = [Cubic { s: 10.0, a: 1.0, b: -0.5, c: 0.25, d: -0.125 }];
        let h = 1e-5;
        let (value, slope, bend) = value_and_derivatives(&cubic, 13.0);
        assert_eq!(value, 1.0 - 1.5 + 2.25 - 3.375);
        let at = |s| value_and_derivatives(&cubic, s).0;
        assert!((slope - (at(13.0 + h) - at(13.0 - h)) / (2.0 * h)).abs() < 1e-8);
        assert!((bend - (at(13.0 + h) - 2.0 * value + at(13.0 - h)) / (h * h)).abs() < 1e-4);
    }
}
