#![doc = include_str!("../README.md")]

mod asked;
pub mod command;
mod common_files;
mod disk;
mod error;
mod files;
pub mod kitti;
mod layout;
mod lock;
pub mod mcap;
pub mod nuscenes;
pub mod opv2v;
mod picture;
mod place;
mod run;
mod selection;
pub mod simbev2x;
mod source;
mod unit;
mod work;

pub use error::ExportError;
pub use files::{ExportFile, UnitFiles};
pub use layout::{Cost, Layout, Omission};
pub use place::Destination;
pub use run::{Outcome, Plan, export, plan};
pub use selection::{Selection, matches};
pub use source::{SceneSource, Source};
pub use unit::{ProgressWatch, UnitName};
