//! Makes voxel grids from the log.

fn main() -> std::process::ExitCode {
    arguments::stage::run(occupancy_gt::STAGE, build_stamp::STAMP)
}
