//! Plans the dataset: scenes, agents, weather; keeps the maps.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(spawn_planner::STAGE, build_stamp::STAMP)
}
