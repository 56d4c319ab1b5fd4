//! SIGTERM and SIGINT: stop at the next frame.

use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(false)));

/// Starts to listen. A second signal ends the process at once.
pub fn listen() {
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        // Without handlers a signal simply kills the process, which the store survives.
        let _ = signal_hook::flag::register_conditional_shutdown(
            signal,
            crate::EXIT_TRY_AGAIN.into(),
            STOP.clone(),
        );
        let _ = signal_hook::flag::register(signal, STOP.clone());
    }
}

/// Whether a signal came.
#[must_use]
pub fn stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Stops as if a signal had come.
pub(crate) fn stop() {
    STOP.store(true, Ordering::Relaxed);
}
