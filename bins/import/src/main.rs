//! Makes a store of a dataset in another layout.

fn main() -> std::process::ExitCode {
    import::program(std::env::args_os().collect())
}
