//! The pack in `tests/packs/example`: a van with doors, lamps and a picture, a bollard, and a pedestrian.
//! What is committed is what this makes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::gltf::{Faces, Maker, png, png_with_alpha};
use crate::person::person;

pub(crate) const ALL: [f32; 4] = [0.0, 0.0, 1.0, 1.0];

pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/packs/example")
}

fn cuboid(low: [f32; 3], high: [f32; 3], uv: [f32; 4]) -> Faces {
    let mut faces = Faces::default();
    faces.cuboid(low, high, uv);
    faces
}

/// Colours of the van's picture.
const YELLOW: [u8; 3] = [244, 190, 20];
const BLUE: [u8; 3] = [24, 52, 140];
/// A normal that leans nowhere.
const RIDGE: [u8; 3] = [128, 128, 255];

/// A van of 5.2 by 2.0 by 2.5 m; glTF's axes: x to the left, y up, z ahead.
pub(crate) fn van() -> Maker {
    let mut m = Maker::new();
    // Yellow with a slanted blue band in each half; the lowest row is dark.
    let picture = png(128, 64, |x, y| match (x + y / 2) % 64 {
        _ if y >= 60 => [30, 30, 32],
        20..34 => BLUE,
        _ => YELLOW,
    });
    let texture = m.picture(&picture, "image/png");
    let side = m.material("Livery", [1.0; 3], Some(texture));
    // Upright ribs, dull in their grooves, and a sign that is lit.
    let ribs = m.picture(
        &png(64, 2, |x, _| [[60, 128, 235], RIDGE, [196, 128, 235], RIDGE][x as usize % 4]),
        "image/png",
    );
    let grooves = m.picture(&png(64, 2, |x, _| [0, if x % 4 == 3 { 255 } else { 128 }, 0]), "image/png");
    let sign = m.picture(
        &png(
            32,
            16,
            |x, y| if (12..20).contains(&x) && (2..5).contains(&y) { [255, 236, 190] } else { [0; 3] },
        ),
        "image/png",
    );
    let livery = &mut m.list("materials")[side];
    livery["normalTexture"] = json!({ "index": ribs, "scale": 0.8 });
    livery["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": grooves });
    livery["emissiveTexture"] = json!({ "index": sign });
    livery["emissiveFactor"] = json!([1.0, 1.0, 1.0]);
    let glass = m.material("Windows", [0.02; 3], None);
    let black = m.material("Tyres", [0.02; 3], None);
    let dark = m.material("Inside", [0.06; 3], None);
    let steel = m.material("Rims", [0.6; 3], None);
    m.list("materials")[steel]["pbrMetallicRoughness"]["metallicFactor"] = json!(1.0);
    let white = m.material("White lens", [0.85; 3], None);
    let red = m.material("Red lens", [0.5, 0.02, 0.02], None);
    let amber = m.material("Amber lens", [0.75, 0.3, 0.03], None);

    // The box at the back, and the cab, whose sides are doors.
    let load = cuboid([-1.0, 0.35, -2.6], [1.0, 2.5, 1.1], ALL);
    let mut cab = cuboid([-0.94, 0.35, 1.1], [0.94, 1.25, 2.6], [0.0, 0.0, 0.1, 0.4]);
    cab.cuboid([-0.9, 2.05, 1.1], [0.9, 2.15, 1.9], [0.0, 0.0, 0.1, 0.4]);
    let mut window = Faces::default();
    let uv = [[0.0; 2]; 4];
    window.quad([[-0.88, 1.25, 2.5], [0.88, 1.25, 2.5], [0.88, 2.05, 1.9], [-0.88, 2.05, 1.9]], uv);
    let inside = cuboid([-0.9, 1.25, 1.1], [0.9, 2.05, 1.85], ALL);
    // A grille of bars, cut out of a sheet.
    let bars =
        m.picture(&png_with_alpha(2, 16, |_, y| [30, 30, 32, if y % 4 < 2 { 255 } else { 0 }]), "image/png");
    let grille = m.material("Grille", [1.0; 3], Some(bars));
    m.list("materials")[grille]["alphaMode"] = json!("MASK");
    let mut sheet = Faces::default();
    let corners = [[-0.5, 0.5, 2.603], [0.5, 0.5, 2.603], [0.5, 0.9, 2.603], [-0.5, 0.9, 2.603]];
    sheet.quad(corners, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    let body = m.mesh(&[(side, &load), (side, &cab), (glass, &window), (dark, &inside), (grille, &sheet)]);
    m.node("Body", body, [0.0; 3]);
    // From farther away: two boxes.
    let coarse = cuboid([-0.9, 0.35, 1.1], [0.9, 1.9, 2.6], [0.0, 0.0, 0.1, 0.4]);
    let coarse = m.mesh(&[(side, &load), (side, &coarse)]);
    m.node("Body_lod1", coarse, [0.0; 3]);

    let mut tyre = Faces::default();
    tyre.drum(0, 0.36, [-0.1, 0.1], 24);
    let mut rim = Faces::default();
    rim.drum(0, 0.2, [-0.11, 0.11], 12);
    let wheel = m.mesh(&[(black, &tyre), (steel, &rim)]);
    for (name, x, z) in [
        ("Wheel front left", 0.86, 1.8),
        ("Wheel front right", -0.86, 1.8),
        ("Wheel rear left", 0.86, -1.5),
        ("Wheel rear right", -0.86, -1.5),
    ] {
        m.node(name, wheel, [x, 0.36, z]);
    }
    for (name, way) in [("Door left", 1.0), ("Door right", -1.0)] {
        // From the hinge backwards; the picture's lower part, and a window.
        let [x0, x1] = if way > 0.0 { [0.0, 0.05] } else { [-0.05, 0.0] };
        let leaf = cuboid([x0, 0.0, -1.1], [x1, 0.85, 0.0], [0.5, 0.5, 1.0, 0.9]);
        let pane = cuboid([x0, 0.85, -1.1], [x1, 1.55, -0.1], ALL);
        let door = m.mesh(&[(side, &leaf), (glass, &pane)]);
        m.node(name, door, [0.94 * way, 0.45, 2.3]);
    }
    let mut lens = |name: &str, material: usize, low: [f32; 3], high: [f32; 3]| {
        let mesh = m.mesh(&[(material, &cuboid(low, high, ALL))]);
        m.node(name, mesh, [0.0; 3]);
    };
    for (side, low, high) in [("left", 0.55, 0.85), ("right", -0.85, -0.55)] {
        lens(&format!("Head {side}"), white, [low, 0.7, 2.58], [high, 0.9, 2.6]);
        lens(&format!("Tail {side}"), red, [low, 0.9, -2.6], [high, 1.1, -2.58]);
        lens(&format!("Brake {side}"), red, [low, 1.12, -2.6], [high, 1.3, -2.58]);
        lens(&format!("Blink front {side}"), amber, [low, 0.56, 2.58], [high, 0.68, 2.6]);
        lens(&format!("Blink rear {side}"), amber, [low, 0.76, -2.6], [high, 0.88, -2.58]);
    }
    // What lies in one plane flickers: lenses stand out a little.
    for node in m.list("nodes") {
        let name = node["name"].as_str().unwrap_or("").to_owned();
        for (word, z) in [
            ("Head", 0.004),
            ("Blink front", 0.004),
            ("Tail", -0.004),
            ("Brake", -0.004),
            ("Blink rear", -0.004),
        ] {
            if name.starts_with(word) {
                node["translation"] = json!([0.0, 0.0, z]);
            }
        }
    }
    m
}

/// A bollard in files of its own: `.gltf`, `.bin`, `.png`.
pub(crate) fn bollard() -> Maker {
    let mut m = Maker::new();
    let image = m.put("images", json!({ "uri": "stripes.png" }));
    let sampler = m.put("samplers", json!({ "wrapS": 10497, "wrapT": 33071 }));
    let texture = m.put("textures", json!({ "source": image, "sampler": sampler }));
    let striped = m.material("Stripes", [1.0; 3], Some(texture));
    let mut post = Faces::default();
    post.drum(1, 0.12, [0.0, 1.0], 16);
    // Normals follow from the creases.
    let mesh = m.mesh(&[(striped, &post)]);
    m.list("meshes")[mesh]["primitives"][0]["attributes"].as_object_mut().expect("a table").remove("NORMAL");
    m.node("Post", mesh, [0.0; 3]);
    m.json["buffers"][0]["uri"] = json!("bollard.bin");
    m
}

/// All files of the pack but the pages, which are written by hand.
pub(crate) fn files() -> BTreeMap<&'static str, Vec<u8>> {
    let bollard = bollard();
    let mut json = serde_json::to_vec_pretty(&bollard.json).expect("is JSON");
    json.push(b'\n');
    let stripes = png(8, 32, |_, y| if (y / 8) % 2 == 0 { [210, 20, 24] } else { [240, 240, 236] });
    BTreeMap::from([
        ("van.glb", van().glb()),
        ("ada.glb", person(1.0).glb()),
        ("bollard.gltf", json),
        ("bollard.bin", bollard.binary),
        ("stripes.png", stripes),
    ])
}

#[test]
fn what_is_committed_is_what_this_makes() {
    for (name, bytes) in files() {
        let path = folder().join(name);
        if std::env::var_os("CONVOY_ACCEPT").is_some() {
            std::fs::write(&path, &bytes).expect("writes");
        }
        let there = std::fs::read(&path).expect("is committed");
        assert!(there == bytes, "{name} is another: CONVOY_ACCEPT=1 writes it anew");
    }
}

/// Seeds for `fuzz/fuzz_targets/packs.rs`: the length of a page, the page, a glTF file.
#[test]
fn seeds_for_fuzzing_are_models() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fuzz/seeds/packs");
    let page = std::fs::read(folder().join("van.toml")).expect("is committed");
    let cube = "name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\n";
    let whole = |page: &[u8], mesh: Vec<u8>| [&(page.len() as u16).to_le_bytes(), page, &mesh].concat();
    let ada = std::fs::read(folder().join("ada.toml")).expect("is committed");
    let made = [
        ("ada", whole(&ada, person(1.0).glb())),
        ("van", whole(&page, van().glb())),
        ("box", whole(cube.as_bytes(), crate::faults::textured_cube())),
    ];
    for (name, bytes) in made {
        if std::env::var_os("CONVOY_ACCEPT").is_some() {
            std::fs::write(seeds.join(name), &bytes).expect("writes");
        }
        assert!(
            std::fs::read(seeds.join(name)).expect("is committed") == bytes,
            "{name}: CONVOY_ACCEPT=1 writes it anew"
        );
    }
}
