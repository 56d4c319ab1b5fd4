//! Merges the boxes of all agents and makes tracks.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(merge_tracks::STAGE, build_stamp::STAMP)
}
