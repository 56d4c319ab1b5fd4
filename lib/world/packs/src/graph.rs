//! Which meshes of a file stand where, and what they are: the tree of nodes with what the page says of them.

use std::collections::{BTreeMap, BTreeSet};

use catalogue::BaseType;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use gltf_json::Root;
use schema::Tag;

use crate::error::Problem;
use crate::limits;
use crate::manifest::ModelManifest;

/// What a piece hangs on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AttachedTo {
    Body,
    Wheel { steered: bool },
    Door { door: usize, hinge_m: DVec3 },
}

/// What a node and those below it are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Role {
    /// Index into [`Graph::hung`].
    pub(crate) hung: usize,
    pub(crate) tag: Tag,
    /// Bits and colour of a lamp.
    pub(crate) lamp: Option<(u32, Option<[f32; 3]>)>,
}

/// A mesh in its place.
pub(crate) struct Placed {
    /// Index of the node, for messages.
    pub(crate) node: usize,
    pub(crate) mesh: usize,
    /// To the object frame, but for its shift to the middle.
    pub(crate) object_from_mesh: DAffine3,
    pub(crate) role: Role,
    /// The skin that bends it, if one does.
    pub(crate) skin: Option<usize>,
    /// At which levels of detail it is there, from 0.
    pub(crate) levels: Vec<bool>,
}

/// The meshes of a scene in their places.
pub(crate) struct Graph {
    pub(crate) placed: Vec<Placed>,
    /// The body, then wheels and doors by the names of their nodes, each with its name.
    pub(crate) hung: Vec<(String, AttachedTo)>,
    /// Of each node of the scene, by its number: the node above it, and where it is.
    pub(crate) nodes: BTreeMap<usize, (Option<usize>, DAffine3)>,
}

/// A node's fault: which, if it is one's.
pub(crate) type At = (Option<usize>, Problem);

/// A node's name without the ending that says at which level of detail it is there, and that level.
fn family(name: &str) -> (&str, usize) {
    let split = name.rsplit_once("_lod").and_then(|(base, level)| Some((base, level.parse().ok()?)));
    split.filter(|(base, level)| !base.is_empty() && *level <= limits::LEVELS).unwrap_or((name, 0))
}

/// What a node is called in messages.
pub(crate) fn name_of(root: &Root, node: usize) -> String {
    let name = root.nodes.get(node).and_then(|node| node.name.clone());
    name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("#{node}"))
}

struct Walk<'a> {
    root: &'a Root,
    sheet: &'a ModelManifest,
    graph: Graph,
    /// Levels at which each family of nodes has a version.
    versions: BTreeMap<&'a str, BTreeSet<usize>>,
    seen: BTreeSet<usize>,
}

impl Graph {
    /// # Errors
    /// The nodes are no tree, or the page speaks of nodes that are not there.
    pub(crate) fn new(root: &Root, sheet: &ModelManifest) -> Result<Self, At> {
        let mut versions: BTreeMap<&str, BTreeSet<usize>> = BTreeMap::new();
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        for name in root.nodes.iter().filter_map(|node| node.name.as_deref()) {
            let (base, level) = family(name);
            versions.entry(base).or_default().insert(level);
            *names.entry(name).or_default() += 1;
        }
        for note in sheet.nodes.keys() {
            let key = || format!("nodes.{note}");
            let bad = |problem| Err((None, Problem::Key { key: key(), problem }));
            let Some(levels) = versions.get(note.as_str()) else {
                let some: Vec<&str> = versions.keys().copied().take(24).collect();
                return bad(format!("there is no such node; there are {}", some.join(", ")));
            };
            let twice = |level: &usize| {
                let name = if *level == 0 { note.clone() } else { format!("{note}_lod{level}") };
                names.get(name.as_str()).copied().unwrap_or(0) > 1
            };
            if levels.iter().any(twice) {
                return bad("there are two nodes of this name: give each its own".into());
            }
        }
        let finest = versions.values().flatten().copied().max().unwrap_or(0);
        if finest != sheet.lod_from_m.len() {
            let problem =
                format!("has {} distances, but nodes go up to `_lod{finest}`", sheet.lod_from_m.len());
            return Err((None, Problem::Key { key: "lod_from_m".into(), problem }));
        }
        let mut hung = vec![(String::new(), AttachedTo::Body)];
        for (name, note) in &sheet.nodes {
            if let Some(steered) = note.wheel {
                hung.push((name.clone(), AttachedTo::Wheel { steered }));
            } else if let Some(door) = note.door {
                let hinge_m = note.hinge_m.map_or(DVec3::NAN, DVec3::from_array);
                hung.push((name.clone(), AttachedTo::Door { door, hinge_m }));
            }
        }
        let tag = sheet.base.tags().last().copied().unwrap_or_default();
        let graph = Self { placed: Vec::new(), hung, nodes: BTreeMap::new() };
        let mut walk = Walk { root, sheet, graph, versions, seen: BTreeSet::new() };
        let [f, l, u] = sheet.axes;
        // Rows: what is ahead, to the left and up in the file.
        let axes = DMat3::from_cols_array_2d(&[f, l, u]).transpose();
        let top = DAffine3::from_mat3(axes * sheet.scale);
        let role = Role { hung: 0, tag, lamp: None };
        let levels = vec![true; sheet.lod_from_m.len() + 1];
        for node in roots(root) {
            walk.visit(node, (None, &top), &role, &levels, 0)?;
        }
        Ok(walk.graph)
    }
}

/// The nodes that the scene begins with: those of the file's scene, else those without parents.
fn roots(root: &Root) -> Vec<usize> {
    let scene = root.scene.map_or(0, |scene| scene.value());
    if let Some(scene) = root.scenes.get(scene) {
        return scene.nodes.iter().map(|node| node.value()).collect();
    }
    let children = root.nodes.iter().flat_map(|node| node.children.iter().flatten()).map(|node| node.value());
    let children: BTreeSet<usize> = children.collect();
    (0..root.nodes.len()).filter(|node| !children.contains(node)).collect()
}

impl Walk<'_> {
    fn visit(
        &mut self,
        index: usize,
        (parent, object_from_parent): (Option<usize>, &DAffine3),
        role: &Role,
        levels: &[bool],
        depth: usize,
    ) -> Result<(), At> {
        let at = |problem| (Some(index), problem);
        if !self.seen.insert(index) {
            return Err(at(Problem::NotATree));
        }
        if depth > limits::DEPTH {
            return Err(at(Problem::TooDeep(limits::DEPTH)));
        }
        let missing = || (None, Problem::Broken(format!("there is no node {index}")));
        let node = self.root.nodes.get(index).ok_or_else(missing)?;
        if node.skin.is_some() && self.sheet.base != BaseType::Pedestrian {
            return Err(at(Problem::Skinned));
        }
        let object_from_node = *object_from_parent * parent_from(node);
        if !object_from_node.is_finite() {
            return Err(at(Problem::NotFinite("its transform")));
        }
        self.graph.nodes.insert(index, (parent, object_from_node));
        let (base, version) = family(node.name.as_deref().unwrap_or(""));
        let mut levels = levels.to_vec();
        if let Some(versions) = self.versions.get(base) {
            for (level, there) in levels.iter_mut().enumerate() {
                // Of its versions the one is there that was made last for this level or a finer one.
                *there &= versions.range(..=level).last() == Some(&version);
            }
        }
        let mut role = role.clone();
        if let Some(note) = self.sheet.nodes.get(base) {
            role.tag = note.tag.unwrap_or(role.tag);
            role.lamp = note.lamps.map(|bits| (bits, note.lamp_rgb)).or(role.lamp);
            if let Some(hung) = self.graph.hung.iter().skip(1).position(|(name, _)| name == base) {
                role.hung = hung + 1;
                if let AttachedTo::Door { hinge_m, .. } = &mut self.graph.hung[hung + 1].1
                    && hinge_m.is_nan()
                {
                    *hinge_m = object_from_node.translation;
                }
            }
        }
        if let Some(mesh) = node.mesh {
            self.graph.placed.push(Placed {
                node: index,
                mesh: mesh.value(),
                object_from_mesh: object_from_node,
                role: role.clone(),
                skin: node.skin.map(|skin| skin.value()),
                levels: levels.clone(),
            });
        }
        for child in node.children.iter().flatten() {
            self.visit(child.value(), (Some(index), &object_from_node), &role, &levels, depth + 1)?;
        }
        Ok(())
    }
}

fn parent_from(node: &gltf_json::Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector = |v: Option<[f32; 3]>, d: DVec3| v.map_or(d, |v| DVec3::from_array(v.map(f64::from)));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    let length = rotation.length();
    // Rounded to unit length; none at all turns nothing.
    let rotation =
        if length > 1e-6 && length.is_finite() { rotation * (1.0 / length) } else { DQuat::IDENTITY };
    let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}

#[cfg(test)]
mod tests {
    use super::family;

    #[test]
    fn levels_are_told_by_endings() {
        assert_eq!(family("Body"), ("Body", 0));
        assert_eq!(family("Body_lod2"), ("Body", 2));
        assert_eq!(family("Body_lod"), ("Body_lod", 0));
        assert_eq!(family("Body_lod99"), ("Body_lod99", 0));
        assert_eq!(family("_lod1"), ("_lod1", 0));
    }
}
