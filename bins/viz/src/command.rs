//! The command line: what is to be drawn follows from the first word, or from the program's name where
//! `convoy preview` and `convoy film` start it.

use std::ffi::OsString;

use arguments::viz::{FilmArgs, PictureCommand, PreviewArgs, Stills};
use clap::{Command, FromArgMatches, Parser, Subcommand};

/// Draws what a finished store holds.
#[derive(Debug, Parser)]
#[command(name = "viz", version)]
struct Others {
    #[command(subcommand)]
    command: Other,
}

#[derive(Debug, Subcommand)]
enum Other {
    /// Draws a contact sheet of a frame as an agent has it: cameras, lidar, masks, voxels, map.
    Preview(PreviewArgs),
    /// Draws a scene as an agent sees it, as an animated PNG, and as MP4 where there is an ffmpeg.
    Film(FilmArgs),
}

impl From<Other> for PictureCommand {
    fn from(other: Other) -> Self {
        match other {
            Other::Preview(args) => Self::Preview(args),
            Other::Film(args) => Self::Film(args),
        }
    }
}

/// Reads the words, of which the first is the program's name; clap's own message ends the program where they
/// are wrong.
pub(crate) fn parse(words: &[OsString]) -> PictureCommand {
    let name = words.first().map(|typed| runner::name_of(typed)).unwrap_or_default();
    match &*name {
        "preview" => PictureCommand::Preview(alone("preview", words)),
        "film" => PictureCommand::Film(alone("film", words)),
        // A command that may be left out cannot be told from options by `clap` where these are required.
        _ if words.get(1).is_some_and(|first| first == "preview" || first == "film") => {
            arguments::parse::<Others>(words, build_stamp::STAMP).command.into()
        }
        _ => PictureCommand::Viz(arguments::parse::<Stills>(words, build_stamp::STAMP).args),
    }
}

/// The arguments of a command that is a program of its own.
fn alone<A: FromArgMatches>(name: &'static str, words: &[OsString]) -> A {
    let all = Other::augment_subcommands(Command::new("viz"));
    let command = all.find_subcommand(name).cloned().unwrap_or_else(|| Command::new(name));
    A::from_arg_matches(&command.get_matches_from(words)).unwrap_or_else(|e| e.exit())
}
