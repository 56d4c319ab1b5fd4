//! All programs as one file: the name by which it is called decides which of them runs.

use std::ffi::OsString;
use std::process::ExitCode;

/// A program: its words in, its exit code out.
type Program = fn(Vec<OsString>) -> ExitCode;

/// The programs by their names, and by the commands of `convoy` that start them under another one.
const PROGRAMS: [(&str, Program); 17] = [
    ("bev-gt", bev_gt::program),
    ("check", check::program),
    ("convoy", convoy::program),
    ("evaluate", evaluate::program),
    ("export", export::program),
    ("film", viz::program),
    ("import", import::program),
    ("merge-tracks", merge_tracks::program),
    ("occupancy-gt", occupancy_gt::program),
    ("postprocess-valid", postprocess_valid::program),
    ("preview", viz::program),
    ("render-sensors", render_sensors::program),
    ("simulate-and-log", simulate_and_log::program),
    ("spawn-planner", spawn_planner::program),
    ("stats", stats::program),
    ("view", view::program),
    ("viz", viz::program),
];

/// The program of a name; `convoy`, which has commands for all others, where there is none of that name.
fn program_of(name: &str) -> Program {
    let found = PROGRAMS.iter().find(|(known, _)| *known == name);
    found.map_or(convoy::program, |(_, program)| *program)
}

fn main() -> ExitCode {
    runner::declare_all_programs();
    let words: Vec<OsString> = std::env::args_os().collect();
    let name = words.first().map(|typed| runner::name_of(typed)).unwrap_or_default();
    program_of(&name)(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_program_is_in_it() {
        let bins = std::fs::read_dir("..").expect("the folder of all programs");
        let names = bins.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut there: Vec<String> = names.filter(|name| name != "all").collect();
        there.sort_unstable();
        let known = PROGRAMS.iter().map(|(name, _)| *name);
        let known: Vec<&str> = known.filter(|name| !["film", "preview"].contains(name)).collect();
        assert_eq!(known, there);
    }
}
