//! The stage graph and the stage runner.
//!
//! A stage program is a few lines: it hands a [`Stage`] and what its arguments say ([`StageOptions`]) to
//! [`run_stage`], which reads the configuration, decides which scenes need work, runs them with their
//! failures kept apart, and turns the outcome into an exit code.

mod agreement;
mod beside;
mod code_version;
mod costs;
mod editions;
mod error;
pub mod forecast;
mod foresight;
pub mod frames;
mod graph;
mod imported;
mod interrupt;
mod lock;
mod options;
mod output_file;
mod overview;
mod pace;
mod prepared;
mod programs;
mod progress;
mod question;
mod record;
mod runner;
mod seen;
mod shards;
mod shares;
mod stage;
mod state;
mod status;
mod survey;
mod suspicions;
mod task;
mod views;
mod why;

pub use beside::{declare_all_programs, name_of, program_beside};
pub use code_version::code_version;
pub use costs::PlannedWork;
pub use editions::{
    EditionError, EditionWish, Editions, newest_recorded, record_of_group, recorded as recorded_editions,
    rules_of_record,
};
pub use error::{At, Place, StageError, report};
pub use foresight::Foresight;
pub use graph::{Graph, StageSpec, UnitKind};
pub use interrupt::{listen as listen_for_signals, stopped as was_stopped, stops_with_this_one};
pub use lock::{hold_alone, hold_for_all_stages};
pub use options::{DeviceOptions, ProgressMode, SceneList, Shard, StageOptions};
pub use output_file::OutputFile;
pub use overview::{Overview, Remembered, overview};
pub use prepared::Prepared;
pub use programs::{Programs, STAMP_LEN, release};
pub use progress::Progress;
pub use runner::{init_logging, run_stage, say};
pub use seen::{IsRead, MadeFrom, StageSettings, ViewError};
pub use shares::{largest_of as largest_share, scenes_of as scenes_of_share};
pub use stage::{Forecast, Job, Open, Outlook, Sections, Stage, Suspicions};
pub use state::{NotReady, Staleness, State, StateError};
pub use status::{Status, planned_scenes};
pub use survey::{Survey, scene_stages};
pub use suspicions::{Suspicious, settings_or_faults};
pub use task::{TaskRules, TaskScene, planned_work, task};
pub use views::config_hash;
pub use why::why;

/// Exit code: everything was done.
pub const EXIT_DONE: u8 = 0;
/// Exit code: some scenes failed; they are listed, the others are kept.
pub const EXIT_SOME_FAILED: u8 = 1;
/// Exit code: bad arguments or configuration.
pub const EXIT_USAGE: u8 = 2;
/// Exit code: the system killed a stage, mostly because memory ran out; another try may end alike.
pub const EXIT_KILLED: u8 = 137;
/// Exit code: stopped by a signal, or because the store cannot be written (a full disk) or is held by others;
/// worth another try.
pub const EXIT_TRY_AGAIN: u8 = 75;
