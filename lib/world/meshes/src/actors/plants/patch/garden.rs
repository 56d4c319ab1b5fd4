//! Flower beds, undergrowth, and what climbs up walls.

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::Surface;

use super::grown::{Budget, Look, Patch};
use crate::actors::ActorMesh;

/// Linear colours of flowers: red, orange, yellow, white, pink, violet, blue.
const FLOWERS: [[f32; 3]; 7] = [
    [0.6, 0.03, 0.03],
    [0.75, 0.22, 0.02],
    [0.8, 0.6, 0.04],
    [0.75, 0.75, 0.7],
    [0.7, 0.2, 0.35],
    [0.3, 0.08, 0.45],
    [0.12, 0.15, 0.55],
];

/// A bed of flowers in drifts of three colours.
pub(super) fn flowers(size: Vec3, look: Look) -> ActorMesh {
    let budget = Budget { on_m2: 3.0, triangles: [600.0, 240.0, 70.0, 16.0] };
    let triangles = budget.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(75);
    let greens = patch.shades([0.088, 0.142, 0.064]);
    let first = 2 * look.shape as usize + look.colour;
    let heads = [0, 1, 3].map(|k| patch.leaf(FLOWERS[(first + k) % FLOWERS.len()]));
    let places = patch.places(triangles[0] / 6.0, &mut draws);
    let start = draws.uniform(0.0, 6.0);
    for foot in places {
        let high = size.z * draws.uniform(0.6, 0.95);
        for _ in 0..4 {
            let out = draws.direction() * Vec3::new(1.0, 1.0, 0.0);
            let z = high * draws.uniform(0.15, 0.8);
            let at = foot + out * 0.07 + Vec3::Z * z;
            let way = out + Vec3::Z * draws.uniform(0.2, 1.2);
            let face = Vec3::Z * 0.8 + draws.direction();
            let side = (0.33 * size.z).clamp(0.05, 0.14);
            patch.short(greens[draws.pick(3)], at, [way, face], side, 2.0);
        }
        let (wave, other) = sin_cos(start + 2.2 * foot.x + 1.3 * foot.y);
        let drift = usize::from(wave > 0.3) + usize::from(other > 0.2);
        // Two leaves of a blossom that looks up.
        let at = foot + Vec3::Z * high;
        let face = Vec3::Z + draws.direction() * 0.6;
        let way = draws.direction();
        let side = draws.uniform(0.07, 0.1);
        for way in [way, -way] {
            patch.short(heads[drift], at + way * 0.012, [way, face], side, 0.8);
        }
    }
    patch.into_actor(triangles)
}

/// Undergrowth: bushes that grow into one another.
pub(super) fn shrubs(size: Vec3, look: Look) -> ActorMesh {
    let budget = Budget { on_m2: 16.0, triangles: [1400.0, 500.0, 130.0, 36.0] };
    let triangles = budget.on((size.x * size.y).min(budget.on_m2));
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(76);
    let green = [[0.101, 0.172, 0.074], [0.132, 0.198, 0.087], [0.146, 0.199, 0.097], [0.09, 0.148, 0.068]];
    let kinds = [0, 1].map(|k| patch.shades(Look { colour: look.colour + k, ..look }.tinted(green)));
    // One bush on two to three square metres.
    let places = patch.places((size.x * size.y / 2.6).clamp(2.0, 9.0), &mut draws);
    let half = Vec3::new(0.5 * size.x, 0.5 * size.y, 0.0);
    let radius = (0.75 * (size.x * size.y / places.len() as f32).sqrt()).min(half.x.min(half.y));
    let bushes: Vec<(Vec3, Vec3)> = places
        .iter()
        .enumerate()
        .map(|(i, at)| {
            let wide = radius * draws.uniform(0.8, 1.05);
            let high = size.z * if i == 0 { 1.0 } else { draws.uniform(0.55, 1.0) };
            let room = (half - Vec3::splat(0.8 * wide)).max(Vec3::ZERO);
            let at = at.clamp(-room, room);
            (Vec3::new(at.x, at.y, 0.42 * high), Vec3::new(wide, wide, 0.58 * high))
        })
        .collect();
    let mut bars = Vec::new();
    for (middle, radii) in &bushes {
        for _ in 0..2 {
            let foot = Vec3::new(middle.x, middle.y, 0.0);
            let way = draws.direction() * radii * 0.6;
            bars.push((foot, *middle + Vec3::new(way.x, way.y, 0.3 * radii.z), [0.03, 0.012]));
        }
    }
    patch.bars([0.11, 0.085, 0.06], &bars, 3);
    let whole: f32 = bushes.iter().map(|(_, r)| r.x * (r.x + r.z)).sum();
    let area = 1.35 * size.x * size.y;
    let side = (2.0 * area / triangles[0]).sqrt().clamp(0.1, 0.26);
    for (number, (middle, radii)) in bushes.iter().enumerate() {
        let count = triangles[0] * radii.x * (radii.x + radii.z) / whole;
        for _ in 0..count as usize {
            // More of them outside.
            let way = draws.direction();
            let out = 1.0 - 0.5 * draws.unit() * draws.unit();
            let mut at = *middle + way * *radii * out;
            // What would be in the ground is in the bush.
            at.z = if at.z < 0.08 { 0.08 + (0.08 - at.z) } else { at.z };
            let outward = (way / *radii).normalize_or(Vec3::Z);
            let shade = draws.pick(3);
            let (lean, face) = (draws.direction(), draws.direction());
            let face = if face.dot(outward) < 0.0 { -face } else { face };
            let ways = [outward + Vec3::Z * 0.2 + lean * 0.5, face + outward * 0.25];
            let one = side * draws.uniform(0.8, 1.2);
            patch.short(kinds[number % 2][shade], at, ways, one, 1.5);
        }
    }
    patch.into_actor(triangles)
}

/// What climbs up a wall at the back face of the box (least y): leaves hang before it and look along y.
pub(super) fn climber(size: Vec3, look: Look) -> ActorMesh {
    let budget = Budget { on_m2: 16.0, triangles: [1200.0, 400.0, 110.0, 28.0] };
    let triangles = budget.on((size.x * size.z).min(20.0));
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(77);
    // Ivy, wild vine in summer and in autumn, another ivy.
    let green = [[0.06, 0.104, 0.049], [0.097, 0.152, 0.067], [0.3, 0.06, 0.03], [0.075, 0.123, 0.058]];
    let greens = patch.shades(look.tinted(green));
    let side = (2.0 * 1.7 * size.x * size.z / triangles[0]).sqrt().clamp(0.1, 0.4);
    let [one, other, third] = [0, 1, 2].map(|_| draws.uniform(0.0, 6.0));
    // How high it reaches by place along the wall, as a share.
    let reach = |x: f32| {
        let (a, _) = sin_cos(one + 2.3 * x);
        let (b, _) = sin_cos(other + 5.1 * x);
        let (c, _) = sin_cos(third + 0.9 * x);
        (0.88 + 0.07 * a + 0.03 * b + 0.08 * c).clamp(0.5, 1.0)
    };
    for i in 0..triangles[0] as usize {
        let x = size.x * ((0.618_034 * i as f32).fract() - 0.5);
        // The ends are ragged, and fewer leaves are at the top.
        let end = (2.0 * x / size.x).abs();
        let high = size.z * reach(x) * (1.0 - 0.35 * end * end * end * end);
        let u = draws.unit();
        let z = (0.02 + 0.98 * u * (0.9 + 0.1 * u)) * high;
        let y = size.y * (draws.unit() - 0.5);
        let face = Vec3::Y + draws.direction() * 0.75 + Vec3::Z * 0.15;
        let way = Vec3::new(draws.uniform(-0.6, 0.6), 0.2, -1.0);
        let one = side * draws.uniform(0.75, 1.25);
        patch.short(greens[draws.pick(3)], Vec3::new(x, y, z), [way, face], one, 1.15);
    }
    patch.into_actor(triangles)
}
