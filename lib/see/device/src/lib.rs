//! Which device looks at scenes: the one place that chooses one and builds its renderers and painters.
//!
//! A device changes no byte of what is made. Stages, benchmarks and examples get their renderer and painter
//! from here; only tests of one name its type.

mod choice;
mod device;
mod error;
mod renderer;

pub use choice::{Choice, list};
pub use device::Device;
pub use error::DeviceError;
pub use gpu::Work;
pub use renderer::DeviceRenderer;
