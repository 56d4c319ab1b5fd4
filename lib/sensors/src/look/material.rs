//! Procedural looks of the kinds of surface.
//!
//! Patterns are anchored to the world (ground) or to the object (everything else), never to the camera.

use glam::{Vec2, Vec3};
use schema::ObjectId;
use schema::geometry::{Instance, Part, Surface};
use schema::lights;

use super::noise::{Noise, hash2, unit};
use super::pattern::{bars, smoothstep};

/// Height of a storey, metres.
const STOREY_M: f32 = 3.0;
/// Share of windows that are lit at night.
const LIT_SHARE: f32 = 0.42;

/// What is the same for all points of one triangle.
pub(crate) struct Facet<'a> {
    part: &'a Part,
    paint: Vec3,
    lights: u32,
    glow: Vec3,
    object: ObjectId,
    pub(crate) normal_local: Vec3,
    normal_object: Vec3,
}

/// A point of a facet.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    /// Object frame, metres.
    pub(crate) object_m: Vec3,
    /// World, repeating after [`Surroundings::WRAP_M`], metres.
    pub(crate) world_m: Vec3,
    /// Width of a pixel there, metres.
    pub(crate) footprint_m: f32,
}

/// How a point sends light back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Look {
    /// Share of light scattered evenly, linear RGB.
    pub(crate) albedo: Vec3,
    /// Light of its own, in units of what the film shows as white.
    pub(crate) emission: Vec3,
    /// Share of light mirrored at normal incidence; 0 without gloss.
    pub(crate) mirror: f32,
    /// Width of the highlight: 0 mirror, 1 dull.
    pub(crate) roughness: f32,
}

/// What is the same for all surfaces of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surroundings {
    /// Wetness of the ground, 0 to 1.
    pub(crate) wetness: f32,
    /// Puddles, 0 to 1.
    pub(crate) puddles: f32,
    /// World coordinates of the local origin, wrapped.
    pub(crate) world_from_local_m: Vec3,
}

impl Surroundings {
    /// World coordinates of textures repeat after this distance, metres: a whole number of noise tiles at every
    /// scale, so that there is no seam.
    pub(crate) const WRAP_M: f64 = 4096.0;
}

impl<'a> Facet<'a> {
    pub(crate) fn new(instance: &Instance, part: &'a Part, normal_local: Vec3) -> Self {
        let object_from_local = instance.local_from_object.matrix3.transpose();
        Self {
            part,
            paint: Vec3::from_array(instance.paint),
            lights: instance.lights,
            glow: Vec3::from_array(instance.glow),
            object: instance.object,
            normal_local,
            normal_object: object_from_local * normal_local,
        }
    }
}

/// The look of one point.
pub(crate) fn look(
    noise: &Noise,
    around: &Surroundings,
    facet: &Facet<'_>,
    object_m: Vec3,
    position_local: Vec3,
    footprint_m: f32,
) -> Look {
    let point = Point { object_m, world_m: position_local + around.world_from_local_m, footprint_m };
    let rgb = Vec3::from_array(facet.part.rgb);
    match facet.part.surface {
        Surface::Plain => dull(rgb * speckle(noise, &point, 0.08)),
        Surface::Cloth => dull(rgb * speckle(noise, &point, 0.2)),
        Surface::Rubber => Look { albedo: rgb, mirror: 0.03, roughness: 0.7, ..Look::default() },
        Surface::Paint => Look { albedo: facet.paint, mirror: 0.045, roughness: 0.06, ..Look::default() },
        Surface::Glass => {
            Look { albedo: rgb.min(Vec3::splat(0.06)), mirror: 0.06, roughness: 0.02, ..Look::default() }
        }
        Surface::Metal => Look {
            albedo: rgb * 0.75 * speckle(noise, &point, 0.1),
            mirror: 0.15,
            roughness: 0.45,
            ..Look::default()
        },
        Surface::Asphalt => asphalt(noise, around, rgb, &point),
        Surface::RoadMarking => marking(noise, around, rgb, &point),
        Surface::Concrete => concrete(noise, around, facet, rgb, &point),
        Surface::Grass => grass(noise, rgb, &point),
        Surface::Foliage => foliage(noise, rgb, &point),
        Surface::Wood => {
            let grain = noise.at(
                (point.object_m.x + point.object_m.y) * 120.0,
                point.object_m.z * 18.0,
                point.footprint_m * 120.0,
            );
            dull(rgb * (0.65 + 0.7 * grain))
        }
        Surface::Facade => facade(noise, facet, rgb, &point),
        Surface::Lamp(bits) => {
            if facet.lights & bits != 0 {
                let street = bits == lights::STREET_LAMP;
                let emission = if street { rgb * facet.glow * 1.6 } else { rgb * 1.6 };
                Look { albedo: rgb * 0.3, emission, ..Look::default() }
            } else {
                // A lens that does not burn: its colour, deep and glossy.
                Look { albedo: rgb * 0.35, mirror: 0.05, roughness: 0.1, ..Look::default() }
            }
        }
    }
}

fn dull(albedo: Vec3) -> Look {
    Look { albedo, ..Look::default() }
}

/// Slight unevenness: 1 on average, `strength` from end to end.
fn speckle(noise: &Noise, p: &Point, strength: f32) -> f32 {
    let value = noise.at(
        (p.object_m.x + 0.37 * p.object_m.z) * 40.0,
        (p.object_m.y + 0.61 * p.object_m.z) * 40.0,
        p.footprint_m * 40.0,
    );
    1.0 + strength * (value - 0.5)
}

/// Noise over the ground: `per_m` texels a metre (a power of two, so that the wrapped world has no seam).
#[inline]
fn ground_noise(noise: &Noise, p: &Point, per_m: f32) -> f32 {
    noise.at(p.world_m.x * per_m, p.world_m.y * per_m, p.footprint_m * per_m)
}

/// Darkens and glosses a porous surface that is wet; `flat` is 1 where puddles can stand.
fn wet(noise: &Noise, around: &Surroundings, mut look: Look, p: &Point, flat: f32) -> Look {
    if around.wetness <= 0.0 && around.puddles <= 0.0 {
        return look;
    }
    let hollow = ground_noise(noise, p, 16.0);
    let threshold = 1.0 - 0.75 * around.puddles;
    let puddle = flat * smoothstep(threshold, threshold + 0.12, hollow) * around.puddles.min(1.0);
    let wetness = around.wetness.max(puddle);
    look.albedo *= 1.0 - 0.5 * wetness;
    look.mirror = (0.02 * wetness).max(look.mirror);
    look.roughness = 0.45 - 0.3 * wetness - 0.14 * puddle;
    look
}

/// Grains of 8 mm, each of its own brightness (0 on average, +-1/2), where a pixel is small enough to tell.
#[inline]
fn grains(p: &Point) -> f32 {
    let w = p.footprint_m * 128.0;
    if w > 6.0 {
        return 0.0;
    }
    let cell = hash2((p.world_m.x * 128.0).floor() as i32, (p.world_m.y * 128.0).floor() as i32, 3);
    (unit(cell) - 0.5) / (1.0 + w * w)
}

fn asphalt(noise: &Noise, around: &Surroundings, rgb: Vec3, p: &Point) -> Look {
    let grain = ground_noise(noise, p, 64.0);
    let patches = ground_noise(noise, p, 2.0);
    let albedo = rgb * (0.78 + 0.22 * grain + 0.22 * patches + 0.8 * grains(p));
    wet(noise, around, dull(albedo), p, 1.0)
}

fn marking(noise: &Noise, around: &Surroundings, rgb: Vec3, p: &Point) -> Look {
    let wear = ground_noise(noise, p, 32.0);
    let kept = 0.35 + 0.65 * smoothstep(0.12, 0.42, wear);
    let albedo = rgb * kept + Vec3::splat(0.07) * (1.0 - kept);
    wet(noise, around, dull(albedo), p, 0.6)
}

fn concrete(noise: &Noise, around: &Surroundings, facet: &Facet<'_>, rgb: Vec3, p: &Point) -> Look {
    let grain = ground_noise(noise, p, 32.0);
    let stains = ground_noise(noise, p, 4.0);
    let mut albedo = rgb * (0.78 + 0.18 * grain + 0.26 * stains);
    if facet.normal_local.z > 0.8 {
        // Slabs of a metre; joints of 12 mm; each slab a little lighter or darker.
        let (x, y, w) = (p.world_m.x, p.world_m.y, p.footprint_m);
        let joint = 1.0 - (1.0 - bars(x, 0.012, w)) * (1.0 - bars(y, 0.012, w));
        let shade = unit(hash2(x.floor() as i32, y.floor() as i32, 7)) - 0.5;
        let fade = 1.0 / (1.0 + w * w * 4.0);
        albedo *= (1.0 - 0.45 * joint) * (1.0 + 0.1 * shade * fade);
        return wet(noise, around, dull(albedo), p, 0.5);
    }
    dull(albedo)
}

fn grass(noise: &Noise, rgb: Vec3, p: &Point) -> Look {
    let blades = ground_noise(noise, p, 64.0);
    let tufts = ground_noise(noise, p, 8.0);
    let meadow = ground_noise(noise, p, 1.0);
    // Dry patches are yellower.
    let tint = Vec3::new(0.85 + 0.45 * meadow, 0.95 + 0.1 * meadow, 0.9 + 0.2 * meadow);
    dull(rgb * tint * (0.45 + 0.55 * blades + 0.55 * tufts))
}

fn foliage(noise: &Noise, rgb: Vec3, p: &Point) -> Look {
    let o = p.object_m;
    let leaf = noise.at((o.x + 0.53 * o.z) * 32.0, (o.y + 0.81 * o.z) * 32.0, p.footprint_m * 32.0);
    let clump = noise.at((o.x - 0.47 * o.z) * 9.0, (o.y - 0.71 * o.z) * 9.0, p.footprint_m * 9.0);
    // Single leaves of 7 cm, bright or in the shade of others, as long as a pixel tells them apart.
    let w = p.footprint_m * 14.0;
    let cell = (o * 14.0).floor();
    let single = unit(hash2(cell.x as i32, cell.y as i32, cell.z as i32 as u32)) - 0.5;
    let shade = (0.3 + 0.7 * leaf) * (0.5 + clump) * (1.0 + 0.9 * single / (1.0 + w * w));
    dull(rgb * shade)
}

/// A house front: storeys of 3 m, bays of about 3 m, a window in each; roofs are plain.
fn facade(noise: &Noise, facet: &Facet<'_>, rgb: Vec3, p: &Point) -> Look {
    let n = facet.normal_object;
    let (o, w) = (p.object_m, p.footprint_m);
    let flat = Vec2::new(n.x, n.y).length();
    let stains = noise.at((o.x + o.y) * 8.0, o.z * 5.0, w * 8.0);
    let grain = noise.at((o.x + o.y) * 48.0, o.z * 48.0, w * 48.0);
    if flat < 0.5 {
        return dull(Vec3::splat(0.18) * (0.8 + 0.4 * stains));
    }
    let style = u32::from(facet.object);
    let pick = |salt: i32| unit(hash2(i32::from(facet.object), salt, 0x51ed));
    // Along the wall, to the right of someone who looks at it.
    let along = (o.y * n.x - o.x * n.y) / flat;
    let bay_m = 2.5 + 1.2 * pick(1);
    let wide = 0.42 + 0.3 * pick(2);
    let high = 0.45 + 0.2 * pick(3);
    let (u, v) = (along / bay_m, o.z / STOREY_M);
    let (wu, wv) = (w / bay_m, w / STOREY_M);
    let ground_floor = o.z < STOREY_M;
    let (wide, high, sill) =
        if ground_floor { (0.78, 0.72, 0.1) } else { (wide, high, 0.5 - 0.5 * high + 0.05) };
    let (left, lower) = (0.5 - 0.5 * wide, sill);
    let opening = bars(u - left, wide, wu) * bars(v - lower, high, wv);
    // The frame is a band of 6 cm inside the opening, and a bar in its middle.
    let (fu, fv) = (0.06 / bay_m, 0.06 / STOREY_M);
    let pane = bars(u - left - fu, wide - 2.0 * fu, wu)
        * bars(v - lower - fv, high - 2.0 * fv, wv)
        * (1.0 - bars(u - 0.5 + 0.5 * fu, fu, wu));
    let ledge = bars(v - lower + 0.05, 0.05, wv) * bars(u - left + 0.03, wide + 0.06, wu);
    let band = bars(v + 0.03, 0.06, wv);

    let wall = rgb * (0.82 + 0.12 * grain + 0.24 * stains);
    let trim = rgb * 0.4 + Vec3::splat(0.4);
    let frame_rgb = if pick(4) > 0.5 { Vec3::splat(0.55) } else { Vec3::new(0.06, 0.055, 0.05) };
    let mut albedo = wall;
    albedo += (trim - albedo) * (0.7 * ledge.max(band * pick(5)));
    albedo += (frame_rgb - albedo) * opening;
    albedo += (Vec3::new(0.025, 0.03, 0.035) - albedo) * pane;
    let mut look = Look { albedo, mirror: 0.08 * pane, roughness: 0.03, ..Look::default() };
    if facet.lights & lights::BUILDING != 0 {
        // Which windows are lit, and how warm; far away all fade to their mean.
        let side = (8.0 * n.x + 3.0 * n.y).round() as i32;
        let cell = hash2(u.floor() as i32, v.floor() as i32 + 1000 * side, style.wrapping_mul(0x9e37_79b9));
        let far = smoothstep(0.3, 1.0, wu.max(wv));
        let on = if unit(cell) < LIT_SHARE { 1.0 } else { 0.0 };
        let bright = 0.3 + 0.7 * unit(cell.wrapping_mul(0x85eb_ca6b));
        let warm = unit(cell.wrapping_mul(0xc2b2_ae35));
        // Rooms of one building differ a little.
        let glow = facet.glow * Vec3::new(1.0, 1.0 + 0.3 * warm, 0.8 + 1.2 * warm);
        let lit = on * bright * (1.0 - far) + LIT_SHARE * 0.65 * far;
        look.emission = glow * (0.55 * pane * lit);
    }
    look
}
