//! Pictures, contact sheets and films of the scenes of a finished store.

use std::process::ExitCode;

use arguments::viz::{FilmArgs, PictureCommand, PreviewArgs, Stills};
use clap::{Parser, Subcommand};

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

fn main() -> ExitCode {
    // A command that may be left out cannot be told from options by `clap` where these are required.
    let is_other = std::env::args_os().nth(1).is_some_and(|first| first == "preview" || first == "film");
    let command = if is_other {
        match Others::parse().command {
            Other::Preview(args) => PictureCommand::Preview(args),
            Other::Film(args) => PictureCommand::Film(args),
        }
    } else {
        PictureCommand::Viz(Stills::parse().args)
    };
    runner::init_logging();
    ExitCode::from(viz::run(&command))
}
