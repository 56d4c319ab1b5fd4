//! Draws a named town from above:
//! `cargo run --example picture -- convoy/demo town.png [metres a pixel] [x y half_m]`.
//!
//! A name that ends in `.xodr` is a map file to draw; a target that does is written as a map file instead.

use opendrive::{LaneType, Map, MarkColour};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

/// An image over a square of the world.
struct Canvas {
    size: usize,
    pixels: Vec<[u8; 3]>,
    west_m: f64,
    north_m: f64,
    metres_per_pixel: f64,
}

impl Canvas {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.west_m) / self.metres_per_pixel, (self.north_m - y) / self.metres_per_pixel]
    }

    /// Fills a polygon, pixel centres inside by the even-odd rule.
    fn fill(&mut self, ring: &[[f64; 2]], colour: [u8; 3]) {
        let ring: Vec<[f64; 2]> = ring.iter().map(|p| self.place(*p)).collect();
        let low = ring.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min).floor().max(0.0);
        let high = ring.iter().map(|p| p[1]).fold(0.0, f64::max).ceil().min(self.size as f64);
        for row in low as usize..high as usize {
            let y = row as f64 + 0.5;
            let mut cuts: Vec<f64> = Vec::new();
            for (i, a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if (a[1] <= y) != (b[1] <= y) {
                    cuts.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
            cuts.sort_by(f64::total_cmp);
            for pair in cuts.chunks_exact(2) {
                let limit = self.size as f64;
                let from = (pair[0] - 0.5).ceil().clamp(0.0, limit) as usize;
                let to = (pair[1] - 0.5).ceil().clamp(0.0, limit) as usize;
                for column in from..to {
                    self.pixels[row * self.size + column] = colour;
                }
            }
        }
    }

    fn disc(&mut self, [x, y]: [f64; 2], radius_m: f64, colour: [u8; 3]) {
        let ring: Vec<[f64; 2]> = (0..12)
            .map(|i| frames::math::sin_cos(f64::from(i) * std::f64::consts::TAU / 12.0))
            .map(|(sin, cos)| [x + radius_m * cos, y + radius_m * sin])
            .collect();
        self.fill(&ring, colour);
    }
}

fn lane_colour(lane_type: LaneType) -> [u8; 3] {
    match lane_type {
        LaneType::Driving => [90, 90, 95],
        LaneType::Shoulder => [120, 115, 105],
        LaneType::Parking => [70, 85, 120],
        LaneType::Sidewalk => [190, 180, 165],
        LaneType::Median => [90, 150, 80],
        LaneType::Biking => [150, 75, 65],
        LaneType::None => [105, 160, 85],
        LaneType::Rail => [130, 110, 95],
        _ => [200, 60, 200],
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let name = args.first().map_or("convoy/demo", String::as_str);
    let target = args.get(1).map_or("town.png", String::as_str);
    let numbers: Vec<f64> = args.iter().skip(2).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let network = if name.ends_with(".xodr") {
        opendrive::read_bytes(&std::fs::read(name)?)?
    } else {
        town::generate(&town::named(name).ok_or("no town of that name")?)?
    };
    if target.ends_with(".xodr") {
        std::fs::write(target, opendrive::write(&network))?;
        return Ok(());
    }
    let [north, south, east, west] = network.header.bounds_m.ok_or("no bounds")?;
    let [x, y, half_m] = match numbers[..] {
        [_, x, y, half_m] => [x, y, half_m],
        _ => [0.5 * (east + west), 0.5 * (north + south), 0.5 * (east - west).max(north - south)],
    };
    let metres_per_pixel = numbers.first().copied().unwrap_or(0.25);
    let size = (2.0 * half_m / metres_per_pixel) as usize;
    let mut canvas = Canvas {
        size,
        pixels: vec![[60, 110, 55]; size * size],
        west_m: x - half_m,
        north_m: y + half_m,
        metres_per_pixel,
    };
    draw(&mut canvas, &Map::new(network));
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(target)?), size as u32, size as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(canvas.pixels.as_flattened())?;
    Ok(())
}

fn draw(canvas: &mut Canvas, map: &Map) {
    let flat = |p: &nalgebra::Point3<f64>| [p.x, p.y];
    let strip = |left: &[nalgebra::Point3<f64>], right: &[nalgebra::Point3<f64>]| -> Vec<[f64; 2]> {
        left.iter().chain(right.iter().rev()).map(flat).collect()
    };
    // Sidewalks last: one that covers a driving lane shows.
    for sidewalks in [false, true] {
        for lane in map.lanes().iter().filter(|l| l.lane_type.is_walkable() == sidewalks) {
            let line = map.lane_polyline(lane.id, 0.02);
            for i in 1..line.s.len() {
                let ring = strip(&line.left[i - 1..=i], &line.right[i - 1..=i]);
                canvas.fill(&ring, lane_colour(lane.lane_type));
            }
        }
    }
    for stripe in map.stripes() {
        let colour = if stripe.colour == MarkColour::Yellow { [240, 200, 40] } else { [240, 240, 240] };
        for part in map.stripe_strips(stripe, 0.02) {
            canvas.fill(&strip(&part.left, &part.right), colour);
        }
    }
    for object in map.objects() {
        let colour = match object.kind.as_str() {
            "crosswalk" => [170, 170, 175],
            "parkingSpace" => [110, 130, 180],
            _ => [255, 120, 120],
        };
        for outline in &object.outlines {
            let ring: Vec<[f64; 2]> = outline.base.iter().map(flat).collect();
            canvas.fill(&ring, colour);
        }
    }
    for signal in map.signals() {
        let at = signal.pose.translation();
        let forward = signal.pose.forward();
        canvas.disc([at.x, at.y], 0.5, if signal.dynamic { [255, 0, 0] } else { [255, 160, 0] });
        canvas.disc([at.x + forward.x, at.y + forward.y], 0.2, [0, 0, 0]);
    }
}
