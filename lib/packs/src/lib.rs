#![doc = include_str!("../README.md")]

mod accessor;
mod bake;
mod document;
mod error;
mod files;
mod folder;
mod graph;
mod hash;
mod limits;
mod model;
mod normals;
mod picture;
mod sheet;
mod soup;

pub use error::{PackError, Problem};
pub use files::{Files, Folder};
pub use folder::{digest, read_folder};
pub use model::{Hang, PackLevel, PackModel, PackPiece, read_model};
