//! The rig of a pedestrian: joints, what each moves, and how skins bend.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DMat3, DMat4, DVec3};
use meshes::people::Bone;

use crate::accessor::Numbers;
use crate::document::Document;
use crate::error::Problem;
use crate::graph::{At, Graph, name_of};
use crate::joints::{JointName, MARKS, recognised};
use crate::limits;
use crate::manifest::ModelManifest;

/// A joint of a skin: the bone that it goes with, and where it takes what hangs on it.
#[derive(Clone, Copy)]
struct SkinJoint {
    /// None of a joint that neither hangs on one of the body's nor bears them.
    bone: Option<Bone>,
    object_from_mesh: DAffine3,
}

/// The rig of a file in the pose that its nodes have.
pub(crate) struct Rig {
    /// Where the joints are, object frame before it is centred, metres.
    pub(crate) places_m: BTreeMap<JointName, DVec3>,
    /// Of each node the bone that it goes with: its own, or that of the nearest one above it that has one.
    bones: BTreeMap<usize, Bone>,
    /// Nodes above joints that are known.
    above: BTreeSet<usize>,
    skins: BTreeMap<usize, Vec<SkinJoint>>,
}

impl Rig {
    /// # Errors
    /// A joint that is needed is not found, or a skin is damaged.
    pub(crate) fn new(document: &Document, graph: &Graph, sheet: &ModelManifest) -> Result<Self, At> {
        let root = &document.root;
        let numbers = |(skin, joints): (usize, &gltf_json::Skin)| {
            let too_many = skin >= limits::SKINS || joints.joints.len() > limits::JOINTS;
            let numbers: Vec<usize> = joints.joints.iter().map(|joint| joint.value()).collect();
            if too_many {
                Err((None, Problem::TooManyJoints(limits::SKINS, limits::JOINTS)))
            } else {
                Ok(numbers)
            }
        };
        let skins: Vec<Vec<usize>> = root.skins.iter().enumerate().map(numbers).collect::<Result<_, At>>()?;
        let used: Vec<usize> = graph.placed.iter().filter_map(|placed| placed.skin).collect();
        let marked = marked(root, graph, sheet, &skins.concat())?;
        let of_node: BTreeMap<usize, JointName> = marked.iter().map(|(mark, node)| (*node, *mark)).collect();
        let place = |(mark, node): (&JointName, &usize)| Some((*mark, graph.nodes.get(node)?.1.translation));
        let places_m = marked.iter().filter_map(place).collect();
        let mut bones = BTreeMap::new();
        for &node in graph.nodes.keys() {
            let mut above = Some(node);
            // The tree is at most so deep: this ends.
            while let Some(at) = above {
                if let Some(mark) = of_node.get(&at) {
                    bones.insert(node, mark.bone());
                    break;
                }
                above = graph.nodes.get(&at).and_then(|(parent, _)| *parent);
            }
        }
        let parent = |node: &usize| graph.nodes.get(node).and_then(|(parent, _)| *parent);
        let above = of_node.keys().flat_map(|node| std::iter::successors(parent(node), parent)).collect();
        let mut rig = Self { places_m, bones, above, skins: BTreeMap::new() };
        for number in used {
            if !rig.skins.contains_key(&number) {
                let joints = skins.get(number).ok_or((None, Problem::NoSkin(number)))?;
                let read = rig.skin(document, graph, number, joints)?;
                rig.skins.insert(number, read);
            }
        }
        Ok(rig)
    }

    fn skin(
        &self,
        document: &Document,
        graph: &Graph,
        number: usize,
        joints: &[usize],
    ) -> Result<Vec<SkinJoint>, At> {
        let accessor = document.root.skins[number].inverse_bind_matrices.map(|accessor| accessor.value());
        let matrices = accessor.map(|accessor| Numbers::matrices(document, accessor)).transpose();
        let matrices = matrices.map_err(|problem| (None, problem))?;
        if let Some(list) = matrices.as_ref().filter(|list| list.len() != joints.len()) {
            let problem = Problem::BindCount { skin: number, joints: joints.len(), matrices: list.len() };
            return Err((None, problem));
        }
        let mut read = Vec::with_capacity(joints.len());
        for (place, &node) in joints.iter().enumerate() {
            let at = |problem| (Some(node), problem);
            let (_, object_from_joint) =
                graph.nodes.get(&node).ok_or_else(|| at(Problem::JointNotInScene(number)))?;
            let joint_from_mesh = match &matrices {
                Some(list) => matrix(list, place).ok_or_else(|| at(Problem::BindMatrix(number)))?,
                None => DAffine3::IDENTITY,
            };
            let object_from_mesh = *object_from_joint * joint_from_mesh;
            // What hangs on a joint above all of the body goes with the hips.
            let over = self.above.contains(&node).then_some(Bone::Pelvis);
            let bone = self.bones.get(&node).copied().or(over);
            read.push(SkinJoint { bone, object_from_mesh });
        }
        Ok(read)
    }

    /// The bone that a mesh without a skin hangs on.
    pub(crate) fn bone_of(&self, node: usize) -> Option<Bone> {
        self.bones.get(&node).copied()
    }
}

/// A matrix that can be inverted and has no perspective.
fn matrix(list: &Numbers<'_>, place: usize) -> Option<DAffine3> {
    let mut values = [0.0; 16];
    for (k, value) in values.iter_mut().enumerate() {
        *value = f64::from(list.float(place, k)?);
    }
    let matrix = DMat4::from_cols_array(&values);
    let last = matrix.row(3) - glam::DVec4::W;
    let whole = DAffine3 { matrix3: DMat3::from_mat4(matrix), translation: matrix.w_axis.truncate() };
    let size = whole.matrix3.determinant().abs();
    (matrix.is_finite() && last.abs().max_element() < 1e-3 && size > 1e-24 && size < 1e24).then_some(whole)
}

/// The node of each joint that is known: those that the page names, then those whose names are known.
fn marked(
    root: &gltf_json::Root,
    graph: &Graph,
    sheet: &ModelManifest,
    skinned: &[usize],
) -> Result<BTreeMap<JointName, usize>, At> {
    let mut nodes: Vec<usize> = graph.nodes.keys().copied().collect();
    let name = |node: usize| root.nodes.get(node).and_then(|node| node.name.as_deref()).unwrap_or("");
    let mut marked: BTreeMap<JointName, usize> = BTreeMap::new();
    for (written, mark) in &sheet.joints {
        let bad = |problem: &str| {
            (None, Problem::Key { key: format!("joints.{written}"), problem: problem.to_owned() })
        };
        let mut found = nodes.iter().filter(|node| name(**node) == written);
        let node = *found.next().ok_or_else(|| bad("there is no such node in the scene"))?;
        if found.next().is_some() {
            return Err(bad("there are two nodes of this name: give each its own"));
        }
        marked.insert(*mark, node);
    }
    if !skinned.is_empty() {
        nodes.retain(|node| skinned.contains(node));
    }
    let names: Vec<&str> = nodes.iter().map(|node| name(*node)).collect();
    for (bone, mark) in MARKS {
        if marked.contains_key(&mark) {
            continue;
        }
        let taken = |place: usize| marked.values().any(|node| *node == nodes[place]);
        match recognised(mark, &names, &taken) {
            Some(place) => {
                marked.insert(mark, nodes[place]);
            }
            None if mark.is_needed() => {
                let names: Vec<String> = nodes.iter().take(80).map(|node| name_of(root, *node)).collect();
                return Err((None, Problem::NoJoint { bone, names: names.join(", ") }));
            }
            None => {}
        }
    }
    Ok(marked)
}

/// Which joints the vertices of a mesh hang on, and how much.
pub(crate) struct Weights<'d> {
    sets: Vec<[Numbers<'d>; 2]>,
    joints: &'d [SkinJoint],
}

/// Weights are 1 together, but for the rounding of bytes.
const WEIGHTS_OFF: f64 = 0.03;

impl<'d> Weights<'d> {
    /// `sets`: joints and weights of each attribute pair, at least one.
    pub(crate) fn new(rig: &'d Rig, skin: usize, sets: Vec<[Numbers<'d>; 2]>) -> Result<Self, Problem> {
        let joints = rig.skins.get(&skin).ok_or(Problem::NoSkin(skin))?;
        if sets.is_empty() { Err(Problem::NoWeights) } else { Ok(Self { sets, joints }) }
    }

    /// Where a vertex is taken to, and the bone that it hangs on most.
    pub(crate) fn of(&self, vertex: usize) -> Result<(DAffine3, Bone), Problem> {
        let mut place = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
        let (mut shares, mut sum) = ([0.0; Bone::BODY.len()], 0.0);
        for [joints, weights] in &self.sets {
            for k in 0..4 {
                let joint = joints.whole(vertex, k).ok_or(Problem::NoWeights)?;
                let weight = f64::from(weights.float(vertex, k).ok_or(Problem::NoWeights)?);
                if !(0.0..=1.0 + WEIGHTS_OFF).contains(&weight) {
                    return Err(Problem::Weights { vertex });
                }
                if weight > 0.0 {
                    let unknown = || Problem::JointIndex { vertex, joint, joints: self.joints.len() };
                    let joint = self.joints.get(joint as usize).ok_or_else(unknown)?;
                    place.matrix3 += joint.object_from_mesh.matrix3 * weight;
                    place.translation += joint.object_from_mesh.translation * weight;
                    let bone = joint.bone.ok_or(Problem::OtherSkeleton { vertex })?;
                    shares[bone as usize] += weight;
                    sum += weight;
                }
            }
        }
        if (sum - 1.0).abs() > WEIGHTS_OFF {
            return Err(Problem::Weights { vertex });
        }
        place.matrix3 *= 1.0 / sum;
        place.translation /= sum;
        // Of equals the first: what is above.
        let most = (1..shares.len()).fold(0, |most, k| if shares[k] > shares[most] { k } else { most });
        Ok((place, Bone::BODY[most]))
    }
}
