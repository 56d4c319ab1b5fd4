//! Merges the boxes of all agents and makes tracks.

fn main() -> std::process::ExitCode {
    arguments::stage::run(merge_tracks::STAGE, build_stamp::STAMP)
}
