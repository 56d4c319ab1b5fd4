// One operation a case, for the self-test and for tests: x says which, y, z and w are bits of its operands.

@group(0) @binding(0) var<storage, read> cases: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> answers: array<u32>;

@compute @workgroup_size(64)
fn arithmetic(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= arrayLength(&cases)) {
        return;
    }
    let asked = cases[id.x];
    let a = bitcast<f32>(asked.y);
    let b = bitcast<f32>(asked.z);
    let c = bitcast<f32>(asked.w);
    var answer = 0u;
    switch asked.x {
        case 0u: { answer = bitcast<u32>(quotient(a, b)); }
        case 1u: { answer = bitcast<u32>(square_root(a)); }
        case 2u: { answer = bitcast<u32>(reciprocal(a)); }
        // Rounded twice: not fused.
        case 3u: { answer = bitcast<u32>(a * b + c); }
        case 4u: { answer = bitcast<u32>(c - a * b); }
        case 5u: { answer = bitcast<u32>(f32(f64(a) * f64(b) + f64(c) * f64(c))); }
        case 6u: { answer = bitcast<u32>(f32(f64(a) * f64(b))); }
        case 7u: { answer = bitcast<u32>(floor(a)); }
        case 8u: { answer = bitcast<u32>(i32(a)); }
        case 9u: { answer = bitcast<u32>(f32(asked.y)); }
        case 10u: { answer = bitcast<u32>(f32(bitcast<i32>(asked.y))); }
        default: {}
    }
    answers[id.x] = answer;
}
