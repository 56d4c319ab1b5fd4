//! Damaged, oversized and hostile models: one clear error each, and no panic.

use std::collections::BTreeMap;

use packs::{Files, PackError, Problem, read_folder, read_model};
use serde_json::{Value, json};

use crate::example::{ALL, folder, van};
use crate::gltf::{Faces, Maker, png};

/// Files in memory.
struct Kept(BTreeMap<String, Vec<u8>>);

impl Files for Kept {
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
        let most = usize::try_from(most).expect("fits") + 1;
        Ok(self.0.get(path).map(|bytes| bytes[..bytes.len().min(most)].to_vec()))
    }

    fn location(&self, path: &str) -> String {
        format!("pack/{path}")
    }
}

const PAGE: &str = "name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\n";

pub(crate) fn read(page: &str, glb: Vec<u8>) -> Result<packs::PackModel, PackError> {
    let files = [("box.toml", page.as_bytes().to_vec()), ("box.glb", glb)];
    read_model("box.toml", &Kept(files.map(|(name, bytes)| (name.to_owned(), bytes)).into()))
}

/// A cube of a metre.
fn cube() -> Maker {
    let mut m = Maker::new();
    let material = m.material("Grey", [0.5; 3], None);
    let mut faces = Faces::default();
    faces.cuboid([0.0; 3], [1.0; 3], ALL);
    let mesh = m.mesh(&[(material, &faces)]);
    m.node("Box", mesh, [0.0; 3]);
    m
}

/// The cube with something done to it.
fn with(change: impl FnOnce(&mut Maker)) -> Vec<u8> {
    let mut m = cube();
    change(&mut m);
    m.glb()
}

/// The message of a cube that was changed.
fn fault(change: impl FnOnce(&mut Maker)) -> String {
    read(PAGE, with(change)).expect_err("has a fault").to_string()
}

fn page_fault(page: &str) -> String {
    read(page, cube().glb()).expect_err("has a fault").to_string()
}

#[track_caller]
pub(crate) fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn the_whole_cube_is_read() {
    let model = read(PAGE, cube().glb()).expect("is good");
    assert_eq!(model.levels[0].pieces[0].mesh.triangles.len(), 12);
    assert_eq!(model.row.size_m, [1.0; 3]);
}

#[test]
fn missing_files_and_buffers() {
    let kept = Kept(BTreeMap::from([("box.toml".to_owned(), PAGE.into())]));
    let error = read_model("box.toml", &kept).expect_err("no mesh").to_string();
    says(&error, &["pack/box.toml", "neither box.glb nor box.gltf"]);
    assert_eq!(
        read_model("no.toml", &kept).expect_err("no page").to_string(),
        "pack/no.toml: there is no such file"
    );
    says(
        &fault(|m| m.json["buffers"][0]["uri"] = json!("gone.bin")),
        &["pack/gone.bin: there is no such file"],
    );
    says(
        &fault(|m| m.json["buffers"][0]["byteLength"] = json!(1_000_000)),
        &["pack/box.glb: buffer 0 has no data"],
    );
    says(
        &fault(|m| m.json["buffers"].as_array_mut().expect("a list").push(json!({ "byteLength": 4 }))),
        &["buffer 1 has no data"],
    );
    let many = json!(vec![json!({ "byteLength": 0, "uri": "data:application/octet-stream;base64," }); 64]);
    says(
        &fault(|m| {
            m.json["buffers"]
                .as_array_mut()
                .expect("a list")
                .extend(many.as_array().cloned().expect("a list"))
        }),
        &["it has more than 64 buffers"],
    );
}

#[test]
fn indices_views_and_accessors_out_of_range() {
    let index = fault(|m| {
        let at = m.binary.len() - 2;
        m.binary[at..].copy_from_slice(&999_u16.to_le_bytes());
    });
    says(&index, &["pack/box.glb, node `Box`", "index 999 is out of range: there are 36 vertices"]);
    says(
        &fault(|m| m.json["accessors"][0]["count"] = json!(1_u64 << 62)),
        &["node `Box`", "accessor 0 reaches beyond"],
    );
    says(
        &fault(|m| m.json["accessors"][0]["byteOffset"] = json!(1_u64 << 63)),
        &["accessor 0 reaches beyond"],
    );
    says(
        &fault(|m| m.json["bufferViews"][0]["byteLength"] = json!(u64::MAX)),
        &["accessor 0 reaches beyond"],
    );
    says(
        &fault(|m| m.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX)),
        &["accessor 0 reaches beyond"],
    );
    says(
        &fault(|m| m.json["bufferViews"][0]["buffer"] = json!(7)),
        &["node `Box`", "accessor 0 reaches beyond"],
    );
    says(&fault(|m| m.json["nodes"][0]["mesh"] = json!(9)), &["node `Box`", "there is no mesh 9"]);
    says(&fault(|m| m.json["accessors"][1]["type"] = json!("VEC2")), &["accessor 1 is no list of vectors"]);
    says(
        &fault(|m| m.json["accessors"][3]["componentType"] = json!(5126)),
        &["accessor 3 is no list of indices"],
    );
    let sparse = json!({ "count": 1, "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 } });
    says(&fault(|m| m.json["accessors"][0]["sparse"] = sparse), &["node `Box`", "accessor 0 is sparse"]);
    says(
        &fault(|m| {
            m.json["accessors"][0].as_object_mut().expect("a table").remove("bufferView");
        }),
        &["accessor 0 has no data"],
    );
}

#[test]
fn numbers_that_are_none() {
    for bad in [f32::NAN, f32::INFINITY, 3e38] {
        let error = fault(|m| m.binary[0..4].copy_from_slice(&bad.to_le_bytes()));
        says(&error, &["node `Box`", "a position is not finite"]);
    }
    says(&fault(|m| m.json["nodes"][0]["scale"] = json!([1e38, 1e38, 1e38])), &["node `Box`", "not finite"]);
    let uv = fault(|m| {
        let picture = m.picture(&png(2, 2, |_, _| [9; 3]), "image/png");
        m.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": picture });
        let from = m.json["bufferViews"][2]["byteOffset"].as_u64().expect("a number") as usize;
        m.binary[from..from + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
    says(&uv, &["node `Box`", "a place in a picture is not finite"]);
}

#[test]
fn nothing_to_see_and_too_much() {
    let empty = fault(|m| m.json["scenes"][0]["nodes"] = json!([]));
    says(&empty, &["pack/box.glb", "no triangle"]);
    // All corners in one place.
    let flat = fault(|m| m.json["nodes"][0]["scale"] = json!([0.0, 0.0, 0.0]));
    says(&flat, &["no triangle"]);
    says(
        &fault(|m| m.json["meshes"][0]["primitives"][0]["mode"] = json!(1)),
        &["node `Box`", "points, lines"],
    );
    // 60,000 are read, more are not, however few vertices they have.
    let many = |triangles: usize| {
        with(|m| {
            let indices: Vec<u8> = (0..triangles)
                .flat_map(|i| [3 * (i % 12), 3 * (i % 12) + 1, 3 * (i % 12) + 2])
                .map(|i| i as u8)
                .collect();
            let view = m.view(&indices);
            let accessor = json!({ "bufferView": view, "componentType": 5121, "count": indices.len(), "type": "SCALAR" });
            let accessor = m.put("accessors", accessor);
            m.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
        })
    };
    assert_eq!(read(PAGE, many(60_000)).expect("is good").levels[0].pieces[0].mesh.triangles.len(), 60_000);
    let error = read(PAGE, many(60_001)).expect_err("too many");
    assert_eq!(error.problem, Problem::TooManyTriangles { level: 0, most: 60_000 });
    // A mesh at a thousand nodes is as good as a thousand meshes.
    let copies = with(|m| {
        (0..4000).for_each(|i| {
            m.node(&format!("Copy {i}"), 0, [0.0; 3]);
        })
    });
    assert!(read(PAGE, copies).is_ok());
    let crowd = with(|m| {
        (0..4100).for_each(|i| {
            m.node(&format!("Copy {i}"), 0, [0.0; 3]);
        })
    });
    assert_eq!(read(PAGE, crowd).expect_err("too many").problem, Problem::TooManyNodes(4096));
    let parts = with(|m| {
        let mesh = &m.json["meshes"][0].clone();
        for i in 0..260 {
            let material = m.material(&format!("M{i}"), [0.5; 3], None);
            let mut other = mesh.clone();
            other["primitives"][0]["material"] = json!(material);
            let other = m.put("meshes", other);
            m.node(&format!("N{i}"), other, [0.0; 3]);
        }
    });
    assert_eq!(read(PAGE, parts).expect_err("too many").problem, Problem::TooManyParts(250));
    let large = read(PAGE, vec![b' '; (64 << 20) + 1]).expect_err("too large").to_string();
    says(&large, &["has more than 67108864 bytes"]);
    says(&read(PAGE, vec![b' '; 17 << 20]).expect_err("too large").to_string(), &["its JSON has more than"]);
    let page = format!("{PAGE}#{}", " ".repeat(300 << 10));
    says(&page_fault(&page), &["pack/box.toml", "has more than 262144 bytes"]);
}

#[test]
fn graphs_that_are_no_trees() {
    let chain = |count: usize, link: &dyn Fn(usize) -> Value| {
        let nodes: Vec<Value> =
            (0..count).map(|i| json!({ "name": format!("N{i}"), "children": link(i) })).collect();
        fault(|m| {
            m.json["nodes"] = json!(nodes);
            m.json["scenes"][0]["nodes"] = json!([0]);
        })
    };
    says(&chain(2, &|i| json!([1 - i])), &["node `N0`", "two parents or is its own ancestor"]);
    says(&chain(1, &|_| json!([0])), &["node `N0`", "its own ancestor"]);
    says(&chain(3, &|i| if i == 0 { json!([1, 2]) } else { json!([2]) }), &["node `N2`", "two parents"]);
    let deep = chain(4000, &|i| if i < 3999 { json!([i + 1]) } else { json!([0]) });
    says(&deep, &["node `N65`", "more than 64 nodes below one another"]);
}

#[test]
fn files_outside_of_the_folder() {
    for uri in [
        "../secret.bin",
        "/etc/passwd",
        "https://example.org/a.bin",
        "..%2f..%2fa.bin",
        "a\\..\\b",
        "file:///a",
    ] {
        says(
            &fault(|m| m.json["buffers"][0]["uri"] = json!(uri)),
            &["pack/box.glb", "lies outside of the folder"],
        );
    }
    says(
        &page_fault(&format!("{PAGE}file = \"../box.glb\"\n")),
        &["pack/box.toml", "lies outside of the folder"],
    );
    says(
        &fault(|m| m.json["buffers"][0]["uri"] = json!("data:text/plain,abc")),
        &["a data URI is no base64"],
    );
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder() {
    let outside = tempfile::tempdir().expect("a folder");
    std::fs::write(outside.path().join("box.glb"), cube().glb()).expect("writes");
    let pack = tempfile::tempdir().expect("a folder");
    std::fs::write(pack.path().join("box.toml"), PAGE).expect("writes");
    std::os::unix::fs::symlink(outside.path().join("box.glb"), pack.path().join("box.glb")).expect("links");
    says(&read_folder(pack.path()).expect_err("a link").to_string(), &["leads out of the folder"]);
}

#[test]
fn extents_must_be_those_of_the_page() {
    let larger = page_fault("name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1.1]\n");
    says(&larger, &["[1.0, 1.0, 1.0]", "[1.0, 1.0, 1.1]", "`scale`, `up` and `forward`"]);
    // Two hundredths either way are let through; the mesh's own size is what counts.
    let near = read("name = \"cone.box\"\nbase = \"cone\"\nsize_m = [0.981, 1.019, 1]\n", cube().glb())
        .expect("is near");
    assert_eq!(near.row.size_m, [1.0; 3]);
    let lod = "name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\nlod_from_m = [20]\n";
    let out = with(|m| {
        let copy = m.node("Box_lod1", 0, [0.0; 3]);
        m.json["nodes"][copy]["scale"] = json!([1.1, 1.0, 1.0]);
    });
    says(&read(lod, out).expect_err("too wide").to_string(), &["level 1 is [1.0, 1.1, 1.0]"]);
}

#[test]
fn words_of_the_page() {
    let with = |more: &str| page_fault(&format!("{PAGE}{more}\n"));
    let place = "pack/box.toml: ";
    says(&with("wight = 2"), &[place, "line 4: unknown field `wight`"]);
    says(&with("weight = \"much\""), &["line 4", "invalid type"]);
    says(&with("weight = -1"), &["`weight`: -1 is not between 0 and 1000"]);
    says(&with("weight = nan"), &["`weight`"]);
    says(&with("up = \"z\""), &["`up`: `z` is none of +x, -x"]);
    says(&with("up = \"+z\""), &["`forward`", "along one axis"]);
    says(&with("special = \"army\""), &["`special`: `army` is none of"]);
    says(&with("scale = 0"), &["`scale`"]);
    says(&with("lod_from_m = [20, 10]"), &["`lod_from_m`: must be up to 4 rising"]);
    says(&with("lod_from_m = [20]"), &["`lod_from_m`: has 1 distances, but nodes go up to `_lod0`"]);
    says(&with("wheelbase_m = 2"), &["a cone has no wheels"]);
    says(&with("[nodes.Bix]\ntag = \"x\""), &["`nodes.Bix.tag`: `x` is none of traffic_cone"]);
    says(&with("[nodes.Bix]"), &["`nodes.Bix`: there is no such node; there are Box"]);
    says(&with("[nodes.Box]\nwheel = \"fixed\""), &["`nodes.Box.wheel`: a cone has none"]);
    says(&with("[nodes.Box]\nlamps = [\"disco\"]"), &["`nodes.Box.lamps`: `disco` is none of position"]);
    says(&with("[nodes.Box]\n[nodes.Box]"), &["line 5", "duplicate"]);
    says(
        &with("[materials]\nGray = \"paint\""),
        &["`materials.Gray`: there is no such material; there are Grey"],
    );
    says(&with("[materials]\nGrey = \"gold\""), &["`gold` is none of paint, glass"]);
    says(&page_fault("base = \"cone\"\nsize_m = [1, 1, 1]\n"), &["missing field `name`"]);
    let named = |name: &str, base: &str| {
        page_fault(&format!("name = \"{name}\"\nbase = \"{base}\"\nsize_m = [1, 1, 1]\n"))
    };
    says(&named("building.tower", "cone"), &["`building.tower` is not `cone.` with small letters"]);
    says(&named("cone../../x", "cone"), &["is not `cone.`"]);
    says(&named("cone.", "cone"), &["is not `cone.`"]);
    says(&named("ufo.one", "ufo"), &["`base`: `ufo` is none of car, van"]);
    says(&named("pedestrian.me", "pedestrian"), &["`name`", "is not `walker.`"]);
    // What drives has wheels, which stand apart.
    says(&named("car.box", "car"), &["say which nodes are wheels"]);
    let twice =
        page_fault("name = \"cone.box\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\nfile = \"page.toml\"\n");
    says(&twice, &["lies outside of the folder, or is no plain"]);
}

#[test]
fn wheels_and_doors() {
    let page = String::from_utf8(std::fs::read(folder().join("van.toml")).expect("is there")).expect("text");
    let van = |page: &str| read(page, van().glb()).map(|_| ()).expect_err("has a fault").to_string();
    let without = |part: &str, with: &str| {
        assert!(page.contains(part), "{part}");
        van(&page.replacen(part, with, 1))
    };
    says(&without("door = \"front_right\"", "tag = \"truck\""), &["doors come as both front ones"]);
    says(&without("door = \"front_right\"", "door = \"front_left\""), &["a left door is on the right"]);
    says(
        &without("door = \"front_left\"", "door = \"front_left\"\nhinge_m = [9, 0.9, 0]"),
        &["its hinge is far from it"],
    );
    let front = page.replace("wheel = \"fixed\"", "tag = \"truck\"");
    says(&van(&front), &["wheels are 0.00 m apart"]);
    says(
        &without(
            "[nodes.\"Head left\"]",
            "[nodes.\"Body\"]\nwheel = \"fixed\"\ndoor = \"front_left\"\n[nodes.\"Head left\"]",
        ),
        &["is a wheel and a door"],
    );
}

#[test]
fn two_nodes_of_one_name() {
    let page = format!("{PAGE}[nodes.Box]\nlamps = [\"position\"]\n");
    let two = with(|m| {
        m.node("Box", 0, [0.0; 3]);
    });
    says(
        &read(&page, two).expect_err("which?").to_string(),
        &["`nodes.Box`: there are two nodes of this name"],
    );
}

#[test]
fn skins_and_extensions() {
    let skinned = fault(|m| {
        m.json["skins"] = json!([{ "joints": [0] }]);
        m.json["nodes"][0]["skin"] = json!(0);
    });
    says(&skinned, &["node `Box`", "only pedestrians have a rig"]);
    let draco = fault(|m| {
        m.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
        m.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    });
    says(&draco, &["needs the extension KHR_draco_mesh_compression"]);
}

#[test]
fn broken_bytes() {
    for bytes in
        [&b""[..], b"glTF", b"glTF\x02\0\0\0\x05\0\0\0", b"{", b"{}", b"[1]", b"glTF\x01\0\0\0\x0c\0\0\0"]
    {
        let error = read(PAGE, bytes.to_vec()).expect_err("is broken").to_string();
        says(&error, &["pack/box.glb: is no glTF 2.0 file"]);
    }
    // Cut off anywhere, and with any one byte changed: an error or a model, never a panic.
    let whole = cube().glb();
    for cut in (0..whole.len()).step_by(7) {
        assert!(read(PAGE, whole[..cut].to_vec()).is_err(), "{cut}");
    }
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x41;
        let _ = read(PAGE, bytes);
    }
    let nested = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    says(&read(PAGE, nested.into_bytes()).expect_err("is too deep").to_string(), &["is no glTF"]);
}

#[test]
fn pictures_are_measured_before_they_are_decoded() {
    let picture = |bytes: &[u8], mime: &str| {
        with(|m| {
            let texture = m.picture(bytes, mime);
            m.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
        })
    };
    let fault = |bytes: &[u8]| read(PAGE, picture(bytes, "image/png")).expect_err("is bad").to_string();
    // A header that promises 60,000 by 60,000 pixels: 10 GB, of which nothing follows.
    let mut bomb = png(4, 4, |_, _| [1; 3]);
    bomb[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    let crc = crc32(&bomb[12..29]);
    bomb[29..33].copy_from_slice(&crc.to_be_bytes());
    says(&fault(&bomb), &["picture 0: is 60000 x 60000 pixels: at most 2048 x 2048"]);
    says(&fault(&png(2049, 1, |_, _| [0; 3])), &["is 2049 x 1 pixels"]);
    says(&fault(b"GIF89a"), &["neither PNG nor JPEG"]);
    let good = png(64, 64, |x, y| [x as u8, y as u8, 7]);
    assert!(read(PAGE, picture(&good, "image/png")).is_ok());
    says(&fault(&good[..good.len() / 2]), &["pack/box.glb: picture 0: "]);
    // JPEG, whole, cut off and too large.
    let jpeg = |side: u16| {
        let mut bytes = Vec::new();
        let pixels = vec![128_u8; 3 * usize::from(side) * 8];
        jpeg_encoder::Encoder::new(&mut bytes, 90)
            .encode(&pixels, side, 8, jpeg_encoder::ColorType::Rgb)
            .expect("encodes");
        bytes
    };
    assert!(read(PAGE, picture(&jpeg(64), "image/jpeg")).is_ok());
    says(&fault(&jpeg(2056)), &["picture 0: "]);
    says(&fault(&jpeg(64)[..40]), &["picture 0: "]);
    // Many pictures at once, one in many colours, and what is no colour: that is kept at half its size, so
    // that its reading is too much.
    let mut grey = Vec::new();
    jpeg_encoder::Encoder::new(&mut grey, 90)
        .encode(&vec![128_u8; 2048 * 2048], 2048, 2048, jpeg_encoder::ColorType::Luma)
        .expect("encodes");
    for (pictures, colours, as_normals, most) in
        [(13, 1, false, 33_554_432), (1, 9, false, 33_554_432), (13, 1, true, 50_331_648)]
    {
        let many = with(|m| {
            let textures: Vec<usize> = (0..pictures).map(|_| m.picture(&grey, "image/jpeg")).collect();
            let mesh = m.json["meshes"][0].clone();
            for i in 0..pictures.max(colours) {
                let texture = textures[i % pictures];
                let rgb = [(i % colours) as f32 / colours as f32, 1.0, 1.0];
                let material = m.material(&format!("M{i}"), rgb, (!as_normals).then_some(texture));
                if as_normals {
                    m.list("materials")[material]["normalTexture"] = json!({ "index": texture });
                }
                let mut other = mesh.clone();
                other["primitives"][0]["material"] = json!(material);
                let other = m.put("meshes", other);
                m.node(&format!("N{i}"), other, [0.0; 3]);
            }
        });
        let fault = read(PAGE, many).expect_err("too many").to_string();
        says(&fault, &[&format!("more than {most} pixels together")]);
    }
}

/// The checksum of PNG's chunks (ISO 3309), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
    })
}

#[test]
fn folders() {
    let pack = tempfile::tempdir().expect("a folder");
    says(&read_folder(pack.path()).expect_err("is empty").to_string(), &["the folder has no model"]);
    says(&read_folder(&pack.path().join("no")).expect_err("is none").to_string(), &["no: cannot read"]);
    std::fs::write(pack.path().join("box.glb"), cube().glb()).expect("writes");
    std::fs::write(pack.path().join("a.toml"), format!("{PAGE}file = \"box.glb\"\n")).expect("writes");
    assert!(read_folder(pack.path()).is_ok());
    let before = packs::digest(pack.path()).expect("is readable");
    std::fs::write(pack.path().join("b.toml"), format!("{PAGE}file = \"box.glb\"\n")).expect("writes");
    says(
        &read_folder(pack.path()).expect_err("twice").to_string(),
        &["b.toml: `cone.box` is described in", "a.toml, too"],
    );
    assert_ne!(packs::digest(pack.path()).expect("is readable"), before);
}

/// A cube of a metre with a picture, for fuzzing.
pub(crate) fn textured_cube() -> Vec<u8> {
    with(|m| {
        let texture = m.picture(&png(8, 8, |x, y| [x as u8 * 30, y as u8 * 30, 7]), "image/png");
        m.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
    })
}
