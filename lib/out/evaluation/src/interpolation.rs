//! Curves through points, as numpy draws them.

/// The value at `x` of the line through points whose `xs` do not fall: the first point's before them,
/// `beyond` after them (the last point's where there is none). Where several points have one x, the last of
/// them counts. numpy's `interp`.
pub(crate) fn interpolate(x: f64, xs: &[f64], ys: &[f64], beyond: Option<f64>) -> f64 {
    let after = xs.partition_point(|point| *point <= x);
    let (Some(first), Some(last)) = (ys.first(), ys.last()) else { return f64::NAN };
    if after == 0 {
        return *first;
    }
    if xs[after - 1] == x {
        return ys[after - 1];
    }
    if after == xs.len() {
        return beyond.unwrap_or(*last);
    }
    let (x0, y0, x1, y1) = (xs[after - 1], ys[after - 1], xs[after], ys[after]);
    (y1 - y0) / (x1 - x0) * (x - x0) + y0
}

/// The mean of the values up to each: those that are no numbers do not count (0 while none is one), and where
/// none of all is one it is 1.
pub(crate) fn running_means(values: &[f64]) -> Vec<f64> {
    if values.iter().all(|v| v.is_nan()) {
        return vec![1.0; values.len()];
    }
    let (mut sum, mut count) = (0.0, 0_u64);
    let next = |value: &f64| {
        if !value.is_nan() {
            (sum, count) = (sum + value, count + 1);
        }
        if count == 0 { 0.0 } else { sum / count as f64 }
    };
    values.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_go_through_the_last_of_equal_points() {
        let (xs, ys) = ([0.1, 0.2, 0.2, 0.4], [1.0, 2.0, 3.0, 5.0]);
        let at = |x| interpolate(x, &xs, &ys, Some(0.0));
        assert_eq!([at(0.0), at(0.1), at(0.2), at(0.4), at(0.5)], [1.0, 1.0, 3.0, 5.0, 0.0]);
        assert!((at(0.3) - 4.0).abs() < 1e-12 && (at(0.15) - 1.5).abs() < 1e-12);
        assert_eq!(interpolate(9.0, &xs, &ys, None), 5.0);
    }

    #[test]
    fn means_pass_over_what_is_no_number() {
        let nan = f64::NAN;
        assert_eq!(running_means(&[nan, 2.0, nan, 4.0]), [0.0, 2.0, 2.0, 3.0]);
        assert_eq!(running_means(&[nan, nan]), [1.0, 1.0]);
    }
}
