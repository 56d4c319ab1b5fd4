//! Map masks: where one may drive, as a picture of 0.1 m a pixel that devkits lay under poses.

use std::io::Write;

use codecs::images::{ImageError, PngStyle, write_grey_rows};

use schema::tables::{VectorKind, VectorMapRow};

use crate::ExportError;

/// Pixels a metre: devkits know no other.
const PIXELS_PER_M: f64 = 10.0;
/// Around the ways of agents the picture shows this much, m: as far as devkits draw it.
pub(crate) const WAY_MARGIN_M: f64 = 100.0;
/// Around the centres of boxes this much, m.
pub(crate) const BOX_MARGIN_M: f64 = 10.0;
/// The ground of a picture begins at a multiple of this, m.
const STEP_M: f64 = 10.0;
/// Rows that are painted at a time.
const STRIP_ROWS: u32 = 64;
/// Devkits read a picture whole: 4 GiB, or 6.5 km square.
const MOST_PIXELS: u64 = 1 << 32;
/// What drives on lanes of these types is where it may be, as the vector map calls them.
const DRIVABLE: [&str; 8] =
    ["Driving", "Entry", "Exit", "OffRamp", "OnRamp", "Shared", "Bidirectional", "Parking"];

schema::columns! {
    /// What a mask needs of the vector map.
    MapElement of VectorMapRow {
        kind: String, x_m: Vec<f64>, y_m: Vec<f64>, rings: Vec<u32>, lane_type: Option<String>, boundaries: Vec<u32>
    }
}

/// Least and greatest x and y of points.
pub(crate) fn bounds(points: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 4]> {
    points.map(|[x, y]| [x, y, x, y]).reduce(merge)
}

/// The bounds of two pieces of ground together.
pub(crate) fn merge(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

pub(crate) fn widened([x0, y0, x1, y1]: [f64; 4], by_m: f64) -> [f64; 4] {
    [x0 - by_m, y0 - by_m, x1 + by_m, y1 + by_m]
}

/// Where a map's global frame has its origin in the world, and how large its picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapMask {
    /// The global origin in the world, whole metres: the lower left corner of the picture.
    pub(crate) origin_m: [f64; 2],
    /// Columns and rows.
    pub(crate) pixels: [u32; 2],
}

impl MapMask {
    /// Of a piece of ground (least and greatest x and y, m), with one pixel: for maps without a mask.
    pub(crate) fn blank([x0, y0, _, _]: [f64; 4]) -> Self {
        Self { origin_m: [x0, y0].map(|v| (v / STEP_M).floor() * STEP_M), pixels: [1; 2] }
    }

    /// Of a piece of ground of a map.
    ///
    /// # Errors
    /// It is too large for a picture.
    pub(crate) fn of(map: &str, [x0, y0, x1, y1]: [f64; 4]) -> Result<Self, ExportError> {
        let Self { origin_m, .. } = Self::blank([x0, y0, x1, y1]);
        let size_m = [x1 - origin_m[0], y1 - origin_m[1]].map(|v| (v / STEP_M).ceil().max(1.0) * STEP_M);
        let pixels = size_m.map(|v| (v * PIXELS_PER_M).round());
        if pixels[0] * pixels[1] > MOST_PIXELS as f64 {
            return Err(ExportError::Refused(format!(
                "map {map}: the scenes spread over {:.1} x {:.1} km: their map mask would have {:.0} million pixels, \
                 which devkits read whole (export fewer scenes into a folder, or --no-map-mask)",
                size_m[0] / 1000.0,
                size_m[1] / 1000.0,
                pixels[0] * pixels[1] / 1e6
            )));
        }
        Ok(Self { origin_m, pixels: pixels.map(|v| v as u32) })
    }

    /// The global frame is the world moved by this, m.
    pub(crate) fn global_from_world(&self) -> [f64; 3] {
        [-self.origin_m[0] + 0.0, -self.origin_m[1] + 0.0, 0.0]
    }
}

/// A polygon: what an odd number of its edges lies to the left of is inside.
struct Shape {
    rings: Vec<Vec<[f64; 2]>>,
    /// Least and greatest y, m.
    span: [f64; 2],
}

impl Shape {
    fn new(rings: Vec<Vec<[f64; 2]>>) -> Option<Self> {
        let [_, y0, _, y1] = bounds(rings.iter().flatten().copied())?;
        Some(Self { rings, span: [y0, y1] })
    }

    /// Fills what of a row (at a height y) lies inside. Pixel i is at x = i / 10 from the origin; crossings
    /// are counted half open, so that neighbours leave no gap.
    fn fill(&self, y: f64, x0: f64, row: &mut [u8], crossings: &mut Vec<f64>) {
        crossings.clear();
        for ring in &self.rings {
            let next = ring.iter().cycle().skip(1);
            for (a, b) in ring.iter().zip(next) {
                if (a[1] <= y) != (b[1] <= y) {
                    crossings.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
        }
        crossings.sort_by(f64::total_cmp);
        let pixel = |x: f64| ((x - x0) * PIXELS_PER_M).ceil().clamp(0.0, row.len() as f64) as usize;
        let spans: Vec<(usize, usize)> =
            crossings.chunks_exact(2).map(|pair| (pixel(pair[0]), pixel(pair[1]))).collect();
        for (from, to) in spans {
            row[from..to].fill(255);
        }
    }
}

/// The polygons of a map on which one may drive: lanes piece by piece, and the paved ground of junctions.
fn shapes(elements: &[MapElement]) -> Vec<Shape> {
    let points = |element: &MapElement| -> Vec<[f64; 2]> {
        element.x_m.iter().zip(&element.y_m).map(|(x, y)| [*x, *y]).collect()
    };
    let mut shapes = Vec::new();
    for element in elements {
        if element.kind == VectorKind::Junction.name() {
            let all = points(element);
            let ends = element.rings.iter().skip(1).map(|end| *end as usize).chain([all.len()]);
            let rings = element.rings.iter().zip(ends);
            let rings = rings.filter_map(|(from, to)| Some(all.get(*from as usize..to)?.to_vec()));
            shapes.extend(Shape::new(rings.collect()));
        }
        let lane_type = element.lane_type.as_deref().unwrap_or_default();
        if element.kind != VectorKind::LaneCentreline.name() || !DRIVABLE.contains(&lane_type) {
            continue;
        }
        let border = |i: usize| element.boundaries.get(i).and_then(|b| elements.get(*b as usize)).map(points);
        // Borders of a lane have their points at the same places along the road.
        let (Some(left), Some(right)) = (border(0), border(1)) else { continue };
        for (l, r) in left.windows(2).zip(right.windows(2)) {
            shapes.extend(Shape::new(vec![vec![l[0], l[1], r[1], r[0]]]));
        }
    }
    shapes
}

/// Paints a map's mask as PNG, a few rows in memory at a time: 255 where one may drive, else 0. Pixel (i, j)
/// is at global x = i / 10 and y = (rows - j) / 10, as devkits have it.
pub(crate) fn paint(mask: &MapMask, elements: &[MapElement], out: impl Write) -> Result<(), ImageError> {
    let [columns, rows] = mask.pixels;
    let mut shapes = shapes(elements);
    // Rows go from north to south.
    shapes.sort_by(|a, b| b.span[1].total_cmp(&a.span[1]));
    let height = |row: u32| mask.origin_m[1] + f64::from(rows - row) / PIXELS_PER_M;
    let (mut next, mut near) = (0, Vec::<&Shape>::new());
    let mut crossings = Vec::new();
    write_grey_rows(out, [columns, rows], PngStyle::FAST, |row, line| {
        if row % STRIP_ROWS == 0 {
            let bottom = (row + STRIP_ROWS).min(rows);
            while let Some(shape) = shapes.get(next).filter(|shape| shape.span[1] >= height(bottom - 1)) {
                near.push(shape);
                next += 1;
            }
            near.retain(|shape| shape.span[0] <= height(row));
        }
        let y = height(row);
        for shape in near.iter().filter(|shape| shape.span[0] <= y && y <= shape.span[1]) {
            shape.fill(y, mask.origin_m[0], line, &mut crossings);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(kind: VectorKind, points: &[[f64; 2]]) -> MapElement {
        MapElement {
            kind: kind.name().to_owned(),
            x_m: points.iter().map(|p| p[0]).collect(),
            y_m: points.iter().map(|p| p[1]).collect(),
            ..MapElement::default()
        }
    }

    /// The picture, row by row.
    fn painted(mask: &MapMask, elements: &[MapElement]) -> Vec<Vec<u8>> {
        let mut bytes = Vec::new();
        paint(mask, elements, &mut bytes).expect("memory does not fail");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        assert_eq!(reader.info().color_type, png::ColorType::Grayscale);
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut pixels).expect("a picture");
        pixels.chunks_exact(mask.pixels[0] as usize).map(<[u8]>::to_vec).collect()
    }

    #[test]
    fn grounds_begin_at_whole_steps() {
        let mask = MapMask::of("town", [-123.0, 45.0, 20.0, 61.0]).expect("small");
        assert_eq!(mask, MapMask { origin_m: [-130.0, 40.0], pixels: [1500, 300] });
        assert_eq!(mask.global_from_world(), [130.0, -40.0, 0.0]);
        let fault = MapMask::of("town", [0.0, 0.0, 20_000.0, 20_000.0]).expect_err("too large").to_string();
        assert!(fault.contains("20.0 x 20.0 km") && fault.contains("--no-map-mask"), "{fault}");
    }

    #[test]
    fn lanes_and_junctions_are_painted_where_they_are() {
        // A lane from (0, 2) to (8, 2), 3 m wide, and a junction of 6 m square with a hole of 2 m; the
        // picture begins at (-10, -10).
        let mut lane = element(VectorKind::LaneCentreline, &[[0.0, 2.0], [8.0, 2.0]]);
        lane.lane_type = Some("Driving".into());
        lane.boundaries = vec![1, 2];
        let square =
            |x: f64, y: f64, side: f64| [[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]];
        let (outer, hole) = (square(-8.0, -8.0, 6.0), square(-6.0, -6.0, 2.0));
        let mut junction = element(VectorKind::Junction, &[outer, hole].concat());
        junction.rings = vec![0, 5];
        let mut walk = lane.clone();
        walk.lane_type = Some("Sidewalk".into());
        walk.boundaries = vec![5, 6];
        let elements = [
            lane,
            element(VectorKind::LaneBoundary, &[[0.0, 3.5], [4.0, 3.5], [8.0, 3.5]]),
            element(VectorKind::LaneBoundary, &[[0.0, 0.5], [4.0, 0.5], [8.0, 0.5]]),
            junction,
            walk,
            element(VectorKind::LaneBoundary, &[[0.0, 8.0], [8.0, 8.0]]),
            element(VectorKind::LaneBoundary, &[[0.0, 6.0], [8.0, 6.0]]),
        ];
        let mask = MapMask::of("town", [-10.0, -10.0, 10.0, 10.0]).expect("small");
        let rows = painted(&mask, &elements);
        assert_eq!((rows.len(), rows[0].len()), (200, 200));
        // As devkits look pixels up.
        let at = |x: f64, y: f64| {
            let (x, y) = (x - mask.origin_m[0], y - mask.origin_m[1]);
            rows[(200.0 - 10.0 * y).round() as usize][(10.0 * x).round() as usize]
        };
        for (x, y, drivable) in [
            (0.1, 2.0, true),
            (3.96, 3.4, true),
            (7.9, 0.6, true),
            (8.2, 2.0, false),
            (-0.2, 2.0, false),
            (4.0, 3.7, false),
            (4.0, 0.3, false),
            (4.0, 7.0, false),
            (-7.0, -7.0, true),
            (-5.0, -5.0, false),
            (-2.2, -2.2, true),
            (-1.8, -2.2, false),
        ] {
            assert_eq!(at(x, y), if drivable { 255 } else { 0 }, "({x}, {y})");
        }
        // Neighbours leave no gap and nothing is painted twice: 80 x 30 and 60 x 60 - 20 x 20.
        assert_eq!(rows.iter().flatten().filter(|p| **p == 255).count(), 2400 + 3200);
    }
}
