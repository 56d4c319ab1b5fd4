//! Counts points per box, judges validity, fills voxel grids, and says what lidars saw of them.

fn main() -> std::process::ExitCode {
    arguments::stage::run(postprocess_valid::STAGE, build_stamp::STAMP)
}
