//! Says which GPUs there are, and of each whether it computes as the CPU does: exit code 0 if one does.
#![allow(clippy::print_stdout, reason = "what it is for")]

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut usable = 0;
    for adapter in gpu::adapters() {
        let start = Instant::now();
        match gpu::open(&adapter) {
            Ok(_) => {
                usable += 1;
                println!(
                    "{adapter}: computes as the CPU does (tried in {:.2} s)",
                    start.elapsed().as_secs_f64()
                );
            }
            Err(e) => println!("{adapter}: not usable: {e}"),
        }
    }
    if usable == 0 {
        println!(
            "no usable GPU (Vulkan drivers are looked for in the folders and by the variables of its loader)"
        );
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
