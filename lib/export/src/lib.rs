#![doc = include_str!("../README.md")]

mod error;
mod layout;
mod place;
mod run;
mod selection;
mod source;

pub use error::ExportError;
pub use layout::{Cost, Layout, Omission, UnitName};
pub use place::{Destination, UnitFiles};
pub use run::{Outcome, Plan, Watch, export, plan};
pub use selection::Selection;
pub use source::{SceneSource, Source};
