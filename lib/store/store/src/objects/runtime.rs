//! The asynchronous edge: stages stay synchronous, and each request is waited for here.

use std::future::Future;
use std::io;
use std::sync::OnceLock;

use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

/// What drives all requests of this process.
fn runtime() -> io::Result<&'static Runtime> {
    static RUNTIME: OnceLock<Result<Runtime, String>> = OnceLock::new();
    let made = RUNTIME.get_or_init(|| {
        let mut builder = tokio::runtime::Builder::new_multi_thread();
        builder.worker_threads(2).thread_name("requests").enable_all().build().map_err(|e| e.to_string())
    });
    made.as_ref().map_err(|problem| io::Error::other(format!("cannot start threads: {problem}")))
}

/// Chooses who encrypts. Clients cannot be made before.
pub(super) fn choose_encryption() {
    // There may be one already: then it is as good.
    let _ = rustls::crypto::ring::default_provider().install_default();
}

/// Waits for a request.
///
/// # Errors
/// Its own, or threads cannot be started.
pub(super) fn wait<T, E: From<io::Error>>(request: impl Future<Output = Result<T, E>>) -> Result<T, E> {
    runtime()?.block_on(request)
}

/// Starts a request that nobody waits for yet.
///
/// # Errors
/// Threads cannot be started.
pub(super) fn start<T: Send + 'static>(
    request: impl Future<Output = T> + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    Ok(runtime()?.spawn(request))
}
