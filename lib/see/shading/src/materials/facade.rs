//! House fronts: walls of several kinds with windows in storeys and bays.

use crate::textures::{Noise, Textures};
use glam::Vec3;
use schema::geometry::Wall;
use schema::lights;
use simd::{F32x8, U32x8, Vec3x8, floor_words, hash2, lerp, smoothstep, unit};

use super::front::Front;
use super::pattern::{Width, bars};
use super::room::{Gaze, Pane, inside};
use super::shaded_triangle::{BrdfSample, Points, ShadedTriangle, Specular, shades};

/// Rain splashes dirt up to this height, metres.
const SPLASHED_M: f32 = 2.2;
/// Height of a slat of shutters, metres.
const SLAT_M: f32 = 0.07;
/// Share of windows that are lit at night.
const LIT_SHARE: f32 = 0.42;

/// A house front.
#[inline]
pub(super) fn facade(
    (noise, textures): (&Noise, &Textures),
    facet: &ShadedTriangle<'_>,
    front: &Front,
    p: &Points,
) -> BrdfSample {
    let rgb = Vec3::from_array(facet.part.rgb);
    let (o, w) = (&p.object_m, p.footprint_m);
    let n = facet.normal_object;
    let [right, _] = facet.tangents_object;
    let along = o.x * right.x + o.y * right.y;
    let Front { wall, style, start_m, cell_m, .. } = front;
    let face = wall_face((noise, textures), *wall, rgb, [along, o.z], w);
    let mut sample = BrdfSample::leaning(face.albedo, face.lean);
    if front.is_on_ground && o.z.simd_lt(SPLASHED_M).any() {
        // Splashed by rain: browner and darker near the ground.
        let edge = noise.at_all(along * 6.0, o.z * 6.0, w * 6.0);
        let dirt = (1.0 - smoothstep(-0.1, 1.3, o.z - edge * 0.9)) * 0.55;
        sample.albedo = sample.albedo * Vec3x8::new(1.0 - dirt * 0.75, 1.0 - dirt * 0.85, 1.0 - dirt);
    }
    let Some(windows) = &front.windows else { return sample };
    let [bay_m, storey_m] = *cell_m;
    let (u, v) = ((along - start_m[0]) * (1.0 / bay_m), (o.z - start_m[1]) * (1.0 / storey_m));
    let (wu, wv) = (Width::new(w * (1.0 / bay_m)), Width::new(w * (1.0 / storey_m)));
    let widths = [wu, wv];
    let window = windows.at(u, v, widths);
    let opening = window.share(u, v, widths, [0.0; 2]);
    let ledge = window.ledge(u, v, widths) * style.sill;
    let band = bars(v + 0.03, 0.06, wv) * style.band;
    // Stone around openings, or shutters beside them.
    let [beside, above] = [style.surround_m / bay_m, style.surround_m / storey_m];
    let surround = match style.surround_m > 0.0 {
        true => window.share(u, v, widths, [beside, above]),
        false => F32x8::ZERO,
    };
    let pale = ledge.fast_max(band).fast_max(surround);
    sample.albedo = sample.albedo.lerp(Vec3x8::splat(rgb * 0.35 + Vec3::splat(0.38)), pale * 0.8);
    if let Some(shutter_rgb) = style.shutter_rgb {
        let shut = window.shutters(u, v, widths);
        let slats = bars(o.z * (1.0 / SLAT_M), 0.3, Width::new(w * (1.0 / SLAT_M)));
        sample.albedo = sample.albedo.lerp(shades(shutter_rgb, 1.0 - slats * 0.45), shut);
    }
    let rails = window.rails(u, v, widths, *cell_m, *wall == Wall::Panels);
    if opening.fast_max(rails).simd_gt(0.0).none() {
        return sample;
    }
    // Glass and frame stand back in the wall: what is seen of them is farther along the way one looks.
    let way = *o - Vec3x8::splat(facet.eye_object_m);
    let gaze = Gaze {
        along: way.x * right.x + way.y * right.y,
        up: way.z,
        inward: (way.x * -n.x + way.y * -n.y).fast_max(F32x8::splat(1e-3)),
    };
    let back = F32x8::splat(style.reveal_m) / gaze.inward;
    let (du, dv) = (gaze.along * back * (1.0 / bay_m), gaze.up * back * (1.0 / storey_m));
    let cell = [floor_words(u), floor_words(v - window.lift)];
    let (deep_u, deep_v) = (u + du, v + dv);
    let glass = window.glass(deep_u, deep_v, widths, *cell_m, style.transom) * opening * (1.0 - rails);
    let framed = window.share(deep_u, deep_v, widths, [0.0; 2]) * opening;
    sample.albedo = sample.albedo.lerp(Vec3x8::splat(rgb * 0.55 + Vec3::splat(0.05)), opening);
    sample.albedo = sample.albedo.lerp(Vec3x8::splat(style.frame_rgb), framed);
    sample.lean = sample.lean.map(|lean| lean.map(|v| v * (1.0 - opening)));
    let rail_rgb = if *wall == Wall::Panels { style.panel_rgb } else { Vec3::splat(0.05) };
    sample.albedo = sample.albedo.lerp(Vec3x8::splat(rail_rgb), rails);
    if glass.simd_gt(0.0).none() {
        return sample;
    }
    // A word for each window of each side of each house.
    let side = (8.0 * n.x + 3.0 * n.y).round() as i32;
    let row = cell[1] + U32x8::splat((1000 * side) as u32);
    let word = hash2(cell[0], row, U32x8::splat(u32::from(facet.object).wrapping_mul(0x9e37_79b9)));
    let far = smoothstep(0.12, 0.4, wu.w.fast_max(wv.w));
    let (left_u, floor_v) = (u.floor(), (v - window.lift).floor());
    let pane = Pane {
        at_m: [(deep_u - left_u) * bay_m, (deep_v - window.lift - floor_v) * storey_m],
        size_m: *cell_m,
        in_opening: [
            (deep_u - left_u - window.left) / window.wide,
            (deep_v - floor_v - window.low) / window.high,
        ],
        word,
    };
    // From far away the mean of all rooms is seen.
    let (mut by_day, mut by_night) = (Vec3x8::splat(MEAN_BY_DAY), Vec3x8::splat(Vec3::ONE));
    if far.simd_lt(1.0).any() {
        let seen = inside(&gaze, &pane);
        by_day = seen.by_day.lerp(by_day, far);
        by_night = seen.by_night.lerp(by_night, far);
    }
    sample.albedo = sample.albedo.lerp(by_day * F32x8::splat(style.clear), glass);
    sample.specular = Some(Specular { mirror: glass * style.mirror, roughness: F32x8::splat(0.03) });
    if *wall == Wall::Curtain {
        // No two panes stand quite alike.
        let tilt = |bits: U32x8| (unit(bits) - 0.5) * 0.012 * glass;
        sample.lean = Some([tilt(word * 0x27d4_eb2fu32), tilt(word * 0x1656_67b1u32)]);
    }
    if facet.lights & lights::BUILDING != 0 {
        // Which windows are lit, and how warm; far away all fade to their mean.
        let bright = unit(word * 0x85eb_ca6bu32) * 0.7 + 0.3;
        let warm = unit(word * 0xc2b2_ae35u32);
        let on = unit(word).simd_lt(LIT_SHARE).select(bright, F32x8::ZERO);
        let lit = lerp(on, F32x8::splat(LIT_SHARE * 0.65), far);
        let glow = window_light(facet.glow, word);
        // Rooms of one building differ a little.
        let glow = glow * Vec3x8::new(F32x8::ONE, warm * 0.3 + 1.0, warm * 1.2 + 0.8);
        sample.emission = Some(glow * by_night * (glass * lit * 0.55));
    }
    sample
}

/// Light of windows by their words. Where colours were drawn each window has one of its own, near to its
/// house's and as bright; lamp shades and curtains take it more than half way back to the hue of windows
/// without.
#[inline]
fn window_light(house: Vec3, word: U32x8) -> Vec3x8 {
    // `lights::WINDOW_RGB`, linear.
    const USUAL: Vec3 = Vec3::new(1.0, 0.672, 0.402);
    const DRAWN: f32 = 0.45;
    if (house - USUAL).abs().max_element() < 0.01 {
        return Vec3x8::splat(house);
    }
    let share = |salt: u32| unit(word * salt);
    let shares = [share(0x9e37_79b1) + 1.0, share(0x632b_e5ab), share(0x2545_f491)];
    let all = shares[0] + shares[1] + shares[2];
    let mixed = |a: f32, b: f32, c: f32| (shares[0] * a + shares[1] * b + shares[2] * c) / all;
    let Vec3 { x, y, z } = house;
    let drawn = Vec3x8::new(mixed(x, y, z), mixed(y, z, x), mixed(z, x, y));
    Vec3x8::splat(USUAL * house.max_element().min(1.0)).lerp(drawn, F32x8::splat(DRAWN))
}

/// Share of daylight that comes back out of rooms on average.
const MEAN_BY_DAY: Vec3 = Vec3::new(0.062, 0.06, 0.056);

/// The wall between the windows.
struct Face {
    albedo: Vec3x8,
    lean: [F32x8; 2],
}

#[inline]
fn wall_face(
    (noise, textures): (&Noise, &Textures),
    wall: Wall,
    rgb: Vec3,
    [along, z]: [F32x8; 2],
    w: F32x8,
) -> Face {
    // Rain runs down: stains are long and narrow.
    let stains = noise.at_all(along * 8.0, z * 1.6, w * 8.0);
    let stained = stains * 0.22 + 0.89;
    let texture = match wall {
        Wall::Brick => &textures.brick,
        Wall::Ashlar => &textures.ashlar,
        Wall::Panels => &textures.concrete,
        Wall::Plaster => &textures.plaster,
        Wall::Curtain => {
            let spandrel = shades(rgb * 0.3 + Vec3::splat(0.02), stained);
            return Face { albedo: spandrel, lean: [F32x8::ZERO; 2] };
        }
    };
    let seen = texture.at(along, z, w);
    let mut albedo = shades(rgb, seen.shade * stained);
    if wall == Wall::Brick {
        // Mortar is grey whatever the bricks are.
        let grey = Vec3::splat(0.34) / rgb.max(Vec3::splat(0.05)) - Vec3::ONE;
        let grey = grey.clamp(Vec3::splat(-0.5), Vec3::splat(2.2));
        albedo = albedo
            * Vec3x8::new(seen.tint * grey.x + 1.0, seen.tint * grey.y + 1.0, seen.tint * grey.z + 1.0);
    }
    Face { albedo, lean: seen.lean }
}
