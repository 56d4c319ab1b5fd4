//! Checks the labels of a finished store against each other.
//!
//! Only files are read, and nothing is shared with the programs that made them but the numbers and names of
//! `schema`: tables by `parquet`, arrays by `rawzip` and a header parser of its own, images by `png`;
//! rotations, projections and counts are written anew here. What exempts from a check is read from the
//! configuration and from columns, and told.

mod checks;
mod config;
mod files;
mod ledger;
mod optics;
mod report;
mod rules;
mod scene;
mod shares;
mod space;
mod standing;
mod vector_map;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser};
use rayon::prelude::*;
use schema::FORMAT_VERSION;

use config::Config;
use files::read_json;
use ledger::Ledger;
use rules::Rule;
use scene::Scene;
use standing::Standing;

/// All is there, and nothing is wrong.
const RIGHT: u8 = 0;
/// Something is wrong.
const WRONG: u8 = 1;
/// No such store, or bad arguments.
const USAGE: u8 = 2;
/// Nothing is wrong in what is there, and that is not all.
const UNFINISHED: u8 = 3;

/// What to check.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The store: a folder.
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Only these scenes, as 0,3,5-9.
    #[arg(long, value_name = "LIST")]
    scenes: Option<String>,
    /// Of each agent's sensors and arrays look at every so many frames; sums over frames are not compared
    /// then.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// Worker threads; as many as there are cores by default.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Checks the labels of a store against each other, from its files alone. Exit codes: 0 all is there and
/// nothing is wrong, 1 something is wrong, 2 no such store or bad arguments, 3 nothing is wrong in what is
/// there, but the store is unfinished.
#[derive(Debug, Parser)]
#[command(name = "check", version)]
struct Program {
    #[command(flatten)]
    check: CheckArgs,
}

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    ExitCode::from(run(&Program::parse_from(words).check))
}

/// Checks a store and prints the report; the exit code.
#[must_use]
pub fn run(args: &CheckArgs) -> u8 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build();
    let outcome = match pool {
        Ok(pool) => pool.install(|| check(args)),
        Err(fault) => Err(fault.to_string()),
    };
    match outcome {
        Ok((text, code)) => {
            say(&text);
            code
        }
        Err(fault) => {
            complain(&fault);
            USAGE
        }
    }
}

/// Prints the report. A reader who has closed the pipe (`check | head`) has seen enough.
fn say(text: &str) {
    let _ = write!(std::io::stdout(), "{text}");
}

fn complain(fault: &str) {
    let _ = writeln!(std::io::stderr(), "error: {fault}");
}

/// The report on a store, and the exit code.
fn check(args: &CheckArgs) -> Result<(String, u8), String> {
    let store = args.store.as_path();
    if !store.join("dataset.json").is_file() {
        return Err(format!("{} is no store: it has no dataset.json", store.display()));
    }
    let dataset = read_json(&store.join("dataset.json")).map_err(|e| e.to_string())?;
    if let Some(found) =
        dataset["format_version"].as_u64().filter(|v| !(1..=u64::from(FORMAT_VERSION)).contains(v))
    {
        return Err(format!(
            "{}: store format {found}, this program checks 1 to {FORMAT_VERSION} (use the Convoy that made the store)",
            store.display()
        ));
    }
    let config = Config::of(&dataset).ok_or_else(|| format!("{}: has no configuration", store.display()))?;
    let there = scene_numbers(store);
    let wanted = args.scenes.as_deref().map(scene_list).transpose()?;
    let is_wanted = |scene: u32| wanted.as_ref().is_none_or(|wanted| wanted.contains(&scene));
    let scenes: Vec<u32> = there.iter().copied().filter(|&scene| is_wanted(scene)).collect();
    if there.is_empty() {
        return Err(format!("{}: no scene is begun: `convoy run` makes them", store.display()));
    }
    if scenes.is_empty() {
        return Err(format!("{}: has no such scenes", store.display()));
    }
    let mut ledger = Ledger::at("dataset");
    let standing = Standing::of(store, &there, is_wanted, &mut ledger);
    let (mut frames, mut agent_frames) = (0, 0);
    for &number in &scenes {
        let (found, counted) = check_scene(store, &config, number, args.every);
        frames += counted[0];
        agent_frames += counted[1];
        ledger.take(found);
    }
    let complete = scenes.len() == there.len() && args.every == 1;
    if !store.join("stats/boxes_per_class.parquet").is_file() {
        ledger.skip(Rule::Statistics, "there are none yet");
    } else if complete {
        checks::statistics::check(store, &mut ledger);
    } else {
        ledger.skip(Rule::Statistics, "not all scenes and frames are looked at");
    }
    let heading = format!(
        "{} ({}): {} scenes, {frames} frames, {agent_frames} agent-frames",
        store.display(),
        config.name(),
        scenes.len()
    );
    let code = match (ledger.is_clean(), standing.is_whole()) {
        (true, true) => RIGHT,
        (true, false) => UNFINISHED,
        (false, _) => WRONG,
    };
    Ok((report::report(&heading, &ledger, &standing), code))
}

/// Checks a scene; how many frames and agent-frames it has.
fn check_scene(store: &Path, config: &Config, number: u32, every: u32) -> (Ledger, [u64; 2]) {
    let mut ledger = Ledger::at(format!("scene {number}"));
    let Some(scene) = Scene::open(store, number, &mut ledger) else { return (ledger, [0; 2]) };
    checks::log::check(&scene, &mut ledger);
    checks::seats::check(&scene, &mut ledger);
    let (said, wanted) = (&scene.facts["label_every_n_frames"], config.label_every());
    ledger.expect(Rule::Times, said.as_u64() == Some(wanted.into()), || {
        format!("log/scene.json: label_every_n_frames is {said}, the configuration says {wanted}")
    });
    let tables: Vec<Ledger> = scene
        .outputs
        .par_iter()
        .map(|named| {
            let mut part = Ledger::at(format!("scene {number}"));
            let inside = named.path.strip_prefix(&scene.folder).unwrap_or(&named.path);
            let rate = config.every_of(&inside.to_string_lossy().replace('\\', "/"));
            checks::tables::check(&scene, named, rate, every, &mut part);
            part
        })
        .collect();
    tables.into_iter().for_each(|part| ledger.take(part));
    let names: Vec<&String> = scene.agents.keys().collect();
    let agents: Vec<_> = names
        .into_par_iter()
        .map(|name| {
            let mut part = Ledger::at(format!("scene {number} {name}"));
            let boxes = checks::agent::check(&scene, config, name, every, &mut part);
            (name.clone(), boxes, part)
        })
        .collect();
    let mut lists = BTreeMap::new();
    for (name, boxes, part) in agents {
        ledger.take(part);
        lists.insert(name, boxes);
    }
    checks::sightings::check(&scene, &lists, &mut ledger);
    let merged = checks::tracks::check(&scene, &lists, config.label_every(), &mut ledger);
    checks::windows::check(&scene, &merged, config.windows(), &mut ledger);
    if scene.is_imported {
        let why = format!("scene {number}: it was imported, and its log holds what its labels say");
        Rule::OF_THE_LOG.iter().for_each(|rule| ledger.exempt(*rule, why.clone()));
    }
    let frames = u64::from(scene.frames);
    (ledger, [frames, frames * scene.agents.len() as u64])
}

/// Numbers of the scenes that a store has folders of, ascending.
fn scene_numbers(store: &Path) -> Vec<u32> {
    let entries = std::fs::read_dir(store.join("scenes")).into_iter().flatten().flatten();
    let mut numbers: Vec<u32> = entries.filter_map(|e| e.file_name().to_str()?.parse().ok()).collect();
    numbers.sort_unstable();
    numbers
}

/// Numbers as in `0,3,5-9`.
fn scene_list(text: &str) -> Result<Vec<u32>, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let parse = |number: &str| number.trim().parse::<u32>().map_err(|e| format!("--scenes {text}: {e}"));
        numbers.extend(parse(first)?..=parse(last)?);
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_listed_singly_and_in_ranges() {
        assert_eq!(scene_list("0,3,5-7"), Ok(vec![0, 3, 5, 6, 7]));
        assert!(scene_list("0,x").is_err());
    }

    #[test]
    fn a_folder_without_a_dataset_is_no_store() {
        let folder = tempfile::tempdir().expect("a folder");
        let args = CheckArgs { store: folder.path().to_owned(), scenes: None, every: 1, threads: Some(1) };
        assert_eq!(run(&args), USAGE);
    }
}
