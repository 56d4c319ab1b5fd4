//! Damaged and unusual rigs: one clear error each, and no panic.

use serde_json::json;

use crate::faults::{read, says};
use crate::gltf::Maker;
use crate::person::person;

const PAGE: &str = include_str!("../../../../../tests/packs/example/ada.toml");

/// The message of the example's pedestrian with something done to her.
fn fault(change: impl FnOnce(&mut Maker)) -> String {
    let mut m = person(1.0);
    change(&mut m);
    read(PAGE, m.glb()).expect_err("has a fault").to_string()
}

fn page_fault(from: &str, to: &str) -> String {
    assert!(PAGE.contains(from));
    read(&PAGE.replace(from, to), person(1.0).glb()).expect_err("has a fault").to_string()
}

/// Writes over the first bytes of what an accessor reads.
fn write(m: &mut Maker, accessor: usize, bytes: &[u8]) {
    let view = m.json["accessors"][accessor]["bufferView"].as_u64().expect("a number") as usize;
    let at = m.json["bufferViews"][view]["byteOffset"].as_u64().expect("a number") as usize;
    m.binary[at..at + bytes.len()].copy_from_slice(bytes);
}

fn attribute(m: &Maker, name: &str) -> usize {
    m.json["meshes"][0]["primitives"][0]["attributes"][name].as_u64().expect("a number") as usize
}

fn binds(m: &Maker) -> usize {
    m.json["skins"][0]["inverseBindMatrices"].as_u64().expect("a number") as usize
}

#[test]
fn joints_that_are_not_there() {
    says(
        &page_fault("\"Shank left\" = \"shin_left\"\n", ""),
        &["pack/box.glb", "no joint is `shin_left`: say in `[joints]`", "Shank left"],
    );
    says(&page_fault("\"Shank left\"", "Wade"), &["pack/box.toml: `joints.Wade`: there is no such node"]);
    says(&page_fault("\"shin_left\"", "\"tail\""), &["`joints.Shank left`", "`tail` is none of pelvis"]);
    says(&page_fault("\"shin_left\"", "\"shin_right\""), &["is `shin_right` as `Shank"]);
    let twice = fault(|m| m.json["nodes"][1]["name"] = json!("Shank left"));
    says(&twice, &["`joints.Shank left`: there are two nodes of this name"]);
    // Swapped sides, and somebody who lies.
    let swapped = PAGE.replace(
        "[joints]",
        "[joints]\n\"mixamorig:LeftUpLeg\" = \"thigh_right\"\n\"mixamorig:RightUpLeg\" = \"thigh_left\"",
    );
    let swapped = read(&swapped, person(1.0).glb()).expect_err("has a fault").to_string();
    says(&swapped, &["is `thigh_left`, but it is not left of the right one"]);
    let lies = PAGE.replace("height_m = 1.755", "up = \"+z\"\nforward = \"+y\"\nheight_m = 0.5");
    says(&read(&lies, person(1.0).glb()).expect_err("lies").to_string(), &["box"]);
}

#[test]
fn skins_that_do_not_fit() {
    says(&fault(|m| m.json["nodes"][20]["skin"] = json!(3)), &["there is no skin 3"]);
    let fewer = fault(|m| {
        let binds = binds(m);
        m.json["accessors"][binds]["count"] = json!(7);
    });
    says(&fewer, &["skin 0 has 19 joints, but 7 inverse bind matrices"]);
    for value in [f32::NAN, 0.0] {
        let bad = fault(|m| {
            let binds = binds(m);
            write(m, binds, &[value; 16].map(f32::to_le_bytes).concat());
        });
        says(&bad, &["pack/box.glb, node `mixamorig:Hips`: its inverse bind matrix in skin 0"]);
    }
    let cycle = fault(|m| m.json["nodes"][3]["children"] = json!([2]));
    says(&cycle, &["must form a tree"]);
    let elsewhere = fault(|m| m.json["skins"][0]["joints"][4] = json!(99));
    says(&elsewhere, &["node `#99`", "is a joint of skin 0, but is not in the scene"]);
    let many = fault(|m| m.json["skins"][0]["joints"] = json!(vec![1; 1025]));
    says(&many, &["one with more than 1024 joints"]);
    // A joint that stands by itself, where a foot's toes were.
    let stray = fault(|m| {
        let nodes = m.json["nodes"].as_array_mut().expect("a list");
        let toes =
            nodes.iter().position(|node| node["name"].as_str().is_some_and(|name| name.contains("Toe")));
        nodes.push(json!({ "name": "Stray" }));
        let stray = nodes.len() - 1;
        m.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(stray));
        let joints = m.json["skins"][0]["joints"].as_array_mut().expect("a list");
        let toes = toes.and_then(|toes| joints.iter().position(|joint| *joint == json!(toes)));
        joints[toes.expect("has toes")] = json!(stray);
    });
    says(&stray, &["node `Ada`", "hangs on a joint that no joint of the body bears"]);
    let far = fault(|m| m.json["nodes"][7]["translation"] = json!([500, 0, 0]));
    says(&far, &["pack/box."]);
    let wide = fault(|m| m.json["nodes"][21]["scale"] = json!([60, 1, 1]));
    says(&wide, &["pack/box.toml: stands", "which is more than 3 m"]);
    let loose = fault(|m| {
        m.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(21));
        m.json["nodes"][5]["children"] = json!([]);
    });
    says(&loose, &["node `Cap`", "neither skinned nor below a joint"]);
}

#[test]
fn weights_that_are_none() {
    let none = fault(|m| {
        let attributes = &mut m.json["meshes"][0]["primitives"][0]["attributes"];
        attributes.as_object_mut().expect("a table").remove("WEIGHTS_0");
    });
    says(&none, &["node `Ada`", "has no JOINTS_0 and WEIGHTS_0"]);
    let half = fault(|m| {
        let weights = attribute(m, "WEIGHTS_0");
        write(m, weights, &[120, 0, 0, 0]);
    });
    says(&half, &["node `Ada`", "the weights of vertex 0"]);
    let joint = fault(|m| {
        let joints = attribute(m, "JOINTS_0");
        write(m, joints, &[200, 0, 0, 0]);
    });
    says(&joint, &["node `Ada`", "vertex 0 hangs on joint 200: the skin has 19"]);
    let few = fault(|m| {
        let weights = attribute(m, "WEIGHTS_0");
        m.json["accessors"][weights]["count"] = json!(1);
    });
    says(&few, &["has no JOINTS_0 and WEIGHTS_0, or not for each vertex"]);
    let floats = fault(|m| {
        // Weights that are no numbers: four floats where its places are.
        let (weights, positions) = (attribute(m, "WEIGHTS_0"), attribute(m, "POSITION"));
        write(m, positions, &[f32::NAN; 4].map(f32::to_le_bytes).concat());
        let view = m.json["accessors"][positions]["bufferView"].clone();
        let accessor = &mut m.json["accessors"][weights];
        (accessor["bufferView"], accessor["componentType"]) = (view, json!(5126));
        accessor["count"] = json!(10);
    });
    says(&floats, &["node `Ada`", "the weights of vertex 0"]);
}

#[test]
fn pages_of_people() {
    says(&page_fault("height_m = 1.755", "size_m = [0.5, 0.5, 1.755]"), &["`height_m`: people have this"]);
    says(&page_fault("height_m = 1.755", "height_m = 1.6"), &["level 0 is", "1.6"]);
    says(&page_fault("gender = \"female\"", "# "), &["`gender`: is missing"]);
    says(&page_fault("\"adult\"", "\"old\""), &["`age`: `old` is none of adult, child, elderly"]);
    says(
        &page_fault("walker.ada", "walker.police"),
        &["`walker.police` has its own work, chair, pram or dog"],
    );
    says(&page_fault("weight = 6.0", "special = \"taxi\""), &["`special`: people of packs walk about"]);
    says(
        &page_fault("[joints]", "[nodes.Cap]\nlamps = [\"brake\"]\n[joints]"),
        &["lamps`: people have none"],
    );
    says(
        &page_fault("[joints]", "[nodes.Cap]\nwheel = \"fixed\"\n[joints]"),
        &["wheel`: a pedestrian has none"],
    );
    let cone = "name = \"cone.a\"\nbase = \"cone\"\nsize_m = [1, 1, 1]\nage = \"adult\"\n";
    says(&read(cone, person(1.0).glb()).expect_err("a cone").to_string(), &["`age`: a cone has none"]);
}
