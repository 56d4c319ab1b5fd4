#![doc = include_str!("../README.md")]

mod about;
pub mod device;
pub mod evaluate;
pub mod export;
pub mod import;
pub mod stage;
pub mod viz;

use std::ffi::OsString;

use clap::{Command, CommandFactory, Parser, Subcommand};
use runner::STAMP_LEN;

/// Reads the words of a program, of which the first is its name as it was typed; clap's own message ends the
/// program where they are wrong. `stamp` is the build's (`build_stamp::STAMP`).
#[must_use]
pub fn parse<P: Parser>(words: &[OsString], stamp: &[u8; STAMP_LEN]) -> P {
    let command = P::command().version(runner::release(stamp));
    P::from_arg_matches(&command.get_matches_from(words)).unwrap_or_else(|e| e.exit())
}

/// The programs' command lines by the names that they have as commands of `convoy`, but for `export`, whose
/// layouts tell their options.
#[must_use]
pub fn commands() -> Vec<Command> {
    let pictures = viz::PictureCommand::augment_subcommands(Command::new("viz"));
    let mut commands = vec![import::Import::command(), evaluate::Evaluate::command(), viz::Stills::command()];
    // Stills alone need no word for what is wanted.
    let others = pictures.get_subcommands().filter(|command| command.get_name() != "viz");
    commands.extend(others.cloned());
    commands
}
