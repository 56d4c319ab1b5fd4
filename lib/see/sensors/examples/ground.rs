//! Draws the ground of a map as a driver has it:
//! `cargo run -p convoy-sensors --example ground -- OUT.jpg MAP.xodr X Y YAW_DEG [HEIGHT [DOWN_DEG]]`; with
//! `--things`, what stands on it, too.

mod stage;

use std::error::Error;
use std::path::Path;

use catalogue::Catalogue;
use glam::{Affine3A, Quat, Vec3};
use land::scenery;
use land::surfaces::{Atlas, Region};
use opendrive::{Map, Network};
use settings::SceneryRules;

use stage::Stage;

/// What is drawn around the eye, metres.
const AROUND_M: f64 = 96.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let with_things = arguments.iter().any(|word| word == "--things");
    arguments.retain(|word| !word.starts_with("--"));
    let [out, map, numbers @ ..] = &arguments[..] else { return Err("OUT.jpg MAP.xodr X Y YAW_DEG".into()) };
    let numbers = numbers.iter().map(|word| word.parse::<f64>()).collect::<Result<Vec<f64>, _>>()?;
    let [x, y, yaw_deg, rest @ ..] = &numbers[..] else { return Err("X Y YAW_DEG".into()) };
    let (height_m, down_deg) = (rest.first().unwrap_or(&1.6), rest.get(1).unwrap_or(&6.0));
    let map = Map::new(Network::parse(&std::fs::read_to_string(map)?)?);
    let cell = |v: f64| (v / 16.0).floor() * 16.0;
    let area = Region {
        min: [cell(x - AROUND_M), cell(y - AROUND_M)],
        max: [cell(x + AROUND_M), cell(y + AROUND_M)],
    };
    let atlas = Atlas::new(&map);
    let ground = atlas.ground(&area);
    let eye = [*x, *y, ground.levels.height(*x, *y, 0.0)];
    let mut stage = Stage::default();
    for piece in ground.surfaces() {
        stage.add_ground(piece, eye);
    }
    if with_things {
        for object in scenery::place(&ground, &SceneryRules::default(), Catalogue::built_in()) {
            let [w, x, y, z] = object.quaternion.map(|q| q as f32);
            let off = [0, 1, 2].map(|k| (object.xyz_m[k] - eye[k]) as f32);
            let at = Affine3A::from_rotation_translation(Quat::from_xyzw(x, y, z, w), Vec3::from_array(off));
            let size_m = [object.length_m, object.width_m, object.height_m];
            stage.add_thing(&object.model, size_m, object.variant, at);
        }
    }
    let turned = [0.0, frames::deg(*down_deg), frames::deg(*yaw_deg)];
    stage.draw(Path::new(out), [0.0, 0.0, height_m - 1.6], turned, [1600, 900], 70.0)
}
