//! What can be wrong with the scenes, maps and models of a plan.

use std::io;
use std::path::PathBuf;

use arrow_schema::DataType;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use schema::FRAME_PERIOD_S;

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
    #[error("{path} (agents.trajectories)")]
    Bad {
        /// The file.
        path: String,
        /// What is wrong with it.
        #[source]
        problem: TrajectoryFault,
    },
}

/// What is wrong with a file of trajectories.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TrajectoryFault {
    /// It cannot be opened.
    #[error("cannot be read")]
    Unreadable(#[source] io::Error),
    /// Its footer is of no Parquet file.
    #[error("is no readable Parquet file")]
    NoParquet(#[source] ParquetError),
    /// Its pages cannot be read.
    #[error("is damaged")]
    Damaged(#[source] ParquetError),
    /// It would take too much memory.
    #[error("has {rows} rows, more than {most}: split it by groups of scenes")]
    TooLong { rows: i64, most: i64 },
    /// A compression that this build cannot undo.
    #[error("is compressed by {0}: write it with compression=\"zstd\", \"snappy\" or none")]
    Packed(Compression),
    /// A column is missing.
    #[error("has no column `{0}` ({COLUMNS})")]
    NoColumn(&'static str),
    /// Two columns say when.
    #[error("has both `frame` and `time_s`: leave one out ({COLUMNS})")]
    FramesAndTimes,
    /// No column says when.
    #[error("has neither `frame` nor `time_s` ({COLUMNS})")]
    NeitherFramesNorTimes,
    /// A column has gaps.
    #[error("column `{0}` has rows without a value")]
    NoValue(&'static str),
    /// A column of other values.
    #[error("column `{name}` is of type {found}, expected {expected}")]
    Type { name: &'static str, found: DataType, expected: &'static str },
    /// A time between frames.
    #[error("row {row}: `time_s` is {time_s}, no multiple of {FRAME_PERIOD_S} s: resample to 20 Hz")]
    Time { row: usize, time_s: f64 },
    /// A number that no scene can have.
    #[error("row {row}: `scene` is {number}")]
    Scene { row: usize, number: i64 },
    /// Two poses of one frame.
    #[error("{whose} has frame {frame} twice")]
    Twice { whose: String, frame: i64 },
    /// A frame without a pose.
    #[error("{whose} has no frame {}: after {before} comes {after}", before + 1)]
    Gap { whose: String, before: i64, after: i64 },
    /// A frame far outside any scene.
    #[error("{whose} has a frame {frame}")]
    Frame { whose: String, frame: i64 },
    /// An actor that turns into another.
    #[error("{whose} has two models, `{first}` and `{other}`")]
    TwoModels { whose: String, first: String, other: String },
    /// Nothing is in it.
    #[error("has no rows")]
    Empty,
}

/// All columns that there may be.
const COLUMNS: &str = "columns: actor, frame (or time_s), x_m, y_m, yaw_rad, and optionally scene, model, \
                       z_m, roll_rad, pitch_rad";

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
