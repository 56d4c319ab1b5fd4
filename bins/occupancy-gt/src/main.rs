//! Makes voxel grids from the log.

fn main() -> std::process::ExitCode {
    occupancy_gt::program(std::env::args_os().collect())
}
