//! What can be wrong with a model.

use std::fmt;

/// A model that cannot be used: where, and why.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct PackError {
    /// The file, as far as is known where it lies.
    pub file: String,
    /// The node in it, by name or as `#number`.
    pub node: Option<String>,
    /// What is wrong, and what to do.
    pub problem: Problem,
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, node, problem } = self;
        match node {
            Some(node) => write!(f, "{file}, node `{node}`: {problem}"),
            None => write!(f, "{file}: {problem}"),
        }
    }
}

impl PackError {
    pub(crate) fn file(file: impl Into<String>, problem: Problem) -> Self {
        Self { file: file.into(), node: None, problem }
    }
}

/// What is wrong with a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what they mean")]
pub enum Problem {
    #[error("cannot read: {0}")]
    Unreadable(String),
    #[error("there is no such file")]
    Missing,
    #[error("has more than {0} bytes: make it smaller or split it")]
    TooLarge(u64),
    #[error("the model's files have more than {0} bytes together")]
    ModelTooLarge(u64),
    #[error("the folder has no model: put a page NAME.toml beside each glTF file (docs/packs.md)")]
    NoModels,
    #[error("the folder has more than {0} files")]
    TooManyFiles(usize),
    #[error("line {line}: {message}")]
    Toml { line: usize, message: String },
    #[error("`{key}`: {problem}")]
    Key { key: String, problem: String },
    #[error("`{name}` is described in {other}, too: give one of them another name or remove it")]
    Duplicate { name: String, other: String },
    #[error("is no glTF 2.0 file: {0}")]
    Broken(String),
    #[error("needs the extension {0}, which is not read here: export without it")]
    Extension(String),
    #[error("`{0}` lies outside of the folder, or is no plain relative path: put the file beside this one")]
    Outside(String),
    #[error("buffer {0} has no data: export as .glb, or put its .bin beside this file")]
    NoBuffer(usize),
    #[error("accessor {0} has no data")]
    NoData(usize),
    #[error("accessor {0} is sparse, which is not read here: export without morph targets and sparse data")]
    Sparse(usize),
    #[error("accessor {0} reaches beyond its buffer: the file is damaged")]
    OutOfBuffer(usize),
    #[error("accessor {accessor} is no {wanted}")]
    Layout { accessor: usize, wanted: &'static str },
    #[error("index {index} is out of range: there are {vertices} vertices")]
    Index { index: u32, vertices: usize },
    #[error("{0} is not finite: repair the mesh")]
    NotFinite(&'static str),
    #[error("has points, lines or an unknown kind of primitive: export triangles alone")]
    NotTriangles,
    #[error("is skinned: only pedestrians have a rig; apply the armature and export the mesh alone")]
    Skinned,
    #[error("there is no skin {0}")]
    NoSkin(usize),
    #[error("there are more than {0} skins, or one with more than {1} joints")]
    TooManyJoints(usize, usize),
    #[error("skin {skin} has {joints} joints, but {matrices} inverse bind matrices: export it anew")]
    BindCount { skin: usize, joints: usize, matrices: usize },
    #[error(
        "its inverse bind matrix in skin {0} cannot be inverted or is none of a place and a turn: export it anew"
    )]
    BindMatrix(usize),
    #[error("is a joint of skin {0}, but is not in the scene")]
    JointNotInScene(usize),
    #[error("is skinned, but has no JOINTS_0 and WEIGHTS_0, or not for each vertex")]
    NoWeights,
    #[error("vertex {vertex} hangs on joint {joint}: the skin has {joints}")]
    JointIndex { vertex: usize, joint: u32, joints: usize },
    #[error(
        "vertex {vertex} hangs on a joint that no joint of the body bears: put all meshes on one skeleton"
    )]
    OtherSkeleton { vertex: usize },
    #[error("the weights of vertex {vertex} are below 0 or not 1 together: normalise them")]
    Weights { vertex: usize },
    #[error("no joint is `{bone}`: say in `[joints]` which one is; there are {names}")]
    NoJoint { bone: &'static str, names: String },
    #[error(
        "is `{bone}`, but {problem}: mend `[joints]`, `forward`, `up` or `scale`, or let the file stand upright"
    )]
    JointPlace { bone: &'static str, problem: &'static str },
    #[error(
        "stands {is_m:?} m long, wide and high with hanging arms, which is more than {most_m} m: mend `[joints]` or the mesh"
    )]
    TooWide { is_m: [f32; 3], most_m: f32 },
    #[error("is neither skinned nor below a joint of the rig: hang it on one")]
    Loose,
    #[error("has two parents or is its own ancestor: nodes must form a tree")]
    NotATree,
    #[error("there are more than {0} nodes below one another")]
    TooDeep(usize),
    #[error("there are more than {0} nodes")]
    TooManyNodes(usize),
    #[error("there is no triangle: nothing would be seen")]
    Empty,
    #[error("level {level} has more than {most} triangles: simplify the mesh")]
    TooManyTriangles { level: usize, most: usize },
    #[error("there are more than {0} combinations of material, tag and lamp: join materials")]
    TooManyParts(usize),
    #[error("picture {index}: {problem}")]
    Picture { index: usize, problem: String },
    #[error(
        "level {level} is {is_m:?} m long, wide and high, but `size_m` says {said_m:?}: set `scale`, `up` and `forward`, or mend `size_m`"
    )]
    Size { level: usize, is_m: [f64; 3], said_m: [f64; 3] },
}
