//! A model of a pack, read and checked.

use std::collections::BTreeMap;
use std::sync::Arc;

use catalogue::BaseType;
use glam::{DVec3, Vec3};
use meshes::people::{Bone, Walker};
use schema::geometry::TriMesh;
use schema::tables::PlanModelRow;

use crate::bake::Baker;
use crate::body::Body;
use crate::document::{Document, ModelFiles};
use crate::error::{PackError, Problem};
use crate::files::{Files, inside};
use crate::graph::{AttachedTo, Graph, name_of};
use crate::hash::hash_of;
use crate::limits;
use crate::manifest::ModelManifest;
use crate::rig::Rig;
use crate::split;
use crate::triangle_soup::{Triangle, TriangleSoup, bounds};

/// How a piece hangs on its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attachment {
    /// It does not move.
    Body,
    /// A wheel that turns about its axle.
    Wheel {
        /// Middle of the axle, object frame, metres.
        at: Vec3,
        /// Whether it follows the steering angle.
        steered: bool,
    },
    /// A door that turns outward about an upright hinge; it is there when it is closed, too.
    Door {
        /// The hinge, object frame, metres.
        at: Vec3,
        /// Front left, front right, rear left, rear right.
        door: usize,
    },
    /// A bone: the mesh is in its frame.
    Bone(Bone),
}

/// A piece of a model.
#[derive(Clone, Debug)]
pub struct PackPiece {
    /// Its triangles, relative to axle or hinge, axes of the object; or in the frame of its bone.
    pub mesh: Arc<TriMesh>,
    /// How it hangs on the model.
    pub hang: Attachment,
}

/// A model as it is shown from some distance on.
#[derive(Clone, Debug)]
pub struct PackLevel {
    /// The distance, metres; 0 of the first level.
    pub from_m: f64,
    /// Its pieces, the body first if it has one.
    pub pieces: Vec<PackPiece>,
}

/// A model of a pack.
#[derive(Clone, Debug)]
pub struct PackModel {
    /// What the plan says of it.
    pub row: PlanModelRow,
    /// Its files by their paths in the pack, the page included.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Its levels of detail, the finest first.
    pub levels: Vec<PackLevel>,
    /// Of pedestrians who walks: the figure of their rig with the meshes of the finest level.
    pub walker: Option<Walker>,
}

/// Reads the model that a page describes; `page` is its path among the files.
///
/// # Errors
/// The page or the glTF file is missing, broken, too large, or one does not fit the other.
pub fn read_model(page: &str, files: &dyn Files) -> Result<PackModel, PackError> {
    let mut bag = ModelFiles::new(files);
    let place = bag.location(page);
    let at = |problem| PackError::file(&place, problem);
    let text = bag.get(page, limits::SHEET_BYTES).map_err(at)?.ok_or_else(|| at(Problem::Missing))?;
    let text = str::from_utf8(text).map_err(|e| at(Problem::Unreadable(e.to_string())))?;
    let sheet = ModelManifest::parse(text).map_err(at)?;
    let path = mesh_file(page, &sheet, &mut bag).map_err(at)?;
    let document = Document::read(&mut bag, &path)?;
    let mesh_place = bag.location(&path);
    let in_mesh = |(node, problem): (Option<usize>, Problem)| match (node, &problem) {
        // The page speaks of something that is not there.
        (None, Problem::Key { .. }) => at(problem),
        _ => {
            let node = node.map(|node| name_of(&document.root, node));
            PackError { file: mesh_place.clone(), node, problem }
        }
    };
    let graph = Graph::new(&document.root, &sheet).map_err(in_mesh)?;
    check_materials(&document, &sheet).map_err(at)?;
    let is_rigged = sheet.base == BaseType::Pedestrian;
    let rig = is_rigged.then(|| Rig::new(&document, &graph, &sheet)).transpose().map_err(in_mesh)?;
    let mut soup =
        TriangleSoup::new(&document, &graph, rig.as_ref(), sheet.lod_from_m.len() + 1).map_err(in_mesh)?;
    let baker = Baker::new(&document, &sheet, &mut bag, &soup.parts, mesh_place.clone())?;
    baker.cut(&mut soup);
    let [low, high] = extents(&soup, &sheet).map_err(in_mesh)?;
    if let Some(rig) = &rig {
        let all = soup.levels[0].concat();
        let body = Body::new(rig, &sheet, &all).map_err(at)?;
        let split = |level: &Vec<Vec<Triangle>>| {
            let pieces = split::pieces(&body, &level.concat()).into_iter();
            let piece = |(bone, triangles): (Bone, Vec<Triangle>)| {
                let mesh = Arc::new(baker.mesh(&triangles, DVec3::ZERO));
                PackPiece { mesh, hang: Attachment::Bone(bone) }
            };
            pieces.map(piece).collect()
        };
        let levels: Vec<Vec<PackPiece>> = soup.levels.iter().map(split).collect();
        return person(sheet, page, bag, &body, levels).map_err(at);
    }
    // The middle of the footprint on the ground is the origin.
    let shift_m = -DVec3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z);
    let hung = places(&graph, &soup, shift_m).map_err(|problem| in_mesh((None, problem)))?;
    let facts = facts(&sheet, &graph, &soup, &hung).map_err(at)?;
    let levels = sheet.levels_from_m().zip(&soup.levels).map(|(from_m, level)| {
        let pieces = level.iter().zip(&hung).filter(|(triangles, _)| !triangles.is_empty());
        let piece = |(triangles, hang): (&Vec<Triangle>, &Attachment)| {
            let relative_m = shift_m - hang.at().as_dvec3();
            PackPiece { mesh: Arc::new(baker.mesh(triangles, relative_m)), hang: *hang }
        };
        PackLevel { from_m, pieces: pieces.map(piece).collect() }
    });
    let levels: Vec<PackLevel> = levels.collect();
    let (row, files) = described(sheet, page, bag, high - low, facts);
    Ok(PackModel { row, files, levels, walker: None })
}

/// What the plan says of a model, and its files.
fn described(
    sheet: ModelManifest,
    page: &str,
    bag: ModelFiles<'_>,
    size_m: DVec3,
    facts: PlanModelRow,
) -> (PlanModelRow, BTreeMap<String, Vec<u8>>) {
    // Rounded up to millimetres, so that the box holds the mesh.
    let size_m = size_m.to_array().map(|v| (v * 1000.0 - 1e-3).ceil() / 1000.0);
    let files = bag.read;
    let row = PlanModelRow {
        name: sheet.name,
        base_type: sheet.base.name().to_owned(),
        size_m,
        special: sheet.special.name().to_owned(),
        age: sheet.age.to_owned(),
        gender: sheet.gender.to_owned(),
        weight: sheet.weight,
        page: page.to_owned(),
        hash: hash_of(&files),
        ..facts
    };
    (row, files)
}

/// Nobody is longer, wider or higher, metres.
const PERSON_M: f32 = 3.0;

/// A pedestrian of pieces in the frames of their bones.
fn person(
    sheet: ModelManifest,
    page: &str,
    bag: ModelFiles<'_>,
    body: &Body,
    levels: Vec<Vec<PackPiece>>,
) -> Result<PackModel, Problem> {
    let finest = levels.iter().take(1).flatten();
    let on_bone = |piece: &PackPiece| match piece.hang {
        Attachment::Bone(bone) => Some((bone, Arc::clone(&piece.mesh))),
        _ => None,
    };
    let walker = Walker::of_meshes(body.figure, finest.filter_map(on_bone).collect());
    let is_m = walker.size_m().to_array();
    if !is_m.iter().all(|size_m| *size_m < PERSON_M) {
        return Err(Problem::TooWide { is_m, most_m: PERSON_M });
    }
    let from_m: Vec<f64> = sheet.levels_from_m().collect();
    let levels =
        from_m.into_iter().zip(levels).map(|(from_m, pieces)| PackLevel { from_m, pieces }).collect();
    let size_m = walker.size_m().as_dvec3();
    let (row, files) = described(sheet, page, bag, size_m, PlanModelRow::default());
    Ok(PackModel { row, files, levels, walker: Some(walker) })
}

/// The glTF file of a page: the one that it names, else the one of its name.
fn mesh_file(page: &str, sheet: &ModelManifest, bag: &mut ModelFiles<'_>) -> Result<String, Problem> {
    if let Some(file) = &sheet.file {
        return inside(page, file).ok_or_else(|| Problem::Outside(file.chars().take(80).collect()));
    }
    let stem = page.strip_suffix(".toml").unwrap_or(page);
    for ending in ["glb", "gltf"] {
        let path = format!("{stem}.{ending}");
        if bag.get(&path, limits::FILE_BYTES)?.is_some() {
            return Ok(path);
        }
    }
    let problem = format!("is not given, and there is neither {stem}.glb nor {stem}.gltf");
    Err(Problem::Key { key: "file".into(), problem })
}

fn check_materials(document: &Document, sheet: &ModelManifest) -> Result<(), Problem> {
    let names: Vec<&str> = document.root.materials.iter().filter_map(|m| m.name.as_deref()).collect();
    match sheet.materials.keys().find(|name| !names.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => {
            let problem = format!("there is no such material; there are {}", names.join(", "));
            Err(Problem::Key { key: format!("materials.{name}"), problem })
        }
    }
}

/// Meshes may be larger or smaller than the page says by this share, or by this much if that is more, metres.
const TOLERANCE: f64 = 0.02;
const TOLERANCE_M: f64 = 0.02;

/// The box around the finest level, which must have the size of the page; coarser ones must not stand out of
/// it.
fn extents(soup: &TriangleSoup, sheet: &ModelManifest) -> Result<[DVec3; 2], (Option<usize>, Problem)> {
    let mut first: Option<[DVec3; 2]> = None;
    for (level, triangles) in soup.levels.iter().enumerate() {
        let Some([low, high]) = bounds(triangles.iter().flatten()) else {
            return Err((None, Problem::Empty));
        };
        // Of people the height alone is said: their arms may be anywhere.
        let [length_m, width_m] = sheet.size_m.map_or((high - low).truncate().to_array(), |[l, w, _]| [l, w]);
        let said_m = DVec3::new(length_m, width_m, sheet.height_m);
        let allowed = (said_m * TOLERANCE).max(DVec3::splat(TOLERANCE_M));
        let good = match first {
            None => ((high - low) - said_m).abs().cmple(allowed).all(),
            Some([finest_low, finest_high]) => {
                low.cmpge(finest_low - allowed).all() && high.cmple(finest_high + allowed).all()
            }
        };
        if !good {
            let is_m = (high - low).to_array().map(|v| (v * 1000.0).round() / 1000.0);
            return Err((None, Problem::Size { level, is_m, said_m: said_m.to_array() }));
        }
        first.get_or_insert([low, high]);
    }
    first.ok_or((None, Problem::Empty))
}

impl Attachment {
    /// Where the piece hangs, object frame, metres.
    #[must_use]
    pub fn at(&self) -> Vec3 {
        match *self {
            Self::Body | Self::Bone(_) => Vec3::ZERO,
            Self::Wheel { at, .. } | Self::Door { at, .. } => at,
        }
    }
}

/// Where everything hangs.
fn places(graph: &Graph, soup: &TriangleSoup, shift_m: DVec3) -> Result<Vec<Attachment>, Problem> {
    let hang = |(number, (name, hung)): (usize, &(String, AttachedTo))| {
        let bad = |problem: &str| Problem::Key { key: format!("nodes.{name}"), problem: problem.into() };
        let around = bounds(soup.levels[0][number].iter());
        Ok(match *hung {
            AttachedTo::Body => Attachment::Body,
            AttachedTo::Wheel { steered } => {
                let [low, high] = around.ok_or_else(|| bad("is a wheel without triangles"))?;
                Attachment::Wheel { at: (0.5 * (low + high) + shift_m).as_vec3(), steered }
            }
            AttachedTo::Door { door, hinge_m } => {
                let [low, high] = around.ok_or_else(|| bad("is a door without triangles"))?;
                let near = DVec3::splat(0.25);
                let beside = hinge_m.clamp(low - near, high + near) - hinge_m;
                // How high the hinge is does not matter.
                if hinge_m.is_nan() || beside.truncate() != glam::DVec2::ZERO {
                    return Err(bad(
                        "its hinge is far from it: put the node's origin there, or set `hinge_m`",
                    ));
                }
                let at = (hinge_m + shift_m).as_vec3();
                if (at.y > 0.0) != door.is_multiple_of(2) {
                    return Err(bad("the hinge of a left door is on the right, or the other way round"));
                }
                Attachment::Door { at, door }
            }
        })
    };
    graph.hung.iter().enumerate().map(hang).collect()
}

/// What the plan says of a model's wheels, doors and lamps.
fn facts(
    sheet: &ModelManifest,
    graph: &Graph,
    soup: &TriangleSoup,
    hung: &[Attachment],
) -> Result<PlanModelRow, Problem> {
    let bad = |key: &str, problem: &str| Problem::Key { key: key.into(), problem: problem.into() };
    let mut doors: Vec<usize> = Vec::new();
    let mut axles = Vec::new();
    for (number, hang) in hung.iter().enumerate() {
        match *hang {
            Attachment::Door { door, .. } if doors.contains(&door) => {
                return Err(bad(
                    &format!("nodes.{}", graph.hung[number].0),
                    "is the second door of that place",
                ));
            }
            Attachment::Door { door, .. } => doors.push(door),
            Attachment::Wheel { at, .. } => {
                let [low, high] = bounds(soup.levels[0][number].iter()).unwrap_or_default();
                axles.push((f64::from(at.x), 0.5 * (high.z - low.z)));
            }
            Attachment::Body | Attachment::Bone(_) => {}
        }
    }
    doors.sort_unstable();
    if ![[].as_slice(), &[0, 1], &[0, 1, 2, 3]].contains(&doors.as_slice()) {
        return Err(bad("nodes", "doors come as both front ones, or these and both rear ones"));
    }
    let mut row = PlanModelRow {
        doors: doors.len() as u32,
        wheels: axles.len() as u32,
        has_lights: soup.parts.iter().any(|part| part.lamp.is_some()),
        ..PlanModelRow::default()
    };
    if !sheet.base.is_driven() {
        return Ok(row);
    }
    if axles.is_empty() {
        let (Some(base), Some(radius)) = (sheet.wheelbase_m, sheet.wheel_radius_m) else {
            let problem = "say which nodes are wheels, or give `wheelbase_m` and `wheel_radius_m`";
            return Err(bad("nodes", problem));
        };
        (row.wheelbase_m, row.wheel_radius_m) = (base, radius);
        row.wheels = if sheet.base.tags().len() > 1 { 2 } else { 4 };
        return Ok(row);
    }
    let xs = || axles.iter().map(|(x, _)| *x);
    let base = xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min);
    let radius = axles.iter().map(|(_, radius)| radius).sum::<f64>() / axles.len() as f64;
    let length_m = sheet.size_m.map_or(0.0, |[length_m, ..]| length_m);
    row.wheelbase_m = sheet.wheelbase_m.unwrap_or(base);
    row.wheel_radius_m = sheet.wheel_radius_m.unwrap_or(radius);
    if !(0.3..=0.98 * length_m).contains(&row.wheelbase_m) || !(0.05..=1.5).contains(&row.wheel_radius_m) {
        let problem = format!(
            "wheels are {:.2} m apart and have a radius of {:.2} m: mark front and rear wheels, or mend `forward` and `scale`",
            row.wheelbase_m, row.wheel_radius_m
        );
        return Err(bad("nodes", &problem));
    }
    Ok(row)
}
