//! Flat pictures of what is painted on a board.

use std::sync::{Arc, OnceLock};

use frames::math;
use schema::mesh_textures::{Image, Level, Wrap};

/// Texels along the longer side.
const SIDE: f32 = 256.0;
/// Rows of samples in a row of texels; along a row edges are exact.
const ROWS: usize = 4;
/// Letters are no narrower than so much of their own width.
const NARROWEST: f32 = 0.75;
/// Steps of the table from linear light to bytes.
const STEPS: usize = 4096;

/// A picture in the making, metres to the right and up from its lower left corner; linear RGB.
pub(crate) struct Canvas {
    size_m: [f32; 2],
    texels: [usize; 2],
    rgb: Vec<[f32; 3]>,
}

impl Canvas {
    pub(crate) fn new(size_m: [f32; 2], rgb: [f32; 3]) -> Self {
        Self::fine(size_m, rgb, SIDE)
    }

    /// The same with so many texels along its longer side.
    pub(crate) fn fine(size_m: [f32; 2], rgb: [f32; 3], texels: f32) -> Self {
        let per_m = texels / size_m[0].max(size_m[1]).max(0.01);
        let texels = size_m.map(|m| ((m * per_m).round() as usize).max(1));
        Self { size_m, texels, rgb: vec![rgb; texels[0] * texels[1]] }
    }

    /// Paints a polygon that does not cross itself.
    pub(crate) fn fill(&mut self, polygon: &[[f32; 2]], rgb: [f32; 3]) {
        let [columns, rows] = self.texels;
        let scale = [0, 1].map(|k| self.texels[k] as f32 / self.size_m[k]);
        // Rows run downwards.
        let ring: Vec<[f32; 2]> =
            polygon.iter().map(|[x, y]| [x * scale[0], rows as f32 - y * scale[1]]).collect();
        let low = ring.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min).floor().max(0.0) as usize;
        let high = ring.iter().map(|p| p[1]).fold(0.0, f32::max).ceil().min(rows as f32) as usize;
        let mut covered = vec![0.0f32; columns];
        let mut cuts: Vec<f32> = Vec::new();
        for row in low..high {
            covered.fill(0.0);
            for k in 0..ROWS {
                let y = row as f32 + (k as f32 + 0.5) / ROWS as f32;
                cuts.clear();
                cuts.extend(ring.iter().zip(ring.iter().cycle().skip(1)).filter_map(|(a, b)| {
                    let crosses = (a[1] > y) != (b[1] > y);
                    crosses.then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                }));
                cuts.sort_by(f32::total_cmp);
                for pair in cuts.chunks_exact(2) {
                    let (from, to) = (pair[0].max(0.0), pair[1].min(columns as f32));
                    let last = (to.ceil().max(0.0) as usize).min(columns);
                    for (column, share) in covered.iter_mut().enumerate().take(last).skip(from as usize) {
                        let inside = to.min(column as f32 + 1.0) - from.max(column as f32);
                        *share += inside.max(0.0) / ROWS as f32;
                    }
                }
            }
            let line = &mut self.rgb[row * columns..(row + 1) * columns];
            for (texel, share) in line.iter_mut().zip(&covered).filter(|(_, share)| **share > 0.0) {
                let share = share.min(1.0);
                *texel = [0, 1, 2].map(|k| texel[k] + (rgb[k] - texel[k]) * share);
            }
        }
    }

    /// Writes a word whose capitals are so high, its middle at a place, no wider than that says.
    pub(crate) fn write(
        &mut self,
        text: &str,
        middle_m: [f32; 2],
        height_m: f32,
        widest_m: f32,
        rgb: [f32; 3],
    ) {
        let Some(word) = lettering::write(text) else { return };
        let fits = (widest_m / (word.width as f32 * height_m)).min(1.0);
        // Letters grow narrower, to a point, before they grow smaller.
        let narrow = fits.max(NARROWEST);
        let height_m = height_m * fits / narrow;
        let start = [middle_m[0] - 0.5 * word.width as f32 * height_m * narrow, middle_m[1] - 0.5 * height_m];
        for outline in &word.outlines {
            let place = |[x, y]: &[f64; 2]| {
                [start[0] + *x as f32 * height_m * narrow, start[1] + *y as f32 * height_m]
            };
            let ring: Vec<[f32; 2]> = outline.iter().map(place).collect();
            self.fill(&ring, rgb);
        }
    }

    /// The picture, with its coarser copies.
    pub(crate) fn finish(self) -> Arc<Image> {
        let Self { mut texels, mut rgb, .. } = self;
        let mut levels = Vec::new();
        loop {
            levels.push(Level {
                width: texels[0] as u32,
                height: texels[1] as u32,
                texels: rgb.iter().map(|rgb| rgb.map(byte)).collect(),
            });
            if texels == [1, 1] {
                break;
            }
            let half = texels.map(|n| n.div_ceil(2));
            let at = |x: usize, y: usize| rgb[y.min(texels[1] - 1) * texels[0] + x.min(texels[0] - 1)];
            rgb = (0..half[0] * half[1])
                .map(|i| {
                    let (x, y) = (2 * (i % half[0]), 2 * (i / half[0]));
                    let four = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
                    [0, 1, 2].map(|k| 0.25 * four.iter().map(|texel| texel[k]).sum::<f32>())
                })
                .collect();
            texels = half;
        }
        Arc::new(Image { levels, wrap: [Wrap::Clamp; 2] })
    }
}

/// The sRGB byte of linear light (IEC 61966-2-1).
fn byte(linear: f32) -> u8 {
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        (0..=STEPS)
            .map(|i| {
                let v = i as f64 / STEPS as f64;
                let srgb = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * math::pow(v, 1.0 / 2.4) - 0.055 };
                (srgb * 255.0).round() as u8
            })
            .collect()
    });
    table[(linear.clamp(0.0, 1.0) * STEPS as f32).round() as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean linear red of the finest copy and of the coarsest.
    fn means(image: &Image) -> [f64; 2] {
        let linear = |byte: u8| math::pow((f64::from(byte) / 255.0 + 0.055) / 1.055, 2.4);
        let mean = |level: &Level| {
            level.texels.iter().map(|t| linear(t[0])).sum::<f64>() / level.texels.len() as f64
        };
        [mean(&image.levels[0]), mean(image.levels.last().expect("has some"))]
    }

    #[test]
    fn a_polygon_covers_its_area_at_every_distance() {
        let mut canvas = Canvas::new([0.8, 0.4], [0.0; 3]);
        // A triangle of 0.06 m2 in 0.32 m2.
        canvas.fill(&[[0.1, 0.05], [0.5, 0.05], [0.3, 0.35]], [1.0; 3]);
        let image = canvas.finish();
        assert_eq!([image.levels[0].width, image.levels[0].height], [256, 128]);
        for mean in means(&image) {
            assert!((mean - 0.06 / 0.32).abs() < 0.006, "{mean}");
        }
    }

    #[test]
    fn words_stand_upright_from_left_to_right() {
        let mut canvas = Canvas::new([1.0, 1.0], [0.0; 3]);
        canvas.write("LI", [0.5, 0.5], 0.8, 0.9, [1.0; 3]);
        let image = canvas.finish();
        let inked = |x: f32, y: f32| {
            image.levels[0].texels[((1.0 - y) * 256.0) as usize * 256 + (x * 256.0) as usize][0] > 128
        };
        let width = 0.8 * lettering::write("LI").expect("is known").width as f32;
        let left = 0.5 - 0.5 * width;
        assert!(inked(left + 0.05, 0.85) && inked(left + 0.05, 0.15) && inked(left + 0.3, 0.15), "an L");
        assert!(!inked(left + 0.3, 0.85) && inked(left + width - 0.05, 0.85), "then an I");
    }
}
