//! What decides which triangle is seen, in the rasteriser and the tracer alike: signs of products with edges,
//! and one reciprocal by which depths are compared.
//!
//! Nothing here is fused, divided or rooted: adding, subtracting and multiplying round alike on all
//! processors, divisions need not. So another implementation of these steps gets the same ids and the
//! same bits of depth.
#![allow(clippy::needless_range_loop, reason = "one index runs through many lane arrays")]

/// Vectors by axis and lane.
pub(crate) type Vectors<const N: usize> = [[f64; N]; 3];

/// Triangles as seen from a point, before any direction is known.
pub(crate) struct Outlines<const N: usize> {
    /// Normals of the planes through the point and an edge, opposite to corner 0, 1, 2. The products with all
    /// three are positive for directions that pass through the triangle.
    pub(crate) edges: [Vectors<N>; 3],
    /// Across the triangle, away from the point.
    pub(crate) normal: Vectors<N>,
    /// Distance of the triangle's plane, times the normal's length: positive, or zero for one that is seen
    /// edge-on.
    pub(crate) offset: [f64; N],
}

impl<const N: usize> Outlines<N> {
    /// Of corners relative to the point.
    ///
    /// Products of single-precision numbers are exact in double precision, so the normal of an edge is off by
    /// less than a direction is, however long and flat the triangle; and two neighbours get exactly opposite
    /// ones: no direction slips through.
    #[inline(always)]
    pub(crate) fn new([a, b, c]: &[Vectors<N>; 3]) -> Self {
        let mut normal = cross(&less(b, a), &less(c, a));
        let mut edges = [cross(b, c), cross(c, a), cross(a, b)];
        let mut offset = [0.0; N];
        for i in 0..N {
            let volume = a[0][i] * normal[0][i] + a[1][i] * normal[1][i] + a[2][i] * normal[2][i];
            let side = 1f64.copysign(volume);
            offset[i] = volume * side;
            for axis in 0..3 {
                normal[axis][i] *= side;
                for edge in &mut edges {
                    edge[axis][i] *= side;
                }
            }
        }
        Self { edges, normal, offset }
    }
}

#[inline(always)]
fn less<const N: usize>(p: &Vectors<N>, q: &Vectors<N>) -> Vectors<N> {
    let mut all = [[0.0; N]; 3];
    for axis in 0..3 {
        for i in 0..N {
            all[axis][i] = p[axis][i] - q[axis][i];
        }
    }
    all
}

#[inline(always)]
fn cross<const N: usize>(p: &Vectors<N>, q: &Vectors<N>) -> Vectors<N> {
    let mut all = [[0.0; N]; 3];
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..N {
            all[axis][i] = p[next][i] * q[last][i] - p[last][i] * q[next][i];
        }
    }
    all
}

/// Whether a direction with these products with the edges passes through the triangle. The least that counts
/// is zero where an edge itself belongs to the triangle.
#[inline(always)]
pub(crate) fn inside(products: [f32; 3], least: [f32; 3]) -> bool {
    (products[0] >= least[0]) & (products[1] >= least[1]) & (products[2] >= least[2])
}

/// The number whose bits less those of another are its reciprocal, to an eighth: it halves the exponent's
/// distance from one.
const SEED: u32 = 0x7EF3_11C7;
const SEED_F64: u64 = 0x7FDE_6238_22FC_16E6;
/// The bits that leave a number the upper half of its digits.
const UPPER: u32 = !0xFFF;

/// The reciprocal by additions and multiplications alone, to a unit or two in the last place, of numbers from
/// 2^-100 to 2^100 either side of zero; not a number for zero.
#[inline(always)]
pub(crate) fn near_reciprocal(x: f32) -> f32 {
    let mut y = f32::from_bits(SEED.wrapping_sub(x.to_bits()));
    // Each step leaves the cube of what was missing: an eighth, two thousandths, nothing but rounding.
    for _ in 0..2 {
        let missing = 1.0 - x * y;
        y += y * (missing + missing * missing);
    }
    y
}

/// The reciprocal by which depths are compared, from additions and multiplications alone: rounded to the
/// nearest, as a division is, but for a dozen numbers in eight million. Of numbers from 2^-100 to 2^100
/// either side of zero; not a number for zero.
#[inline(always)]
#[must_use]
pub fn reciprocal(x: f32) -> f32 {
    let y = near_reciprocal(x);
    // What is missing, exactly: products of half as many digits are not rounded, nor are these differences.
    let [x_upper, y_upper] = [x, y].map(|v| f32::from_bits(v.to_bits() & UPPER));
    let (x_lower, y_lower) = (x - x_upper, y - y_upper);
    let missing = 1.0 - x_upper * y_upper - x_upper * y_lower - x_lower * y_upper - x_lower * y_lower;
    y + y * missing
}

/// The reciprocal of any number of usual size, to some units in the last place.
#[inline(always)]
pub(crate) fn reciprocal_f64(x: f64) -> f64 {
    let mut y = f64::from_bits(SEED_F64.wrapping_sub(x.to_bits()));
    for _ in 0..2 {
        let missing = 1.0 - x * y;
        y += y * (missing + missing * missing);
    }
    y + y * (1.0 - x * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reciprocals_are_those_of_a_division() {
        // All digits there are, at some sizes.
        for size in [1.0f32, -1.0, 1e-9, 3e11, 2e-30, -1e30] {
            let first = size.to_bits() & !0x7F_FFFF;
            let mut off = 0;
            for x in (first..first + (1 << 23)).map(f32::from_bits) {
                let units_off = |y: f32| y.to_bits().abs_diff((1.0 / x).to_bits());
                let units = units_off(reciprocal(x));
                assert!(units <= 1 && units_off(near_reciprocal(x)) <= 2, "{x}");
                off += units;
            }
            assert!(off < 12, "{off} around {size}");
        }
        assert!([0.0, -0.0].iter().all(|&x| reciprocal(x).is_nan() && near_reciprocal(x).is_nan()));
        let mut stream = random::Stream::new(1, 2, "reciprocals", 3);
        for _ in 0..100_000 {
            let sign = if stream.chance(0.5) { 1.0 } else { -1.0 };
            let power = 1023 + stream.int_inclusive(-300, 300);
            let x = f64::from_bits((power as u64) << 52) * stream.uniform(1.0, 2.0) * sign;
            assert!((reciprocal_f64(x) * x - 1.0).abs() < 1e-15, "{x}");
        }
    }
}
