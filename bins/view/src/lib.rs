//! Shows a store in the browser.
//!
//! A server for this machine alone gives one page (its sources are in `viewer/`, its bundle in `assets/`),
//! lists of what the store has, and byte ranges of its files; the page decodes Parquet and npz itself. An
//! excerpt is the same page with a small store inside it, as one file.

mod content;
mod embed;
mod error;
mod http;
mod listing;
mod object;
mod open;
mod page;
mod paths;
mod predictions;
mod server;
mod site;

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser};

use embed::Excerpt;
use error::{ViewError, of_place};
use server::Server;
use site::Site;

/// Exit codes: done, something could not be read or written, no such store or arguments, a place that is
/// away.
const CODES: [u8; 4] = [0, 1, 2, 75];

/// What to show, and how.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// The store: a folder, or s3://, az://, gs://.
    #[arg(value_name = "STORE")]
    store: PathBuf,
    /// The port (default: 8461, or a free one if that is taken).
    #[arg(long, value_name = "PORT")]
    port: Option<u16>,
    /// Only print the address; open no browser.
    #[arg(long)]
    no_open: bool,
    /// Boxes that a model found, shown over those of the store: the Parquet file that `evaluate` reads.
    #[arg(long, value_name = "FILE")]
    predictions: Option<PathBuf>,
    /// Write an excerpt into this HTML file instead: the page with its data inside, below 15 MB, without
    /// pictures unless `--cameras` names some, and without voxels. Of lidar points so many stay as fit.
    #[arg(long, value_name = "FILE", requires = "scene")]
    embed: Option<PathBuf>,
    /// The excerpt's scene.
    #[arg(long, value_name = "N", requires = "embed")]
    scene: Option<u32>,
    /// Its frames, the last one not included; the first 20 by default.
    #[arg(long, value_name = "A..B", requires = "embed", value_parser = frame_range)]
    frames: Option<(u32, u32)>,
    /// Its agents, with commas between them; all by default.
    #[arg(long, value_name = "LIST", requires = "embed", value_delimiter = ',')]
    agents: Option<Vec<String>>,
    /// Cameras whose pictures it has, with commas between them.
    #[arg(long, value_name = "LIST", requires = "embed", value_delimiter = ',')]
    cameras: Vec<String>,
}

/// Shows a store in the browser: opens a page on this machine that plays its scenes. Nothing is written,
/// nothing leaves the machine.
#[derive(Debug, Parser)]
#[command(name = "view", version)]
struct Program {
    #[command(flatten)]
    view: ViewArgs,
}

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    ExitCode::from(run(&Program::parse_from(words).view))
}

/// Shows the store until the program is stopped, or writes an excerpt; the exit code.
#[must_use]
pub fn run(args: &ViewArgs) -> u8 {
    let site = match Site::open(&args.store, args.predictions.as_deref()) {
        Ok(site) => site,
        Err(fault) => {
            complain(&fault);
            let is_away = matches!(&fault, ViewError::Store(error) if error.is_transient());
            return CODES[if is_away { 3 } else { 2 }];
        }
    };
    let outcome = match &args.embed {
        Some(file) => write_excerpt(args, &site, file),
        None => serve(args, site),
    };
    match outcome {
        Ok(()) => CODES[0],
        Err(fault) => {
            complain(&fault);
            CODES[1]
        }
    }
}

fn serve(args: &ViewArgs, site: Site) -> Result<(), ViewError> {
    let server = Server::bind(args.port, site).map_err(|e| ViewError::Port(args.port.unwrap_or(0), e))?;
    let address = server.address();
    say(&format!("{} is shown at {address} (Ctrl-C ends it)", args.store.display()));
    if !args.no_open && !open::in_browser(&address) {
        say("no browser could be started here: open the address in one on this machine");
    }
    server.run();
    Ok(())
}

fn write_excerpt(args: &ViewArgs, site: &Site, file: &Path) -> Result<(), ViewError> {
    let excerpt = Excerpt {
        scene: args.scene.unwrap_or_default(),
        frames: args.frames,
        agents: args.agents.clone(),
        cameras: args.cameras.clone(),
    };
    let page = excerpt.page(site)?;
    std::fs::write(file, &page.html).map_err(of_place(&file.display().to_string()))?;
    say(&format!("{}: {}, {:.1} MB", file.display(), page.what, page.html.len() as f64 / 1e6));
    Ok(())
}

fn frame_range(text: &str) -> Result<(u32, u32), String> {
    let range = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    range
        .filter(|(a, b)| a < b)
        .ok_or_else(|| "expected two numbers as 0..20, the second one greater".to_owned())
}

/// Prints a line, if anybody still reads (a closed pipe is no error).
fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

fn complain(fault: &ViewError) {
    let _ = writeln!(std::io::stderr(), "error: {fault}");
}

#[cfg(test)]
mod tests {
    use super::frame_range;

    #[test]
    fn frames_are_two_numbers_in_order() {
        assert_eq!(frame_range("0..20"), Ok((0, 20)));
        assert_eq!(frame_range("7..8"), Ok((7, 8)));
        for wrong in ["", "5", "5..5", "6..5", "a..b", "..3", "3..", "-1..3"] {
            assert!(frame_range(wrong).is_err(), "{wrong}");
        }
    }
}
