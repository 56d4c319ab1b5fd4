//! The instances as one camera sees them, sorted into tiles.

use crate::{Outputs, PinholeCamera, Stipple};
use glam::{DVec3, Mat3, Vec3};

use crate::prepared::meshes::MeshData;
use crate::prepared::outline::reciprocal;
use crate::prepared::placed::Placed;

/// Columns of a tile; a multiple of the pixels that are drawn at once.
pub const TILE_WIDTH: usize = 64;
/// Rows of a tile. Which pixels a triangle covers is worked out from a tile's first pixel, so all renderers
/// keep this grid.
pub const TILE_HEIGHT: usize = 32;
/// Pixels by which projected boxes grow: far more than rounding, far less than a tile.
const MARGIN_PX: f32 = 1.0;

/// An instance in front of the camera.
#[derive(Clone, Debug)]
pub struct ViewedInstance<'a> {
    /// Its number in the snapshot.
    pub number: u32,
    /// Number of its mesh.
    pub mesh_number: u32,
    /// Its mesh.
    pub mesh: &'a MeshData,
    /// As [`MeshData::panes`] has them, where these are stippled.
    pub panes: &'a [u8],
    /// Where those are opaque.
    pub stipple: Stipple,
    /// Rows of the rotation from the object to the optical frame.
    pub rows: [Vec3; 3],
    /// The object's origin in the optical frame, metres.
    pub translation: Vec3,
    /// No point of it is nearer: planar depth, metres.
    pub nearest_m: f32,
}

/// A camera and what is in front of it.
#[derive(Clone, Debug)]
pub struct TiledView<'a> {
    /// The camera.
    pub camera: PinholeCamera,
    /// Nearest first.
    pub seen: Vec<ViewedInstance<'a>>,
    /// Indices into `seen` of all tiles, one tile after the other, nearest first within each.
    entries: Vec<u32>,
    /// Where a tile's entries start; one more than there are tiles.
    starts: Vec<u32>,
    columns: usize,
}

/// First and last tile, column and row.
type TileRange = [usize; 4];

impl<'a> TiledView<'a> {
    /// Sorts instances, given with their numbers.
    pub(crate) fn new<'p>(
        placed: impl Iterator<Item = (u32, &'p Option<Placed<'a>>)>,
        camera: &PinholeCamera,
        panes: Stipple,
    ) -> Self
    where
        'a: 'p,
    {
        let columns = (camera.width as usize).div_ceil(TILE_WIDTH);
        let rows = (camera.height as usize).div_ceil(TILE_HEIGHT);
        let look = |(number, placed): (u32, &'p Option<Placed<'a>>)| {
            let placed = placed.as_ref()?;
            let (mut seen, range) = in_view(number, placed, camera)?;
            if panes != Stipple::OPAQUE && placed.has_cabin {
                seen.panes = &placed.mesh.panes;
                seen.stipple = panes;
            }
            Some((seen, range))
        };
        let mut found: Vec<(ViewedInstance<'a>, TileRange)> = placed.filter_map(look).collect();
        found.sort_by(|(a, _), (b, _)| {
            a.nearest_m.total_cmp(&b.nearest_m).then_with(|| a.number.cmp(&b.number))
        });
        // Two passes: count, then place.
        let mut starts = vec![0u32; columns * rows + 1];
        let tiles_of = |[c0, c1, r0, r1]: TileRange| {
            (r0..=r1).flat_map(move |row| (c0..=c1).map(move |column| row * columns + column))
        };
        for (_, range) in &found {
            tiles_of(*range).for_each(|tile| starts[tile + 1] += 1);
        }
        for tile in 0..columns * rows {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let mut entries = vec![0u32; starts[columns * rows] as usize];
        for (index, (_, range)) in found.iter().enumerate() {
            for tile in tiles_of(*range) {
                entries[next[tile] as usize] = index as u32;
                next[tile] += 1;
            }
        }
        let seen = found.into_iter().map(|(seen, _)| seen).collect();
        Self { camera: *camera, seen, entries, starts, columns }
    }

    /// The change of a pixel's direction per column and per row: directions are 1 long along the axis.
    #[must_use]
    pub fn step(&self) -> [f64; 2] {
        [1.0 / f64::from(self.camera.fx), 1.0 / f64::from(self.camera.fy)]
    }

    /// Pixels from the optical axis to the centre of a tile's first pixel.
    #[must_use]
    pub fn first(&self, column: usize, row: usize) -> [f64; 2] {
        [
            (column * TILE_WIDTH) as f64 + 0.5 - f64::from(self.camera.cx),
            (row * TILE_HEIGHT) as f64 + 0.5 - f64::from(self.camera.cy),
        ]
    }

    /// Inverse depth where nothing is seen. What is exactly at the far end is nearer: by its numbers, or by a
    /// hair where depths alone are wanted.
    #[must_use]
    pub fn sky(&self, outputs: Outputs) -> f32 {
        let farthest = reciprocal(self.camera.far_m);
        match outputs {
            Outputs::Surfaces => farthest,
            Outputs::Depths => farthest.next_down(),
        }
    }

    /// Columns and rows of tiles.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, (self.camera.height as usize).div_ceil(TILE_HEIGHT)]
    }

    /// The instances that may be seen in a tile, nearest first: places in [`seen`](Self::seen).
    #[must_use]
    pub fn entries(&self, column: usize, row: usize) -> &[u32] {
        let tile = row * self.columns + column;
        &self.entries[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// The instances that may be seen in a tile, nearest first.
    pub fn tile(&self, column: usize, row: usize) -> impl Iterator<Item = &ViewedInstance<'a>> {
        self.entries(column, row).iter().map(|&index| &self.seen[index as usize])
    }
}

/// An instance in optical coordinates, and the bounds of it.
struct Framed {
    /// From the object to the optical frame.
    rotation: Mat3,
    translation: Vec3,
    nearest_m: f32,
    farthest_m: f32,
    /// Lowest and highest column and row; the whole picture's where it reaches before the near depth.
    low: [f32; 2],
    high: [f32; 2],
}

impl Framed {
    /// `None` when it lies wholly before or behind the camera's depths.
    fn new(placed: &Placed<'_>, camera: &PinholeCamera) -> Option<Self> {
        // In double precision: the difference of two places far from the local origin loses nothing.
        let optical_from_local = Mat3::from(camera.local_from_optical.matrix3).as_dmat3().transpose();
        let camera_m: DVec3 = camera.local_from_optical.translation.as_dvec3();
        let rotation = (optical_from_local * placed.rotation.as_dmat3()).as_mat3();
        let translation = (optical_from_local * (placed.translation.as_dvec3() - camera_m)).as_vec3();
        let corners = placed.mesh.aabb.corners().map(|c| rotation * c + translation);
        let (mut nearest_m, mut farthest_m) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in corners {
            nearest_m = nearest_m.min(corner.z);
            farthest_m = farthest_m.max(corner.z);
        }
        // Rounding of the corners, relative to the coordinates that went into them.
        let reach = placed.mesh.aabb.min.abs().max(placed.mesh.aabb.max.abs()).max_element();
        let slack_m = 8.0 * f32::EPSILON * (reach + translation.abs().max_element());
        nearest_m -= slack_m;
        farthest_m += slack_m;
        if farthest_m < camera.near_m || nearest_m > camera.far_m {
            return None;
        }
        let mut low = [0.0, 0.0];
        let mut high = [camera.width as f32, camera.height as f32];
        if nearest_m >= camera.near_m {
            low = [f32::INFINITY; 2];
            high = [f32::NEG_INFINITY; 2];
            for corner in corners {
                let x = camera.fx * corner.x / corner.z + camera.cx;
                let y = camera.fy * corner.y / corner.z + camera.cy;
                low = [low[0].min(x), low[1].min(y)];
                high = [high[0].max(x), high[1].max(y)];
            }
        }
        Some(Self { rotation, translation, nearest_m, farthest_m, low, high })
    }
}

/// Whether an instance is wholly in a picture, so many pixels off its edges, and within its depths.
pub(crate) fn is_within(placed: &Placed<'_>, camera: &PinholeCamera, inner_px: f32) -> bool {
    let inner_px = inner_px + MARGIN_PX;
    Framed::new(placed, camera).is_some_and(|Framed { nearest_m, farthest_m, low, high, .. }| {
        nearest_m >= camera.near_m
            && farthest_m <= camera.far_m
            && low.iter().all(|low| *low >= inner_px)
            && high[0] <= camera.width as f32 - inner_px
            && high[1] <= camera.height as f32 - inner_px
    })
}

/// Places one instance before the camera and finds the tiles it may touch; `None` when there are none.
fn in_view<'a>(
    number: u32,
    placed: &Placed<'a>,
    camera: &PinholeCamera,
) -> Option<(ViewedInstance<'a>, TileRange)> {
    if camera.width == 0 || camera.height == 0 {
        return None;
    }
    let Framed { rotation, translation, nearest_m, low, high, .. } = Framed::new(placed, camera)?;
    let (width, height) = (camera.width as f32, camera.height as f32);
    if low[0] - MARGIN_PX > width
        || low[1] - MARGIN_PX > height
        || high[0] + MARGIN_PX < 0.0
        || high[1] + MARGIN_PX < 0.0
    {
        return None;
    }
    let tile = |value: f32, size: usize, end: f32| (value.clamp(0.0, end - 1.0) as usize) / size;
    let range = [
        tile(low[0] - MARGIN_PX, TILE_WIDTH, width),
        tile(high[0] + MARGIN_PX, TILE_WIDTH, width),
        tile(low[1] - MARGIN_PX, TILE_HEIGHT, height),
        tile(high[1] + MARGIN_PX, TILE_HEIGHT, height),
    ];
    let rows = rotation.transpose();
    let seen = ViewedInstance {
        number,
        mesh_number: placed.mesh_number,
        mesh: placed.mesh,
        panes: &[],
        stipple: Stipple::OPAQUE,
        rows: [rows.x_axis, rows.y_axis, rows.z_axis],
        translation,
        nearest_m,
    };
    Some((seen, range))
}
