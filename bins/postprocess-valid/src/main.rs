//! Counts points per box, judges validity, fills voxel grids.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(postprocess_valid::STAGE)
}
