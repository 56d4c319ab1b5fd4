//! Why there is no device.

/// The device that is meant cannot be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// No GPU is usable.
    #[error("--device gpu: no GPU is usable: {why}")]
    NoGpu {
        /// What is wrong with each adapter.
        why: String,
    },
    /// No adapter has the name.
    #[error("--device {name}: there is no such adapter; {adapters}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        adapters: String,
    },
    /// The name fits several.
    #[error("--device {name}: several adapters fit: say a number; {adapters}")]
    Several {
        /// What was asked for.
        name: String,
        /// What there is.
        adapters: String,
    },
    /// The adapter cannot be used.
    #[error("--device {name}: {adapter} is not usable: {problem}")]
    Unusable {
        /// What was asked for.
        name: String,
        /// The adapter, with its driver.
        adapter: String,
        /// What is wrong with it.
        problem: Box<gpu::GpuError>,
    },
}
