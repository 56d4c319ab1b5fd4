//! Writes pictures of every grid of a small town: `cargo run -p convoy-tests --example look_down -- FOLDER`.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use frames::{Agent, Pose, World};
use labels::bev::{Areas, BevRasterizer, to_rgb};
use labels::fill::fill;
use labels::voxels::{oblique_view, top_view, voxelize};
use nalgebra::Point3;
use settings::{BevSettings, OccupancySettings};
use testkit::small_town;

fn save(path: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(rgb)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let folder = Path::new(&folder);
    let town = small_town();
    let world_from_agent = Pose::<World, Agent>::from_xyz_rpy([-20.0, -2.0, -0.1], [0.002, -0.006, 0.05]);

    let corners = |x: [f64; 2], y: [f64; 2]| {
        vec![
            Point3::new(x[0], y[0], 0.0),
            Point3::new(x[1], y[0], 0.0),
            Point3::new(x[1], y[1], 0.0),
            Point3::new(x[0], y[1], 0.0),
        ]
    };
    let crosswalks = [corners([-13.0, -9.0], [-8.0, 8.0]), corners([9.0, 13.0], [-8.0, 8.0])];
    let hazards = [corners([20.0, 34.0], [-8.0, -4.0])];
    let areas = Areas { crosswalks: &crosswalks, hazards: &hazards, ..Areas::default() };
    let mask = BevRasterizer::new(&BevSettings::default())?.rasterize(&town, &world_from_agent, areas);
    save(&folder.join("bev.png"), mask.cells(), mask.cells(), &to_rgb(&mask))?;

    let settings = OccupancySettings { range_m: 40.0, ..OccupancySettings::default() };
    let mut grid = voxelize(&town, &world_from_agent, &settings, None)?;
    let (width, height, rgb) = top_view(&grid);
    save(&folder.join("voxels-top.png"), width, height, &rgb)?;
    let (width, height, rgb) = oblique_view(&grid);
    save(&folder.join("voxels-oblique.png"), width, height, &rgb)?;
    fill(&mut grid, settings.voxel_m, settings.fill_rule)?;
    // Cut open: the upper half of the cells taken away.
    let [_, _, nz] = grid.shape;
    for column in grid.data.chunks_exact_mut(nz) {
        column[nz / 4..].fill(0);
    }
    let (width, height, rgb) = top_view(&grid);
    save(&folder.join("voxels-filled-cut.png"), width, height, &rgb)?;
    Ok(())
}
