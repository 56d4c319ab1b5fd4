//! Datasets in SimBEV2X's layout as stores.
//!
//! [`Source::open`] looks through a dataset, [`import`] writes its scenes into a store. What is read was
//! written by others: pickles are read by a machine of our own that calls nothing ([`pickle`]), no path leads
//! out of the dataset's folder ([`Folder`]), every size is bounded, and what is wrong is an error that names
//! file and place.

mod arrays;
mod cast;
mod error;
mod facts;
mod folder;
mod infos;
pub mod json;
mod labels;
mod lanes;
mod names;
pub mod npy;
pub mod pickle;
mod pictures;
mod plan;
mod readings;
mod record;
mod rig;
mod run;
mod scene_unit;
mod sensors;
mod settings;
mod survey;
mod value;
mod work;

pub use error::{ImportError, SourceFault};
pub use folder::Folder;
pub use infos::{Entry, Index, IndexError, Infos, Record, Scene, scan};
pub use rig::Rigs;
pub use run::{Outcome, Prospect, Selection, import, prospect};
pub use survey::{SceneSurvey, Source};
pub use value::Value;
pub use work::ProgressWatch;
