// What cameras see. One workgroup draws one tile; each of its threads keeps eight pixels of a row.
//
// Nodes of search trees are taken off a stack, many at a time, until they are small enough; their triangles are set
// up, one by a thread, and then drawn by all threads, each over its own pixels. In which order triangles come does
// not matter: of each pixel the nearest is kept, of equally near ones the smaller (instance, triangle). Boxes, bounds
// and the farthest depth drawn only leave out what cannot be seen. What decides (`place`, `outline`, `cover`) are the
// operations of `render::cpu`, one by one: `raster/tile.rs` and `outline.rs` there.

struct Drawn {
    // Per column, per row, at the first pixel.
    edges: array<vec3<f32>, 3>,
    inverse: vec3<f32>,
    // Least inverse depth of the corners, and the greatest; of a triangle that reaches before the near depth, the
    // inverse of that, above which nothing is seen.
    least: f32,
    greatest: f32,
    // First and last column and row, six bits each.
    bounds: u32,
    // Bits 0 to 2: edges that belong to the triangle. Bit 3: it lies wholly beyond the near depth. Bits 4 to 7: at
    // which pixels of two by two it is opaque.
    flags: u32,
    instance: u32,
    triangle: u32,
}

struct Lens {
    step: vec2<f64>,
    first: vec2<f64>,
    focal: vec2<f32>,
    near_m: f32,
    inverse_near: f32,
}

// In the job: tiles, cameras, instances and entries of tiles, as `job.rs` writes them; before them where each begins.
const TILE_WIDTH: u32 = 64u;
const TILE_PIXELS: u32 = 2048u;
const TILE_WORDS: u32 = 10u;
const CAMERA_WORDS: u32 = 10u;
const INSTANCE_WORDS: u32 = 18u;

// Nodes taken off the stack at a time, and the room that the stack has. As many words are kept free as a tree may be
// deep.
const TAKEN: u32 = 64u;
const ROOM: u32 = 1024u;
const SPARE: u32 = 64u;
// Triangles that are set up at a time, and of one node.
const SET_UP: u32 = 128u;
const BATCH: u32 = 16u;

const STACKED: u32 = 0u;
const BATCHES: u32 = 1u;
const DRAWN: u32 = 2u;
const LEAST_INVERSE: u32 = 3u;

const MARGIN_PX: f32 = 0.01f;
const DEPTH_SLACK: f32 = 1.00001f;

// Places of nodes: which entry of `instances`, and which node of its mesh.
var<workgroup> stack: array<vec2<u32>, 1024>;
// Instance, first slot, how many.
var<workgroup> batches: array<vec3<u32>, 64>;
var<workgroup> drawn: array<Drawn, 128>;
// How many of these there are, and the bits of the least inverse depth of all pixels.
var<workgroup> counts: array<atomic<u32>, 4>;
// What all threads are told.
var<workgroup> told: u32;

// The product of a vector with the pixels' directions: per column, per row, at the first pixel.
fn along_rays(lens: Lens, v: vec3<f64>) -> vec3<f32> {
    let per_column = v.x * lens.step.x;
    let per_row = v.y * lens.step.y;
    let start = v.z + per_column * lens.first.x + per_row * lens.first.y;
    return vec3<f32>(f32(per_column), f32(per_row), f32(start));
}

// Whether an edge belongs to the triangle: to the one of two neighbours for which it grows along the row.
fn owns(edge: vec3<f32>) -> bool {
    return is_positive(edge.x) || (is_zero(edge.x) && is_positive(edge.y));
}

// Whether a box is outside of one of the half spaces whose normal, in the optical frame, is (x, y, z).
fn is_outside(at: u32, normal: vec3<f32>, offset: f32, slack_m: f32, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let object = vector_at(at) * normal.x + vector_at(at + 3u) * normal.y + vector_at(at + 6u) * normal.z;
    let slack = slack_m * (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let nearest = product(object, centre) + product(normal, vector_at(at + 9u)) + offset + slack;
    return nearest + product(abs(object), half) < 0.0f;
}

// Takes a node: leaves it out, or puts its children on the stack, or its triangles among the batches.
fn visit(item: vec2<u32>, instances: u32, lens: Lens, farthest_m: f32) {
    let at = instances + item.x * INSTANCE_WORDS;
    let node = 2u * (job[at + 15u] + item.y);
    let low = nodes[node];
    let high = nodes[node + 1u];
    let lowest = bitcast<vec3<f32>>(low.xyz);
    let highest = bitcast<vec3<f32>>(high.xyz);
    let centre = (lowest + highest) * 0.5f;
    let half = (highest - lowest) * 0.5f;
    let slack_m = float_at(at + 13u);
    // Half a pixel outside the outermost centres.
    let left = f32((lens.first.x - 0.5lf) * lens.step.x);
    let right = f32((lens.first.x + 63.5lf) * lens.step.x);
    let top = f32((lens.first.y - 0.5lf) * lens.step.y);
    let bottom = f32((lens.first.y + 31.5lf) * lens.step.y);
    if (is_outside(at, vec3<f32>(1.0f, 0.0f, -left), 0.0f, slack_m, centre, half)
        || is_outside(at, vec3<f32>(-1.0f, 0.0f, right), 0.0f, slack_m, centre, half)
        || is_outside(at, vec3<f32>(0.0f, 1.0f, -top), 0.0f, slack_m, centre, half)
        || is_outside(at, vec3<f32>(0.0f, -1.0f, bottom), 0.0f, slack_m, centre, half)
        || is_outside(at, vec3<f32>(0.0f, 0.0f, 1.0f), -lens.near_m, slack_m, centre, half)
        || is_outside(at, vec3<f32>(0.0f, 0.0f, -1.0f), farthest_m * DEPTH_SLACK, slack_m, centre, half)) {
        return;
    }
    if (high.w != 0u) {
        batches[atomicAdd(&counts[BATCHES], 1u)] = vec3<u32>(item.x, low.w, high.w);
        return;
    }
    let children = 2u * (job[at + 15u] + low.w);
    let forward = vector_at(at + 6u);
    let of_left = product(forward, bitcast<vec3<f32>>(nodes[children].xyz))
        + product(forward, bitcast<vec3<f32>>(nodes[children + 1u].xyz));
    let of_right = product(forward, bitcast<vec3<f32>>(nodes[children + 2u].xyz))
        + product(forward, bitcast<vec3<f32>>(nodes[children + 3u].xyz));
    let left_is_nearer = of_left <= of_right;
    let free = atomicAdd(&counts[STACKED], 2u);
    // The nearer one is taken first.
    stack[free] = vec2<u32>(item.x, low.w + select(0u, 1u, left_is_nearer));
    stack[free + 1u] = vec2<u32>(item.x, low.w + select(1u, 0u, left_is_nearer));
}

// A corner in the optical frame.
fn place(at: u32, corner: vec3<f32>) -> vec3<f32> {
    let x = vector_at(at);
    let y = vector_at(at + 3u);
    let z = vector_at(at + 6u);
    return vec3<f32>(
        x.x * corner.x + x.y * corner.y + x.z * corner.z + float_at(at + 9u),
        y.x * corner.x + y.y * corner.y + y.z * corner.z + float_at(at + 10u),
        z.x * corner.x + z.y * corner.y + z.z * corner.z + float_at(at + 11u),
    );
}

// First and last pixel centre along an axis that a triangle wholly beyond the near depth may cover: further than
// rounding, so that nothing hangs on how it is computed.
fn span(p: vec3<f32>, per_depth: vec3<f32>, focal: f32, axis: f32, last: f32) -> vec2<f32> {
    let a = focal * per_depth.x * p.x + axis;
    let b = focal * per_depth.y * p.y + axis;
    let c = focal * per_depth.z * p.z + axis;
    let from_px = ceil(max(min(min(a, b), c) - MARGIN_PX, 0.0f));
    let to_px = floor(min(max(max(a, b), c) + MARGIN_PX, last));
    return vec2<f32>(from_px, to_px);
}

// Sets up the triangle in a slot, and puts it among those that are drawn if it may be seen.
fn set_up(number: u32, instances: u32, slot: u32, lens: Lens, farthest_m: f32) {
    let at = instances + number * INSTANCE_WORDS;
    let here = job[at + 16u] + slot;
    let base = (here >> 3u) * 72u + (here & 7u);
    let a = place(at, vec3<f32>(corners[base], corners[base + 8u], corners[base + 16u]));
    let b = place(at, vec3<f32>(corners[base + 24u], corners[base + 32u], corners[base + 40u]));
    let c = place(at, vec3<f32>(corners[base + 48u], corners[base + 56u], corners[base + 64u]));
    let nearest_m = min(min(a.z, b.z), c.z);
    let far_end_m = max(max(a.z, b.z), c.z);
    if (far_end_m < lens.near_m || nearest_m > farthest_m * DEPTH_SLACK) {
        return;
    }
    let in_front = nearest_m >= lens.near_m;
    var columns = vec2<f32>(0.0f, 63.0f);
    var rows = vec2<f32>(0.0f, 31.0f);
    if (in_front) {
        let per_depth = vec3<f32>(newton(a.z), newton(b.z), newton(c.z));
        columns = span(vec3<f32>(a.x, b.x, c.x), per_depth, lens.focal.x, f32(-lens.first.x), 63.0f);
        rows = span(vec3<f32>(a.y, b.y, c.y), per_depth, lens.focal.y, f32(-lens.first.y), 31.0f);
        if (columns.x > columns.y || rows.x > rows.y) {
            return;
        }
    }
    let p = vec3<f64>(a);
    let q = vec3<f64>(b);
    let r = vec3<f64>(c);
    var normal = across(q - p, r - p);
    let volume = p.x * normal.x + p.y * normal.y + p.z * normal.z;
    if ((bitcast<u64>(volume) << 1u) == 0lu) {
        return; // Seen edge-on.
    }
    let side = select(1.0lf, -1.0lf, (bitcast<u64>(volume) >> 63u) != 0lu);
    normal = normal * side;
    let first = along_rays(lens, across(q, r) * side);
    let second = along_rays(lens, across(r, p) * side);
    let third = along_rays(lens, across(p, q) * side);
    let triangle = order[here];
    let stipple = select(15u, job[at + 17u], (triangle & PANE) != 0u);
    let place_in_list = atomicAdd(&counts[DRAWN], 1u);
    drawn[place_in_list].edges[0] = first;
    drawn[place_in_list].edges[1] = second;
    drawn[place_in_list].edges[2] = third;
    drawn[place_in_list].inverse = along_rays(lens, normal * newton_f64(volume * side));
    drawn[place_in_list].least = newton(far_end_m);
    drawn[place_in_list].greatest = select(lens.inverse_near, newton(nearest_m), in_front);
    drawn[place_in_list].bounds = u32(columns.x) | u32(columns.y) << 6u | u32(rows.x) << 12u | u32(rows.y) << 18u;
    drawn[place_in_list].flags = select(0u, 1u, owns(first)) | select(0u, 2u, owns(second))
        | select(0u, 4u, owns(third)) | select(0u, 8u, in_front) | stipple << 4u;
    drawn[place_in_list].instance = job[at + 14u];
    drawn[place_in_list].triangle = triangle & ~PANE;
}

fn is_inside(value: f32, is_owned: bool) -> bool {
    return is_positive(value) || (is_owned && is_zero(value));
}

// Waits for all threads, and tells them what was counted.
fn tell(thread: u32, counter: u32) -> u32 {
    workgroupBarrier();
    if (thread == 0u) {
        told = atomicLoad(&counts[counter]);
    }
    return workgroupUniformLoad(&told);
}

@compute @workgroup_size(256)
fn visibility(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let number = group.y * groups.x + group.x;
    if (number >= job[0]) {
        return;
    }
    let tile = job[1] + number * TILE_WORDS;
    let camera = job[2] + job[tile] * CAMERA_WORDS;
    let instances = job[3];
    let last_entry = job[4] + job[tile + 2u];
    var next_entry = job[4] + job[tile + 1u];
    var lens: Lens;
    lens.step = vec2<f64>(double_at(camera), double_at(camera + 2u));
    lens.first = vec2<f64>(double_at(tile + 4u), double_at(tile + 6u));
    lens.focal = vec2<f32>(float_at(camera + 4u), float_at(camera + 5u));
    lens.near_m = float_at(camera + 6u);
    lens.inverse_near = float_at(camera + 7u);
    let sky = float_at(camera + 8u);
    let is_numbered = job[camera + 9u] != 0u;

    // Pixels beyond the picture count as drawn.
    let row = thread >> 3u;
    let column = (thread & 7u) << 3u;
    var inverse: array<f32, 8>;
    var instance: array<u32, 8>;
    var triangle: array<u32, 8>;
    for (var i = 0u; i < 8u; i = i + 1u) {
        let is_there = column + i < job[tile + 8u] && row < job[tile + 9u];
        inverse[i] = select(bitcast<f32>(0x7F800000u), sky, is_there);
        instance[i] = SKY;
        triangle[i] = SKY;
    }
    // All that is seen is nearer than the sky.
    var farthest_m = newton(sky);
    if (thread == 0u) {
        atomicStore(&counts[STACKED], 0u);
    }
    loop {
        var waiting = tell(thread, STACKED);
        if (waiting == 0u) {
            if (next_entry >= last_entry) {
                break;
            }
            // The others are no nearer.
            if (float_at(instances + job[next_entry] * INSTANCE_WORDS + 12u) > farthest_m * DEPTH_SLACK) {
                break;
            }
            waiting = min(TAKEN, last_entry - next_entry);
            if (thread < waiting) {
                stack[waiting - 1u - thread] = vec2<u32>(job[next_entry + thread], 0u);
            }
            next_entry = next_entry + waiting;
            workgroupBarrier();
        }
        // Each may leave two where it was.
        var taken = 1u;
        if (waiting + SPARE < ROOM) {
            taken = min(min(waiting, TAKEN), ROOM - SPARE - waiting);
        }
        var item = vec2<u32>(0u, 0u);
        if (thread < taken) {
            item = stack[waiting - 1u - thread];
        }
        if (thread == 0u) {
            atomicStore(&counts[STACKED], waiting - taken);
            atomicStore(&counts[BATCHES], 0u);
        }
        workgroupBarrier();
        if (thread < taken) {
            visit(item, instances, lens, farthest_m);
        }
        let count = tell(thread, BATCHES);
        if (count == 0u) {
            continue;
        }
        for (var chunk = 0u; chunk * SET_UP < count * BATCH; chunk = chunk + 1u) {
            if (thread == 0u) {
                atomicStore(&counts[DRAWN], 0u);
            }
            workgroupBarrier();
            let mine = chunk * (SET_UP >> 4u) + (thread >> 4u);
            if (thread < SET_UP && mine < count) {
                let batch = batches[mine];
                if ((thread & 15u) < batch.z) {
                    set_up(batch.x, instances, batch.y + (thread & 15u), lens, farthest_m);
                }
            }
            let triangles = tell(thread, DRAWN);
            for (var k = 0u; k < triangles; k = k + 1u) {
                let bounds = drawn[k].bounds;
                if (row < ((bounds >> 12u) & 63u) || row > (bounds >> 18u)
                    || column > ((bounds >> 6u) & 63u) || column + 7u < (bounds & 63u)) {
                    continue;
                }
                let flags = drawn[k].flags;
                let down = f32(row);
                let first = drawn[k].edges[0];
                let second = drawn[k].edges[1];
                let third = drawn[k].edges[2];
                let plane = drawn[k].inverse;
                let first_row = first.y * down + first.z;
                let second_row = second.y * down + second.z;
                let third_row = third.y * down + third.z;
                let plane_row = plane.y * down + plane.z;
                let opaque = flags >> (4u + 2u * (row & 1u));
                for (var i = 0u; i < 8u; i = i + 1u) {
                    let along = f32(column + i);
                    var w = plane.x * along + plane_row;
                    let is_in_front = (flags & 8u) != 0u;
                    let is_covered = is_inside(first.x * along + first_row, (flags & 1u) != 0u)
                        && is_inside(second.x * along + second_row, (flags & 2u) != 0u)
                        && is_inside(third.x * along + third_row, (flags & 4u) != 0u)
                        && is_number(w) && (is_in_front || w <= drawn[k].greatest)
                        && ((opaque >> (i & 1u)) & 1u) != 0u;
                    // Within the corners' depths whatever the rounding of a steep plane.
                    if (w < drawn[k].least) {
                        w = drawn[k].least;
                    }
                    if (is_in_front && w > drawn[k].greatest) {
                        w = drawn[k].greatest;
                    }
                    let is_first = drawn[k].instance < instance[i]
                        || (drawn[k].instance == instance[i] && drawn[k].triangle < triangle[i]);
                    if (is_covered && (w > inverse[i] || (w == inverse[i] && is_first))) {
                        inverse[i] = w;
                        instance[i] = drawn[k].instance;
                        triangle[i] = drawn[k].triangle;
                    }
                }
            }
            workgroupBarrier();
        }
        if (thread == 0u) {
            atomicStore(&counts[LEAST_INVERSE], 0x7F800000u);
        }
        workgroupBarrier();
        var least = inverse[0];
        for (var i = 1u; i < 8u; i = i + 1u) {
            least = min(least, inverse[i]);
        }
        // Bits of positive numbers are in the numbers' order.
        atomicMin(&counts[LEAST_INVERSE], bitcast<u32>(least));
        workgroupBarrier();
        farthest_m = newton(bitcast<f32>(tell(thread, LEAST_INVERSE)));
    }

    let at = job[tile + 3u] + row * TILE_WIDTH + column;
    for (var i = 0u; i < 8u; i = i + 1u) {
        // Of depths alone, those of the sky are a hair less than that of the far end.
        let is_sky = select(inverse[i] <= sky, instance[i] == SKY, is_numbered);
        answers[at + i] = select(bitcast<u32>(reciprocal(inverse[i])), 0x7F800000u, is_sky);
        if (is_numbered) {
            answers[at + i + TILE_PIXELS] = instance[i];
            answers[at + i + 2u * TILE_PIXELS] = triangle[i];
        }
    }
}
