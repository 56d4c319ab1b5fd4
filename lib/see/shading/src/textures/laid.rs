//! What is laid piece by piece: bricks, stones, slabs, roof tiles.

use crate::textures::canvas::{Canvas, Spot, clouds, grain, smooth};
use crate::textures::noise::{hash2, unit};
use crate::textures::texture::Texture;

/// Pieces in rows, every second row moved by half a piece.
struct Bond {
    /// Pieces in a row, and rows (an even number).
    across: [f32; 2],
    /// Half a joint's width over a piece's width and height.
    joint: [f32; 2],
    seed: u32,
}

/// A place in a bond.
struct Laid {
    /// 1 on the piece, 0 in the joint.
    piece: f32,
    /// Numbers of the piece, 0 to 1.
    own: [f32; 2],
}

impl Bond {
    fn at(&self, x: f32, y: f32, wobble: f32) -> Laid {
        let y = y * self.across[1] + wobble * 0.02;
        let row = y.floor();
        let half = if row as i32 & 1 == 0 { 0.0 } else { 0.5 };
        let x = x * self.across[0] + half + wobble * 0.01;
        let column = x.floor();
        let edge = |v: f32, joint: f32| {
            let from_edge = 0.5 - (v - v.floor() - 0.5).abs();
            smooth(0.7 * joint, 1.5 * joint, from_edge)
        };
        let piece = edge(x, self.joint[0]) * edge(y, self.joint[1]);
        let index = |v: f32, n: f32| (v as i32).rem_euclid(n as i32);
        let word = hash2(index(column, self.across[0]), index(row, self.across[1]), self.seed);
        Laid { piece, own: [unit(word), unit(word.wrapping_mul(0x85eb_ca6b))] }
    }
}

/// Bricks of 250 mm, 26 courses in 2 m, joints of 10 mm.
pub(crate) fn brick() -> Texture {
    let bond = Bond { across: [8.0, 26.0], joint: [0.02, 0.065], seed: 41 };
    let canvas = Canvas::new(512, |x, y| {
        let rough = grain(x, y, 72);
        let laid = bond.at(x, y, clouds(x, y, 1.0, 10) - 0.5);
        // One in twelve was burnt dark.
        let burnt = if laid.own[1] > 0.92 { 0.6 } else { 1.0 };
        let face = (0.72 + 0.5 * laid.own[0]) * burnt * (0.86 + 0.28 * rough);
        let mortar = 0.85 + 0.3 * rough;
        Spot {
            height: 2.0 * laid.piece + 0.8 * rough,
            shade: mortar + (face - mortar) * laid.piece,
            tint: 1.0 - laid.piece,
        }
    });
    Texture::new(&canvas, 256.0)
}

/// Stones of 0.5 m in courses of 0.25 m, joints of 8 mm.
pub(crate) fn ashlar() -> Texture {
    let bond = Bond { across: [4.0, 8.0], joint: [0.009, 0.018], seed: 43 };
    let canvas = Canvas::new(256, |x, y| {
        let rough = grain(x, y, 40);
        let laid = bond.at(x, y, 0.0);
        let face = (0.9 + 0.2 * laid.own[0]) * (0.85 + 0.3 * rough);
        Spot {
            height: 1.5 * laid.piece + 0.7 * rough,
            shade: 0.62 + (face - 0.62) * laid.piece,
            tint: 1.0 - laid.piece,
        }
    });
    Texture::new(&canvas, 128.0)
}

/// Slabs of 0.5 m, joints of 8 mm with dirt in them.
pub(crate) fn slabs() -> Texture {
    let bond = Bond { across: [4.0, 4.0], joint: [0.009, 0.009], seed: 47 };
    let canvas = Canvas::new(512, |x, y| {
        let (fine, cloud) = (grain(x, y, 96), clouds(x, y, 1.0, 16));
        let laid = bond.at(x, y, 0.0);
        let face = (0.88 + 0.2 * laid.own[0]) * (0.8 + 0.2 * fine + 0.2 * cloud);
        Spot {
            height: 2.2 * laid.piece + 0.7 * fine,
            shade: 0.5 + (face - 0.5) * laid.piece,
            tint: 1.0 - laid.piece,
        }
    });
    Texture::new(&canvas, 256.0)
}

/// Tiles of 0.25 m, light and dark in turn, joints of 5 mm.
pub(crate) fn tiles() -> Texture {
    let canvas = Canvas::new(512, |x, y| {
        let (fine, cloud) = (grain(x, y, 96), clouds(x, y, 1.0, 23));
        let (u, v) = (x * 8.0, y * 8.0);
        let edge = |v: f32| smooth(0.007, 0.017, 0.5 - (v - v.floor() - 0.5).abs());
        let piece = edge(u) * edge(v);
        let (column, row) = (u as i32 & 7, v as i32 & 7);
        let dark = if (column + row) & 1 == 0 { 0.80 } else { 1.06 };
        let own = unit(hash2(column, row, 59));
        let face = dark * (0.94 + 0.1 * own) * (0.82 + 0.2 * fine + 0.16 * cloud);
        Spot { height: 1.6 * piece + 0.5 * fine, shade: 0.5 + (face - 0.5) * piece, tint: 1.0 - piece }
    });
    Texture::new(&canvas, 256.0)
}

/// Cobbles of 125 mm in half bond, rounded, with sand between them.
pub(crate) fn setts() -> Texture {
    let bond = Bond { across: [16.0, 16.0], joint: [0.07, 0.07], seed: 61 };
    let canvas = Canvas::new(512, |x, y| {
        let rough = grain(x, y, 72);
        let laid = bond.at(x, y, 3.0 * (clouds(x, y, 1.0, 29) - 0.5));
        // Higher in its middle.
        let (u, v) = (x * 16.0, y * 16.0);
        let half = if v.floor() as i32 & 1 == 0 { 0.0 } else { 0.5 };
        let off = |v: f32| v - v.floor() - 0.5;
        let dome = 1.0 - 2.0 * (off(u + half) * off(u + half) + off(v) * off(v));
        let face = (0.72 + 0.5 * laid.own[0]) * (0.85 + 0.3 * rough);
        Spot {
            height: 4.0 * dome * laid.piece + 0.8 * rough,
            shade: 0.55 + (face - 0.55) * laid.piece,
            tint: 1.0 - laid.piece,
        }
    });
    Texture::new(&canvas, 256.0)
}

/// Tiles of 250 by 333 mm: a wave across, a step down to the next row.
pub(crate) fn roof() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let (u, v) = (x * 8.0, y * 6.0);
        let (across, down) = (u - u.floor(), v - v.floor());
        let word = hash2(u as i32 & 7, (v as i32).rem_euclid(6), 53);
        let arch = 1.0 - 4.0 * (across - 0.5) * (across - 0.5);
        // The lower edge of a tile lies on the next one and shades it.
        let under = smooth(0.82, 1.0, down);
        Spot {
            height: 5.0 * arch - 3.5 * down,
            shade: (0.78 + 0.36 * unit(word))
                * (0.55 + 0.45 * arch)
                * (1.0 - 0.55 * under)
                * (0.75 + 0.5 * clouds(x, y, 1.0, 17)),
            tint: 0.0,
        }
    });
    Texture::new(&canvas, 128.0)
}
