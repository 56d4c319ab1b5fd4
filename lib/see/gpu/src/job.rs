//! What the kernel for cameras is told: views, tile by tile, as the words that `visibility.wgsl` reads.

use std::ops::Range;

use render::prepared::{TILE_HEIGHT, TILE_WIDTH, TiledView, ViewedInstance, reciprocal};
use render::{Outputs, VisibilityBuffer};

use crate::meshes::{FARTHEST_M, Place, ResidentMeshes};

/// Words before the tiles: how many tiles, and where tiles, cameras, instances and entries begin.
const HEADER: usize = 5;
const INSTANCE_WORDS: usize = 18;
const TILE_PIXELS: usize = TILE_WIDTH * TILE_HEIGHT;

/// A camera's view that a device is to draw.
#[derive(Debug)]
pub(crate) struct Asked<'a> {
    view: TiledView<'a>,
    outputs: Outputs,
    places: Vec<Place>,
}

/// Some tiles of some views, in one call of the kernel.
#[derive(Debug)]
pub(crate) struct Job {
    /// What the kernel reads.
    pub(crate) words: Vec<u32>,
    /// How many words it answers.
    pub(crate) answers: usize,
    tiles: Vec<Tile>,
}

/// A tile of a view, and where its answer begins.
#[derive(Clone, Copy, Debug)]
struct Tile {
    view: usize,
    column: usize,
    row: usize,
    answer: usize,
}

impl<'a> Asked<'a> {
    /// A view over meshes on the device; `None` if a kernel cannot draw it as the CPU does.
    pub(crate) fn new(view: TiledView<'a>, outputs: Outputs, meshes: &ResidentMeshes) -> Option<Self> {
        let place = |seen: &ViewedInstance<'_>| {
            let reach_m = reach_m(seen);
            meshes.place(seen.mesh_number).filter(|_| reach_m <= FARTHEST_M)
        };
        let places = view.seen.iter().map(place).collect::<Option<Vec<_>>>()?;
        Some(Self { view, outputs, places })
    }

    /// A picture of the sky alone.
    pub(crate) fn empty(&self) -> VisibilityBuffer {
        match self.outputs {
            Outputs::Surfaces => VisibilityBuffer::empty(&self.view.camera),
            Outputs::Depths => VisibilityBuffer::empty_depths(&self.view.camera),
        }
    }

    fn words_a_tile(&self) -> usize {
        match self.outputs {
            Outputs::Surfaces => 3 * TILE_PIXELS,
            Outputs::Depths => TILE_PIXELS,
        }
    }

    /// Tiles in which something may be.
    fn tiles(&self) -> impl Iterator<Item = (usize, usize)> {
        let [columns, rows] = self.view.size();
        let all = (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)));
        all.filter(|&(column, row)| !self.view.entries(column, row).is_empty())
    }

    /// Columns and rows of a tile that are in the picture.
    fn size(&self, column: usize, row: usize) -> [usize; 2] {
        let camera = &self.view.camera;
        [
            (camera.width as usize - column * TILE_WIDTH).min(TILE_WIDTH),
            (camera.height as usize - row * TILE_HEIGHT).min(TILE_HEIGHT),
        ]
    }
}

impl Job {
    /// All views, in calls that answer no more than so many words (one tile at least).
    pub(crate) fn split(asked: &[Asked<'_>], most_words: usize) -> Vec<Self> {
        let mut jobs = Vec::new();
        let (mut tiles, mut answers) = (Vec::new(), 0);
        for (view, of_view) in asked.iter().enumerate() {
            for (column, row) in of_view.tiles() {
                if !tiles.is_empty() && answers + of_view.words_a_tile() > most_words {
                    jobs.push(Self::of(asked, std::mem::take(&mut tiles), answers));
                    answers = 0;
                }
                tiles.push(Tile { view, column, row, answer: answers });
                answers += of_view.words_a_tile();
            }
        }
        if !tiles.is_empty() {
            jobs.push(Self::of(asked, tiles, answers));
        }
        jobs
    }

    /// Workgroups: one a tile.
    pub(crate) fn workgroups(&self) -> u32 {
        self.tiles.len() as u32
    }

    fn of(asked: &[Asked<'_>], tiles: Vec<Tile>, answers: usize) -> Self {
        // Tiles are in the order of their views.
        let views: Range<usize> = match (tiles.first(), tiles.last()) {
            (Some(first), Some(last)) => first.view..last.view + 1,
            _ => 0..0,
        };
        let views = &asked[views];
        let first_view = tiles.first().map_or(0, |tile| tile.view);
        let mut first_instance = Vec::with_capacity(views.len());
        let (mut cameras, mut instances) = (Vec::new(), Vec::new());
        for asked in views {
            first_instance.push((instances.len() / INSTANCE_WORDS) as u32);
            camera(asked, &mut cameras);
            asked.view.seen.iter().zip(&asked.places).for_each(|(seen, place)| {
                instance(seen, *place, &mut instances);
            });
        }
        let (mut told, mut entries) = (Vec::new(), Vec::<u32>::new());
        for tile in &tiles {
            let (number, asked) = (tile.view - first_view, &asked[tile.view]);
            let first_entry = entries.len() as u32;
            let of_tile = asked.view.entries(tile.column, tile.row);
            entries.extend(of_tile.iter().map(|entry| entry + first_instance[number]));
            told.extend([number as u32, first_entry, entries.len() as u32, tile.answer as u32]);
            asked.view.first(tile.column, tile.row).iter().for_each(|v| told.extend(double(*v)));
            told.extend(asked.size(tile.column, tile.row).map(|size| size as u32));
        }
        let mut words = vec![tiles.len() as u32];
        let mut begin = HEADER;
        for part in [&told, &cameras, &instances, &entries] {
            words.push(begin as u32);
            begin += part.len();
        }
        words.extend([told, cameras, instances, entries].into_iter().flatten());
        Self { words, answers, tiles }
    }

    /// Puts a view's answers into its picture.
    pub(crate) fn store(&self, answers: &[u32], number: usize, asked: &Asked<'_>, to: &mut VisibilityBuffer) {
        let width = to.width as usize;
        for tile in self.tiles.iter().filter(|tile| tile.view == number) {
            let [columns, rows] = asked.size(tile.column, tile.row);
            for row in 0..rows {
                let from = tile.answer + row * TILE_WIDTH;
                let at = (tile.row * TILE_HEIGHT + row) * width + tile.column * TILE_WIDTH;
                let words = |part: usize| {
                    let from = from + part * TILE_PIXELS;
                    &answers[from..from + columns]
                };
                to.depth_m[at..at + columns].copy_from_slice(bytemuck::cast_slice(words(0)));
                if asked.outputs == Outputs::Surfaces {
                    to.instance[at..at + columns].copy_from_slice(words(1));
                    to.triangle[at..at + columns].copy_from_slice(words(2));
                }
            }
        }
    }
}

/// The largest coordinate of an instance, in the object's and in the optical frame.
fn reach_m(seen: &ViewedInstance<'_>) -> f32 {
    let aabb = &seen.mesh.aabb;
    aabb.min.abs().max(aabb.max.abs()).max_element() + seen.translation.abs().max_element()
}

fn camera(asked: &Asked<'_>, words: &mut Vec<u32>) {
    let camera = &asked.view.camera;
    asked.view.step().iter().for_each(|step| words.extend(double(*step)));
    let sky = asked.view.sky(asked.outputs);
    let floats = [camera.fx, camera.fy, camera.near_m, reciprocal(camera.near_m), sky];
    words.extend(floats.map(f32::to_bits));
    words.push(u32::from(asked.outputs == Outputs::Surfaces));
}

fn instance(seen: &ViewedInstance<'_>, place: Place, words: &mut Vec<u32>) {
    let slack_m = 16.0 * f32::EPSILON * reach_m(seen);
    let places = seen.rows.iter().flat_map(glam::Vec3::to_array).chain(seen.translation.to_array());
    words.extend(places.chain([seen.nearest_m, slack_m]).map(f32::to_bits));
    let opaque = seen.stipple.row(0) | seen.stipple.row(1) << 2;
    words.extend([seen.number, place.node, place.slot, opaque]);
}

/// The two words of a double, the lower first.
fn double(value: f64) -> [u32; 2] {
    let bits = value.to_bits();
    [bits as u32, (bits >> 32) as u32]
}
