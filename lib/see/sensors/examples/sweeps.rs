//! Draws lidar sweeps of a street from above:
//! `cargo run -p convoy-sensors --release --example sweeps -- FOLDER`.

#[path = "../tests/sensors/common/mod.rs"]
mod common;

use std::error::Error;
use std::path::Path;

use common::{at, prepared, street};
use random::Stream;
use render::{Renderer, Scene};
use schema::tables::Weather;
use schema::{ReturnKind, Tag};
use sensors::{Lidar, LidarMoment, LidarSweep};
use settings::{BeamSpec, LidarSpec, Returned, RollingScan, WeatherSpec};

/// Pixels of a side.
const SIDE: usize = 900;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: sweeps FOLDER")?;
    let world = street(false);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world)?;
    let rolling = |compensated| Some(RollingScan { slices: 128, compensated });
    let base = LidarSpec::vehicle();
    let all = Returned { first: true, strongest: true, last: true };
    let beam = BeamSpec { rays: 7, returned: all, ..base.beam.clone() };
    let weather = Some(WeatherSpec { detected: 0.1 });
    let wet = Weather { precipitation: 60.0, ..Weather::default() };
    let foggy = Weather { fog_density: 90.0, ..Weather::default() };
    let air = LidarSpec { weather, ..base.clone() };
    for (name, spec, sky, per_m) in [
        ("snapshot", base.clone(), Weather::default(), 12.0),
        ("rolling_raw", LidarSpec { rolling: rolling(false), ..base.clone() }, Weather::default(), 12.0),
        (
            "rolling_compensated",
            LidarSpec { rolling: rolling(true), ..base.clone() },
            Weather::default(),
            12.0,
        ),
        ("beams", LidarSpec { beam, ..base.clone() }, Weather::default(), 12.0),
        ("rain", air.clone(), wet, 12.0),
        ("rain_near", air.clone(), wet, 45.0),
        ("fog", air.clone(), foggy, 12.0),
        ("fog_near", air.clone(), foggy, 45.0),
        ("clear", air, Weather::default(), 12.0),
    ] {
        let sweep = sweep(scene, &spec, sky)?;
        draw(&Path::new(&folder).join(format!("{name}.png")), &sweep, per_m)?;
    }
    Ok(())
}

/// From a vehicle that drives at 30 m/s and turns by 0.1 rad a frame.
fn sweep(scene: &dyn Scene, spec: &LidarSpec, weather: Weather) -> Result<LidarSweep, Box<dyn Error>> {
    let mut moment = LidarMoment { weather, ..LidarMoment::standing(1, at(0.0, -5.2, 1.8, 0.0)) };
    moment.path.previous_local_from_agent = at(-1.5, -5.2, 1.8, -0.1);
    Ok(Lidar::new(spec)?.sweep(scene, &moment, &Stream::new(27, 0, "sweeps", 0))?)
}

/// Forward is up. The ground is dark; the objects on it go from blue to red by height; second and third
/// returns are white, rain is cyan, fog magenta.
fn draw(path: &Path, sweep: &LidarSweep, per_m: f32) -> Result<(), Box<dyn Error>> {
    let mut rgb = vec![0; 3 * SIDE * SIDE];
    for k in 0..sweep.len() {
        let kind = sweep.of_beam.as_ref().map_or(0, |told| told.kind[k]);
        let number = sweep.of_beam.as_ref().map_or(1, |told| told.number[k]);
        let is_ground = [Tag::Road, Tag::Terrain, Tag::Sidewalk].iter().any(|tag| *tag as u8 == sweep.tag[k]);
        let height = ((sweep.z_m[k] + 1.8) / 4.0).clamp(0.0, 1.0);
        let color = match kind {
            kind if kind == ReturnKind::Rain as u8 => [0, 255, 255],
            kind if kind == ReturnKind::Fog as u8 => [255, 0, 255],
            _ if number > 1 => [255; 3],
            _ if is_ground => [60, 70, 60],
            _ => [(255.0 * height) as u8, 120, (255.0 * (1.0 - height)) as u8],
        };
        let half = 0.5 * SIDE as f32;
        let (row, column) = (half - per_m * sweep.x_m[k], half - per_m * sweep.y_m[k]);
        if (0.0..SIDE as f32).contains(&row) && (0.0..SIDE as f32).contains(&column) {
            let place = 3 * (row as usize * SIDE + column as usize);
            rgb[place..place + 3].copy_from_slice(&color);
        }
    }
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&rgb)?;
    Ok(())
}
