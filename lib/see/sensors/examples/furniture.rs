//! Draws street furniture: `cargo run -p convoy-sensors --example furniture -- FOLDER [--levels] [KIND ...]`.
//! Sheets of several kinds, each in some variants, or from close by and as from far away. Prints what stands
//! on each sheet, from the left to the right, and how many triangles it has.

mod stage;

use std::error::Error;
use std::path::Path;

use land::scenery::{FURNITURE, FurnitureKind};

use stage::{Stage, at};

/// A sheet is about so wide, metres; things are so far apart.
const SHEET_M: f64 = 9.0;
const APART_M: f64 = 0.7;
/// Variants of a kind that are shown.
const SHOWN: u32 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".into());
    let mut wanted: Vec<String> = arguments.collect();
    let of_levels = wanted.iter().any(|w| w == "--levels");
    wanted.retain(|w| !w.starts_with("--"));
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| name.ends_with(w.as_str()));
    let mut kinds: Vec<&FurnitureKind> = FURNITURE.iter().filter(|kind| is_wanted(kind.model)).collect();
    // What is about as high stands together.
    kinds.sort_by(|a, b| a.size_m[2].total_cmp(&b.size_m[2]));
    let mut sheet: Vec<(&FurnitureKind, u32)> = Vec::new();
    let mut number = 0;
    for kind in kinds {
        for shown in 0..if of_levels { 2 } else { SHOWN.min(kind.variants) } {
            if wide_m(&sheet) + kind.size_m[1] > SHEET_M.max(1.4 * kind.size_m[2]) && !sheet.is_empty() {
                draw(&sheet, Path::new(&folder), number, of_levels)?;
                sheet.clear();
                number += 1;
            }
            sheet.push((kind, shown));
        }
    }
    draw(&sheet, Path::new(&folder), number, of_levels)
}

fn wide_m(sheet: &[(&FurnitureKind, u32)]) -> f64 {
    sheet.iter().map(|(kind, _)| kind.size_m[0].max(kind.size_m[1]) + APART_M).sum()
}

/// Draws a row of things that are turned a little.
fn draw(
    sheet: &[(&FurnitureKind, u32)],
    folder: &Path,
    number: usize,
    of_levels: bool,
) -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::new();
    let mut x = -0.5 * wide_m(sheet);
    let mut said = Vec::new();
    for (kind, shown) in sheet {
        let wide = kind.size_m[0].max(kind.size_m[1]) + APART_M;
        let place = at((x + 0.5 * wide) as f32, 0.0, -62.0);
        let (variant, level) = if of_levels { (0, *shown as usize) } else { (*shown, 0) };
        let triangles = stage.add_thing_level(kind.model, kind.size_m, variant, level, place);
        said.push(format!("{} {variant} ({triangles})", kind.model));
        x += wide;
    }
    let tall = sheet.iter().map(|(kind, _)| kind.size_m[2]).fold(0.0, f64::max);
    let eye_m = (0.72 * wide_m(sheet)).max(1.6 * tall).max(3.0) + 1.2;
    let name = format!("furniture-{number:02}{}.jpg", if of_levels { "-levels" } else { "" });
    #[allow(clippy::print_stdout, reason = "it is what it is for")]
    {
        println!("{name}: {}", said.join(", "));
    }
    // The camera is 1.6 m over its agent.
    let down_rad = frames::math::atan2(1.6 - 0.45 * tall, eye_m);
    stage.save(&folder.join(name), [0.0, -eye_m, 0.0], down_rad, [1800, 900], 68.0)
}
