//! Merges the boxes of all agents and makes tracks.

fn main() -> std::process::ExitCode {
    merge_tracks::program(std::env::args_os().collect())
}
