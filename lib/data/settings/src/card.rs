//! What the dataset's card says that no number tells.

use crate::key::settings;

settings! {
    /// Words of the dataset's card.
    #[derive(Eq)]
    pub struct CardSettings {
        /// What the dataset is, as Markdown; empty: a sentence that is true of all of them.
        description: String = String::new();
        /// Licence of the dataset, an SPDX name where there is one (`CC-BY-4.0`); empty: not stated.
        licence: String = String::new();
        /// Who made the dataset.
        authors: Vec<String> = Vec::new();
        /// Where the dataset is to be had.
        url: String = String::new();
        /// How to cite the dataset, as BibTeX; empty: an entry made of the words above.
        citation: String = String::new();
    }
}
