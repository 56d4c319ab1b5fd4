//! Meadows and reed.

use glam::Vec3;
use schema::geometry::Surface;

use super::grown::{Budget, Grows, Look, Patch, USUAL};
use crate::actors::ActorMesh;
use crate::actors::plants::leaves::Draws;

/// Linear colours of the grass of meadows: fresh, light, yellow, in seed.
const GRASS: [[f32; 3]; 4] =
    [[0.166, 0.319, 0.074], [0.208, 0.354, 0.094], [0.299, 0.361, 0.113], [0.242, 0.309, 0.1]];
/// Of flowers in it.
const HEADS: [[f32; 3]; 4] = [[0.75, 0.6, 0.05], [0.7, 0.7, 0.66], [0.55, 0.12, 0.3], [0.3, 0.2, 0.55]];

/// A way along the ground (unit).
fn level_way(draws: &mut Draws) -> Vec3 {
    let ([x, y], _) = draws.disc();
    Vec3::new(x, y, 0.0).normalize_or(Vec3::X)
}

/// A meadow: tufts of three blades, some with a flower.
pub(super) fn meadow(size: Vec3, look: Look) -> ActorMesh {
    // Few wide blades would look like agaves.
    let budget = Budget { on_m2: 16.0, triangles: [960.0, 640.0, 160.0, 30.0] };
    let triangles = budget.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Grass, triangles[0] * 1.1);
    let mut draws = look.draws(70);
    let greens = patch.shades(look.tinted(GRASS));
    let straw = patch.leaf([0.36, 0.33, 0.14]);
    let heads = [0, 1].map(|k| patch.leaf(HEADS[(look.colour + k) % 4]));
    let places = patch.places(triangles[0] / 3.0, &mut draws);
    for foot in places {
        let high = size.z * draws.uniform(0.5, 1.0);
        for k in 0..3 {
            let way = level_way(&mut draws);
            let high = high * draws.uniform(0.7, 1.0);
            let foot = foot + way * 0.04;
            let tip = foot + way * (high * draws.uniform(0.12, 0.6)) + Vec3::Z * high;
            let part = if draws.unit() < 0.12 { straw } else { greens[draws.pick(3)] };
            let across = Vec3::new(-way.y, way.x, 0.0) + 0.5 * level_way(&mut draws);
            let wide = (0.022 + 0.03 * size.z) * draws.uniform(0.8, 1.3);
            patch.blade((part, Grows::Across), [foot, tip], across.normalize_or(Vec3::X), wide);
            if k == 0 && draws.unit() < 0.11 {
                let at = tip - Vec3::Z * 0.03;
                patch.short(
                    heads[usize::from(draws.unit() < 0.4)],
                    at,
                    [way, Vec3::Z + draws.direction() * 0.5],
                    0.05,
                    1.0,
                );
            }
        }
    }
    patch.into_actor(triangles)
}

/// Reed: stems with leaves and plumes.
pub(super) fn reed(size: Vec3, look: Look) -> ActorMesh {
    let triangles = USUAL.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Grass, triangles[0] * 1.1);
    let mut draws = look.draws(71);
    let green = [[0.159, 0.261, 0.078], [0.196, 0.279, 0.09], [0.294, 0.317, 0.125], [0.144, 0.231, 0.074]];
    let greens = patch.shades(look.tinted(green));
    let straw = patch.leaf([0.3, 0.25, 0.13]);
    let plume = patch.leaf([0.19, 0.13, 0.09]);
    let places = patch.places(triangles[0] / 3.4, &mut draws);
    for foot in places {
        let lean = level_way(&mut draws) * draws.uniform(0.02, 0.12);
        let high = size.z * draws.uniform(0.66, 0.97);
        let up = (Vec3::Z + lean) * high;
        let stem = if draws.unit() < 0.3 { straw } else { greens[0] };
        let across = level_way(&mut draws);
        patch.blade((stem, Grows::Gone), [foot, foot + up], across, 0.03);
        for _ in 0..2 {
            let at = foot + up * draws.uniform(0.25, 0.75);
            let way = level_way(&mut draws);
            let long = size.z * draws.uniform(0.2, 0.32);
            let tip = at + way * (long * draws.uniform(0.35, 0.7)) + Vec3::Z * long * draws.uniform(0.5, 0.9);
            let side = Vec3::new(-way.y, way.x, 0.0);
            let part = greens[draws.pick(3)];
            patch.blade((part, Grows::Mostly), [at, tip], side, 0.055);
        }
        if draws.unit() < 0.4 {
            let top = foot + up;
            let tip = top + lean * 1.5 + Vec3::Z * 0.05 * size.z;
            patch.blade((plume, Grows::Across), [top - Vec3::Z * 0.09 * size.z, tip], across, 0.05);
        }
    }
    patch.into_actor(triangles)
}
