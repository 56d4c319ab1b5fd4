#![doc = include_str!("../README.md")]

pub mod device;
pub mod evaluate;
pub mod export;
pub mod import;
pub mod stage;
pub mod viz;

use clap::{Command, CommandFactory, Subcommand};

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
