//! Plans the dataset: scenes, agents, weather; keeps the maps.

fn main() -> std::process::ExitCode {
    spawn_planner::program(std::env::args_os().collect())
}
