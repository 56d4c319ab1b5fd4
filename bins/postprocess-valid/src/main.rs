//! Counts points per box, judges validity, fills voxel grids, and says what lidars saw of them.

fn main() -> std::process::ExitCode {
    postprocess_valid::program(std::env::args_os().collect())
}
