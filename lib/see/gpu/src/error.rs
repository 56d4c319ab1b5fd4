//! Why a GPU is not used.

/// A GPU cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The adapter lacks something that shaders need.
    #[error("lacks {feature}")]
    Feature {
        /// What it lacks.
        feature: &'static str,
    },
    /// The driver gave no device.
    #[error("the driver gives no device")]
    Open(#[source] wgpu::RequestDeviceError),
    /// A shader could not be translated.
    #[error("a shader is no WGSL: {problem}")]
    Shader {
        /// What is wrong, with its place.
        problem: String,
    },
    /// Device or driver failed.
    #[error("the device failed: {problem}")]
    Device {
        /// What the driver said.
        problem: String,
    },
    /// It has no room, or may not use so much.
    #[error("no room in the device's memory: {problem}")]
    Memory {
        /// What was needed.
        problem: String,
    },
    /// It did not see a scene as the CPU does.
    #[error("driver {driver}: column {column}, row {row} of a test scene is not what the CPU sees")]
    Unequal {
        /// Version of the driver.
        driver: String,
        /// Column of the first pixel that differs.
        column: usize,
        /// Its row.
        row: usize,
    },
    /// It did not follow a ray as the CPU does.
    #[error("driver {driver}: ray {ray} through a test scene does not meet what the CPU meets")]
    UnequalRay {
        /// Version of the driver.
        driver: String,
        /// The first ray that differs.
        ray: usize,
    },
    /// It did not compute as the CPU does.
    #[error("driver {driver}: {operation} of {operands} gives {found:#010x}, not {expected:#010x}")]
    Inexact {
        /// Version of the driver.
        driver: String,
        /// What was computed.
        operation: &'static str,
        /// Of which numbers.
        operands: String,
        /// Bits of the device's answer.
        found: u32,
        /// Bits of the CPU's.
        expected: u32,
    },
}
