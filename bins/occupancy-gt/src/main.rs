//! Makes voxel grids from the log.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(occupancy_gt::STAGE, build_stamp::STAMP)
}
