//! Draws people: `cargo run -p convoy-sensors --example people -- FOLDER`. One sheet for each model with all
//! of its looks from the front, the side and the back, some from 5 m, a strip of eight phases of a walk and
//! of a run from the side, people on benches, and riders.

mod stage;

use std::error::Error;
use std::path::Path;

use catalogue::{BaseType, Model, Special, models::MODELS};
use meshes::actors::Posture;
use meshes::people::{APPEARANCES, Appearance};

use stage::{Stage, at};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let folder = Path::new(&folder);
    let people: Vec<&Model> = MODELS.iter().filter(|m| m.base == BaseType::Pedestrian).collect();
    for model in &people {
        let mut stage = Stage::new();
        for look in 0..APPEARANCES {
            let x = 1.05 * (look as f32 - 0.5 * (APPEARANCES - 1) as f32);
            for (row, yaw) in [(0.0, -75.0), (2.6, 20.0), (5.2, 110.0)] {
                let gait_mps = if row > 2.0 { 1.3 } else { 0.0 };
                let posture = Posture { phase_rad: 0.5 + row, gait_mps, ..Posture::default() };
                stage.add(model, look, at(x * (1.0 + 0.13 * row), row, yaw), posture);
            }
        }
        let name = format!("people-{}.jpg", model.name.trim_start_matches("walker."));
        stage.save(&folder.join(name), [0.0, -10.6, 0.6], frames::deg(5.0), [1320, 384], 64.0)?;
    }
    let strips = [
        ("man", 1, 1.4),
        ("woman", 4, 1.3),
        ("child", 2, 1.2),
        ("elder", 0, 0.9),
        ("man", 3, 3.2),
        ("with_pram", 2, 1.4),
        ("with_dog", 3, 1.4),
        ("with_dog", 6, 3.0),
    ];
    for (k, (name, look, gait_mps)) in strips.into_iter().enumerate() {
        let Some(model) = people.iter().find(|m| m.name.ends_with(name)) else { continue };
        let mut stage = Stage::new();
        let (step_m, away_m) = if model.size_m[0] > 0.9 { (1.65, -12.8) } else { (1.25, -9.6) };
        for phase in 0..8 {
            let phase_rad = std::f32::consts::TAU * phase as f32 / 8.0;
            let posture = Posture { phase_rad, gait_mps, ..Posture::default() };
            stage.add(model, look, at(step_m * (phase as f32 - 3.5), 0.0, 0.0), posture);
        }
        let file = folder.join(format!("people-strip-{k}-{name}.jpg"));
        stage.save(&file, [0.0, away_m, -0.6], 0.0, [1200, 288], 56.0)?;
    }
    // Some as a camera of a vehicle sees them at 5 m.
    for (k, name) in
        ["man", "woman", "child", "elder", "teen", "worker", "with_pram", "with_dog"].into_iter().enumerate()
    {
        let Some(model) = people.iter().find(|m| m.name.ends_with(name)) else { continue };
        let mut stage = Stage::new();
        for (j, look) in [1, 4, 6, 9, 11, 14].into_iter().enumerate() {
            let posture = Posture {
                phase_rad: 0.6 * j as f32,
                gait_mps: if j % 3 == 2 { 1.3 } else { 0.0 },
                ..Posture::default()
            };
            stage.add(model, look, at(0.95 * (j as f32 - 2.5), 0.0, [-60.0, -100.0, -15.0][j % 3]), posture);
        }
        let file = folder.join(format!("people-near-{k}-{name}.jpg"));
        stage.save(&file, [0.0, -5.0, -0.35], frames::deg(5.0), [1600, 900], 58.0)?;
    }
    benches(&people, folder)?;
    riders_near(folder)?;
    let riders = MODELS.iter().filter(|m| matches!(m.base, BaseType::Motorcycle | BaseType::Bicycle));
    let mut stage = Stage::new();
    for (k, model) in riders.chain(people.iter().copied().filter(|m| m.wheel_radius_m > 0.0)).enumerate() {
        let x = 2.4 * (k as f32 - 2.5);
        for (row, yaw) in [(0.0, -5.0), (3.0, -120.0)] {
            let posture = Posture { phase_rad: 1.0 + 2.0 * row, ..Posture::default() };
            let number = 7 * k + row as usize;
            let place = at(x * (1.0 + 0.1 * row), row, yaw);
            stage.add_level(model, number as u32, 0, place, posture, paint(model, number));
        }
    }
    stage.save(&folder.join("people-riders.jpg"), [0.0, -10.5, 0.6], frames::deg(5.0), [1320, 384], 68.0)?;
    Ok(())
}

/// A paint of a model, linear RGB.
fn paint(model: &Model, number: usize) -> [f32; 3] {
    let paint = model.paints.get(number % model.paints.len().max(1)).copied().unwrap_or([128; 3]);
    paint.map(|byte| frames::math::f32::pow(f32::from(byte) / 255.0, 2.2))
}

/// Riders as a camera of a vehicle sees them at 5 m.
fn riders_near(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::new();
    let names = [
        ("motorcycle.sport", 130.0),
        ("bicycle.city", -20.0),
        ("motorcycle.scooter", -70.0),
        ("bicycle.road", 60.0),
    ];
    for (k, (name, yaw)) in names.into_iter().enumerate() {
        let Some(model) = MODELS.iter().find(|m| m.name == name) else { continue };
        let number = 5 * k + 2;
        let posture = Posture { phase_rad: 1.3 * k as f32, ..Posture::default() };
        let place = at(1.45 * (k as f32 - 1.5), 0.3, yaw);
        stage.add_level(model, number as u32, 0, place, posture, paint(model, number));
    }
    stage.save(
        &folder.join("people-riders-near.jpg"),
        [0.0, -5.0, -0.35],
        frames::deg(6.0),
        [1600, 900],
        62.0,
    )
}

/// Two on each of four benches, from before and from the side: those of each model who are dressed so as to
/// sit, in turn.
fn benches(people: &[&Model], folder: &Path) -> Result<(), Box<dyn Error>> {
    let sits = |model: &&&Model| model.special == Special::None && model.name != "walker.child";
    let mut all: Vec<(&Model, u32)> = Vec::new();
    for model in people.iter().filter(sits) {
        let looks = (0..APPEARANCES).filter(|look| Appearance::new(model, *look).may_sit());
        all.extend(looks.map(|look| (*model, look)));
    }
    for (name, yaws) in [("people-benches.jpg", [-78.0, -110.0]), ("people-benches-side.jpg", [-8.0, -172.0])]
    {
        let mut stage = Stage::new();
        for k in 0..4 {
            let chosen: Vec<(&Model, u32)> = (0..2).map(|j| all[(2 * k + j) * all.len() / 8]).collect();
            let place = at(2.4 * (k as f32 - 1.5), 0.0, yaws[k % 2]);
            stage.add_bench(place, &chosen, 0.8 * k as f32);
        }
        stage.save(&folder.join(name), [0.0, -7.9, -0.1], frames::deg(5.5), [1320, 384], 66.0)?;
    }
    Ok(())
}
