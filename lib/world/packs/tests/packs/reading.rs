//! What is read of a pack.

use frames::Aabb;
use glam::Vec3;
use packs::{Attachment, PackModel, read_folder};
use schema::Tag;
use schema::geometry::{Surface, TriMesh};
use schema::lights;
use schema::mesh_textures::{Glow, Wrap};
use serde_json::json;

use crate::example;
use crate::gltf::{Faces, Maker, png_with_alpha};

fn example() -> Vec<PackModel> {
    read_folder(&example::folder()).expect("is a pack")
}

fn van() -> PackModel {
    example().into_iter().find(|model| model.row.name == "van.kiosk").expect("has a van")
}

/// The box around the finest level at rest.
fn around(model: &PackModel) -> Aabb {
    let places =
        model.levels[0].pieces.iter().flat_map(|p| p.mesh.positions.iter().map(|v| *v + p.hang.at()));
    Aabb::from_points(&places.collect::<Vec<_>>())
}

/// Six times the volume that a mesh encloses: positive when its triangles look outward.
fn volume(mesh: &TriMesh) -> f32 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            a.dot(b.cross(c))
        })
        .sum()
}

#[test]
fn a_model_is_as_its_page_says() {
    let models = example();
    assert_eq!(
        models.iter().map(|m| m.row.name.as_str()).collect::<Vec<_>>(),
        ["walker.ada", "cone.bollard", "van.kiosk"]
    );
    let van = van();
    let row = &van.row;
    assert_eq!(
        (row.base_type.as_str(), row.weight, row.doors, row.wheels, row.has_lights),
        ("van", 6.0, 2, 4, true)
    );
    assert!((row.wheelbase_m - 3.3).abs() < 1e-5 && (row.wheel_radius_m - 0.36).abs() < 1e-5, "{row:?}");
    assert_eq!(row.page, "van.toml");
    assert_eq!(van.files.keys().collect::<Vec<_>>(), ["van.glb", "van.toml"]);
    for model in models.iter().filter(|model| model.walker.is_none()) {
        let bounds = around(model);
        let size = Vec3::from_array(model.row.size_m.map(|v| v as f32));
        let centre = 0.5 * (bounds.min + bounds.max);
        assert!(centre.truncate().length() < 1e-5 && bounds.min.z.abs() < 1e-5, "{bounds:?}");
        let over = size - (bounds.max - bounds.min);
        assert!(over.cmpge(Vec3::splat(-1e-5)).all() && over.cmple(Vec3::splat(0.0011)).all(), "{over}");
        for piece in model.levels.iter().flat_map(|level| &level.pieces) {
            assert!(volume(&piece.mesh) > 0.0, "{}: {:?} is inside out", model.row.name, piece.hang);
        }
    }
}

#[test]
fn wheels_doors_and_levels_hang_where_they_are() {
    let van = van();
    let hangs: Vec<Attachment> = van.levels[0].pieces.iter().map(|piece| piece.hang).collect();
    let wheels: Vec<(Vec3, bool)> = hangs
        .iter()
        .filter_map(
            |hang| if let Attachment::Wheel { at, steered } = *hang { Some((at, steered)) } else { None },
        )
        .collect();
    // The van reaches 4 mm farther on both ends than its boxes: their middle is the origin.
    let want = [(1.8, 0.86, true), (1.8, -0.86, true), (-1.5, 0.86, false), (-1.5, -0.86, false)];
    for (x, y, steered) in want {
        let at = Vec3::new(x, y, 0.36);
        assert!(wheels.iter().any(|(there, s)| (*there - at).length() < 1e-4 && *s == steered), "{wheels:?}");
    }
    let doors = hangs
        .iter()
        .filter_map(|hang| if let Attachment::Door { at, door } = *hang { Some((door, at)) } else { None });
    let mut doors: Vec<(usize, Vec3)> = doors.collect();
    doors.sort_by_key(|(door, _)| *door);
    assert_eq!(doors.iter().map(|(door, _)| *door).collect::<Vec<_>>(), [0, 1]);
    assert!((doors[0].1 - Vec3::new(2.3, 0.94, 0.45)).length() < 1e-4, "{doors:?}");
    assert!((doors[1].1 - Vec3::new(2.3, -0.94, 0.45)).length() < 1e-4, "{doors:?}");
    // A coarser level replaces what it has a version of, and keeps the rest.
    assert_eq!(van.levels.iter().map(|level| level.from_m).collect::<Vec<_>>(), [0.0, 30.0]);
    let count = |level: usize, hang: Attachment| {
        let piece = van.levels[level].pieces.iter().find(|piece| piece.hang == hang);
        piece.map_or(0, |piece| piece.mesh.triangles.len())
    };
    assert_eq!(van.levels[1].pieces.len(), van.levels[0].pieces.len());
    assert!(count(1, Attachment::Body) < count(0, Attachment::Body));
    assert!(hangs.iter().filter(|h| **h != Attachment::Body).all(|h| count(0, *h) == count(1, *h)));
}

#[test]
fn parts_have_surfaces_lamps_and_pictures() {
    let van = van();
    let body = &van.levels[0].pieces[0];
    assert_eq!(body.hang, Attachment::Body);
    let parts = &body.mesh.parts;
    assert!(parts.iter().all(|part| part.tag == Tag::Truck));
    let has = |surface: Surface| parts.iter().any(|part| part.surface == surface);
    assert!(has(Surface::Glass));
    for bits in [
        lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION,
        lights::POSITION | lights::FOG,
        lights::BRAKE,
        lights::BLINK_LEFT,
        lights::BLINK_RIGHT,
    ] {
        assert!(has(Surface::Lamp(bits)), "{bits}");
    }
    // The picture: yellow and blue, of which triangles see shares.
    let textures = body.mesh.textures.as_deref().expect("has a picture");
    assert_eq!((textures.sets.len(), textures.corners.len()), (2, body.mesh.triangles.len()));
    let finest = &textures.sets[0].colour.as_ref().expect("a colour").levels[0];
    assert_eq!((finest.width, finest.height, finest.texels[0]), (128, 64, [244, 190, 20]));
    let livery =
        parts.iter().find(|part| matches!(part.surface, Surface::Textured(f) if f.texture_set == Some(0)));
    let [r, g, b] = livery.expect("is there").rgb;
    assert!(r > g && g > b && b < 0.2, "{r} {g} {b}");
    let wheel = van.levels[0]
        .pieces
        .iter()
        .find(|piece| matches!(piece.hang, Attachment::Wheel { .. }))
        .expect("has wheels");
    let rim =
        wheel.mesh.parts.iter().find(|part| matches!(part.surface, Surface::Textured(_))).expect("a rim");
    let Surface::Textured(factors) = rim.surface else { unreachable!() };
    assert_eq!((factors.texture_set, factors.metallic), (None, 1.0));
    assert!(wheel.mesh.parts.iter().any(|part| part.surface == Surface::Rubber));
}

#[test]
fn materials_bring_relief_gloss_light_and_cut_outs() {
    let van = van();
    let mesh = &van.levels[0].pieces[0].mesh;
    let textures = mesh.textures.as_deref().expect("has pictures");
    let livery = &textures.sets[0];
    let relief = livery.relief.as_ref().expect("has ribs");
    assert_eq!((relief.image.levels[0].texels[0], relief.strength), ([60, 128, 235], 0.8));
    // Roughness is the factor's times the picture's: 0.6 and half of it; the part has their mean.
    let gloss = livery.specular.as_ref().expect("has grooves");
    assert_eq!(gloss.levels[0].texels[..4], [[0, 77, 0], [0, 77, 0], [0, 77, 0], [0, 153, 0]]);
    let factors = mesh.parts.iter().find_map(|part| match part.surface {
        Surface::Textured(factors) if factors.texture_set == Some(0) => Some(factors),
        _ => None,
    });
    let mean = 0.6 * (3.0 * 128.0 + 255.0) / (4.0 * 255.0);
    assert!((factors.expect("is there").roughness - mean).abs() < 1e-4);
    let Some(Glow::Picture(sign)) = &livery.glow else { panic!("has no sign") };
    assert_eq!(sign.levels[0].texels[3 * 32 + 15], [255, 236, 190]);
    // Half of the grille's square metre times 0.4 is bars, and what is between them is no surface.
    let bars = mesh
        .parts
        .iter()
        .position(|part| matches!(part.surface, Surface::Textured(f) if f.texture_set == Some(1)));
    let bars = bars.expect("has a grille");
    let mut area_m2 = 0.0;
    for t in (0..mesh.triangles.len()).filter(|t| usize::from(mesh.triangle_part[*t]) == bars) {
        let [a, b, c] = mesh.corners(t);
        area_m2 += 0.5 * (b - a).cross(c - a).length();
        // From 0.9 m down: bars of 5 cm, 5 cm apart.
        let down = 0.9 - (a.z + b.z + c.z) / 3.0;
        assert!((down / 0.05).rem_euclid(2.0) < 1.05, "{down}");
    }
    assert!((area_m2 - 0.2).abs() < 0.004, "{area_m2}");
}

/// A sheet whose picture is half there: masked by the file's alpha, blended where it is nearly invisible.
#[test]
fn alpha_cuts_by_the_mode_of_its_material() {
    let left = |mode: &str, alpha: u8, factor: f32| {
        let mut m = Maker::new();
        let half = png_with_alpha(2, 1, |x, _| [90, 90, 90, if x == 0 { 255 } else { alpha }]);
        let texture = m.picture(&half, "image/png");
        let sheet = m.material("Sheet", [1.0; 3], Some(texture));
        m.list("materials")[sheet]["alphaMode"] = json!(mode);
        m.list("materials")[sheet]["pbrMetallicRoughness"]["baseColorFactor"][3] = json!(factor);
        let mut faces = Faces::default();
        faces.cuboid([-0.5, 0.0, -0.5], [0.5, 1.0, 0.5], example::ALL);
        let mesh = m.mesh(&[(sheet, &faces)]);
        m.node("Box", mesh, [0.0; 3]);
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("box.glb"), m.glb()).expect("writes");
        let page = "name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\n";
        std::fs::write(folder.path().join("box.toml"), page).expect("writes");
        let model = read_folder(folder.path()).expect("is a pack").remove(0);
        let mesh = &model.levels[0].pieces[0].mesh;
        let area = |t| {
            let [a, b, c] = mesh.corners(t);
            0.5 * (b - a).cross(c - a).length()
        };
        (0..mesh.triangles.len()).map(area).sum::<f32>()
    };
    for (mode, alpha, factor, area_m2) in [
        ("OPAQUE", 0, 1.0, 6.0),
        ("MASK", 100, 1.0, 3.0),
        ("MASK", 200, 1.0, 6.0),
        ("MASK", 200, 0.6, 3.0),
        ("BLEND", 100, 0.3, 6.0),
        ("BLEND", 20, 0.3, 3.0),
    ] {
        let left_m2 = left(mode, alpha, factor);
        assert!((left_m2 - area_m2).abs() < 0.1, "{mode} {alpha} {factor}: {left_m2}");
    }
}

#[test]
fn files_of_their_own_and_normals_by_creases() {
    let models = example();
    let bollard = models.iter().find(|model| model.row.name == "cone.bollard").expect("has a bollard");
    let files: Vec<&str> = bollard.files.keys().map(String::as_str).collect();
    assert_eq!(files, ["bollard.bin", "bollard.gltf", "bollard.toml", "stripes.png"]);
    let mesh = &bollard.levels[0].pieces[0].mesh;
    assert_eq!(
        mesh.textures.as_ref().expect("a picture").sets[0].colour.as_ref().expect("colours").wrap,
        [Wrap::Repeat, Wrap::Clamp]
    );
    // Round about, flat on top: the normal of the wall points away from the axis.
    let mut round = 0;
    for t in 0..mesh.triangles.len() {
        let Some(normals) = mesh.bent(t) else { continue };
        for (corner, normal) in mesh.corners(t).into_iter().zip(normals) {
            let away = corner.truncate().normalize().extend(0.0);
            assert!(away.dot(normal) > 0.999, "{corner} {normal}");
            round += 1;
        }
    }
    assert_eq!(round, 3 * 2 * 16);
}

#[test]
fn a_store_reads_what_the_folder_has() {
    // The same page and files by another way have the same digest; another byte gives another.
    struct Kept(std::collections::BTreeMap<String, Vec<u8>>);
    impl packs::Files for Kept {
        fn read(&self, path: &str, _: u64) -> Result<Option<Vec<u8>>, String> {
            Ok(self.0.get(path).cloned())
        }
        fn location(&self, path: &str) -> String {
            path.to_owned()
        }
    }
    let van = van();
    let mut kept = Kept(van.files.clone());
    let again = packs::read_model("van.toml", &kept).expect("reads");
    assert_eq!(again.row, van.row);
    kept.0.get_mut("van.toml").expect("is there").extend(b"\n# more\n");
    let other = packs::read_model("van.toml", &kept).expect("reads");
    assert!(other.row.hash != van.row.hash && other.row.size_m == van.row.size_m);
}

#[test]
fn axes_and_scale_are_those_of_the_page() {
    // The bollard lying along z of the file, in centimetres, with the names turned.
    let page = "name = \"barrier.log\"\nbase = \"barrier\"\nfile = \"bollard.gltf\"\nsize_m = [0.12, 0.5, 0.12]\nscale = 0.5\nup = \"-x\"\nforward = \"+z\"\n";
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in example::files() {
        std::fs::write(folder.path().join(name), bytes).expect("writes");
    }
    std::fs::write(folder.path().join("log.toml"), page).expect("writes");
    let models = read_folder(folder.path()).expect("is a pack");
    // y of the file is up in glTF; with -x up and z ahead, left is -x cross z = y.
    assert_eq!(models[0].row.size_m, [0.12, 0.5, 0.12]);
    assert!(volume(&models[0].levels[0].pieces[0].mesh) > 0.0);
}
