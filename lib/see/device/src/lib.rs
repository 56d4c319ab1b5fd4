//! Which device looks at scenes: the one place that chooses one and builds its renderers.
//!
//! A device changes no byte of what is made. Stages, benchmarks and examples get their renderer from here;
//! only tests of a renderer name its type.

mod choice;
mod device;
mod error;
mod renderer;

pub use choice::{Choice, list};
pub use device::Device;
pub use error::DeviceError;
pub use gpu::Seen;
pub use renderer::DeviceRenderer;
