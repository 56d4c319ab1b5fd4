//! What the dataset's card says that no number tells.

use serde::Serialize;

/// Words of the dataset's card.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CardSettings {
    /// What the dataset is, as Markdown; empty: a sentence that is true of all of them.
    pub description: String,
    /// Under which licence it may be used, an SPDX name where there is one (`CC-BY-4.0`); empty: not stated.
    pub licence: String,
    /// Who made it.
    pub authors: Vec<String>,
    /// Where it is to be had.
    pub url: String,
    /// How to cite it, as BibTeX; empty: an entry made of the other words.
    pub citation: String,
}
