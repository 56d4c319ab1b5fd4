//! Pictures on posters and signs: colours, simple shapes and words of everyday life.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::mesh_textures::{Image, MeshTextures, PbrFactors, TextureSet};

use crate::actors::canvas::Canvas;
use crate::solids::circle;

/// A part on which the picture lies.
pub(super) const PRINTED: MeshPart = MeshPart::new(
    Tag::Static,
    Surface::Textured(PbrFactors { texture_set: Some(0), roughness: 0.35, metallic: 0.0 }),
    [0.4; 3],
);

/// How a picture lies on a thing.
pub(super) enum Lies {
    /// On upright faces that look along x, forwards and backwards.
    AlongX,
    /// On upright faces that look along y.
    AlongY,
    /// Round an upright axis, so many times.
    Round(f32),
}

/// A picture and where it lies: between two corners of the box around the printed faces, metres.
pub(super) struct Skin {
    pub(super) image: Arc<Image>,
    pub(super) lies: Lies,
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Skin {
    /// Lays it on a mesh.
    pub(super) fn lay_on(&self, mesh: &mut TriMesh) {
        let corners = (0..mesh.triangles.len()).map(|i| self.places(mesh.corners(i))).collect();
        let sets = vec![TextureSet { colour: Some(Arc::clone(&self.image)), ..TextureSet::default() }];
        mesh.textures = Some(Arc::new(MeshTextures { corners, sets }));
    }

    /// Where the corners of a triangle are in the picture.
    fn places(&self, corners: [Vec3; 3]) -> [Vec2; 3] {
        let [a, b, c] = corners;
        let out = (b - a).cross(c - a);
        let share = (self.high - self.low).max(Vec3::splat(1e-3));
        let down = |p: Vec3| 1.0 - (p.z - self.low.z) / share.z;
        match self.lies {
            // As a reader sees it: who looks against +x has +y at the right hand.
            Lies::AlongX => corners.map(|p| {
                let u = (p.y - self.low.y) / share.y;
                Vec2::new(if out.x >= 0.0 { u } else { 1.0 - u }, down(p))
            }),
            Lies::AlongY => corners.map(|p| {
                let u = (p.x - self.low.x) / share.x;
                Vec2::new(if out.y >= 0.0 { 1.0 - u } else { u }, down(p))
            }),
            Lies::Round(times) => {
                let turn = |p: Vec3| frames::math::atan2(f64::from(p.y), f64::from(p.x)) as f32 / TAU;
                let middle = turn((a + b + c) / 3.0);
                corners.map(|p| {
                    // The turn that is nearest to the middle's.
                    let off = turn(p) - middle;
                    Vec2::new(times * (0.5 + middle + off - off.round()), down(p))
                })
            }
        }
    }
}

/// Words that posters say.
const WORDS: [[&str; 2]; 6] = [
    ["CIRCUS", "IN TOWN"],
    ["FRESH", "BREAD"],
    ["OPEN AIR", "SUMMER"],
    ["CITY RUN", "10 KM"],
    ["MUSEUM", "OF CLOCKS"],
    ["JAZZ", "TONIGHT"],
];
/// Colours of grounds, shapes and letters.
const COLOURS: [[[f32; 3]; 3]; 6] = [
    [[0.70, 0.08, 0.05], [0.85, 0.60, 0.06], [0.90, 0.88, 0.80]],
    [[0.80, 0.70, 0.48], [0.36, 0.17, 0.05], [0.20, 0.08, 0.03]],
    [[0.10, 0.38, 0.62], [0.90, 0.68, 0.10], [0.92, 0.92, 0.90]],
    [[0.86, 0.86, 0.84], [0.10, 0.45, 0.16], [0.03, 0.10, 0.22]],
    [[0.05, 0.09, 0.16], [0.60, 0.45, 0.18], [0.86, 0.80, 0.62]],
    [[0.22, 0.06, 0.28], [0.88, 0.32, 0.10], [0.90, 0.85, 0.90]],
];

/// Paints a poster between two corners of a picture: a ground, a shape, two words.
pub(super) fn poster(canvas: &mut Canvas, low: [f32; 2], high: [f32; 2], variant: u32) {
    let number = variant as usize % WORDS.len();
    let [ground, shape, ink] = COLOURS[number];
    let [wide, tall] = [high[0] - low[0], high[1] - low[1]];
    let at = |u: f32, v: f32| [low[0] + u * wide, low[1] + v * tall];
    canvas.fill(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], ground);
    let round = |middle: [f32; 2], radius: f32| -> Vec<[f32; 2]> {
        circle(20).map(|(c, s)| [middle[0] + radius * c, middle[1] + radius * s]).collect()
    };
    let side = wide.min(tall);
    match number % 3 {
        0 => {
            for k in 0..6 {
                let (a, c) = (k as f32 / 6.0, (k as f32 + 0.5) / 6.0);
                canvas.fill(&[at(0.5, 0.62), at(a, 0.30), at(c, 0.30)], shape);
            }
            canvas.fill(&round(at(0.5, 0.62), 0.12 * side), shape);
        }
        1 => {
            canvas.fill(&round(at(0.5, 0.52), 0.26 * side), shape);
            canvas.fill(&round(at(0.42, 0.56), 0.16 * side), ground);
        }
        _ => {
            canvas.fill(
                &[at(0.0, 0.34), at(0.35, 0.62), at(0.55, 0.46), at(1.0, 0.72), at(1.0, 0.3), at(0.0, 0.3)],
                shape,
            );
            canvas.fill(&round(at(0.74, 0.72), 0.10 * side), ink);
        }
    }
    let [first, second] = WORDS[number];
    canvas.write(first, at(0.5, 0.87), 0.11 * tall.min(1.6 * wide), 0.88 * wide, ink);
    canvas.write(second, at(0.5, 0.14), 0.08 * tall.min(1.6 * wide), 0.80 * wide, ink);
    // Small print.
    for k in 0..2 {
        let v = 0.045 + 0.025 * k as f32;
        canvas.fill(&[at(0.2, v), at(0.8, v), at(0.8, v + 0.01), at(0.2, v + 0.01)], ink);
    }
}
