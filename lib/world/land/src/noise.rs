//! Numbers by place: of the nodes of a grid, and smooth between them.

/// A number that tells the nodes or cells of a grid apart.
pub(crate) fn entity(i: i32, j: i32) -> u64 {
    u64::from(i as u32) << 32 | u64::from(j as u32)
}

/// The value at a place in units of a grid, eased between the four nodes around it.
pub(crate) fn smooth([u, v]: [f64; 2], at: impl Fn(i32, i32) -> f64) -> f64 {
    let (i, j) = (u.floor(), v.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (a, b) = (ease(u - i), ease(v - j));
    let (i, j) = (i as i32, j as i32);
    let row = |j: i32| at(i, j) + a * (at(i + 1, j) - at(i, j));
    let (low, high) = (row(j), row(j + 1));
    low + b * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_have_their_value_and_between_them_it_never_leaves_theirs() {
        let at = |i: i32, j: i32| f64::from((3 * i + 5 * j).rem_euclid(7));
        assert_eq!([smooth([2.0, -3.0], at), smooth([-1.0, 0.0], at)], [at(2, -3), at(-1, 0)]);
        assert_eq!(smooth([0.5, 0.0], at), 0.5 * (at(0, 0) + at(1, 0)));
        for k in 0..100 {
            let v = smooth([-5.0 + 0.13 * f64::from(k), 0.07 * f64::from(k)], at);
            assert!((0.0..=6.0).contains(&v), "{v}");
        }
        assert_ne!(entity(1, -1), entity(-1, 1));
    }
}
