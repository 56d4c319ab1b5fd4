//! What a user may choose of the layout.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::masks::Palette;

/// Before or after the original's post-processing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// What its generator writes.
    Raw,
    /// With points, validity and difficulty of boxes, combined boxes, filled grids.
    Processed,
}

/// What a user may choose.
#[derive(Clone, Debug, Args, Serialize)]
pub struct Options {
    /// As before or after SimBEV2X's post-processing.
    #[arg(long, value_enum, default_value = "processed")]
    pub state: State,
    /// Colours of the pictures of BEV masks.
    #[arg(long, value_enum, default_value = "plain")]
    pub palette: Palette,
    /// The folder by which readers will find the dataset (their --path): it stands in the paths of the infos
    /// (default: as --dest is given).
    #[arg(long, value_name = "DIR")]
    pub path_prefix: Option<String>,
}

impl Options {
    /// A path of infos.
    pub(super) fn path(&self, below: &str) -> String {
        match self.path_prefix.as_deref() {
            None | Some("") => below.to_owned(),
            Some(prefix) => format!("{}/{below}", prefix.trim_end_matches('/')),
        }
    }
}
