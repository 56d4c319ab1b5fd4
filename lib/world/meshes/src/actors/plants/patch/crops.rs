//! What grows in rows: maize, wheat, vines.

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::Surface;

use super::grown::{Budget, Grows, Look, Patch, USUAL};
use crate::actors::ActorMesh;

/// From row to row, metres; patches that stand side by side go on with it as nearly as whole rows do.
const MAIZE_ROWS_M: f32 = 0.75;
const WHEAT_ROWS_M: f32 = 0.15;
/// From plant to plant in a row, metres.
const MAIZE_M: f32 = 0.2;
/// From the middle of a row of vines to where its leaves end, metres.
const VINE_HALF_M: f32 = 0.32;

/// The middles of rows about so far apart that fill a width.
fn rows(width_m: f32, apart_m: f32) -> impl Iterator<Item = f32> {
    let count = (width_m / apart_m).round().max(1.0);
    (0..count as usize).map(move |i| width_m * ((i as f32 + 0.5) / count - 0.5))
}

/// Rows of maize along x.
pub(super) fn maize(size: Vec3, look: Look) -> ActorMesh {
    let budget = Budget { on_m2: 16.0, triangles: [1000.0, 360.0, 95.0, 26.0] };
    let triangles = budget.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(72);
    let green = [[0.147, 0.23, 0.097], [0.161, 0.244, 0.106], [0.181, 0.246, 0.113], [0.233, 0.251, 0.131]];
    let greens = patch.shades(look.tinted(green));
    let (stem, tassel) = (patch.leaf([0.186, 0.241, 0.125]), patch.leaf([0.33, 0.27, 0.12]));
    // Large fields have fewer plants in a row than grow there.
    let rows: Vec<f32> = rows(size.y, MAIZE_ROWS_M).collect();
    let in_row = (size.x / MAIZE_M).min(triangles[0] / 10.0 / rows.len() as f32).floor().max(1.0);
    for y in rows {
        for i in 0..in_row as usize {
            let x = size.x * ((i as f32 + draws.uniform(0.2, 0.8)) / in_row - 0.5);
            let foot = Vec3::new(x, y + draws.uniform(-0.04, 0.04), 0.0);
            let high = size.z * draws.uniform(0.82, 0.93);
            let top = foot + Vec3::Z * high;
            let (sin, cos) = sin_cos(draws.uniform(0.0, std::f32::consts::PI));
            patch.blade((stem, Grows::Gone), [foot, top], Vec3::new(cos, sin, 0.0), 0.05);
            // Leaves to both sides in turn, as they grow; many reach between the rows.
            let turn = draws.uniform(0.6, 2.5);
            for k in 0..4 {
                let angle = turn + if k % 2 == 0 { 0.0 } else { std::f32::consts::PI };
                let (sin, cos) = sin_cos(angle + draws.uniform(-0.4, 0.4));
                let way = Vec3::new(cos, sin, 0.0);
                let at = foot + Vec3::Z * high * (0.12 + 0.2 * k as f32 + draws.uniform(-0.05, 0.05));
                let long = size.z * draws.uniform(0.19, 0.29);
                let knee = at + way * (0.55 * long) + Vec3::Z * (0.5 * long);
                let tip = at + way * (1.15 * long) + Vec3::Z * (draws.uniform(-0.35, 0.25) * long);
                patch.bent(greens[draws.pick(3)], [at, knee, tip], 0.09);
            }
            let tip = top + Vec3::Z * (size.z - high);
            let side = Vec3::new(sin, -cos, 0.0);
            patch.blade((tassel, Grows::Across), [top - Vec3::Z * 0.12, tip], side, 0.05);
        }
    }
    patch.into_actor(triangles)
}

/// Rows of wheat along x; each triangle stands for some stalks.
pub(super) fn wheat(size: Vec3, look: Look) -> ActorMesh {
    let triangles = USUAL.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(73);
    // Ripe but for one.
    let ripe = [[0.62, 0.46, 0.19], [0.68, 0.52, 0.24], [0.55, 0.46, 0.17], [0.223, 0.297, 0.148]];
    let [dark, middle, light] = patch.shades(look.tinted(ripe));
    let rows: Vec<f32> = rows(size.y, WHEAT_ROWS_M).collect();
    let in_row = (triangles[0] / rows.len() as f32).floor().max(1.0);
    for y in rows {
        for i in 0..in_row as usize {
            let x = size.x * ((i as f32 + draws.unit()) / in_row - 0.5);
            let foot = Vec3::new(x, y + draws.uniform(-0.03, 0.03), 0.0);
            let (sin, cos) = sin_cos(draws.uniform(0.0, std::f32::consts::PI));
            let across = Vec3::new(cos, sin, 0.0);
            let ([u, v], _) = draws.disc();
            let high = size.z * draws.uniform(0.78, 0.9);
            let tip = foot + Vec3::new(0.09 * u, 0.09 * v, 1.0) * high;
            if i % 3 == 2 {
                // Ears.
                let to = tip + Vec3::new(0.05 * v, 0.05 * u, 0.1 * size.z);
                patch.blade((light, Grows::Alike), [tip - Vec3::Z * 0.06, to], across, 0.07);
            } else {
                // Wider above, where the ears are.
                let part = [dark, middle, light][draws.pick(3)];
                let half = across * 0.036;
                patch.triangle(
                    (part, Grows::Across),
                    [tip + half, tip - half, foot],
                    (tip - foot).normalize_or(Vec3::Z),
                );
            }
        }
    }
    patch.into_actor(triangles)
}

/// A row of vines along x in the middle of its rectangle, with stocks and a post.
pub(super) fn vines(size: Vec3, look: Look) -> ActorMesh {
    let budget = Budget { on_m2: 8.0, triangles: [900.0, 330.0, 90.0, 24.0] };
    let triangles = budget.on(size.x * size.y);
    let mut patch = Patch::new(size, Surface::Foliage, triangles[0]);
    let mut draws = look.draws(74);
    let stocks = size.x.round().max(1.0);
    let mut bars = vec![(Vec3::ZERO, Vec3::Z * 0.97 * size.z, [0.04, 0.04])];
    for i in 0..stocks as usize {
        let x = size.x * ((i as f32 + 0.5) / stocks - 0.5);
        let foot = Vec3::new(x, draws.uniform(-0.04, 0.04), 0.0);
        let top = Vec3::new(x + draws.uniform(-0.1, 0.1), 0.0, 0.5 * size.z);
        bars.push((foot, top, [0.035, 0.02]));
    }
    patch.bars([0.15, 0.11, 0.08], &bars, 3);
    // Leaves would float without it.
    patch.solid_until = 3;
    let green = [[0.107, 0.161, 0.07], [0.124, 0.172, 0.077], [0.162, 0.176, 0.084], [0.25, 0.13, 0.04]];
    let greens = patch.shades(look.tinted(green));
    let half = VINE_HALF_M.min(0.5 * size.y);
    for i in 0..triangles[0] as usize {
        let x = size.x * ((0.618_034 * i as f32).fract() - 0.5);
        let ([across, _], _) = draws.disc();
        let z = size.z * (0.34 + 0.64 * draws.unit());
        // Narrower at the top.
        let reach = half * (1.15 - 0.6 * z / size.z);
        let at = Vec3::new(x, across * reach, z);
        let way = Vec3::new(0.0, across, -0.8) + draws.direction() * 0.6;
        let face = Vec3::new(0.0, across * 1.5, 0.4) + draws.direction();
        let side = 0.17 * draws.uniform(0.8, 1.2);
        patch.short(greens[draws.pick(3)], at, [way, face], side, 1.15);
    }
    patch.into_actor(triangles)
}
