//! What gathers along kerbs: grime, leaves, and the grates that rain drains into.

use crate::textures::Noise;
use glam::Vec3;
use simd::{F32x8, Vec3x8, smoothstep, unit};

use super::cells::in_cell;
use super::lane::Kerbed;
use super::pattern::{Width, bars};
use super::shaded_triangle::{Points, shades};

/// How far from a kerb anything lies, metres; within lanes that are narrower, less far by as much.
const REACH_M: f32 = 0.9;
/// Dust and soot, linear RGB.
const GRIME: Vec3 = Vec3::new(0.040, 0.035, 0.029);
/// Leaves that have fallen: from these two colours, linear RGB.
const LEAVES: [Vec3; 2] = [Vec3::new(0.105, 0.062, 0.026), Vec3::new(0.235, 0.155, 0.034)];
/// One leaf in a square of this side (a power of two, so that the wrapped world has no seam), metres.
const LEAF_CELL_M: f32 = 0.125;
/// Radius of a leaf, metres.
const LEAF_M: f32 = 0.028;
/// At most one grate on a side of the road in a square of this side (a power of two again), metres, and the
/// share that has one.
const GRATE_CELL_M: f32 = 16.0;
/// See [`GRATE_CELL_M`].
const GRATE_SHARE: f32 = 0.45;
/// A grate: its half length along the kerb, from where to where across, metres.
const GRATE_M: [f32; 3] = [0.24, 0.03, 0.34];
const IRON: Vec3 = Vec3::new(0.045, 0.042, 0.040);

/// A road's albedo with what lies on it along its kerbs; `stones` is the brightness of its grain.
#[inline]
pub(super) fn soiled(
    kerbed: &Kerbed,
    noise: &Noise,
    p: &Points,
    mut albedo: Vec3x8,
    stones: &F32x8,
) -> Vec3x8 {
    let away_m = kerbed.away_m(&p.object_m);
    if away_m.simd_lt(REACH_M).none() {
        return albedo;
    }
    let noised = |per_m: f32| noise.at_all(p.world_m.x * per_m, p.world_m.y * per_m, p.footprint_m * per_m);
    // Nearer to some stretches of a kerb than to others.
    let cloud = noised(1.0) * 0.6 + noised(8.0) * 0.4;
    let narrow = (kerbed.width_m() / REACH_M).min(1.0);
    let reach = (cloud * 0.7 + 0.15) * narrow;
    let grime = 1.0 - smoothstep(0.0, 1.0, away_m / reach);
    albedo = albedo.lerp(shades(GRIME, *stones), grime * 0.85);
    // The joint at the kerb's foot.
    let edge = |from_m: f32| {
        ((from_m - away_m) / p.footprint_m.fast_max(F32x8::splat(0.004)) + 0.5)
            .fast_clamp(F32x8::ZERO, F32x8::ONE)
    };
    albedo *= 1.0 - edge(0.012) * 0.55;
    let littered = smoothstep(0.45, 0.8, noised(0.25)) * grime * 0.7;
    if littered.simd_gt(0.0).any() {
        let (leaf, rgb) = leaves(p, littered);
        albedo = albedo.lerp(rgb, leaf);
    }
    if let Some((iron, shade)) = grate(kerbed, p, &away_m) {
        albedo = albedo.lerp(shades(IRON, shade), iron);
    }
    albedo
}

/// Shares that are a grate, and its brightness; none where there is none near.
#[inline]
fn grate(kerbed: &Kerbed, p: &Points, away_m: &F32x8) -> Option<(F32x8, F32x8)> {
    let [half_m, from_m, to_m] = GRATE_M;
    let w = p.footprint_m.fast_max(F32x8::splat(0.004));
    let (word, [dx, dy]) = in_cell(p, GRATE_CELL_M, 131, 0.0);
    // As far along the road as a place somewhere in the square. Ground lies in its object's frame as in the
    // world.
    let along = kerbed.along();
    let off_m = dx * along.x + dy * along.y;
    let has_one = unit(word * 0xc2b2_ae35u32).simd_lt(GRATE_SHARE);
    let near = has_one & off_m.abs().simd_lt(w * 0.5 + half_m) & away_m.simd_lt(w * 0.5 + to_m);
    if near.none() {
        return None;
    }
    let within = |inside_m: F32x8| (inside_m / w + 0.5).fast_clamp(F32x8::ZERO, F32x8::ONE);
    let iron = within(half_m - off_m.abs()) * within(to_m - *away_m) * within(*away_m - from_m);
    let slots = bars(off_m * (1.0 / 0.06), 0.5, Width::new(w * (1.0 / 0.06)));
    let frame = within(off_m.abs() - (half_m - 0.03)).fast_max(within(*away_m - (to_m - 0.03)));
    Some((near.select(iron, F32x8::ZERO), (slots.fast_max(frame)) * 0.9 + 0.12))
}

/// Shares that are leaves, and their colour, where such a share of squares has one.
#[inline]
fn leaves(p: &Points, littered: F32x8) -> (F32x8, Vec3x8) {
    let (word, [dx, dy]) = in_cell(p, LEAF_CELL_M, 57, LEAF_M * 1.6);
    // Longer than broad, any way.
    let turn = unit(word * 0x9e37_79b9u32) * 2.0 - 1.0;
    let lean = (1.0 - turn * turn).fast_max(F32x8::ZERO).sqrt();
    let (length, breadth) = ((dx * turn + dy * lean) * 0.65, (dy * turn - dx * lean) * 1.5);
    let radius = (length * length + breadth * breadth).sqrt();
    let w = p.footprint_m.fast_max(F32x8::splat(0.002));
    let disc = ((LEAF_M - radius) / w + 0.5).fast_clamp(F32x8::ZERO, F32x8::ONE);
    let is_there = unit(word * 0x27d4_eb2fu32).simd_lt(littered);
    // From afar so much of each square is covered.
    const MEAN: f32 = std::f32::consts::PI * LEAF_M * LEAF_M / (0.65 * 1.5) / (LEAF_CELL_M * LEAF_CELL_M);
    let near = 1.0 - smoothstep(0.25 * LEAF_CELL_M, LEAF_CELL_M, p.footprint_m);
    let leaf = is_there.select(disc, F32x8::ZERO) * near + littered * MEAN * (1.0 - near);
    let kind = unit(word * 0x85eb_ca6bu32) * near + (1.0 - near) * 0.5;
    (leaf, Vec3x8::splat(LEAVES[0]).lerp(Vec3x8::splat(LEAVES[1]), kind))
}
