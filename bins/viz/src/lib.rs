#![doc = include_str!("../README.md")]

mod archive;
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

use arguments::viz::PictureCommand;
use runner::{EXIT_DONE, EXIT_USAGE, report};

use error::VizError;

/// Runs a command; its exit code.
#[must_use]
pub fn run(command: &PictureCommand) -> u8 {
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
