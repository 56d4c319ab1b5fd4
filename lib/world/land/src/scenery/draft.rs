//! Objects in the making.

use frames::{Object, Pose, World};
use schema::tables::TileObjectRow;
use schema::{ActorKind, Attributes, Tag};

/// An object in the making.
pub(crate) struct Draft {
    pub(crate) kind: ActorKind,
    pub(crate) model: String,
    pub(crate) tags: Vec<Tag>,
    pub(crate) size_m: [f64; 3],
    pub(crate) color: [u8; 3],
    pub(crate) xyz_m: [f64; 3],
    pub(crate) rpy_rad: [f64; 3],
    pub(crate) variant: u32,
    pub(crate) opendrive_id: Option<String>,
    pub(crate) attributes: Attributes,
}

impl Draft {
    pub(crate) fn new(
        kind: ActorKind,
        model: &str,
        tag: Tag,
        size_m: [f64; 3],
        xyz_m: [f64; 3],
        yaw_rad: f64,
    ) -> Self {
        Self {
            kind,
            model: model.to_owned(),
            tags: vec![tag],
            size_m,
            color: [128; 3],
            xyz_m,
            rpy_rad: [0.0, 0.0, yaw_rad],
            variant: 0,
            opendrive_id: None,
            attributes: Attributes::new(),
        }
    }

    /// The object's row.
    pub(crate) fn row(self) -> TileObjectRow {
        let pose = Pose::<World, Object>::from_xyz_rpy(self.xyz_m, self.rpy_rad);
        TileObjectRow {
            kind: self.kind,
            model: self.model,
            semantic_tags: self.tags.iter().map(|t| *t as u8).collect(),
            length_m: self.size_m[0],
            width_m: self.size_m[1],
            height_m: self.size_m[2],
            color: self.color.to_vec(),
            xyz_m: self.xyz_m,
            quaternion: pose.wxyz(),
            variant: self.variant,
            opendrive_id: self.opendrive_id,
            attributes: self.attributes,
        }
    }
}
