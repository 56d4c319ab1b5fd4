#![doc = include_str!("../README.md")]

mod accessor;
mod bake;
mod body;
mod cutout;
mod document;
mod error;
mod files;
mod folder;
mod graph;
mod hash;
mod joints;
mod limits;
mod manifest;
mod material;
mod model;
mod normals;
mod picture;
mod pictures;
mod rig;
mod split;
mod stencil;
mod triangle_soup;

pub use error::{PackError, Problem};
pub use files::{Files, Folder};
pub use folder::{digest, read_folder};
pub use model::{Attachment, PackLevel, PackModel, PackPiece, read_model};
