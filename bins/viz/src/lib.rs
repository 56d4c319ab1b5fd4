#![doc = include_str!("../README.md")]

mod archive;
mod command;
mod desk;
mod draw;
mod error;
mod feed;
mod film;
mod ground;
mod known;
mod mode;
mod preview;
mod scene_view;
mod session;
mod stills;

use std::ffi::OsString;
use std::process::ExitCode;

use arguments::viz::PictureCommand;
use runner::{EXIT_DONE, EXIT_USAGE, report};

use error::VizError;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    let command = command::parse(&words);
    runner::init_logging();
    ExitCode::from(run(&command))
}

/// Runs a command; its exit code.
fn run(command: &PictureCommand) -> u8 {
    let threads = command.common().threads.unwrap_or(0);
    let result = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(|| match command {
            PictureCommand::Viz(args) => stills::run(args),
            PictureCommand::Preview(args) => preview::run(args),
            PictureCommand::Film(args) => film::run(args),
        }),
        Err(fault) => Err(VizError::Refused(fault.to_string())),
    };
    match result {
        Ok(()) => EXIT_DONE,
        Err(fault) => {
            tracing::error!("{}", report(&fault));
            fault.exit_code().unwrap_or(EXIT_USAGE)
        }
    }
}
