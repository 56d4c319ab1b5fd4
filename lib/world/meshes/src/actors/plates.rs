//! What is written on number plates: a picture on the sheeting, which no ray meets.
//!
//! Plates are invented: two letters and four digits, in two lines where a plate is not long. All vehicles of
//! a model share a mesh, and with it their plate; two-wheelers differ by their variants.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::mesh_textures::{MeshTextures, TextureSet};

use crate::actors::canvas::Canvas;
use crate::actors::pieces::ActorMesh;

/// The sheeting of plates, by which they are known.
pub(crate) const SHEETING: [f32; 3] = [0.78, 0.78, 0.76];
const INK: [f32; 3] = [0.012, 0.013, 0.018];
/// The band at the left end.
const BAND: [f32; 3] = [0.035, 0.16, 0.17];
/// No letter that could be a digit.
const LETTERS: &[u8; 23] = b"ABCDEFGHJKLMNPRSTUVWXYZ";
/// Texels along a picture.
const TEXELS: f32 = 224.0;
/// Of a picture so much is the plate, from below; above are the colours of what else is of sheeting.
const PLATE: f32 = 0.72;
/// A plate is at least so much longer than it is high to be in one line.
const LONG: f32 = 2.4;

/// What the plate of a model and a variant says, in two parts.
fn text(model: &str, variant: u32) -> [String; 2] {
    let seed = model.bytes().fold(u64::from(variant) + 1, |sum, byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23)
    });
    let pick = |k: u32, of: u64| (seed.rotate_right(11 * k) >> 17) % of;
    let letter = |k: u32| char::from(LETTERS[pick(k, LETTERS.len() as u64) as usize]);
    let number = 1000 + pick(4, 9000);
    [[letter(0), letter(2)].iter().collect(), number.to_string()]
}

/// Writes the plates of an actor that is seen from close by.
pub(crate) fn lettered(mut made: ActorMesh, model: &str, variant: u32) -> ActorMesh {
    for piece in &mut made.pieces {
        let is_plate = |part: &MeshPart| part.surface == Surface::Reflector && part.rgb == SHEETING;
        if piece.mesh.textures.is_none() && piece.mesh.parts.iter().any(is_plate) {
            write(Arc::make_mut(&mut piece.mesh), &text(model, variant));
        }
    }
    made
}

/// The end at which a triangle of a plate shows its face: ahead or behind; none for its rim and its back.
fn end(mesh: &TriMesh, triangle: usize) -> Option<bool> {
    let part = mesh.part(triangle);
    if part.surface != Surface::Reflector || part.rgb != SHEETING {
        return None;
    }
    let [a, b, c] = mesh.corners(triangle);
    let looks = (b - a).cross(c - a).normalize_or_zero().x;
    let ahead = a.x + b.x + c.x > 0.0;
    (if ahead { looks > 0.5 } else { looks < -0.5 }).then_some(ahead)
}

fn write(mesh: &mut TriMesh, text: &[String; 2]) {
    let all = 0..mesh.triangles.len();
    // The boxes about the faces ahead and behind.
    let mut boxes = [[Vec3::INFINITY, Vec3::NEG_INFINITY]; 2];
    for (triangle, ahead) in all.clone().filter_map(|t| Some((t, end(mesh, t)?))) {
        let [low, high] = &mut boxes[usize::from(ahead)];
        for p in mesh.corners(triangle) {
            (*low, *high) = (low.min(p), high.max(p));
        }
    }
    let Some(size) = boxes.iter().map(|[low, high]| *high - *low).find(|size| size.y > 0.0) else { return };
    let others: Vec<[f32; 3]> =
        mesh.parts.iter().filter(|part| part.surface == Surface::Reflector).map(|part| part.rgb).collect();
    let swatch = |k: usize| [(k as f32 + 0.5) / others.len() as f32, 0.5 * (1.0 + PLATE)];
    let corners = all
        .map(|triangle| {
            if let Some(ahead) = end(mesh, triangle) {
                let [low, high] = boxes[usize::from(ahead)];
                return mesh.corners(triangle).map(|p| {
                    let share = (p - low) / (high - low);
                    // As a reader sees it.
                    let u = if ahead { share.y } else { 1.0 - share.y };
                    Vec2::new(u, 1.0 - PLATE * share.z)
                });
            }
            let rgb = mesh.part(triangle).rgb;
            let [u, v] = swatch(others.iter().position(|other| *other == rgb).unwrap_or(0));
            [Vec2::new(u, 1.0 - v); 3]
        })
        .collect();
    let (wide, high) = (size.y, size.z);
    let mut canvas = Canvas::fine([wide, high / PLATE], SHEETING, TEXELS);
    let block = |[x0, x1]: [f32; 2], [y0, y1]: [f32; 2]| [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    for (k, rgb) in others.iter().enumerate() {
        let share = |k: usize| wide * k as f32 / others.len() as f32;
        // Free of the plate's upper edge, so that copies of less detail do not mix them at once.
        let low = high * (1.0 + 0.25 * (1.0 / PLATE - 1.0));
        canvas.fill(&block([share(k), share(k + 1)], [low, high / PLATE]), *rgb);
    }
    let rim = 0.05 * high;
    for side in [[0.0, 0.5 * rim], [high - 0.5 * rim, high]] {
        canvas.fill(&block([0.0, wide], side), INK);
    }
    let [letters, digits] = text;
    if wide > LONG * high {
        canvas.fill(&block([0.0, 0.09 * wide], [0.5 * rim, high - 0.5 * rim]), BAND);
        canvas.write(letters, [0.25 * wide, 0.5 * high], 0.66 * high, 0.26 * wide, INK);
        canvas.write(digits, [0.68 * wide, 0.5 * high], 0.66 * high, 0.52 * wide, INK);
    } else {
        canvas.write(letters, [0.5 * wide, 0.74 * high], 0.34 * high, 0.6 * wide, INK);
        canvas.write(digits, [0.5 * wide, 0.28 * high], 0.38 * high, 0.86 * wide, INK);
    }
    let sets = vec![TextureSet { colour: Some(canvas.finish()), ..TextureSet::default() }];
    mesh.textures = Some(Arc::new(MeshTextures { corners, sets }));
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use catalogue::models::{self, MODELS};
    use catalogue::{BaseType, Body};

    use super::*;
    use crate::actors::actor_mesh;

    fn byte(linear: f32) -> f32 {
        255.0
            * if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * frames::math::f32::pow(linear, 1.0 / 2.4) - 0.055
            }
    }

    #[test]
    fn plates_read_from_left_to_right_and_other_sheeting_keeps_its_colour() {
        for (name, ends) in [("car.sedan", 2), ("motorcycle.sport", 1), ("truck.box", 2)] {
            let model = models::find(name).expect("is one");
            let made = actor_mesh(name, model.size_m, 3).expect("is one");
            let mesh = &made.pieces.iter().find(|piece| piece.mesh.textures.is_some()).expect("a plate").mesh;
            let textures = mesh.textures.as_ref().expect("has some");
            let image = textures.sets[0].colour.as_ref().expect("a picture");
            let finest = &image.levels[0];
            let texel = |uv: Vec2| {
                let [x, y] = [(uv.x, finest.width), (uv.y, finest.height)]
                    .map(|(share, n)| ((share * n as f32) as u32).min(n - 1));
                finest.texels[(y * finest.width + x) as usize]
            };
            let mut seen = BTreeSet::new();
            for t in 0..mesh.triangles.len() {
                let (part, places, corners) = (mesh.part(t), textures.corners[t], mesh.corners(t));
                if let Some(ahead) = end(mesh, t) {
                    seen.insert(ahead);
                    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                        // To the reader's right, and down.
                        let right = if ahead { 1.0 } else { -1.0 };
                        let (du, dv) = (places[j].x - places[i].x, places[j].y - places[i].y);
                        let (dy, dz) = (corners[j].y - corners[i].y, corners[j].z - corners[i].z);
                        assert!(du * dy * right >= 0.0 && dv * dz <= 1e-6, "{name}");
                    }
                } else if part.surface == Surface::Reflector {
                    let found = texel(places[0]);
                    let off = (0..3).map(|k| (f32::from(found[k]) - byte(part.rgb[k])).abs());
                    assert!(off.fold(0.0, f32::max) < 2.0, "{name}: {found:?} for {:?}", part.rgb);
                }
            }
            let inked = finest.texels.iter().filter(|rgb| rgb[0] < 60 && rgb[2] < 60).count();
            let share = inked as f32 / finest.texels.len() as f32;
            assert_eq!(seen.len(), ends, "{name}");
            assert!((0.08..0.5).contains(&share), "{name}: {share} of it is ink");
        }
    }

    #[test]
    fn hardly_two_models_have_one_number() {
        let drives = |body: Body| matches!(body, Body::Car(_) | Body::Lorry(_) | Body::TwoWheeler(_));
        let all: Vec<[String; 2]> = MODELS
            .iter()
            .filter(|m| drives(m.body) && m.base != BaseType::Bicycle)
            .map(|m| text(m.name, 0))
            .collect();
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
        assert!(all.iter().all(|[letters, digits]| letters.len() == 2 && digits.len() == 4));
        let riders: BTreeSet<[String; 2]> = (0..16).map(|k| text("motorcycle.sport", k)).collect();
        assert_eq!(riders.len(), 16);
    }
}
