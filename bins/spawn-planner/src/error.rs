//! What can be wrong with the scenes, maps and models of a plan.

use std::io;
use std::path::PathBuf;

/// The wish for scenes leads nowhere.
#[derive(Debug, thiserror::Error)]
pub(crate) enum RosterError {
    /// An edition without scenes.
    #[error(
        "the configuration asks for no scene beyond the {scenes} that older editions have: ask for more (counts are totals), or \
         say which edition it is to replace: --edition N"
    )]
    NothingToGrow {
        /// Scenes of older editions.
        scenes: usize,
    },
}

/// A map cannot be had.
#[derive(Debug, thiserror::Error)]
pub(crate) enum MapError {
    /// Two files of one stem.
    #[error("maps `{first}` and `{second}` are both called `{name}`: rename one of the files")]
    SameName { first: String, second: String, name: String },
    /// A name that is no town of ours, and no folder to look in.
    #[error(
        "map `{written}` is none of our own towns ({own}): give the path of its .xodr file instead, or say \
         in which folder it is with --maps FOLDER"
    )]
    NoFolder { written: String, own: String },
    /// A name that leads out of the maps folder.
    #[error("map `{written}` is not a plain name: give the whole path of the file, with its ending .xodr")]
    NotPlain { written: String },
    /// No file of this name.
    #[error("map `{written}`: there is no {looked}; our own towns are {own}")]
    NotFound { written: String, looked: String, own: String },
    /// A file that cannot be read.
    #[error("{}: cannot read the map", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// A file that is no gzip after all.
    #[error("broken gzip file")]
    Gzip(#[source] io::Error),
    /// A map of older scenes is gone from the store.
    #[error("missing, and older scenes stand on this map")]
    Gone,
}

/// Trajectories cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TrajectoryError {
    /// It is not there.
    #[error(
        "agents.trajectories: there is no file `{written}`, neither below the maps folder nor from where the program runs"
    )]
    NotFound {
        /// As it is written.
        written: String,
    },
    /// It holds no trajectories.
    #[error("{path} (agents.trajectories): {problem}")]
    Bad {
        /// The file.
        path: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// A pack of models cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ModelError {
    /// It is not there.
    #[error(
        "models.packs: there is no folder `{written}`, neither below the maps folder nor from where the program runs"
    )]
    NoFolder {
        /// As it is written.
        written: String,
    },
    /// Two packs have a model of one name.
    #[error("models.packs: `{first}` and `{second}` both have a model `{name}`: remove one of them")]
    SameName {
        /// The model.
        name: String,
        /// The first pack.
        first: String,
        /// The second pack.
        second: String,
    },
}
