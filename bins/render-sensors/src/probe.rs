//! What is asked of devices, before there is a configuration or a store.

use std::ffi::OsString;
use std::process::ExitCode;

use arguments::device::DeviceArgs;
use clap::Parser;
use device::{Choice, Device};
use runner::DeviceOptions;

/// Whether a device can be had; `convoy run` asks before anything is planned.
#[derive(Parser)]
struct Probe {
    #[arg(long, required = true)]
    try_device: bool,
    #[command(flatten)]
    device: DeviceArgs,
}

/// Answers what is asked of devices; none where something else is wanted.
pub(crate) fn answer(words: &[OsString]) -> Option<ExitCode> {
    let said: Vec<_> = words.iter().skip(1).map(|word| word.to_string_lossy()).collect();
    match &said.iter().map(AsRef::as_ref).collect::<Vec<&str>>()[..] {
        ["--device", "list"] | ["--device=list"] => {
            runner::say(device::list().trim_end());
            Some(ExitCode::SUCCESS)
        }
        ["--try-device", ..] => {
            let DeviceOptions { name, memory_bytes } = Probe::parse_from(words).device.into();
            Some(match Device::open(&Choice::from(&*name), memory_bytes) {
                Ok(_) => ExitCode::SUCCESS,
                Err(e) => {
                    runner::init_logging();
                    tracing::error!("{e}");
                    ExitCode::from(runner::EXIT_USAGE)
                }
            })
        }
        _ => None,
    }
}
