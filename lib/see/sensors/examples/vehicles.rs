//! Draws vehicles:
//! `cargo run -p convoy-sensors --example vehicles -- FOLDER [--levels | --cabins] [MODEL ...]`. One sheet
//! for each model: from the front, the side and the rear (with open doors), or as it is farther away, or
//! without its panes; of each train one in line, in a bend, and from behind. Prints how many triangles its
//! levels have.

mod stage;

use std::error::Error;
use std::path::Path;

use catalogue::{
    Model,
    models::{PARKED_TWO_WHEELERS, vehicles},
    trains,
    trains::{TRAINS, Train, sections},
};
use meshes::actors::Posture;

use stage::{Stage, at};

/// Paints of a sheet, linear RGB.
const PAINTS: [[f32; 3]; 5] =
    [[0.42, 0.02, 0.02], [0.02, 0.06, 0.22], [0.30, 0.31, 0.32], [0.75, 0.75, 0.74], [0.02, 0.02, 0.022]];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".into());
    let mut wanted: Vec<String> = arguments.collect();
    let of_levels = wanted.iter().any(|w| w == "--levels");
    let of_cabins = wanted.iter().any(|w| w == "--cabins");
    wanted.retain(|w| !w.starts_with("--"));
    let is_wanted = |name: &str| wanted.iter().any(|w| name.starts_with(w.as_str()));
    let whole = !of_levels && !of_cabins;
    for train in TRAINS.iter().filter(|t| whole && (wanted.is_empty() || is_wanted(t.towed.name))) {
        draw_train(train, Path::new(&folder))?;
    }
    let all = vehicles().chain(PARKED_TWO_WHEELERS).chain(sections());
    // Sections of trains are shown together, unless they are asked for.
    let alone = |name: &str| whole && trains::find(name).is_some();
    let chosen = all.filter(|m| if wanted.is_empty() { !alone(m.name) } else { is_wanted(m.name) });
    for (k, model) in chosen.enumerate() {
        let (paint, folder) = (paint(model, k), Path::new(&folder));
        let counts =
            if of_cabins { cabin(model, paint, folder)? } else { sheet(model, paint, folder, of_levels)? };
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        #[allow(clippy::print_stdout, reason = "it is what it is for")]
        {
            println!("{:28} {}", model.name, counts.join(" "));
        }
    }
    Ok(())
}

/// A paint that a model comes in: one of its own if it has few.
fn paint(model: &Model, number: usize) -> [f32; 3] {
    match model.paints {
        few if few.len() < PAINTS.len() => {
            few[0].map(|byte| frames::math::f32::pow(f32::from(byte) / 255.0, 2.2))
        }
        _ => PAINTS[number % PAINTS.len()],
    }
}

/// Draws a model without its panes and counts the triangles behind them.
fn cabin(model: &Model, paint: [f32; 3], folder: &Path) -> Result<Vec<usize>, Box<dyn Error>> {
    let mut stage = Stage::new();
    let apart = 0.93 * (model.size_m[0] as f32).max(2.0) + 0.8;
    let mut count = 0;
    for (i, yaw) in [-142.0, 180.0, 38.0].into_iter().enumerate() {
        count = stage.add_open(model, at(apart * (i as f32 - 1.0), 0.0, yaw), paint);
    }
    let name = format!("{}-cabin.jpg", model.name.replace('.', "-"));
    let away = f64::from(apart);
    stage.save(
        &folder.join(name),
        [-0.6, -2.9 * away, 0.25 * away - 0.1],
        frames::deg(7.0),
        [1800, 576],
        57.0,
    )?;
    Ok(vec![count])
}

/// Draws a train in line from its side, then in a bend to the left from ahead and from behind.
fn draw_train(train: &Train, folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::new();
    for (k, (at_m, yaw_deg, turned_deg)) in
        [([5.0, 9.0], 180.0, 0.0), ([-11.0, -3.5], -140.0, 30.0), ([16.5, -2.0], 40.0, 24.0)]
            .into_iter()
            .enumerate()
    {
        let paint = PAINTS[(k + 1) % PAINTS.len()];
        let (sin, cos) = frames::math::sin_cos(frames::deg(yaw_deg));
        let towed_rad = frames::deg(yaw_deg - turned_deg);
        let (towed_sin, towed_cos) = frames::math::sin_cos(towed_rad);
        let [x, y] = [
            at_m[0] - train.hitch_m * cos - train.coupling_m * towed_cos,
            at_m[1] - train.hitch_m * sin - train.coupling_m * towed_sin,
        ];
        let rest = Posture { phase_rad: 0.4, ..Posture::default() };
        let steered = Posture { steer_rad: if turned_deg > 0.0 { 0.35 } else { 0.0 }, ..rest };
        stage.add_level(train.lead, 3, 0, at(at_m[0] as f32, at_m[1] as f32, yaw_deg as f32), steered, paint);
        let yaw_deg = (yaw_deg - turned_deg) as f32;
        stage.add_level(train.towed, 3, 0, at(x as f32, y as f32, yaw_deg), rest, paint);
    }
    let name = format!("train-{}.jpg", train.towed.name.replace('.', "-"));
    stage.save(&folder.join(name), [0.0, -26.0, 7.0], frames::deg(14.0), [1600, 700], 62.0)?;
    Ok(())
}

/// Draws a model and counts the triangles of its levels.
fn sheet(
    model: &Model,
    paint: [f32; 3],
    folder: &Path,
    of_levels: bool,
) -> Result<Vec<usize>, Box<dyn Error>> {
    let length = model.size_m[0] as f32;
    let apart = 0.93 * length.max(2.0) + 0.8;
    let away = f64::from(apart);
    let mut counts = Vec::new();
    for near in [true, false] {
        let mut stage = Stage::new();
        let rest = Posture { steer_rad: 0.3, phase_rad: 0.4, ..Posture::default() };
        if near {
            for (i, yaw) in [-142.0, 180.0, 38.0].into_iter().enumerate() {
                let mut posture = rest;
                if i == 2 {
                    posture.door_rad = [1.1; 4];
                }
                stage.add_level(model, 3, 0, at(apart * (i as f32 - 1.0), 0.0, yaw), posture, paint);
            }
        } else {
            for level in 0..3 {
                let place = at(apart * (level as f32 - 1.0), 0.0, -150.0);
                counts.push(stage.add_level(model, 3, level, place, rest, paint));
            }
        }
        let name = format!("{}{}.jpg", model.name.replace('.', "-"), if near { "" } else { "-levels" });
        let eye = [-0.6, -2.9 * away, 0.25 * away - 0.4];
        if near != of_levels {
            stage.save(&folder.join(name), eye, frames::deg(6.5), [1200, 384], 57.0)?;
        }
    }
    Ok(counts)
}
