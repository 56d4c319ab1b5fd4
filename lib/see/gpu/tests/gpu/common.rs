//! Devices for tests.

use std::sync::Arc;

use gpu::{Adapter, Eyes, GpuError};
use testkit::{Need, skip};

/// Calls with what is opened of every adapter that is usable, those in software too.
pub(crate) fn with_each<T>(open: impl Fn(&Adapter) -> Result<T, GpuError>, each: impl Fn(T)) {
    let mut missing =
        "there is no Vulkan adapter (Debian's mesa-vulkan-drivers has one in software)".to_owned();
    let mut tried = 0;
    for adapter in gpu::adapters() {
        match open(&adapter) {
            Ok(opened) => {
                each(opened);
                tried += 1;
            }
            Err(e) => missing = format!("{adapter} is not usable: {e}"),
        }
    }
    if tried == 0 {
        skip(Need::Vulkan, &missing);
    }
}

/// Calls with every adapter that sees as the CPU does.
pub(crate) fn with_eyes(each: impl Fn(&Arc<Eyes>)) {
    with_each(|adapter| gpu::eyes(adapter, None), |eyes| each(&eyes));
}
