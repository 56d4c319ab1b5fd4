//! Procedural looks of the kinds of surface, eight points of one triangle at a time.
//!
//! Patterns are anchored to the world (ground) or to the object (everything else), never to the camera.

use glam::{Vec2, Vec3};
use lanes::{Lanes, Vec3s, Words, floor_words, hash2, lerp, smoothstep, unit};
use schema::ObjectId;
use schema::geometry::{Instance, Part, Surface};
use schema::lights;

use super::noise::{self, Noise};
use super::pattern::{Width, bars};

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

/// Points of a facet.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    /// Object frame, metres.
    pub(crate) object_m: Vec3s,
    /// World, repeating after [`Surroundings::WRAP_M`], metres.
    pub(crate) world_m: Vec3s,
    /// Width of a pixel there, metres.
    pub(crate) footprint_m: Lanes,
}

/// How points send light back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Look {
    /// Share of light scattered evenly, linear RGB.
    pub(crate) albedo: Vec3s,
    /// Light of its own, in units of what the film shows as white; none for most.
    pub(crate) emission: Option<Vec3s>,
    /// What it mirrors; nothing for dull surfaces.
    pub(crate) gloss: Option<Gloss>,
}

/// How points mirror.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gloss {
    /// Share of light mirrored at normal incidence; 0 without gloss.
    pub(crate) mirror: Lanes,
    /// Width of the highlight: 0 mirror, 1 dull.
    pub(crate) roughness: Lanes,
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

    /// Whether it stands for leaves.
    pub(crate) fn is_leaf(&self) -> bool {
        self.part.surface == Surface::Foliage
    }
}

/// The look of eight points.
#[inline]
pub(crate) fn look(noise: &Noise, around: &Surroundings, facet: &Facet<'_>, p: &Points) -> Look {
    let rgb = Vec3::from_array(facet.part.rgb);
    match facet.part.surface {
        Surface::Plain => dull(shades(rgb, speckle(noise, p, 0.08))),
        Surface::Cloth => dull(shades(rgb, speckle(noise, p, 0.2))),
        Surface::Rubber => glossy(Vec3s::splat(rgb), 0.03, 0.7),
        Surface::Paint => glossy(Vec3s::splat(facet.paint), 0.045, 0.06),
        Surface::Glass => glossy(Vec3s::splat(rgb.min(Vec3::splat(0.06))), 0.06, 0.02),
        Surface::Metal => glossy(shades(rgb * 0.75, speckle(noise, p, 0.1)), 0.15, 0.45),
        Surface::Asphalt => asphalt(noise, around, rgb, p),
        Surface::RoadMarking => marking(noise, around, rgb, p),
        Surface::Concrete => concrete(noise, around, facet, rgb, p),
        Surface::Grass => grass(noise, rgb, p),
        Surface::Foliage => foliage(noise, rgb, p),
        Surface::Wood => {
            let o = &p.object_m;
            let grain = noise.at_all((o.x + o.y) * 120.0, o.z * 18.0, p.footprint_m * 120.0);
            dull(shades(rgb, grain * 0.7 + 0.65))
        }
        Surface::Facade => facade(noise, facet, rgb, p),
        Surface::Lamp(bits) => {
            if facet.lights & bits != 0 {
                let street = bits == lights::STREET_LAMP;
                let emission = if street { rgb * facet.glow * 1.6 } else { rgb * 1.6 };
                Look { emission: Some(Vec3s::splat(emission)), ..dull(Vec3s::splat(rgb * 0.3)) }
            } else {
                // A lens that does not burn: its colour, deep and glossy.
                glossy(Vec3s::splat(rgb * 0.35), 0.05, 0.1)
            }
        }
    }
}

#[inline]
fn dull(albedo: Vec3s) -> Look {
    Look { albedo, ..Look::default() }
}

#[inline]
fn glossy(albedo: Vec3s, mirror: f32, roughness: f32) -> Look {
    let gloss = Gloss { mirror: Lanes::splat(mirror), roughness: Lanes::splat(roughness) };
    Look { albedo, emission: None, gloss: Some(gloss) }
}

/// A colour in so many shades.
#[inline]
fn shades(rgb: Vec3, shade: Lanes) -> Vec3s {
    Vec3s::new(shade * rgb.x, shade * rgb.y, shade * rgb.z)
}

/// Slight unevenness: 1 on average, `strength` from end to end.
#[inline]
fn speckle(noise: &Noise, p: &Points, strength: f32) -> Lanes {
    let o = &p.object_m;
    let value = noise.at_all((o.x + o.z * 0.37) * 40.0, (o.y + o.z * 0.61) * 40.0, p.footprint_m * 40.0);
    (value - 0.5) * strength + 1.0
}

/// Noise over the ground: `per_m` texels a metre (a power of two, so that the wrapped world has no seam).
#[inline]
fn ground_noise(noise: &Noise, p: &Points, per_m: f32) -> Lanes {
    noise.at_all(p.world_m.x * per_m, p.world_m.y * per_m, p.footprint_m * per_m)
}

/// Darkens and glosses a porous surface that is wet; `flat` is 1 where puddles can stand.
#[inline]
fn wet(noise: &Noise, around: &Surroundings, mut look: Look, p: &Points, flat: f32) -> Look {
    if around.wetness <= 0.0 && around.puddles <= 0.0 {
        return look;
    }
    let hollow = ground_noise(noise, p, 16.0);
    let threshold = 1.0 - 0.75 * around.puddles;
    let puddle = smoothstep(threshold, threshold + 0.12, hollow) * (flat * around.puddles.min(1.0));
    let wetness = puddle.fast_max(Lanes::splat(around.wetness));
    look.albedo *= 1.0 - wetness * 0.5;
    look.gloss = Some(Gloss { mirror: wetness * 0.02, roughness: 0.45 - wetness * 0.3 - puddle * 0.14 });
    look
}

/// Grains of 8 mm, each of its own brightness (0 on average, +-1/2), where a pixel is small enough to tell.
#[inline]
fn grains(p: &Points) -> Lanes {
    let w = p.footprint_m * 128.0;
    let tell = w.simd_le(6.0);
    if tell.none() {
        return Lanes::ZERO;
    }
    let (x, y) = (floor_words(p.world_m.x * 128.0), floor_words(p.world_m.y * 128.0));
    let cell = hash2(x, y, Words::splat(3));
    tell.select((unit(cell) - 0.5) / (w * w + 1.0), Lanes::ZERO)
}

#[inline]
fn asphalt(noise: &Noise, around: &Surroundings, rgb: Vec3, p: &Points) -> Look {
    let grain = ground_noise(noise, p, 64.0);
    let patches = ground_noise(noise, p, 2.0);
    let albedo = shades(rgb, grain * 0.22 + patches * 0.22 + grains(p) * 0.8 + 0.78);
    wet(noise, around, dull(albedo), p, 1.0)
}

#[inline]
fn marking(noise: &Noise, around: &Surroundings, rgb: Vec3, p: &Points) -> Look {
    let wear = ground_noise(noise, p, 32.0);
    let kept = smoothstep(0.12, 0.42, wear) * 0.65 + 0.35;
    let albedo = shades(rgb, kept) + shades(Vec3::splat(0.07), 1.0 - kept);
    wet(noise, around, dull(albedo), p, 0.6)
}

#[inline]
fn concrete(noise: &Noise, around: &Surroundings, facet: &Facet<'_>, rgb: Vec3, p: &Points) -> Look {
    let grain = ground_noise(noise, p, 32.0);
    let stains = ground_noise(noise, p, 4.0);
    let shade = grain * 0.18 + stains * 0.26 + 0.78;
    if facet.normal_local.z > 0.8 {
        // Slabs of a metre; joints of 12 mm; each slab a little lighter or darker.
        let (x, y, w) = (p.world_m.x, p.world_m.y, Width::new(p.footprint_m));
        let joint = 1.0 - (1.0 - bars(x, 0.012, w)) * (1.0 - bars(y, 0.012, w));
        let slab = unit(hash2(floor_words(x), floor_words(y), Words::splat(7))) - 0.5;
        let fade = 0.1 / (w.w * w.w * 4.0 + 1.0);
        let shade = shade * (1.0 - joint * 0.45) * (slab * fade + 1.0);
        return wet(noise, around, dull(shades(rgb, shade)), p, 0.5);
    }
    dull(shades(rgb, shade))
}

#[inline]
fn grass(noise: &Noise, rgb: Vec3, p: &Points) -> Look {
    let blades = ground_noise(noise, p, 64.0);
    let tufts = ground_noise(noise, p, 8.0);
    let meadow = ground_noise(noise, p, 1.0);
    // Dry patches are yellower.
    let tint = Vec3s::new(meadow * 0.45 + 0.85, meadow * 0.1 + 0.95, meadow * 0.2 + 0.9);
    dull(shades(rgb, blades * 0.55 + tufts * 0.55 + 0.45) * tint)
}

#[inline]
fn foliage(noise: &Noise, rgb: Vec3, p: &Points) -> Look {
    let o = &p.object_m;
    let w = p.footprint_m;
    let leaf = noise.at_all((o.x + o.z * 0.53) * 32.0, (o.y + o.z * 0.81) * 32.0, w * 32.0);
    let clump = noise.at_all((o.x - o.z * 0.47) * 9.0, (o.y - o.z * 0.71) * 9.0, w * 9.0);
    // Single leaves of 7 cm, bright or in the shade of others, as long as a pixel tells them apart.
    let w = w * 14.0;
    let cell = |v: Lanes| floor_words(v * 14.0);
    let single = unit(hash2(cell(o.x), cell(o.y), cell(o.z))) - 0.5;
    let shade = (leaf * 0.7 + 0.3) * (clump + 0.5) * (single * 0.9 / (w * w + 1.0) + 1.0);
    dull(shades(rgb, shade))
}

/// A house front: storeys of 3 m, bays of about 3 m, a window in each; roofs are plain.
#[inline]
fn facade(noise: &Noise, facet: &Facet<'_>, rgb: Vec3, p: &Points) -> Look {
    let n = facet.normal_object;
    let (o, w) = (&p.object_m, p.footprint_m);
    let flat = Vec2::new(n.x, n.y).length();
    let stains = noise.at_all((o.x + o.y) * 8.0, o.z * 5.0, w * 8.0);
    if flat < 0.5 {
        return dull(shades(Vec3::splat(0.18), stains * 0.4 + 0.8));
    }
    let grain = noise.at_all((o.x + o.y) * 48.0, o.z * 48.0, w * 48.0);
    let pick = |salt: i32| noise::unit(noise::hash2(i32::from(facet.object), salt, 0x51ed));
    // Along the wall, to the right of someone who looks at it.
    let along = o.y * (n.x / flat) - o.x * (n.y / flat);
    let bay_m = 2.5 + 1.2 * pick(1);
    let (u, v) = (along * (1.0 / bay_m), o.z * (1.0 / STOREY_M));
    let (wu, wv) = (Width::new(w * (1.0 / bay_m)), Width::new(w * (1.0 / STOREY_M)));
    let (wide, high) = (0.42 + 0.3 * pick(2), 0.45 + 0.2 * pick(3));
    let upper = Windows { wide, high, sill: 0.5 - 0.5 * high + 0.05, bay_m };
    let lower = Windows { wide: 0.78, high: 0.72, sill: 0.1, bay_m };
    let is_lower = o.z.simd_lt(STOREY_M);
    let shares = if is_lower.none() {
        upper.at(u, v, wu, wv)
    } else if is_lower.all() {
        lower.at(u, v, wu, wv)
    } else {
        let (a, b) = (lower.at(u, v, wu, wv), upper.at(u, v, wu, wv));
        std::array::from_fn(|i| is_lower.select(a[i], b[i]))
    };
    let [opening, pane, ledge] = shares;
    let band = bars(v + 0.03, 0.06, wv) * pick(5);

    let trim = rgb * 0.4 + Vec3::splat(0.4);
    let frame_rgb = if pick(4) > 0.5 { Vec3::splat(0.55) } else { Vec3::new(0.06, 0.055, 0.05) };
    let mut albedo = shades(rgb, grain * 0.12 + stains * 0.24 + 0.82);
    albedo = albedo.lerp(Vec3s::splat(trim), ledge.fast_max(band) * 0.7);
    albedo = albedo.lerp(Vec3s::splat(frame_rgb), opening);
    albedo = albedo.lerp(Vec3s::splat(Vec3::new(0.025, 0.03, 0.035)), pane);
    let mut look = dull(albedo);
    if pane.simd_gt(0.0).any() {
        look.gloss = Some(Gloss { mirror: pane * 0.08, roughness: Lanes::splat(0.03) });
    }
    if facet.lights & lights::BUILDING != 0 {
        // Which windows are lit, and how warm; far away all fade to their mean.
        let side = (8.0 * n.x + 3.0 * n.y).round() as i32;
        let style = u32::from(facet.object).wrapping_mul(0x9e37_79b9);
        let row = floor_words(v) + Words::splat((1000 * side) as u32);
        let cell = hash2(floor_words(u), row, Words::splat(style));
        let far = smoothstep(0.3, 1.0, wu.w.fast_max(wv.w));
        let bright = unit(cell * 0x85eb_ca6b) * 0.7 + 0.3;
        let warm = unit(cell * 0xc2b2_ae35);
        let on = unit(cell).simd_lt(LIT_SHARE).select(bright, Lanes::ZERO);
        let lit = lerp(on, Lanes::splat(LIT_SHARE * 0.65), far);
        // Rooms of one building differ a little.
        let glow = Vec3s::splat(facet.glow) * Vec3s::new(Lanes::ONE, warm * 0.3 + 1.0, warm * 1.2 + 0.8);
        look.emission = Some(glow * (pane * lit * 0.55));
    }
    look
}

/// The windows of some storeys, in bays and storeys.
struct Windows {
    wide: f32,
    high: f32,
    sill: f32,
    bay_m: f32,
}

impl Windows {
    /// Shares of the opening in the wall, of the panes in it, and of the ledge below.
    #[inline]
    fn at(&self, u: Lanes, v: Lanes, wu: Width, wv: Width) -> [Lanes; 3] {
        let &Self { wide, high, sill, bay_m } = self;
        let left = 0.5 - 0.5 * wide;
        let opening = bars(u - left, wide, wu) * bars(v - sill, high, wv);
        // The frame is a band of 6 cm inside the opening, and a bar in its middle.
        let (fu, fv) = (0.06 / bay_m, 0.06 / STOREY_M);
        let pane = bars(u - left - fu, wide - 2.0 * fu, wu)
            * bars(v - sill - fv, high - 2.0 * fv, wv)
            * (1.0 - bars(u - 0.5 + 0.5 * fu, fu, wu));
        let ledge = bars(v - sill + 0.05, 0.05, wv) * bars(u - left + 0.03, wide + 0.06, wu);
        [opening, pane, ledge]
    }
}
