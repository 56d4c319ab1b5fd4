//! BEV masks as pictures.

use clap::ValueEnum;
use codecs::images::{Chroma, ImageError, encode_jpeg};
use schema::BevClass;
use schema::palette::bev_cityscapes_rgb;
use serde::Serialize;

/// Quality of the pictures: that of the layout's own ones.
const QUALITY: u8 = 95;

/// Colours of the masks' pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Palette {
    /// Bright colours.
    Plain,
    /// Those of Cityscapes.
    Cityscapes,
}

impl Palette {
    fn rgb(self, class: BevClass) -> [u8; 3] {
        match self {
            Self::Plain => class.rgb(),
            Self::Cityscapes => bev_cityscapes_rgb(class),
        }
    }
}

/// The picture of `cells` x `cells` masks: on white, later channels over earlier ones.
pub(super) fn picture(masks: &[u8], cells: usize, palette: Palette) -> Result<Vec<u8>, ImageError> {
    let rgb = painted(masks, cells, palette);
    jpeg(&rgb, cells, QUALITY)
}

fn painted(masks: &[u8], cells: usize, palette: Palette) -> Vec<u8> {
    let mut rgb = vec![255; 3 * cells * cells];
    for (class, mask) in BevClass::ALL.into_iter().zip(masks.chunks_exact(cells * cells)) {
        let color = palette.rgb(class);
        for (pixel, _) in rgb.chunks_exact_mut(3).zip(mask).filter(|(_, set)| **set != 0) {
            pixel.copy_from_slice(&color);
        }
    }
    rgb
}

/// A square picture.
pub(super) fn jpeg(rgb: &[u8], side: usize, quality: u8) -> Result<Vec<u8>, ImageError> {
    encode_jpeg([side as u32; 2], rgb, quality, Chroma::Half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_channels_lie_over_earlier_ones() {
        let mut masks = vec![0; 14 * 4];
        let mut set = |class: BevClass, cell: usize| masks[4 * class as usize + cell] = 1;
        set(BevClass::Road, 0);
        set(BevClass::Road, 1);
        set(BevClass::Car, 1);
        set(BevClass::Pedestrian, 3);
        let plain = painted(&masks, 2, Palette::Plain);
        assert_eq!(plain, [196, 80, 196, 0, 128, 240, 255, 255, 255, 240, 0, 0]);
        let cityscapes = painted(&masks, 2, Palette::Cityscapes);
        assert_eq!(cityscapes, [128, 64, 128, 0, 0, 142, 255, 255, 255, 220, 20, 60]);
    }
}
