// What rays meet. One thread follows one ray, through a tree over instances and those over their triangles, the
// nearer box first.
//
// Of all triangles that a ray passes through the nearest is kept, of equally near ones the smaller (instance,
// triangle): it does not matter in which order they come. Boxes only leave out what cannot be met. What decides
// (`meet`) are the operations of `render::cpu`, one by one: `packet.rs` and `outline.rs` there.

// In the job: groups of rays, queries, nodes of trees over instances, and instances, as `ray_job.rs` writes them; before
// them where each begins.
const GROUP_RAYS: u32 = 64u;
const GROUP_WORDS: u32 = 2u;
const QUERY_WORDS: u32 = 15u;
const NODE_WORDS: u32 = 8u;
const RECORD_WORDS: u32 = 16u;
const TREES: u32 = 4u;
const NONE: u32 = 0xFFFFFFFFu;

// As in packet.rs: by how much a ray may miss a box, and boxes grow for the rounding of what is in them.
const SLACK: f32 = 1.00000095367431640625f;
const PAD: f32 = 4.76837158203125e-7f;
const STEEPEST: f32 = 1e-20f;

// The ray, and what it has met so far.
var<private> from_m: vec3<f32>;
var<private> along: vec3<f32>;
var<private> nearest_m: f32;
var<private> met_m: f32;
var<private> met_instance: u32;
var<private> met_triangle: u32;
var<private> met_edges: vec3<f32>;
// Nodes that are still to be looked at, and how far away they begin.
var<private> waiting: array<u32, 64>;
var<private> waiting_m: array<f32, 64>;
var<private> outer_waiting: array<u32, 64>;
var<private> outer_waiting_m: array<f32, 64>;

// A ray's way through boxes: the reciprocals of its direction, and its origin moved up for lower planes and down for
// upper ones.
struct Way {
    inverse: vec3<f32>,
    up: vec3<f32>,
    down: vec3<f32>,
}

fn steep(d: f32) -> f32 {
    let sign = bitcast<u32>(d) & 0x80000000u;
    return select(d, bitcast<f32>(bitcast<u32>(STEEPEST) | sign), abs(d) < STEEPEST);
}

fn way_of(origin: vec3<f32>, direction: vec3<f32>, reach: f32) -> Way {
    let size = abs(origin);
    let pad = PAD * (max(max(size.x, size.y), size.z) + reach);
    let inverse = vec3<f32>(
        near_newton(steep(direction.x)),
        near_newton(steep(direction.y)),
        near_newton(steep(direction.z)),
    );
    return Way(inverse, origin + vec3<f32>(pad), origin - vec3<f32>(pad));
}

// A distance before which the ray enters no box; negative where it misses it.
fn entry(way: Way, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let a = (low - way.up) * way.inverse;
    let b = (high - way.down) * way.inverse;
    let near = max(max(min(a.x, b.x), min(a.y, b.y)), max(min(a.z, b.z), nearest_m));
    let far = min(min(max(a.x, b.x), max(a.y, b.y)), min(max(a.z, b.z), met_m));
    return select(-1.0f, near, near <= far * SLACK);
}

fn corner_at(base: u32, origin: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(vec3<f32>(corners[base], corners[base + 8u], corners[base + 16u])) - origin;
}

// Whether a product with an edge counts as inside: no negative number.
fn is_inside(product: f32) -> bool {
    let bits = bitcast<u32>(product);
    return bits <= 0x7F800000u || bits == 0x80000000u;
}

// Keeps a triangle if the ray passes through it nearer than through all before.
fn meet(slot: u32, origin: vec3<f64>, direction: vec3<f32>, instance: u32) {
    let base = (slot >> 3u) * 72u + (slot & 7u);
    let a = corner_at(base, origin);
    let b = corner_at(base + 24u, origin);
    let c = corner_at(base + 48u, origin);
    let normal = across(b - a, c - a);
    let volume = a.x * normal.x + a.y * normal.y + a.z * normal.z;
    let side = select(1.0lf, -1.0lf, (bitcast<u64>(volume) >> 63u) != 0lu);
    let offset = f32(volume * side);
    if (is_zero(offset)) {
        return; // Seen edge-on.
    }
    let edges = vec3<f32>(
        product(vec3<f32>(across(b, c) * side), direction),
        product(vec3<f32>(across(c, a) * side), direction),
        product(vec3<f32>(across(a, b) * side), direction),
    );
    if (!is_inside(edges.x) || !is_inside(edges.y) || !is_inside(edges.z)) {
        return;
    }
    let steepness = product(vec3<f32>(normal * side), direction);
    if (is_zero(steepness)) {
        return; // Within its plane.
    }
    let t = offset * near_newton(steepness);
    // Neither infinite nor no number.
    if ((bitcast<u32>(t) & 0x7FFFFFFFu) >= 0x7F800000u || !(t >= nearest_m && t <= met_m)) {
        return;
    }
    let triangle = order[slot] & ~PANE;
    let is_first = instance < met_instance || (instance == met_instance && triangle < met_triangle);
    if (t < met_m || is_first) {
        met_m = t;
        met_instance = instance;
        met_triangle = triangle;
        met_edges = edges;
    }
}

// Follows the ray through an instance.
fn visit(at: u32) {
    let x = vector_at(at);
    let y = vector_at(at + 3u);
    let z = vector_at(at + 6u);
    let off = vec3<f64>(from_m) - vec3<f64>(vector_at(at + 9u));
    let origin = vec3<f64>(
        f64(x.x) * off.x + f64(x.y) * off.y + f64(x.z) * off.z,
        f64(y.x) * off.x + f64(y.y) * off.y + f64(y.z) * off.z,
        f64(z.x) * off.x + f64(z.y) * off.y + f64(z.z) * off.z,
    );
    let direction = vec3<f32>(product(x, along), product(y, along), product(z, along));
    let way = way_of(vec3<f32>(origin), direction, float_at(at + 15u));
    let first_node = job[at + 12u];
    let first_slot = job[at + 13u];
    let instance = job[at + 14u];
    let root = 2u * first_node;
    var count = 0u;
    let at_root = entry(way, bitcast<vec3<f32>>(nodes[root].xyz), bitcast<vec3<f32>>(nodes[root + 1u].xyz));
    if (at_root >= 0.0f) {
        waiting[0] = 0u;
        waiting_m[0] = at_root;
        count = 1u;
    }
    while (count > 0u) {
        count = count - 1u;
        if (waiting_m[count] > met_m * SLACK) {
            continue;
        }
        let node = 2u * (first_node + waiting[count]);
        let first = nodes[node].w;
        let triangles = nodes[node + 1u].w;
        if (triangles != 0u) {
            for (var k = 0u; k < triangles; k = k + 1u) {
                meet(first_slot + first + k, origin, direction, instance);
            }
            continue;
        }
        let child = 2u * (first_node + first);
        let left = entry(way, bitcast<vec3<f32>>(nodes[child].xyz), bitcast<vec3<f32>>(nodes[child + 1u].xyz));
        let right = entry(way, bitcast<vec3<f32>>(nodes[child + 2u].xyz), bitcast<vec3<f32>>(nodes[child + 3u].xyz));
        // The nearer one is taken first.
        let is_left_nearer = left <= right;
        let far = max(left, right);
        let near = min(left, right);
        if (far >= 0.0f) {
            waiting[count] = first + select(0u, 1u, is_left_nearer);
            waiting_m[count] = far;
            count = count + 1u;
        }
        if (near >= 0.0f) {
            waiting[count] = first + select(1u, 0u, is_left_nearer);
            waiting_m[count] = near;
            count = count + 1u;
        }
    }
}

// Follows the ray through a tree over instances, whose nodes begin at a word of the job.
fn walk(first_node: u32, records: u32) {
    let reach_low = abs(vector_at(first_node));
    let reach_high = abs(vector_at(first_node + 4u));
    let reach = max(
        max(max(reach_low.x, reach_low.y), reach_low.z),
        max(max(reach_high.x, reach_high.y), reach_high.z),
    );
    let way = way_of(from_m, along, reach);
    var count = 0u;
    let at_root = entry(way, vector_at(first_node), vector_at(first_node + 4u));
    if (at_root >= 0.0f) {
        outer_waiting[0] = 0u;
        outer_waiting_m[0] = at_root;
        count = 1u;
    }
    while (count > 0u) {
        count = count - 1u;
        if (outer_waiting_m[count] > met_m * SLACK) {
            continue;
        }
        let node = first_node + outer_waiting[count] * NODE_WORDS;
        let first = job[node + 3u];
        let instances = job[node + 7u];
        if (instances != 0u) {
            for (var k = 0u; k < instances; k = k + 1u) {
                visit(records + (first + k) * RECORD_WORDS);
            }
            continue;
        }
        let child = first_node + first * NODE_WORDS;
        let left = entry(way, vector_at(child), vector_at(child + 4u));
        let right = entry(way, vector_at(child + 8u), vector_at(child + 12u));
        let is_left_nearer = left <= right;
        let far = max(left, right);
        let near = min(left, right);
        if (far >= 0.0f) {
            outer_waiting[count] = first + select(0u, 1u, is_left_nearer);
            outer_waiting_m[count] = far;
            count = count + 1u;
        }
        if (near >= 0.0f) {
            outer_waiting[count] = first + select(1u, 0u, is_left_nearer);
            outer_waiting_m[count] = near;
            count = count + 1u;
        }
    }
}

@compute @workgroup_size(64)
fn rays(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let number = group.y * groups.x + group.x;
    if (number >= job[0]) {
        return;
    }
    let in_group = job[1] + number * GROUP_WORDS;
    let query = job[2] + job[in_group] * QUERY_WORDS;
    let records = job[3];
    let ray = job[in_group + 1u] + thread;
    let count = job[query + 5u];
    if (ray >= count) {
        return;
    }
    from_m = vector_at(query);
    along = vector_at(job[query + 6u] + 3u * ray);
    nearest_m = float_at(query + 4u);
    if (job[query + 7u] != NONE) {
        nearest_m = float_at(job[query + 7u] + ray);
    }
    met_m = float_at(query + 3u);
    met_instance = SKY;
    met_triangle = SKY;
    met_edges = vec3<f32>(0.0f);
    let size = bitcast<vec3<u32>>(along) & vec3<u32>(0x7FFFFFFFu);
    // Directions that are no numbers meet nothing.
    if (size.x < 0x7F800000u && size.y < 0x7F800000u && size.z < 0x7F800000u) {
        for (var tree = 0u; tree < TREES; tree = tree + 1u) {
            if (job[query + 9u + tree] != NONE) {
                walk(job[query + 9u + tree], records);
            }
        }
        let some = job[query + 13u];
        for (var k = 0u; k < job[query + 14u]; k = k + 1u) {
            visit(records + (some + k) * RECORD_WORDS);
        }
    }
    let is_met = met_instance != SKY;
    let sum = met_edges.x + met_edges.y + met_edges.z;
    // A ray through a corner within rounding can have three zero edges; any weights do.
    var scale = reciprocal(sum);
    if (is_zero(sum)) {
        scale = 0.0f;
    }
    let at = job[query + 8u] + ray;
    answers[at] = select(0x7F800000u, bitcast<u32>(met_m), is_met);
    answers[at + count] = met_instance;
    answers[at + 2u * count] = met_triangle;
    answers[at + 3u * count] = select(0u, bitcast<u32>(met_edges.y * scale), is_met);
    answers[at + 4u * count] = select(0u, bitcast<u32>(met_edges.z * scale), is_met);
}
