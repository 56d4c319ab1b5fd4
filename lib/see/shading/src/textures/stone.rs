//! What is cast, spread or strewn: asphalt, concrete, plaster, gravel.

use crate::textures::canvas::{Canvas, Spot, clouds, grain, smooth};
use crate::textures::cells::cell;
use crate::textures::texture::Texture;

/// Stones of 11 mm in bitumen, some of them pale.
pub(crate) fn asphalt() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let stone = cell(x, y, [90, 90], 11);
        let top = smooth(0.05, 0.3, stone.gap);
        let pale = if stone.own > 0.94 { 0.5 } else { 0.0 };
        Spot {
            height: 0.45 * top + 0.5 * grain(x, y, 24),
            shade: 0.52 + top * (0.2 + 0.45 * stone.own + pale) + 0.2 * grain(x, y, 24),
            tint: 0.0,
        }
    });
    Texture::new(&canvas, 256.0)
}

/// Fine grain, pores, and clouds of lighter and darker cement.
pub(crate) fn concrete() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let hole = cell(x, y, [24, 24], 21);
        let pore = if hole.own > 0.75 { smooth(0.11, 0.05, hole.near) } else { 0.0 };
        Spot {
            height: 0.5 * grain(x, y, 48) - 0.5 * pore,
            shade: (0.8 + 0.16 * clouds(x, y, 1.0, 3) + 0.2 * grain(x, y, 48)) * (1.0 - 0.3 * pore),
            tint: 0.0,
        }
    });
    Texture::new(&canvas, 128.0)
}

/// Render, rubbed on in arcs.
pub(crate) fn plaster() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let rough = grain(x, y, 56);
        Spot { height: 1.1 * rough, shade: 0.9 + 0.2 * rough, tint: 0.0 }
    });
    Texture::new(&canvas, 128.0)
}

/// Pebbles of 3 cm of many shades.
pub(crate) fn gravel() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let pebble = cell(x, y, [64, 64], 31);
        let dome = smooth(0.0, 0.45, pebble.gap);
        Spot {
            height: 1.4 * dome + clouds(x, y, 1.0, 8),
            shade: (0.35 + 0.65 * dome) * (0.6 + 0.7 * pebble.own) * (0.85 + 0.3 * clouds(x, y, 1.0, 9)),
            tint: 0.0,
        }
    });
    Texture::new(&canvas, 128.0)
}
