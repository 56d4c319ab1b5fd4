// What the kernels for cameras and for rays share: meshes, and the arithmetic that decides what is seen, operation by
// operation that of `outline.rs` in render.

// Two words of four a node: lowest corner, highest corner. Beside the lowest the first slot of a node whose
// triangles are taken together, and beside the highest how many; else the first child, and 0.
@group(0) @binding(0) var<storage, read> nodes: array<vec4<u32>>;
// By block, corner, axis, lane.
@group(0) @binding(1) var<storage, read> corners: array<f32>;
// The triangle in each slot; the highest bit says that it is a pane.
@group(0) @binding(2) var<storage, read> order: array<u32>;
// What is asked for.
@group(0) @binding(3) var<storage, read> job: array<u32>;
@group(0) @binding(4) var<storage, read_write> answers: array<u32>;

const PANE: u32 = 0x80000000u;
const SKY: u32 = 0xFFFFFFFFu;

fn float_at(word: u32) -> f32 {
    return bitcast<f32>(job[word]);
}

fn double_at(word: u32) -> f64 {
    return bitcast<f64>(u64(job[word]) | (u64(job[word + 1u]) << 32u));
}

fn vector_at(word: u32) -> vec3<f32> {
    return vec3<f32>(float_at(word), float_at(word + 1u), float_at(word + 2u));
}

fn product(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// As `near_reciprocal` in outline.rs.
fn near_newton(x: f32) -> f32 {
    var y = bitcast<f32>(0x7EF311C7u - bitcast<u32>(x));
    var missing = 1.0f - x * y;
    y = y + y * (missing + missing * missing);
    missing = 1.0f - x * y;
    return y + y * (missing + missing * missing);
}

// As `reciprocal` in outline.rs: rounded otherwise than a division for a dozen numbers in eight million.
fn newton(x: f32) -> f32 {
    let y = near_newton(x);
    let x_upper = bitcast<f32>(bitcast<u32>(x) & 0xFFFFF000u);
    let y_upper = bitcast<f32>(bitcast<u32>(y) & 0xFFFFF000u);
    let x_lower = x - x_upper;
    let y_lower = y - y_upper;
    let left = 1.0f - x_upper * y_upper - x_upper * y_lower - x_lower * y_upper - x_lower * y_lower;
    return y + y * left;
}

// As `reciprocal_f64` in outline.rs.
fn newton_f64(x: f64) -> f64 {
    var y = bitcast<f64>(0x7FDE623822FC16E6lu - bitcast<u64>(x));
    var missing = 1.0lf - x * y;
    y = y + y * (missing + missing * missing);
    missing = 1.0lf - x * y;
    y = y + y * (missing + missing * missing);
    return y + y * (1.0lf - x * y);
}

fn across(p: vec3<f64>, q: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
}

// Told by bits, so that no driver's view of tiny numbers counts.
fn is_zero(x: f32) -> bool {
    return (bitcast<u32>(x) << 1u) == 0u;
}

fn is_positive(x: f32) -> bool {
    return bitcast<u32>(x) - 1u < 0x7F800000u;
}

fn is_number(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7FFFFFFFu) <= 0x7F800000u;
}
