//! Draws plants: `cargo run -p convoy-sensors --example plants -- FOLDER [--levels] [SPECIES ...]`. One sheet
//! for each kind of tree: young, grown and old, or a grown one as it is farther away; one of bushes and
//! hedges. Prints how many triangles the levels have.

mod stage;

use std::error::Error;
use std::path::Path;

use land::scenery::{TREES, TreeKind};

use stage::{Stage, at};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".into());
    let mut wanted: Vec<String> = arguments.collect();
    let of_levels = wanted.iter().any(|w| w == "--levels");
    wanted.retain(|w| !w.starts_with("--"));
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| name.ends_with(w.as_str()));
    for kind in TREES.iter().filter(|kind| is_wanted(kind.model)) {
        let counts = sheet(kind, Path::new(&folder), of_levels)?;
        #[allow(clippy::print_stdout, reason = "it is what it is for")]
        {
            println!("{:16} {counts:?}", kind.model);
        }
    }
    if wanted.is_empty() && !of_levels {
        low(Path::new(&folder))?;
    }
    Ok(())
}

/// Draws a kind of tree.
fn sheet(kind: &TreeKind, folder: &Path, of_levels: bool) -> Result<Vec<usize>, Box<dyn Error>> {
    let mut stage = Stage::meadow();
    let mut counts = Vec::new();
    let (name, eye_m) = if of_levels {
        let size_m = kind.size_m(1, 0);
        let apart = size_m[0] as f32 + 2.0;
        for level in 0..4 {
            counts.push(stage.add_thing_level(
                kind.model,
                size_m,
                1,
                level,
                at(apart * (level as f32 - 1.5), 0.0, 20.0),
            ));
        }
        ("-levels", 1.1 * size_m[2] + 2.0 * size_m[0])
    } else {
        let sizes = [0, 1, 2].map(|age| kind.size_m(age, 1));
        let mut x = -0.5 * (sizes[0][0] + sizes[1][0] + sizes[2][0]) - 2.0;
        for (age, size_m) in sizes.into_iter().enumerate() {
            let place = at((x + 0.5 * size_m[0]) as f32, 0.0, 70.0 * age as f32);
            counts.push(stage.add_thing_level(kind.model, size_m, 1 + age as u32, 0, place));
            x += size_m[0] + 2.0;
        }
        ("", 0.75 * sizes[2][2] + 0.9 * (sizes[1][0] + sizes[2][0]))
    };
    let name = format!("{}{name}.jpg", kind.model.replace('.', "-"));
    stage.save(&folder.join(name), [0.0, -eye_m, 1.7], frames::deg(-14.0), [1600, 900], 62.0)?;
    Ok(counts)
}

/// Draws bushes and hedges from close by.
fn low(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::meadow();
    for (k, size) in
        [[0.75, 0.75, 0.5], [1.25, 1.25, 1.0], [2.0, 2.0, 1.5], [1.5, 1.5, 1.0]].into_iter().enumerate()
    {
        stage.add_thing("bush.round", size, k as u32, at(1.9 * k as f32 - 3.0, -1.0, 0.0));
    }
    for k in 0..3 {
        stage.add_thing("bush.hedge", [4.0, 0.8, 1.2], k, at(4.0 * k as f32 - 4.0, 2.0, 0.0));
    }
    stage.save(&folder.join("bushes.jpg"), [0.0, -6.0, 1.9], frames::deg(16.0), [1600, 900], 70.0)
}
