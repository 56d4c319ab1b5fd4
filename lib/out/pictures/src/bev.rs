//! Bird's-eye-view masks.

use schema::BevClass;
use schema::palette::bev_cityscapes_rgb;

use crate::{Canvas, PictureError, Rgb};

/// The colours of classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BevPalette {
    /// The default ones.
    Plain,
    /// Those of Cityscapes.
    Cityscapes,
}

impl BevPalette {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Plain, Self::Cityscapes];

    /// The colour of a class.
    #[must_use]
    pub fn rgb(self, class: BevClass) -> Rgb {
        match self {
            Self::Plain => class.rgb(),
            Self::Cityscapes => bev_cityscapes_rgb(class),
        }
    }
}

/// Draws masks (`[classes, rows, columns]`, not 0 is true) on white, later classes over earlier ones; `scale`
/// pixels a cell.
///
/// # Errors
/// There are not as many cells as that, or the picture would be too large.
pub fn draw_bev(
    masks: &[u8],
    classes: &[BevClass],
    [rows, columns]: [usize; 2],
    palette: BevPalette,
    scale: u32,
) -> Result<Canvas, PictureError> {
    let cells = rows * columns;
    let expected = classes.len() * cells;
    if masks.len() != expected {
        return Err(PictureError::Shape { what: "BEV masks", found: masks.len(), expected });
    }
    let mut colours = vec![[255_u8; 3]; cells];
    let mut order: Vec<(BevClass, &[u8])> =
        classes.iter().copied().zip(masks.chunks_exact(cells.max(1))).collect();
    order.sort_by_key(|(class, _)| *class);
    for (class, mask) in order {
        let rgb = palette.rgb(class);
        colours.iter_mut().zip(mask).filter(|(_, set)| **set != 0).for_each(|(colour, _)| *colour = rgb);
    }
    let side = |cells: usize| (cells as u64 * u64::from(scale)).min(u64::from(u32::MAX)) as u32;
    let mut canvas = Canvas::new([side(columns), side(rows)], [255; 3])?;
    let n = scale as usize;
    for (y, row) in canvas.rows_mut().enumerate() {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            pixel[..3].copy_from_slice(&colours[y / n * columns + x / n]);
        }
    }
    Ok(canvas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_classes_lie_over_earlier_ones_whatever_their_channel() {
        // Channel 0 is cars, channel 1 road: both in the first cell, road alone in the second, nothing in the
        // third.
        let classes = [BevClass::Car, BevClass::Road];
        let masks = [1, 0, 0, 1, 1, 0];
        for (palette, want) in [
            (BevPalette::Plain, [[0, 128, 240], [196, 80, 196]]),
            (BevPalette::Cityscapes, [[0, 0, 142], [128, 64, 128]]),
        ] {
            let canvas = draw_bev(&masks, &classes, [1, 3], palette, 2).expect("draws");
            assert_eq!(canvas.size(), [6, 2]);
            let colours = [1, 3, 5].map(|x| canvas.pixel([x, 1]).expect("is inside"));
            assert_eq!(colours, [want[0], want[1], [255; 3]]);
        }
        assert!(draw_bev(&masks[1..], &classes, [1, 3], BevPalette::Plain, 2).is_err());
    }
}
