//! Draws the models of a pack: `cargo run -p convoy-sensors --example packs -- PACK FOLDER`. Of vehicles and
//! things three sides, of pedestrians a strip of eight phases of a walk and of a run from the side, and one
//! of them near by.

mod stage;

use std::error::Error;
use std::path::Path;

use meshes::people::Walker;
use packs::PackModel;

use stage::{Stage, at};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let pack = arguments.next().ok_or("say which pack")?;
    let folder = arguments.next().unwrap_or_else(|| ".".into());
    for model in packs::read_folder(Path::new(&pack))? {
        match &model.walker {
            Some(walker) => draw_walker(&model, walker, Path::new(&folder))?,
            None => draw_sides(&model, Path::new(&folder))?,
        }
    }
    Ok(())
}

fn draw_sides(model: &PackModel, folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::new();
    let long = model.row.size_m.into_iter().fold(0.5, f64::max);
    let apart = 1.15 * long;
    for (k, yaw) in [-142.0, 180.0, 38.0].into_iter().enumerate() {
        stage.add_pack(model, at(apart as f32 * (k as f32 - 1.0), 0.0, yaw));
    }
    let away = (2.0 * apart).max(3.0);
    // The eye's height is told from 1.6 m on.
    let eye = [0.0, -away, 0.55 * long - 1.6];
    stage.save(&folder.join(format!("{}.jpg", model.row.name)), eye, frames::deg(6.0), [1400, 480], 84.0)
}

fn draw_walker(model: &PackModel, walker: &Walker, folder: &Path) -> Result<(), Box<dyn Error>> {
    let path = |what: &str| folder.join(format!("{}-{what}.jpg", model.row.name));
    for (what, gait_mps) in [("walks", 1.4), ("runs", 3.2)] {
        let mut stage = Stage::new();
        for phase in 0..8 {
            let phase_rad = std::f32::consts::TAU * phase as f32 / 8.0;
            stage.add_walker(walker, at(1.25 * (phase as f32 - 3.5), 0.0, 0.0), phase_rad, gait_mps);
        }
        stage.save(&path(what), [0.0, -9.6, -0.6], 0.0, [1200, 288], 56.0)?;
    }
    let mut stage = Stage::new();
    for (k, (yaw, gait_mps)) in
        [(-75.0, 0.0), (20.0, 1.4), (-40.0, 1.4), (110.0, 0.0)].into_iter().enumerate()
    {
        stage.add_walker(walker, at(0.85 * (k as f32 - 1.5), 0.0, yaw), 1.0 + k as f32, gait_mps);
    }
    stage.save(&path("near"), [0.0, -4.2, -0.45], frames::deg(3.0), [700, 450], 50.0)
}
