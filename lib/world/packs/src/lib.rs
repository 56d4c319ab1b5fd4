#![doc = include_str!("../README.md")]

mod accessor;
mod bake;
mod body;
mod coat;
mod cutout;
mod document;
mod error;
mod files;
mod folder;
mod graph;
mod hash;
mod joints;
mod limits;
mod model;
mod normals;
mod picture;
mod pictures;
mod rig;
mod sheet;
mod soup;
mod split;
mod stencil;

pub use error::{PackError, Problem};
pub use files::{Files, Folder};
pub use folder::{digest, read_folder};
pub use model::{Hang, PackLevel, PackModel, PackPiece, read_model};
