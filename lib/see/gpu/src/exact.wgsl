// Division, reciprocal and square root of f32 as IEEE 754 rounds them, from additions and multiplications alone.
// Vulkan promises of its own 2.5 units in the last place for `/`, and less for `sqrt`.
//
// Newton steps in f64, a last one from what is left, and one rounding to f32. A quotient of two f32 is never
// nearer than 2^-49 of itself to the middle between two f32, a root never nearer than 2^-51; what is rounded is off
// by less than 2^-51.5. Numbers and results below 2^-126 are outside of this: devices may take them for zero.

const SIGN: u32 = 0x80000000u;
const INFINITY: u32 = 0x7F800000u;
const NOT_A_NUMBER: u32 = 0x7FC00000u;

fn reciprocal_f64(x: f64) -> f64 {
    // The bits of a number less those of x are those of its reciprocal, to an eighth. Each step doubles the digits.
    var y = bitcast<f64>(0x7FDE623822FC16E6lu - bitcast<u64>(x));
    y = y + y * (1.0lf - x * y);
    y = y + y * (1.0lf - x * y);
    y = y + y * (1.0lf - x * y);
    y = y + y * (1.0lf - x * y);
    return y;
}

// What is zero, infinite or no number is told by bits: drivers may assume that there are no such numbers.
fn quotient(a: f32, b: f32) -> f32 {
    let x = f64(b);
    let n = f64(a);
    let y = reciprocal_f64(x);
    let q = n * y;
    let closer = f32(q + y * (n - x * q));
    let size_a = bitcast<u32>(a) & ~SIGN;
    let size_b = bitcast<u32>(b) & ~SIGN;
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & SIGN;
    var bits = bitcast<u32>(closer);
    if (size_a == 0u || size_b == INFINITY) {
        bits = sign;
    }
    if (size_b == 0u || size_a == INFINITY) {
        bits = sign | INFINITY;
    }
    let is_undefined = (size_a == 0u && size_b == 0u) || (size_a == INFINITY && size_b == INFINITY);
    if (is_undefined || size_a > INFINITY || size_b > INFINITY) {
        bits = NOT_A_NUMBER;
    }
    return bitcast<f32>(bits);
}

fn reciprocal(x: f32) -> f32 {
    return quotient(1.0f, x);
}

fn square_root(a: f32) -> f32 {
    let x = f64(a);
    var y = bitcast<f64>(0x5FE6EB50C7B537A9lu - (bitcast<u64>(x) >> 1u));
    let half = 0.5lf * x;
    y = y * (1.5lf - half * y * y);
    y = y * (1.5lf - half * y * y);
    y = y * (1.5lf - half * y * y);
    let s = x * y;
    let closer = f32(s + 0.5lf * y * (x - s * s));
    let bits = bitcast<u32>(a);
    var root = bitcast<u32>(closer);
    if ((bits & ~SIGN) == 0u || bits == INFINITY) {
        root = bits;
    }
    if (bits > INFINITY && bits != SIGN) {
        root = NOT_A_NUMBER;
    }
    return bitcast<f32>(root);
}
