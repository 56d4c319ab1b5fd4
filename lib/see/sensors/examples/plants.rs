//! Draws plants: `cargo run -p convoy-sensors --example plants -- FOLDER [--levels] [KIND ...]`. One sheet
//! for each kind of tree, in leaf and bare: young, grown and old, or a grown one as it is farther away; one
//! for each kind of patch: nine side by side, or as many at each level; one of bushes and hedges. Prints how
//! many triangles the levels have.

mod stage;

use std::error::Error;
use std::path::Path;

use land::scenery::{TREES, TreeKind};
use schema::geometry::{Surface, SurfaceMesh, TriMesh};
use schema::{Layer, Tag};

use stage::{Stage, at};

/// Kinds of patches and the size of one.
const PATCHES: [(&str, [f64; 3]); 8] = [
    ("plant.meadow", [4.0, 4.0, 0.5]),
    ("plant.reed", [4.0, 4.0, 2.2]),
    ("plant.flowers", [3.0, 1.0, 0.35]),
    ("plant.maize", [4.0, 4.0, 2.2]),
    ("plant.wheat", [4.0, 4.0, 0.8]),
    ("plant.vines", [4.0, 2.0, 1.8]),
    ("plant.shrubs", [4.0, 4.0, 2.0]),
    ("plant.climber", [4.0, 0.25, 5.0]),
];
/// Trees that are never bare.
const EVERGREENS: [&str; 3] = ["tree.spruce", "tree.pine", "tree.palm"];
/// Linear colour of the lawn.
const LAWN: [f32; 3] = [0.09, 0.14, 0.035];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".into());
    let folder = Path::new(&folder);
    let mut wanted: Vec<String> = arguments.collect();
    let of_levels = wanted.iter().any(|w| w == "--levels");
    wanted.retain(|w| !w.starts_with("--"));
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| name.ends_with(w.as_str()));
    let report = |name: &str, counts: Vec<usize>| {
        #[allow(clippy::print_stdout, reason = "it is what it is for")]
        {
            println!("{name:20} {counts:?}");
        }
    };
    for kind in TREES.iter().filter(|kind| is_wanted(kind.model)) {
        report(kind.model, trees(kind, kind.model, folder, of_levels)?);
        if !EVERGREENS.contains(&kind.model) {
            let bare = format!("{}.bare", kind.model);
            report(&bare, trees(kind, &bare, folder, of_levels)?);
        }
    }
    for (model, size_m) in PATCHES.iter().filter(|(model, _)| is_wanted(model)) {
        report(model, patches(model, *size_m, folder, of_levels)?);
    }
    if wanted.is_empty() && !of_levels {
        low(folder)?;
    }
    Ok(())
}

/// A lawn.
fn lawn() -> Stage {
    let mut stage = Stage::default();
    let mut mesh = TriMesh::clone(&testkit::plane(160.0, 0.0, Tag::Terrain, Surface::Grass));
    mesh.parts.iter_mut().for_each(|part| part.rgb = LAWN);
    stage.add_ground(SurfaceMesh { layer: Layer::Terrain, origin_m: [0.0; 3], mesh }, [0.0; 3]);
    stage
}

/// Draws a kind of tree.
fn trees(kind: &TreeKind, model: &str, folder: &Path, of_levels: bool) -> Result<Vec<usize>, Box<dyn Error>> {
    let mut stage = lawn();
    let mut counts = Vec::new();
    let (name, eye_m) = if of_levels {
        let size_m = kind.size_m(1, 0);
        let apart = size_m[0] as f32 + 2.0;
        for level in 0..4 {
            let place = at(apart * (level as f32 - 1.5), 0.0, 20.0);
            counts.push(stage.add_thing_level(model, size_m, 1, level, place));
        }
        ("-levels", 1.1 * size_m[2] + 2.0 * size_m[0])
    } else {
        let sizes = [0, 1, 2].map(|age| kind.size_m(age, 1));
        let mut x = -0.5 * (sizes[0][0] + sizes[1][0] + sizes[2][0]) - 2.0;
        for (age, size_m) in sizes.into_iter().enumerate() {
            let place = at((x + 0.5 * size_m[0]) as f32, 0.0, 70.0 * age as f32);
            counts.push(stage.add_thing_level(model, size_m, 1 + age as u32, 0, place));
            x += size_m[0] + 2.0;
        }
        ("", 0.75 * sizes[2][2] + 0.9 * (sizes[1][0] + sizes[2][0]))
    };
    let name = format!("{}{name}.jpg", model.replace('.', "-"));
    stage.save(&folder.join(name), [0.0, -eye_m, 1.7], frames::deg(-14.0), [1600, 900], 62.0)?;
    Ok(counts)
}

/// Draws a kind of patch: a field of it from close by, or fields of each level side by side.
fn patches(
    model: &str,
    size_m: [f64; 3],
    folder: &Path,
    of_levels: bool,
) -> Result<Vec<usize>, Box<dyn Error>> {
    let mut stage = lawn();
    let [x, y, z] = size_m;
    let mut counts = Vec::new();
    // What climbs looks along y: it is turned to the camera, and stands in one row at a wall.
    let climbs = model == "plant.climber";
    let (rows, turn_deg) = if climbs { (1, 180.0) } else { (3, 0.0) };
    if climbs {
        let wall = testkit::block([60.0, 0.3, 1.1 * z as f32], Tag::Building, Surface::Concrete);
        let (layer, mesh) = (Layer::Bridge, TriMesh::clone(&wall));
        stage.add_ground(SurfaceMesh { layer, origin_m: [0.0, 0.5 * y + 0.16, 0.0], mesh }, [0.0; 3]);
    }
    for level in 0..if of_levels { 4 } else { 1 } {
        let middle = if of_levels { (level as f64 - 1.5) * (3.0 * x + 1.5) } else { 0.0 };
        for (i, j) in (0..3).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            let place = at((middle + (f64::from(i) - 1.0) * x) as f32, (f64::from(j) * y) as f32, turn_deg);
            let count = stage.add_thing_level(model, size_m, ((3 * i + j) % 4) as u32, level, place);
            if i + j == 0 {
                counts.push(count);
            }
        }
    }
    let (name, away_m, down_deg) = match (of_levels, y < 0.5, y < 1.5) {
        (true, ..) => ("-levels", 4.6 * x, 5.0),
        (_, true, _) => ("", 6.0, 0.0),
        (_, _, true) => ("", 1.2, 30.0),
        _ => ("", 2.0 + 0.5 * z, 12.0),
    };
    let name = format!("{}{name}.jpg", model.replace('.', "-"));
    let eye = [0.3, -0.5 * y - away_m, 1.5 + 0.35 * z];
    stage.save(&folder.join(name), eye, frames::deg(down_deg), [1600, 900], 80.0)?;
    Ok(counts)
}

/// Draws bushes and hedges from close by.
fn low(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut stage = lawn();
    for (k, size) in
        [[0.75, 0.75, 0.5], [1.25, 1.25, 1.0], [2.0, 2.0, 1.5], [1.5, 1.5, 1.0]].into_iter().enumerate()
    {
        stage.add_thing("bush.round", size, k as u32, at(1.9 * k as f32 - 3.0, -1.0, 0.0));
    }
    for k in 0..3 {
        stage.add_thing("bush.hedge", [4.0, 0.8, 1.2], k, at(4.0 * k as f32 - 2.0, 2.0, 0.0));
    }
    stage.save(&folder.join("bushes.jpg"), [0.0, -6.0, 1.9], frames::deg(16.0), [1600, 900], 70.0)
}
