//! Plans the dataset: scenes, agents, weather; keeps the maps.

fn main() -> std::process::ExitCode {
    arguments::stage::run(spawn_planner::STAGE, build_stamp::STAMP)
}
