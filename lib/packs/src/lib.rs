#![doc = include_str!("../README.md")]

mod accessor;
mod bake;
mod body;
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
mod rig;
mod sheet;
mod soup;
mod split;

pub use error::{PackError, Problem};
pub use files::{Files, Folder};
pub use folder::{digest, read_folder};
pub use model::{Hang, PackLevel, PackModel, PackPiece, read_model};
