//! The boards over shops: invented names and trades, as pictures.

use std::sync::{Arc, OnceLock};

use glam::Vec2;
use schema::geometry::{MeshPart, Surface, TriMesh};
use schema::mesh_textures::{Image, MeshTextures, PbrFactors, TextureSet};

use super::style::TAG;
use crate::actors::canvas::Canvas;

/// So many boards differ.
pub(super) const FASCIAS: usize = 64;
/// Width and height that they are painted for, metres, and texels along them.
const SIZE_M: [f32; 2] = [5.8, 0.63];
const TEXELS: f32 = 640.0;
/// Colours of boards, linear RGB.
const GROUNDS: [[f32; 3]; 8] = [
    [0.05, 0.16, 0.09],
    [0.30, 0.04, 0.04],
    [0.03, 0.06, 0.18],
    [0.42, 0.30, 0.06],
    [0.06, 0.06, 0.065],
    [0.50, 0.48, 0.43],
    [0.24, 0.10, 0.24],
    [0.04, 0.20, 0.22],
];
/// Letters on dark boards and on light ones.
const INKS: [[[f32; 3]; 2]; 2] =
    [[[0.80, 0.77, 0.68], [0.72, 0.52, 0.16]], [[0.05, 0.05, 0.055], [0.30, 0.05, 0.04]]];
/// Boards lighter than this are light.
const LIGHT: f32 = 0.22;
/// Made-up names of families that keep shops, and what they sell: as many as have no divisor in common, so
/// that every board says something else.
const NAMES: [&str; 13] = [
    "ALDERBY", "BRENNIK", "CORVANE", "DELLARU", "ESKO", "FARNWOLD", "GRIMALDE", "HOLLMAR", "IVERSOL",
    "JANOWEY", "KETTLER", "LUMBERG", "MARRISK",
];
const TRADES: [&str; 16] = [
    "BAKERY", "BOOKS", "FLOWERS", "OPTICIAN", "SHOES", "CYCLES", "PHARMACY", "TAILOR", "COFFEE", "HARDWARE",
    "TOYS", "WINES", "BARBER", "GROCER", "MUSIC", "CLOCKS",
];

/// The number of the board over a shop of a building.
pub(super) fn number(variant: u32, shop: u32) -> usize {
    (variant as usize * 11 + shop as usize * 21) % FASCIAS
}

/// The colour of a board.
pub(super) fn ground(number: usize) -> [f32; 3] {
    GROUNDS[number % GROUNDS.len()]
}

/// The part of a board, the `shop`-th of its building.
pub(super) fn part(number: usize, shop: u32) -> MeshPart {
    let factors = PbrFactors { texture_set: Some(shop as u8), roughness: 0.45, metallic: 0.0 };
    MeshPart::new(TAG, Surface::Textured(factors), ground(number))
}

/// The board's picture: a name and a trade, side by side or with a stroke between them.
fn picture(number: usize) -> Arc<Image> {
    static PAINTED: [OnceLock<Arc<Image>>; FASCIAS] = [const { OnceLock::new() }; FASCIAS];
    let paint = || {
        let rgb = ground(number);
        let [ink, accent] = INKS[usize::from(rgb.iter().sum::<f32>() / 3.0 > LIGHT)];
        let mut canvas = Canvas::fine(SIZE_M, rgb, TEXELS);
        let [wide, tall] = SIZE_M;
        let at = |u: f32, v: f32| [u * wide, v * tall];
        let stripe = |canvas: &mut Canvas, [u0, u1]: [f32; 2], [v0, v1]: [f32; 2], rgb: [f32; 3]| {
            canvas.fill(&[at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)], rgb);
        };
        let (name, trade) = (NAMES[number % NAMES.len()], TRADES[number % TRADES.len()]);
        let both = format!("{name} {trade}");
        match number % 3 {
            0 => {
                stripe(&mut canvas, [0.0, 1.0], [0.06, 0.10], accent);
                stripe(&mut canvas, [0.0, 1.0], [0.90, 0.94], accent);
                canvas.write(&both, at(0.5, 0.5), 0.46 * tall, 0.92 * wide, ink);
            }
            1 => {
                canvas.write(name, at(0.34, 0.5), 0.54 * tall, 0.52 * wide, ink);
                stripe(&mut canvas, [0.635, 0.641], [0.2, 0.8], accent);
                canvas.write(trade, at(0.81, 0.5), 0.34 * tall, 0.28 * wide, accent);
            }
            _ => canvas.write(trade, at(0.5, 0.5), 0.56 * tall, 0.8 * wide, ink),
        }
        canvas.finish()
    };
    Arc::clone(PAINTED[number].get_or_init(paint))
}

/// Lays the pictures of some boards on a building whose parts of boards have their places in the list.
pub(super) fn lay_on(mesh: &mut TriMesh, numbers: &[usize]) {
    if numbers.is_empty() {
        return;
    }
    let board = |mesh: &TriMesh, triangle: usize| match mesh.part(triangle).surface {
        Surface::Textured(PbrFactors { texture_set, .. }) => texture_set.map(usize::from),
        _ => None,
    };
    let mut bounds = vec![[Vec2::INFINITY, Vec2::NEG_INFINITY]; numbers.len()];
    for triangle in 0..mesh.triangles.len() {
        let Some([low, high]) = board(mesh, triangle).and_then(|set| bounds.get_mut(set)) else { continue };
        for p in mesh.corners(triangle) {
            (*low, *high) = (low.min(Vec2::new(p.y, p.z)), high.max(Vec2::new(p.y, p.z)));
        }
    }
    let places = |triangle: usize| {
        let Some([low, high]) = board(mesh, triangle).and_then(|set| bounds.get(set)) else {
            return [Vec2::ZERO; 3];
        };
        // As a reader sees it: who looks against +x has +y at the right hand.
        mesh.corners(triangle).map(|p| {
            let share = (Vec2::new(p.y, p.z) - *low) / (*high - *low).max(Vec2::splat(1e-3));
            Vec2::new(share.x, 1.0 - share.y)
        })
    };
    let corners = (0..mesh.triangles.len()).map(places).collect();
    let set = |number: &usize| TextureSet { colour: Some(picture(*number)), ..TextureSet::default() };
    mesh.textures = Some(Arc::new(MeshTextures { corners, sets: numbers.iter().map(set).collect() }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actors::actor_mesh;

    #[test]
    fn no_two_boards_say_the_same_and_all_letters_are_known() {
        let all: std::collections::BTreeSet<(usize, usize)> =
            (0..FASCIAS).map(|k| (k % NAMES.len(), k % TRADES.len())).collect();
        assert_eq!(all.len(), FASCIAS);
        for word in NAMES.iter().chain(&TRADES) {
            assert!(lettering::write(word).is_some(), "{word}");
        }
    }

    #[test]
    fn every_shop_has_a_board_with_its_own_picture() {
        for (model, size_m) in [("building.block", [13.0, 26.0, 16.0]), ("building.shop", [12.0, 14.0, 5.0])]
        {
            let actor = actor_mesh(model, size_m, 7).expect("a building");
            let shops = (size_m[1] / 6.4).round() as usize;
            for pieces in std::iter::once(&actor.pieces).chain(actor.coarser.iter().map(|far| &far.pieces)) {
                let mesh = &pieces[0].mesh;
                let textures = mesh.textures.as_ref().expect("pictures");
                assert_eq!((textures.sets.len(), textures.corners.len()), (shops, mesh.triangles.len()));
                for set in 0..shops {
                    let of = |i: &usize| matches!(mesh.part(*i).surface, Surface::Textured(f) if f.texture_set == Some(set as u8));
                    let facing = |i: &usize| {
                        let [a, b, c] = mesh.corners(*i);
                        (b - a).cross(c - a).normalize().x > 0.9
                    };
                    let front: Vec<usize> = (0..mesh.triangles.len()).filter(of).filter(facing).collect();
                    assert_eq!(front.len(), 2, "{model}");
                    // Upright, and from the left to the right over all of it.
                    let places = front.iter().flat_map(|i| textures.corners[*i]);
                    let (low, high) = places.fold((Vec2::ONE, Vec2::ZERO), |(l, h), p| (l.min(p), h.max(p)));
                    assert!(low.length() < 1e-3 && (high - Vec2::ONE).length() < 1e-3, "{low} {high}");
                    for i in &front {
                        for (p, place) in mesh.corners(*i).iter().zip(textures.corners[*i]) {
                            for (q, other) in mesh.corners(*i).iter().zip(textures.corners[*i]) {
                                let (right, up) =
                                    ((q.y - p.y) * (other.x - place.x), (q.z - p.z) * (other.y - place.y));
                                assert!(right >= 0.0 && up <= 0.0);
                            }
                        }
                    }
                }
            }
        }
    }
}
