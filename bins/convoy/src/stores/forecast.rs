//! What a configuration will cost, and how much of it is still to do.

use std::path::{Path, PathBuf};

use runner::forecast::{Machine, span};
use runner::{
    EXIT_DONE, Graph, Programs, STAMP_LEN, StageError, State, Status, Suspicious, say, settings_or_faults,
};
use store::{Scope, Store};

use super::progress::Standing;
use super::run::{run_program, stage_program};
use super::status::opened;

/// What `convoy forecast` takes.
#[derive(Debug, clap::Args)]
pub(crate) struct ForecastArgs {
    /// Dataset configuration (TOML, or YAML of SimBEV2X), or the name of one that comes with this program.
    #[arg(long, value_name = "FILE")]
    config: PathBuf,
    /// The store: what of it is done already need not be made. Without one, all is counted.
    #[arg(long, value_name = "DIR")]
    store: Option<PathBuf>,
    /// Folder with OpenDRIVE files for maps that the configuration names.
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
    /// Count what a run with `--grow` would plan.
    #[arg(long, conflicts_with = "edition", requires = "store")]
    grow: bool,
    /// Count what a run with `--edition N` would plan.
    #[arg(long, value_name = "N", requires = "store")]
    edition: Option<u32>,
    /// Warnings about the configuration and about the plan are errors (2).
    #[arg(long)]
    strict: bool,
}

/// Says what the plan comes to, which the planner knows, and what of it is left; the exit code.
pub(crate) fn forecast(args: &ForecastArgs, stamp: &[u8; STAMP_LEN]) -> u8 {
    let mut planner = match stage_program(Graph::get().planner().name) {
        Ok(planner) => planner,
        Err(code) => return code,
    };
    // The planner wants a place, of which it only looks whether something is there.
    let place =
        args.store.clone().unwrap_or_else(|| std::env::temp_dir().join("convoy-forecast-of-no-store"));
    planner.arg("--config").arg(&args.config).arg("--store").arg(place);
    if let Some(maps) = &args.maps {
        planner.arg("--maps").arg(maps);
    }
    if let Some(edition) = args.edition {
        planner.arg("--edition").arg(edition.to_string());
    }
    planner.args(args.grow.then_some("--grow")).args(args.strict.then_some("--strict"));
    let code = run_program(planner.args(["--dry-run", "--progress", "none"]));
    let Some(store) = args.store.as_deref().filter(|_| code == EXIT_DONE) else { return code };
    match left(args, store, stamp) {
        Ok(line) => {
            line.iter().for_each(|line| say(line));
            EXIT_DONE
        }
        Err(e) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
    }
}

/// What is still to do of a store that is planned by this configuration.
fn left(args: &ForecastArgs, place: &Path, stamp: &[u8; STAMP_LEN]) -> Result<Option<String>, StageError> {
    if Store::open(place)?.manifest(Scope::Plan, Graph::get().planner().name)?.is_none() {
        return Ok(None);
    }
    let settings = settings_or_faults(&args.config, Suspicious::Unsaid);
    let programs = Programs::of_build(stamp, None);
    let wish = arguments::stage::edition_wish(args.grow, args.edition);
    let (store, editions) = opened(settings, place, wish)?;
    let Some(editions) = &editions else { return Ok(None) };
    let status = Status::new(&store, editions, &programs);
    if status.state(Graph::get().planner(), Scope::Plan)? != State::Done {
        return Ok(None);
    }
    let standing = Standing::of(&status)?;
    let (Machine { cores, times }, scenes) = (Machine::measured(), standing.scenes_left());
    let (amount, unit) = span(standing.left_s * times / cores.max(1) as f64);
    Ok(Some(match scenes {
        0 => "still to do: nothing of any scene".to_owned(),
        _ => format!(
            "still to do: {scenes} of {} scenes, {:.0} % of the work: about {amount} {unit} on {cores} cores of this machine",
            standing.scenes.len(),
            100.0 * standing.share_left(),
        ),
    }))
}
