//! Pictures of a grid for people.

use schema::Tag;

use crate::voxel_grid::VoxelGrid;

/// An RGB picture: width, height, three bytes a pixel.
type Picture = (usize, usize, Vec<u8>);

/// Colour of a label at a height: lower cells are darker.
fn shade(label: u8, k: usize, layers: usize) -> [u8; 3] {
    let rgb = Tag::from_u8(label).unwrap_or_default().viewer_rgb();
    let light = 0.55 + 0.45 * (k + 1) as f32 / layers as f32;
    rgb.map(|c| (f32::from(c) * light) as u8)
}

/// The topmost label of every column, seen from above: one pixel a column, forward is up, left is left.
/// Returns width, height and RGB bytes.
#[must_use]
pub fn top_view(grid: &VoxelGrid) -> Picture {
    let [nx, ny, nz] = grid.shape;
    let mut pixels = vec![255_u8; 3 * nx * ny];
    for i in 0..nx {
        for j in 0..ny {
            let start = grid.index(i, j, 0);
            let column = &grid.data[start..start + nz];
            if let Some(k) = column.iter().rposition(|&label| label != 0) {
                let pixel = 3 * ((nx - 1 - i) * ny + (ny - 1 - j));
                pixels[pixel..pixel + 3].copy_from_slice(&shade(column[k], k, nz));
            }
        }
    }
    (ny, nx, pixels)
}

/// The grid seen obliquely from behind: depth is halved, heights stand upright. Returns width, height and RGB
/// bytes.
#[must_use]
pub fn oblique_view(grid: &VoxelGrid) -> Picture {
    let [nx, ny, nz] = grid.shape;
    let height = nx.div_ceil(2) + nz;
    let mut pixels = vec![255_u8; 3 * height * ny];
    // From far to near and from low to high: later cells hide earlier ones.
    for i in (0..nx).rev() {
        for j in 0..ny {
            let start = grid.index(i, j, 0);
            for (k, &label) in grid.data[start..start + nz].iter().enumerate() {
                if label != 0 {
                    let row = (nx - 1 - i) / 2 + (nz - 1 - k);
                    let pixel = 3 * (row * ny + (ny - 1 - j));
                    pixels[pixel..pixel + 3].copy_from_slice(&shade(label, k, nz));
                }
            }
        }
    }
    (ny, height, pixels)
}
