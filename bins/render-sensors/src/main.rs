//! Renders cameras, lidar, radar, GNSS and IMU from the log.

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

fn main() -> ExitCode {
    // What is asked of devices needs no configuration and no store.
    let words: Vec<String> = std::env::args().collect();
    match &words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [_, "--device", "list"] | [_, "--device=list"] => {
            runner::say(device::list().trim_end());
            ExitCode::SUCCESS
        }
        [_, "--try-device", ..] => {
            let DeviceOptions { name, memory_bytes } = Probe::parse_from(&words).device.into();
            match Device::open(&Choice::from(&*name), memory_bytes) {
                Ok(_) => ExitCode::SUCCESS,
                Err(e) => {
                    runner::init_logging();
                    tracing::error!("{e}");
                    ExitCode::from(runner::EXIT_USAGE)
                }
            }
        }
        _ => arguments::stage::run(render_sensors::STAGE, build_stamp::STAMP),
    }
}
