//! Patches in the making: blades and leaves, and their levels of detail.

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::{Normal, Tag};

use crate::actors::plants::leaves::{Draws, prepare, push, reserve, share};
use crate::actors::plants::levels::levels_of;
use crate::actors::{ActorMesh, Coarser};
use crate::solids::MeshBuilder;

/// From where on the coarser levels are there, metres.
const FROM_M: [f64; 3] = [12.0, 35.0, 90.0];
/// Lower patches are not there from so far away on, metres: they are grass in grass.
const LOW_M: f32 = 0.9;
const GONE_M: f64 = 180.0;
/// Patches that are larger than usual have at most so many times as many triangles.
const MOST: f32 = 4.0;

/// So much brighter [`Surface::Foliage`] has to be to look as [`Surface::Grass`] does.
const FOLIAGE_DARKER: f32 = 1.35;

/// Which patch of a kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Where its leaves are: 0 to 3.
    pub(super) shape: u32,
    /// How a whole field is coloured: 0 to 3.
    pub(super) colour: usize,
}

impl Look {
    /// Numbers for one, by what they are for.
    pub(super) fn draws(self, what: u64) -> Draws {
        Draws::new(self.shape, what)
    }

    /// One of some linear colours, a little different for each shape.
    pub(super) fn tinted(self, colours: [[f32; 3]; 4]) -> [f32; 3] {
        let by = [1.0, 1.03, 0.98, 1.01][self.shape as usize % 4];
        let [r, g, b] = colours[self.colour % 4];
        [r * by, g, b * by]
    }
}

/// How many triangles a patch has by level, on a rectangle of usual size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    /// That size, m2.
    pub(super) on_m2: f32,
    pub(super) triangles: [f32; 4],
}

/// What is usual: on 16 m2.
pub(super) const USUAL: Budget = Budget { on_m2: 16.0, triangles: [960.0, 350.0, 90.0, 24.0] };

impl Budget {
    /// The same for some other rectangle.
    pub(super) fn on(self, m2: f32) -> [f32; 4] {
        let share = (m2 / self.on_m2).min(MOST);
        // Of the smallest ones few are needed, but less and less.
        let least = [32.0, 20.0, 12.0, 8.0];
        std::array::from_fn(|level| (self.triangles[level] * share).max(least[level]))
    }
}

/// How a triangle grows where it stands for several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grows {
    /// Across alone: what stands upright.
    Across,
    /// Mostly across: long leaves.
    Mostly,
    /// Both ways.
    Alike,
    /// It is too thin to be seen from afar: there it is left out.
    Gone,
}

/// A blade or a leaf: a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blade {
    pub(super) corners: [Vec3; 3],
    /// The way that it grew (unit).
    pub(super) along: Vec3,
    pub(super) grows: Grows,
    pub(super) part: u8,
    pub(super) normals: [Normal; 2],
    pub(super) open: [u8; 3],
}

impl Blade {
    pub(super) fn area_m2(&self) -> f32 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }

    /// As much larger that it has so many times its area, within a box.
    pub(super) fn larger(&self, by: f32, [min, max]: [Vec3; 2]) -> [Vec3; 3] {
        let [a, b, c] = self.corners;
        let centre = (a + b + c) / 3.0;
        let root = by.sqrt();
        let [along, across] = match self.grows {
            Grows::Across | Grows::Gone => [1.0, by],
            Grows::Mostly => [root.sqrt(), by / root.sqrt()],
            Grows::Alike => [root; 2],
        };
        let corners = self.corners.map(|p| {
            let off = p - centre;
            let kept = self.along * off.dot(self.along);
            centre + kept * along + (off - kept) * across
        });
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // Moved inside; what is too large for the box is cut.
        let off = (min - low).max(Vec3::ZERO) - (high - max).max(Vec3::ZERO);
        corners.map(|p| (p + off).clamp(min, max))
    }
}

/// A patch in the making.
pub(super) struct Patch {
    pub(super) size: Vec3,
    /// What is no leaf.
    pub(super) solid: TriMesh,
    /// How many levels have it.
    pub(super) solid_until: usize,
    /// Of leaves.
    pub(super) surface: Surface,
    pub(super) parts: Vec<MeshPart>,
    pub(super) blades: Vec<Blade>,
}

impl Patch {
    pub(super) fn new(size: Vec3, surface: Surface, blades: f32) -> Self {
        let blades = Vec::with_capacity(blades as usize + 16);
        Self { size, solid: TriMesh::default(), solid_until: 2, surface, parts: Vec::new(), blades }
    }

    /// A colour of leaves.
    pub(super) fn leaf(&mut self, rgb: [f32; 3]) -> u8 {
        self.parts.push(MeshPart::new(Tag::Vegetation, self.surface, rgb));
        (self.parts.len() - 1) as u8
    }

    /// Three shades of one.
    pub(super) fn shades(&mut self, rgb: [f32; 3]) -> [u8; 3] {
        [0.82, 1.0, 1.18].map(|by| self.leaf(rgb.map(|c| by * c)))
    }

    /// What of the light gets to a height.
    pub(super) fn open(&self, z: f32) -> f32 {
        0.5 + 0.5 * (z / self.size.z).clamp(0.0, 1.0)
    }

    /// Adds a triangle that looks a way (not unit) as far as light goes.
    pub(super) fn triangle(&mut self, (part, grows): (u8, Grows), corners: [Vec3; 3], along: Vec3) {
        let [a, b, c] = corners;
        let face = (b - a).cross(c - a).normalize_or(Vec3::Z);
        // Lit as the patch is as a whole.
        let light = Vec3::Z * 0.75 + 0.4 * if face.z < 0.0 { -face } else { face };
        let normals = [Normal::new(light), Normal::new(light + 0.2 * (c - a).normalize_or(Vec3::Z))];
        let open = corners.map(|p| share(self.open(p.z)));
        self.blades.push(Blade { corners, along, grows, part, normals, open });
    }

    /// A blade that is wide at its foot and ends in a point.
    pub(super) fn blade(&mut self, kind: (u8, Grows), [foot, tip]: [Vec3; 2], across: Vec3, wide_m: f32) {
        let half = across * (0.5 * wide_m);
        let along = (tip - foot).normalize_or(Vec3::Z);
        self.triangle(kind, [foot - half, foot + half, tip], along);
    }

    /// A long leaf that bends at its widest place: two triangles.
    pub(super) fn bent(&mut self, part: u8, [foot, knee, tip]: [Vec3; 3], wide_m: f32) {
        let across = (knee - foot).cross(Vec3::Z).normalize_or(Vec3::X);
        self.blade((part, Grows::Mostly), [knee, foot], across, wide_m);
        self.blade((part, Grows::Mostly), [knee, tip], across, wide_m);
    }

    /// A short leaf at a place that grows a way (not unit) and faces any direction nearest to another.
    pub(super) fn short(&mut self, part: u8, at: Vec3, [way, face]: [Vec3; 2], side_m: f32, longer: f32) {
        let face = face.normalize_or(Vec3::Z);
        let along = (way - face * way.dot(face)).normalize_or(face.any_orthonormal_vector());
        let long = longer.sqrt() * side_m;
        let half = along.cross(face) * (0.5 * long / longer);
        let foot = at - along * (0.4 * long);
        let corners = [foot - half, foot + half, at + along * (0.6 * long)];
        self.triangle((part, Grows::Alike), corners, along);
    }

    /// Adds bars: from, to, radii.
    pub(super) fn bars(&mut self, rgb: [f32; 3], bars: &[(Vec3, Vec3, [f32; 2])], sides: usize) {
        let part = MeshPart::new(Tag::Vegetation, Surface::Wood, rgb);
        let mut b = MeshBuilder::new();
        bars.iter().for_each(|(from, to, radii)| b.bar(part, *from, *to, *radii, sides));
        let [min, max] = self.box_m();
        b.reshape(|p| p.clamp(min, max));
        self.solid = b.finish();
        let height = self.size.z;
        prepare(&mut self.solid, |p| 0.5 + 0.5 * (p.z / height).clamp(0.0, 1.0));
    }

    pub(super) fn box_m(&self) -> [Vec3; 2] {
        let half = Vec3::new(0.5 * self.size.x, 0.5 * self.size.y, 0.0);
        [-half, half + Vec3::Z * self.size.z]
    }

    /// Places all over the rectangle, about so many: one anywhere in each of equal cells.
    pub(super) fn places(&self, count: f32, draws: &mut Draws) -> Vec<Vec3> {
        let [x, y] = [self.size.x, self.size.y];
        let rows = (count * y / x).sqrt().round().max(1.0);
        let columns = (count / rows).round().max(1.0);
        let mut places = Vec::with_capacity((rows * columns) as usize);
        for i in 0..rows as usize {
            for j in 0..columns as usize {
                let u = (j as f32 + draws.unit()) / columns - 0.5;
                let v = (i as f32 + draws.unit()) / rows - 0.5;
                places.push(Vec3::new(u * x, v * y, 0.0));
            }
        }
        places
    }

    /// The patch by levels, of about so many triangles: all of its blades, then fewer but larger ones.
    pub(super) fn into_actor(self, triangles: [f32; 4]) -> ActorMesh {
        let bounds = self.box_m();
        let all: Vec<&Blade> = self.blades.iter().collect();
        let lasting: Vec<&Blade> = all.iter().copied().filter(|blade| blade.grows != Grows::Gone).collect();
        let area = |blades: &[&Blade]| blades.iter().map(|blade| blade.area_m2()).sum::<f32>();
        let whole = area(&all);
        let meshes = triangles.iter().enumerate().map(|(level, count)| {
            let from = if level < 2 { &all } else { &lasting };
            let count = if level == 0 { all.len() } else { (*count as usize).min(from.len()) };
            let shown: Vec<&Blade> = (0..count).map(|j| from[j * from.len() / count]).collect();
            let by = if level == 0 { 1.0 } else { whole / area(&shown).max(1e-6) };
            let mut mesh = if level < self.solid_until { self.solid.clone() } else { TriMesh::default() };
            // Large ones that stand for many let light through as those do together; foliage is darker.
            let (surface, by_rgb) = match self.surface {
                Surface::Grass if level >= 2 => (Surface::Foliage, FOLIAGE_DARKER),
                surface => (surface, 1.0),
            };
            let far =
                |part: &MeshPart| MeshPart { surface, rgb: part.rgb.map(|c| (c * by_rgb).min(0.9)), ..*part };
            let parts: Vec<u8> = self.parts.iter().map(|part| mesh.part_index(far(part))).collect();
            reserve(&mut mesh, count);
            for blade in shown {
                let [normal, tip] = blade.normals;
                let corners = blade.larger(by, bounds);
                push(&mut mesh, parts[usize::from(blade.part)], corners, [normal, normal, tip], blade.open);
            }
            mesh
        });
        let mut actor = levels_of(meshes.collect(), FROM_M);
        if self.size.z < LOW_M {
            actor.coarser.push(Coarser { from_m: GONE_M, pieces: Vec::new() });
        }
        actor
    }
}
